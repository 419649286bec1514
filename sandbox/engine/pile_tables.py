"""Tables of the free bodies that only contacts connect, and room to solve their contacts."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.engine.blocks import BITS
from sandbox.engine.plan import Pattern
from sandbox.engine.state import PILE_BODY
from sandbox.numeric import Array, Integers, Records

FEWEST = 12
"""Fewer bodies are no pile: too few rows for :mod:`sandbox.engine.piles` to pay."""


def loose_bodies(
    pattern: Pattern, inverse_mass: Array, joints: Records, shapes: Records,
) -> Integers:
    """The number of each body among those that may be in a pile, -1 for others, [nb]."""
    count = len(inverse_mass)
    loose = (inverse_mass[:, 0] > 0.0) & np.isin(np.arange(count), shapes["body"])
    loose &= pattern.hubs[:count, 0] < 0
    loose[pattern.entry_body[pattern.entry_body < count]] = False
    loose[joints["a"]] = loose[joints["b"]] = False
    if np.count_nonzero(loose) < FEWEST:
        loose[:] = False
    return np.where(loose, np.cumsum(loose) - 1, -1).astype(np.int64)


def pile_bodies(loose: Integers) -> Records:
    """PILE_BODY of all of them."""
    made = np.zeros(np.count_nonzero(loose >= 0), PILE_BODY)
    made["number"], made["place"] = np.flatnonzero(loose >= 0), -1
    return made


def pile_tables(count: int) -> dict[str, Any]:
    """Arrays of a :class:`sandbox.engine.state.Result` for so many bodies.

    There is room for all pairs; the system gives memory only to what is used of it.
    """
    slots = count * (count - 1) // 2
    return {
        "pile_starts": np.zeros(count + 1, dtype=np.int64),
        "pile_below": np.zeros(slots, dtype=np.int64),
        "pile_adjacent": np.zeros((count, count // BITS + 1), dtype=np.int64),
        "pile_work": np.zeros((3, count), dtype=np.int64),
        "pile_vectors": np.zeros((7, count, 3)), "pile_diagonal": np.zeros((count, 3, 3)),
        "pile_lower": np.zeros((slots, 3, 3)), "pile_upper": np.zeros((slots, 3, 3))}
