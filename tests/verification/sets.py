"""Set A and Set G: see :mod:`sandbox.study.reference_fingers`."""

from sandbox.study.reference_fingers import MM, SET_A, SET_G, SET_G_TABLE, DiscRow, FingerSet

__all__ = ["MM", "SET_A", "SET_G", "SET_G_TABLE", "DiscRow", "FingerSet"]
