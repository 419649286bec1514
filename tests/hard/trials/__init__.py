"""All trials."""

from __future__ import annotations

from tests.hard.trial import Trial
from tests.hard.trials import boxes, chains, cords, cradles, fingers, linkages, rods

TRIALS: tuple[Trial, ...] = tuple(
    trial for module in (chains, linkages, cords, fingers, boxes, cradles, rods)
    for trial in module.trials())
