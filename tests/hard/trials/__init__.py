"""All trials, in the order of the table."""

from __future__ import annotations

from tests.hard.trial import Trial
from tests.hard.trials import (
    boxes,
    chains,
    clearance,
    cords,
    cradles,
    drives,
    fingers,
    linkages,
    loops,
    rods,
)

TRIALS: tuple[Trial, ...] = tuple(
    trial for room in (
        chains, loops, linkages, drives, cords, fingers, boxes, cradles, rods, clearance)
    for trial in room.trials())

__all__ = ["TRIALS"]
