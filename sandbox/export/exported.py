"""What an export gives back: the model's text, and what its reader has to know."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Export:
    """A model in another program's format.

    ``notes`` say, one sentence each, where it differs from the scene;
    ``left_out`` are the names of the elements that it does without.
    """

    text: str
    notes: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
