"""Set A and Set G of the verification cases, so that their numbers are written down once."""

from __future__ import annotations

from ..verification.sets import SET_A, SET_G, SET_G_TABLE, DiscRow, FingerSet

__all__ = ["SET_A", "SET_G", "SET_G_TABLE", "DiscRow", "FingerSet"]
