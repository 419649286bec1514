"""Names of fingers: each rides beside the hinge that its finger begins at, on a short leader."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.draw.film.canvas import XY
from sandbox.draw.film.leaders import HINGE, OF_FINGERS, leader, ways_from
from sandbox.numeric import Array, Flags

CELL = 3.0
"""Side of the cells that are free or covered [points]."""


@dataclass(frozen=True)
class Name:
    """A finger's name and where it goes."""

    text: str
    body: int
    """The finger's first; it begins at its hinge."""
    away: XY
    """From the hinge to the middle of the text [finished pixels]."""
    size: tuple[int, int]

    def rect(self, hinge: XY) -> pygame.Rect:
        """Where the text lies when the hinge is there [finished pixels]."""
        width, height = self.size
        return pygame.Rect(round(hinge[0] + self.away[0] - width / 2),
                           round(hinge[1] + self.away[1] - height / 2), width, height)

    def leader(self, hinge: XY, unit: float) -> tuple[XY, XY]:
        """From the text to just before the hinge."""
        return leader(self.rect(hinge), hinge, unit, HINGE)


class Covered:
    """What the drawing covers in each of a few samples, as sums over cells."""

    def __init__(self, stage: pygame.Rect, unit: float) -> None:
        self._stage, self._side = stage, max(1, round(CELL * unit))
        self._sums: list[NDArray[np.int32]] = []

    def add(self, drawn: NDArray[np.bool_]) -> None:
        """Note one sample: which finished pixels [height, width] of the picture are drawn on."""
        left, top, width, height = self._stage
        side = self._side
        rows, columns = -(-height // side), -(-width // side)
        padded = np.zeros((rows * side, columns * side), dtype=bool)
        padded[:height, :width] = drawn[top:top + height, left:left + width]
        cells = np.zeros((rows, columns), dtype=bool)
        for k in range(side * side):  # some times faster than a reduction over short axes
            cells |= padded[k // side::side, k % side::side]
        sums = np.zeros((rows + 1, columns + 1), dtype=np.int32)
        np.cumsum(np.cumsum(cells, axis=0), axis=1, out=sums[1:, 1:])
        self._sums.append(sums)

    def seen(self, at: XY) -> bool:
        """Whether a point is on the stage."""
        return bool(np.isfinite(at).all() and self._stage.collidepoint(at))

    def free(self, sample: int, rects: NDArray[np.int64]) -> Flags:
        """Which rectangles lie on the stage and on nothing that is drawn.

        Args:
            sample: by the order in which they were noted.
            rects: left, top, width and height [k, 4] in finished pixels.
        """
        sums, side, stage = self._sums[sample], self._side, self._stage
        low = rects[:, :2] - stage.topleft
        high = low + rects[:, 2:]
        inside: Flags = np.asarray((low >= 0).all(axis=1) & (high <= stage.size).all(axis=1))
        (x0, y0), (x1, y1) = (low[inside] // side).T, (-(-high[inside] // side)).T
        inside[inside] = sums[y1, x1] - sums[y0, x1] - sums[y1, x0] + sums[y0, x0] == 0
        return inside


def place_names(
    names: list[tuple[str, int]], hinges: Array, covered: Covered,
    measure: Callable[[str], tuple[int, int]], unit: float,
) -> list[Name]:
    """A place for every name that nothing passes in any sample; one that finds none is left out.

    So is that of a finger whose hinge is ever out of sight.

    Args:
        names: what to write, and of which body.
        hinges: where each of these bodies begins in each sample [s, n, 2] [finished pixels].
        covered: what is drawn in these samples.
        measure: width and height of a text [pixels].
        unit: pixels of the finished picture per point.
    """
    seekers = []
    for k, (text, body) in enumerate(names):
        if all(map(covered.seen, hinges[:, k].tolist())):
            way = [(float(x), float(y)) for x, y in hinges[:, k]]
            size = measure(text)
            about = [Name(text, body, away, size)
                     for away in ways_from(size, unit, OF_FINGERS)]
            free = np.ones(len(about), dtype=bool)
            for s, at in enumerate(way):
                here = np.flatnonzero(free)
                free[here] = covered.free(s, np.array(
                    [tuple(about[i].rect(at)) for i in here], dtype=np.int64).reshape(-1, 4))
            seekers.append(_Seeker(way, [name for name, is_free in zip(
                about, free, strict=True) if is_free]))
    # who chooses first may stand in the others' way: of a few orders the best
    orders = [seekers, *(sorted(seekers, key=lambda one: one.way[0][axis]) for axis in (0, 1))]
    tried = [_choose(order, unit) for order in orders + [order[::-1] for order in orders]]
    return min(tried, key=lambda found: (-len(found), sum(math.hypot(*n.away) for n in found)))


@dataclass(frozen=True)
class _Seeker:
    """A hinge's place in every sample, and the names on free ground beside it, nearest first."""

    way: list[XY]
    free: list[Name]


def _choose(order: list[_Seeker], unit: float) -> list[Name]:
    """One after another takes the nearest name that meets none of those before."""
    placed: list[tuple[Name, list[XY]]] = []
    for seeker in order:
        name = next((name for name in seeker.free if not any(
            _meet(name, seeker.way, other, along, unit) for other, along in placed)), None)
        if name is not None:
            placed.append((name, seeker.way))
    return [name for name, _ in placed]


def _meet(name: Name, way: list[XY], other: Name, along: list[XY], unit: float) -> bool:
    """Whether two names, or a name and a leader, or two leaders meet in any sample."""
    for here, there in zip(way, along, strict=True):
        one, two = name.rect(here).inflate(6, 4), other.rect(there)
        leader, line = name.leader(here, unit), other.leader(there, unit)
        if (one.colliderect(two) or one.clipline(*line) or two.clipline(*leader)
                or _cross(*leader, *line)):
            return True
    return False


def _cross(a: XY, b: XY, c: XY, d: XY) -> bool:
    def side(p: XY, q: XY, r: XY) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
