"""The display list: a picture of a run as data, without pixels and without elements.

Painters (films, paper, the page's script) know item kinds and styles only. A list has all samples.

Frames: ``pose`` [n, frames, 3] is x, y [m] and angle [rad]: the bodies, then ``world``, which is at
rest at the origin, then frames of elements, such as a piston.
Points: ``[frame, x, y]`` in metres of the frame, or ``[frame, x, y, dx, dy]`` with an offset in
points of the screen (dy up) that does not turn. A point is a unit of widths, glyphs and offsets: a
picture is 800 points wide or 300 high, whichever gives fewer pixels for each.
Columns: ``columns`` [k][n] vary in time; any number of an item may be ``[k]``, the index of a
column. Poses and columns are interpolated linearly; columns in ``steady`` and rows of tables are
those of the nearest sample.
Tables: any number of rows for each sample, sorted: the sample, a key of the described pair or
element, and more.
Inks: ``inks`` maps a token to ``#rrggbb`` by day and by night; ``ramps`` a name to the colours for
-1 to 0 (element 0 is 0) and for 0 to 1. ``@name`` is the colour of a ramp at the item's ``by``; the
empty token paints nothing.
Styles: ``[fill, edge, width, dash, hatched]``, with 0 for a solid line; gaps are 0.8 dashes.
Glyphs: ``{name: [[style, subpath], ...]}``, symbols of constant size in points, y up.
Subpaths: a closed ring ``[x0, y0, x1, y1, ...]``, a capsule or circle ``{"c": [x0, y0, x1, y1,
radius]}`` (the radius may be a column), or an open line ``{"l": [x0, y0, ...]}``.

Items are sorted back to front. Each has ``k`` kind, ``l`` layer, ``s`` style, and optionally ``n``
the element's name, ``state`` (column) that selects one of several styles or glyphs, ``if`` (column)
that shows it where it is not 0, ``by`` its place on a ramp, ``wide`` (column) a factor of its
width:

``path``    ``f`` frame, ``d`` subpaths. With ``m`` 1 they are one area with one outline; otherwise
            the second and later ones are holes (even-odd).
``line``    ``p`` points: a polyline, also through several frames.
``mark``    ``at`` point, ``g`` glyph or list of glyphs, ``turn`` [rad].
``span``    ``a``, ``b`` points; ``t`` pattern ``[w, v, ...]`` of fractions w of the way from a to b
            and sides v; ``w`` ``[share, min, max]``: half the width relative to the length, limited
            in points. With ``every`` the pattern is one stroke, repeated every so many points; then
            w and v are in points along and across.
``spiral``  ``at`` point, ``r`` radii ``[first, last]`` in points, angle ``start``, ``sweep`` [rad].
            ``head``: length of an arrow head at its end in points.
``taut``    ``p`` list of ``[frame, x, y, radius, sense, meets, leaves]``: a tendon that meets each
            circle at one angle [rad, world] and leaves it at another (columns; NaN off the circle),
            clockwise for sense 1. Points with radius 0 have five values. ``c`` 1 closes the line.
``sag``     ``a``, ``b`` points, ``depth`` [m]: a parabola that hangs down.
``arrows``  ``t`` name of a table with columns sample, key, x, y, vx, vy[, value]: arrows at world
            points [m], ``metres`` long for a vector of size 1; those above ``most`` are cut and
            marked. ``size`` ``[shaft, head]`` and ``least`` (shortest painted) in points. ``unit``,
            ``decimals``, ``factor``: format of values, which are the size or the seventh column.
            ``names``: words before values by key. ``labelled``: vectors below half of this have no
            number. ``rank`` as of texts. ``labels`` ``{key: [side, column]}``: side of the number
            and whether it is shown.
``strips``  ``t`` name of a table with columns sample, key, x0, y0, ... x3, y3, value: areas
            of four corners [m]. Values and labels as of arrows, at the fourth point (or the third);
            those below ``least`` have none.
``trail``   ``at`` point: its path up to now. ``every`` [s]: time between marks, ``mark``: their
            radius in points.
``text``    ``at`` point, ``words``; with ``value`` (column), ``unit``, ``decimals`` and ``factor``
            a number follows. The style's edge is its colour. ``side``, ``show`` (column): as of
            labels. ``rank``: lower ones are placed first. ``clear``: free points around ``at``.
            ``edge`` 0 or 1: a number of the grid, at the bottom or left.

Sides of labels are numbers of :data:`SIDES`. ``legend`` has rows, most important first, with ``l``:

``scale``   ``metres`` of 1 ``unit``, ``words``, ``s`` style and ``size`` of the arrow; without
            ``size`` it is a bar for lengths (``metres`` is 1).
``ramp``    ``ramp`` name, ``low`` -1 or 0, ``before`` and ``after`` words. It replaces the
            row before it if that belongs to the layer ``instead``.
``glyph``   ``g`` glyph, ``width`` in points, ``words``; ``centred`` if its origin is its middle.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from sandbox.elements.arrays import Arrays
from sandbox.model.joints import placed
from sandbox.model.meters import worked_out
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.samples import Samples
from sandbox.scene.mechanism import Mechanism
from sandbox.values.expressions import is_expression

Item = dict[str, Any]
Number = float | list[int]  # a number, or the index of a column in a list
Point = list[Any]
Look = tuple[Any, ...]  # fill, edge, width, dash, hatched of a style
SIDES = [(round(math.cos(k * math.pi / 4), 6), round(math.sin(k * math.pi / 4), 6), far)
         for far in (0, 22) for k in range(8)]
"""Sides of labels: direction (y up), and additional distance [points], with a line if not 0."""


class SomeSamples(NamedTuple):
    """Samples of a running simulation."""

    mechanism: Mechanism
    model: Model
    arrays: Arrays
    time: Array


RunData = Samples | SomeSamples


def read_curve(run: Samples, name: str) -> Array:
    """A quantity or the value of an expression over time [n]."""
    if not is_expression(name):
        return np.asarray(run[name], dtype=float)
    value = worked_out(name, run.mechanism, lambda each: run.time if each == "t" else run[each])
    return np.broadcast_to(value, run.time.shape)


def nearest(time: Array, moments: Sequence[float]) -> Integers:
    """The samples nearest to some moments [s]."""
    return np.unique(np.abs(time[:, None] - np.asarray(moments)).argmin(axis=0))


def short(value: float) -> float:
    """A number with six digits, which is enough for a picture."""
    return float(f"{float(value):.6g}")


def flat(*points: Any) -> list[float]:
    """Coordinates of points in one row, shortened."""
    return [short(v) for at in points for v in at]


@dataclass
class Listing:
    """A display list; see the module's description."""

    time: Array  # of the samples [n] s
    frames: list[Array]  # x, y and angle of each [n, 3] m, rad
    world: int  # the frame that stands still
    fixed_columns: bool = False
    """Keep constant and equal columns: lists of other samples then have the same items."""
    inks: dict[str, list[str]] = field(default_factory=dict)
    ramps: dict[str, list[list[str]]] = field(default_factory=dict)
    styles: list[list[Any]] = field(default_factory=list)
    glyphs: dict[str, list[Any]] = field(default_factory=dict)
    items: list[Item] = field(default_factory=list)
    columns: list[Array] = field(default_factory=list)
    steady: list[int] = field(default_factory=list)
    tables: dict[str, Array] = field(default_factory=dict)
    legend: list[Item] = field(default_factory=list)
    drift: Array | None = None  # displacement of a camera that follows a body [n, 2] m
    _known: dict[Any, int] = field(default_factory=dict)

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Number of columns, tables and frames."""
        return len(self.columns), len(self.tables), len(self.frames)

    @cached_property
    def pose(self) -> Array:
        """All frames [n, frames, 3], once they are complete."""
        return np.stack(self.frames, axis=1)

    def share_styles(self, other: Listing) -> None:
        """Use the inks, styles and glyphs of another list, with the same numbers."""
        self.inks, self.styles, self.glyphs = other.inks, other.styles, other.glyphs
        self._known = {tuple(style): number for number, style in enumerate(other.styles)}

    @classmethod
    def of(cls, time: Array, pose: Array, *, fixed_columns: bool = False) -> Listing:
        """An empty list for bodies with these poses [n, nb, 3]."""
        frames = [*np.moveaxis(pose, 1, 0), np.zeros((len(time), 3))]
        return cls(np.asarray(time), frames, pose.shape[1], fixed_columns)

    def style(self, fill: str = "", edge: str = "", width: float = 0.0, dash: float = 0.0,
              hatched: int = 0) -> int:
        """The number of a style."""
        key = (fill, edge, float(width), float(dash), int(hatched))
        if key not in self._known:
            self._known[key] = len(self.styles)
            self.styles.append([fill, edge, width, dash, hatched])
        return self._known[key]

    def column(self, values: Array | Flags, *, steady: bool = False) -> list[int]:
        """A column with these values [n]."""
        floats: Array = np.asarray(values, dtype=float)
        key = (floats.tobytes(), steady)
        if self.fixed_columns or key not in self._known:
            self._known[key] = len(self.columns)
            self.columns.append(floats)
            if steady:
                self.steady.append(len(self.columns) - 1)
        return [self._known[key]]

    def varying(self, values: Array | Flags, *, steady: bool = False) -> Number:
        """The values [n] as a column, or as one number where they do not change."""
        values = np.asarray(values, dtype=float)
        if not self.fixed_columns and (values == values[0]).all():
            return short(values[0])
        return self.column(values, steady=steady)

    def spot(self, place: Array, angle: Array | float = 0.0) -> Point:
        """A point at a place [n, 2] m of each sample, in a frame of its own with an angle [rad]."""
        self.frames.append(np.column_stack([place, np.broadcast_to(angle, len(self.time))]))
        return [len(self.frames) - 1, 0, 0]

    def place(self, point: Sequence[float]) -> Array:
        """Where a point ``[frame, x, y]`` is in each sample [n, 2] m."""
        return placed(self.frames[int(point[0])], np.array(point[1:3], dtype=float))

    def head(self) -> dict[str, Any]:
        """All but the arrays for JSON, with used inks only."""
        used = {"paper", "ink", "faint_ink", "hairline"}.union(*(s[:2] for s in self.styles))
        return {"world": self.world, "items": self.items, "styles": self.styles,
                "glyphs": self.glyphs, "ramps": self.ramps, "steady": self.steady,
                "legend": self.legend, "sides": SIDES,
                "inks": {token: pair for token, pair in self.inks.items() if token in used}}


class Between:
    """The way from one place [n, 2] m to another, in each sample."""

    def __init__(self, out: Listing, a: Array, b: Array) -> None:
        self.out, self.a, way = out, a, b - a
        self.length = np.maximum(np.hypot(*way.T), 1e-12)  # [n] m
        self.way = way / self.length[:, None]
        self.angle: Array = np.unwrap(np.arctan2(way[:, 1], way[:, 0]))  # [n] rad

    def at(self, distance: Array | float) -> Point:
        """A point at a distance from the first place [m], in a frame with x to the other."""
        return self.out.spot(self.a + np.reshape(distance, (-1, 1)) * self.way, self.angle)
