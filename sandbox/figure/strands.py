"""Curves that coincide: detection, and drawing in alternating colours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from sandbox.figure.style import LINE
from sandbox.numeric import Array, Flags

NEAR = 0.012
"""Curves closer than this share of the axes' height coincide: about the width of a line."""
SHORT = 0.04
"""A shorter stretch, as a share of the axes' width, is a crossing."""
STROKE = 3.5
"""Length of each colour where curves coincide, as a multiple of the line width."""
MAX_POINTS = 2000
"""Approximate number of points of a curve that are compared."""


class Strand(NamedTuple):
    """A stretch of a curve."""

    first: int
    last: int
    """Inclusive: the next stretch begins here."""
    rank: int
    """Number of earlier curves that coincide here."""
    turns: int
    """Number of curves that coincide here, this one included."""


def take_apart(axes: Any, lines: Sequence[Any]) -> None:
    """Draw alternating colours where lines of axes coincide; the limits must be set."""
    lines = [line for line in lines if len(line.get_xdata()) > 1]
    to_axes = axes.transScale + axes.transLimits
    every = [max(1, len(line.get_xdata()) // MAX_POINTS) for line in lines]
    places = [to_axes.transform(line.get_xydata()[::step]).T
              for line, step in zip(lines, every, strict=True)]
    found = strands([(x, y) for x, y in places])
    for line, step, parts in zip(lines, every, found, strict=True):
        points = np.asarray(line.get_xydata())
        for part in (part for part in parts if part.turns > 1):
            # where the next stretch begins the curves have parted already
            last = len(points) if part is parts[-1] else step * (part.last - 1) + 1
            # wider than the lines below, so that no gap shows between the colours
            axes.plot(*points[step * part.first:last].T, color=line.get_color(), zorder=2.5,
                      linewidth=1.2 * LINE, scalex=False, scaley=False, linestyle=(
                          STROKE * (part.turns - part.rank),
                          (STROKE, STROKE * (part.turns - 1))))


def strands(lines: Sequence[tuple[Array, Array]]) -> list[list[Strand]]:
    """Stretches in which each curve is alone or coincides with others.

    Args:
        lines: x and y, shape [n] each, n > 1, as shares of the axes' width and height. A curve
            whose x decreases coincides only with curves of the same x; a curve with values that
            are not finite coincides with none.
    """
    found, forward = [], [bool((np.diff(x) > 0).all()) for x, _ in lines]
    finite = [bool(np.isfinite(x + y).all()) for x, y in lines]
    for i, (x, y) in enumerate(lines):
        count, rank = np.ones(len(x), dtype=int), np.zeros(len(x), dtype=int)
        for j, (other_x, other_y) in enumerate(lines):
            if j == i or not (finite[i] and finite[j]):
                continue
            if np.array_equal(x, other_x):
                near = np.asarray(np.abs(other_y - y) < NEAR)
            elif forward[i] and forward[j]:
                within = (x >= other_x[0] - SHORT / 4) & (x <= other_x[-1] + SHORT / 4)
                near = np.asarray(within & (np.abs(np.interp(x, other_x, other_y) - y) < NEAR))
            else:
                continue
            near = _without_crossings(x, near)
            count += near
            rank += near & (j < i)
        found.append([Strand(first, min(last + 1, len(x) - 1), int(rank[first]), int(count[first]))
                      for first, last in _runs(rank + (len(rank) + 1) * count)])
    return found


def _without_crossings(x: Array, near: Flags) -> Flags:
    kept, way = near.copy(), np.concatenate(([0.0], np.cumsum(np.abs(np.diff(x)))))
    for first, last in _runs(near):
        if near[first] and way[last] - way[first] < SHORT:
            kept[first:last + 1] = False
    return kept


def _runs(values: Array | Flags) -> Iterator[tuple[int, int]]:
    """First and last index of every run of equal values."""
    ends = [*np.flatnonzero(values[1:] != values[:-1]).tolist(), len(values) - 1]
    yield from zip([0, *(end + 1 for end in ends)], ends, strict=False)
