"""Texts that stand off from what they tell of, on a thin line; pages have the distances too."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from sandbox.draw.film.canvas import XY

if TYPE_CHECKING:  # pages need the distances and nothing that draws films
    import pygame


class StandOff(NamedTuple):
    """Where a text is looked for that finds no room beside what it tells of."""

    nearest: float
    """From there to the nearest point of the text, the least [points]."""
    farthest: float
    further: float
    """Steps between the two."""
    ways: int
    """Directions, upwards first."""


OF_NUMBERS = StandOff(16.0, 88.0, 9.0, ways=16)
OF_FINGERS = StandOff(14.0, 150.0, 8.0, ways=24)
RIM = 1.5
"""A line begins so far from its text [points],"""
TIP, HINGE = 2.5, 5.0
"""and ends so far before the end of an arrow, and before a hinge [points]."""


def ways_from(size: tuple[int, int], unit: float, reach: StandOff) -> list[XY]:
    """From a point to the middle of a text of a size [pixels], nearest first, upwards first."""
    found = []
    for k in range(int((reach.farthest - reach.nearest) / reach.further) + 1):
        gap = (reach.nearest + k * reach.further) * unit
        for n in range(reach.ways):
            # to either side by turns, so that texts are above rather than below
            turn = math.tau / reach.ways * (n // 2 + 1) * (1 if n % 2 else -1) if n else 0.0
            dx, dy = math.sin(turn), -math.cos(turn)
            found.append((dx * gap + _sign(dx) * size[0] / 2, dy * gap + _sign(dy) * size[1] / 2))
    return found


def _sign(value: float) -> float:
    return 0.0 if abs(value) < 1e-9 else math.copysign(1.0, value)


def leader(rect: pygame.Rect, at: XY, unit: float, before: float) -> tuple[XY, XY]:
    """A line from a text to so many points before what it tells of."""
    x = min(max(at[0], rect.left), rect.right)
    y = min(max(at[1], rect.top), rect.bottom)
    dx, dy = at[0] - x, at[1] - y
    length = max(math.hypot(dx, dy), 1e-9)
    start, end = RIM * unit / length, max(0.0, 1.0 - before * unit / length)
    return (x + start * dx, y + start * dy), (x + end * dx, y + end * dy)
