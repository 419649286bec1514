"""Lines that coincide, taken apart: each shows its colour by turns where they run as one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from sandbox.draw.figure import style
from sandbox.numeric import Array, Flags

NEAR = 0.012
"""Of the axes' height: what is nearer to each other than about a line's thickness is one line."""
SHORT = 0.04
"""Of the axes' width: what is shorter is a crossing."""
STROKE = 3.5
"""Length of a line's colour where several coincide, in its thickness."""
LOOKED_AT = 2000
"""Points of a line, more or less, that are looked at."""


def take_apart(axes: Any, lines: Sequence[Any]) -> None:
    """Where lines of some axes, whose limits are set, coincide, draw their colours by turns."""
    lines = [line for line in lines if len(line.get_xdata()) > 1]
    to_axes = axes.transScale + axes.transLimits
    every = [max(1, len(line.get_xdata()) // LOOKED_AT) for line in lines]
    places = [to_axes.transform(line.get_xydata()[::step]).T
              for line, step in zip(lines, every, strict=True)]
    found = strands([(x, y) for x, y in places])
    for line, step, parts in zip(lines, every, found, strict=True):
        points = np.asarray(line.get_xydata())
        for part in (part for part in parts if part.turns > 1):
            # where the next part begins they have parted already
            last = len(points) if part is parts[-1] else step * (part.last - 1) + 1
            # over the whole lines, so that turns that do not quite meet leave no gap
            axes.plot(*points[step * part.first:last].T, color=line.get_color(), zorder=2.5,
                      linewidth=1.2 * style.LINE, scalex=False, scaley=False, linestyle=(
                          STROKE * (part.turns - part.rank),
                          (STROKE, STROKE * (part.turns - 1))))


class Strand(NamedTuple):
    """A stretch of a line, between two of its points."""

    first: int
    last: int
    """Inclusive, so that the next stretch begins where this one ends."""
    rank: int
    """How many of the lines before it run here as well."""
    turns: int
    """How many lines run here, itself among them."""


def strands(lines: Sequence[tuple[Array, Array]]) -> list[list[Strand]]:
    """Where each line runs alone and where with others.

    Args:
        lines: x and y, shape [n] each, n > 1, as shares of the axes' width and height. One whose
            x goes back is with those alone that have the same x, one with values that are no
            numbers runs alone.
    """
    found, forward = [], [bool((np.diff(x) > 0).all()) for x, _ in lines]
    finite = [bool(np.isfinite(x + y).all()) for x, y in lines]
    for i, (x, y) in enumerate(lines):
        count, rank = np.ones(len(x), dtype=int), np.zeros(len(x), dtype=int)
        for j, other in enumerate(lines):
            if j == i or not (finite[i] and finite[j]):
                continue
            if np.array_equal(x, other[0]):
                near = np.asarray(np.abs(other[1] - y) < NEAR)
            elif forward[i] and forward[j]:
                near = _near(x, y, *other)
            else:
                continue
            with_it = _without_crossings(x, near)
            count += with_it
            rank += with_it & (j < i)
        found.append(list(_stretches(rank, count)))
    return found


def _near(x: Array, y: Array, other_x: Array, other_y: Array) -> Flags:
    there = (x >= other_x[0] - SHORT / 4) & (x <= other_x[-1] + SHORT / 4)
    off: Array = np.abs(np.interp(x, other_x, other_y) - y)
    return np.asarray(there & (off < NEAR))


def _without_crossings(x: Array, near: Flags) -> Flags:
    kept, way = near.copy(), np.concatenate(([0.0], np.cumsum(np.abs(np.diff(x)))))
    for first, last in _runs(near):
        if near[first] and way[last] - way[first] < SHORT:
            kept[first:last + 1] = False
    return kept


def _stretches(rank: Array, count: Array) -> Iterator[Strand]:
    for first, last in _runs(rank + (len(rank) + 1) * count):
        yield Strand(first, min(last + 1, len(rank) - 1), int(rank[first]), int(count[first]))


def _runs(values: Array | Flags) -> Iterator[tuple[int, int]]:
    """First and last place of every run of equal values."""
    ends = [*np.flatnonzero(values[1:] != values[:-1]).tolist(), len(values) - 1]
    first = 0
    for last in ends:
        yield first, last
        first = last + 1
