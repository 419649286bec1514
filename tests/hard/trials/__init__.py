"""All trials."""

from __future__ import annotations

from tests.hard.trial import Trial
from tests.hard.trials import boxes, chains, cords, fingers

TRIALS: tuple[Trial, ...] = tuple(
    trial for module in (chains, cords, fingers, boxes)
    for trial in module.trials())
