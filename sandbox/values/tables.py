"""Tables that a scene names, and that expressions call like functions: ``"=profile(x)"``.

A table is a curve in pieces, each y = y0 + t (b + t (c + t d)) of the distance t from its start,
with one more piece before the first and after the last point. Smooth curves are cubic splines: with
second derivatives M, distances h and slopes d of the chords, h_i M_i + 2 (h_i + h_j) M_j + h_j M_k
= 6 (d_j - d_i) at each point. A periodic one has no ends; a natural one has M = 0 there.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field, field_validator

from sandbox.numeric import Array
from sandbox.values.expressions import RESERVED
from sandbox.values.numbers import Items, Pair, Quantity
from sandbox.values.spec import Spec
from sandbox.values.units import Measured, dimension_of
from sandbox.wording import quoted, refuse_if

MAX_POINTS = 1000  # of one table
CLOSEST = 1e-9  # the least distance of two points, as a share of the whole table
CLOSES = 1e-9  # maximum difference of the ends of a table that repeats, as a share of its range
STEEPEST = 1e15  # maximum slope of a table, SI, so that derived numbers are finite
Points = tuple[tuple[float, float], ...]


def check_distinct(points: Points, *, closed: bool) -> Points:
    """Check that neighbouring points of a curve differ."""
    for i, one in enumerate(points):
        j = (i + 1) % len(points)
        refuse_if(one == points[j] and (closed or j), f"points {i} and {j} are the same point",
                  "bad-outline", allowed="each point once; a closed curve closes automatically")
    return points


class Spline:
    """The cubic spline through values [n] at increasing places [n].

    It is ``natural``; ``bent``, if the third derivative does not jump at the place next to an end;
    or ``periodic``, if the last value is the first.
    """

    def __init__(self, at: Array, values: Array, ends: str) -> None:
        self.at, step, n = at, np.diff(at), len(at)
        chord = np.diff(values) / step
        matrix, i = np.eye(n), np.arange(1, n - 1)
        matrix[i, i - 1], matrix[i, i + 1] = step[:-1], step[1:]
        matrix[i, i] = 2 * (step[:-1] + step[1:])
        right = np.concatenate([[0.0], 6 * np.diff(chord), [0.0]])
        if ends == "periodic":  # in its first row M is the same at both ends
            matrix[0, -1], right[-1] = -1.0, 6 * (chord[0] - chord[-1])
            matrix[-1, [1, -2, -1]] = step[0], step[-1], 2 * (step[0] + step[-1])
        elif ends == "bent" and n > 2:
            matrix[0, :3] = -step[1], step[0] + step[1], -step[0]
            matrix[-1, -3:] = -step[-1], step[-2] + step[-1], -step[-2]
            if n == 3:  # both end conditions are the same: a parabola
                matrix[0, :] = 1, -1, 0
        bend = np.linalg.solve(matrix, right)
        slope = chord - step * (2 * bend[:-1] + bend[1:]) / 6
        self.pieces = np.stack(
            [values[:-1], slope, bend[:-1] / 2, np.diff(bend) / step / 6], axis=1)

    def __call__(self, x: Array) -> tuple[Array, Array, Array]:
        """Value, first and second derivative at places [m] between its ends, [m] each."""
        k = np.clip(np.searchsorted(self.at, x, side="right") - 1, 0, len(self.pieces) - 1)
        t, (y, b, c, d) = x - self.at[k], self.pieces[k].T
        return y + t * (b + t * (c + t * d)), b + t * (2 * c + t * 3 * d), 2 * c + t * 6 * d


class NamedTable(Spec):
    """A function of one number, given by points; expressions call it by its name."""

    points: Items[Pair[Quantity]] = Field(min_length=2, max_length=MAX_POINTS)
    """Points ``[x, y]``, 2 to 1000, x rising: numbers in SI, or with units, one kind of unit for
    all x and one for all y."""
    between: Literal["linear", "cubic"] = "linear"
    """Interpolation: ``linear``, or ``cubic`` by the cubic spline."""
    beyond: Literal["hold", "extend", "repeat"] = "hold"
    """Before the first and after the last point: ``hold`` the value there, ``extend`` with the
    slope there, ``repeat`` from the start; then the first and last value must be equal."""

    @field_validator("points")
    @classmethod
    def _rising(cls, points: Points) -> Points:
        at = np.array([x for x, _ in points])
        i = int(np.argmin(np.diff(at)))
        gap, closest = at[i + 1] - at[i], CLOSEST * abs(at[-1] - at[0])
        refuse_if(gap <= 0, f"the x of a table must increase: point {i + 1} has {at[i + 1]:g} "
                  f"after {at[i]:g}", "bad-table")
        refuse_if(gap < closest, f"points {i} and {i + 1} are {gap:g} apart, less than {closest:g}",
                  "bad-table")
        for axis, numbers in zip("xy", zip(*points, strict=True), strict=True):
            kinds = {dimension_of(each.unit) for each in numbers if isinstance(each, Measured)}
            refuse_if(len(kinds) > 1, f"all {axis} of a table are of one kind, and here are "
                      f"{' and '.join(sorted(kinds))}", "bad-table")
        return points

    def _verify(self) -> None:
        first, last = self.points[0][1], self.points[-1][1]
        values = [y for _, y in self.points]
        if self.beyond == "repeat":
            refuse_if(abs(last - first) > CLOSES * (max(values) - min(values)), "the ends of a "
                      f"table that repeats must be equal: {first:g}, {last:g}", "bad-table")
            refuse_if(len(self.points) < 4 and self.between == "cubic",
                      "a cubic table that repeats needs at least 4 points", "bad-table")
        steepest = float(np.abs(function_of(self).pieces[:, 1]).max())
        refuse_if(not steepest <= STEEPEST, f"the table is too steep: {steepest:.3g}; the maximum "
                  f"is {STEEPEST:g}", "bad-table")


def _free(name: str) -> str:
    refuse_if(name in RESERVED or "__" in name, f"a table cannot have the name {quoted(name)}, "
              "which expressions reserve", "invalid-name")
    return name


TableName = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=100),
                      AfterValidator(_free)]


class Function:
    """A table as a function of arrays or of single numbers."""

    def __init__(self, table: NamedTable) -> None:
        at, value = np.array(table.points, dtype=float).T
        self.knots: Array = at  # where pieces but the first begin, [n]
        self.repeats = table.beyond == "repeat"
        self.period = float(at[-1] - at[0])  # from its first to its last knot
        with np.errstate(all="ignore"):  # a table that is too steep is refused with its number
            if table.between == "linear":
                slope = np.diff(value) / np.diff(at)
                inner = np.stack([value[:-1], slope, 0 * slope, 0 * slope], axis=1)
            else:
                inner = Spline(at, value, "periodic" if self.repeats else "natural").pieces
        step = at[-1] - at[-2]
        end = inner[-1, 1] + step * (2 * inner[-1, 2] + step * 3 * inner[-1, 3])
        on = 1.0 if table.beyond == "extend" else 0.0
        self.pieces: Array = np.vstack([
            [value[0], on * inner[0, 1], 0.0, 0.0], inner, [value[-1], on * end, 0.0, 0.0]])
        """Coefficients y0, b, c, d of each piece, that before the first knot first, [n + 1, 4]."""
        self._origin = np.concatenate([at[:1], at])
        self._list = at.tolist(), self.pieces.tolist()

    def __call__(self, x: Any) -> Array:
        """Its values at ``x``, of any shape; nan where that is nan."""
        at = np.asarray(x, dtype=float)
        if self.repeats:
            at = np.mod(at - self.knots[0], self.period) + self.knots[0]
        k = np.searchsorted(self.knots, at, side="right")
        y, b, c, d = np.moveaxis(self.pieces[k], -1, 0)
        t = np.where(b == 0.0, np.clip(at, self.knots[0], self.knots[-1]), at) - self._origin[k]
        return np.asarray(y + t * (b + t * (c + t * d)))

    def at(self, x: float) -> float:
        """Its value at one number; the same as of an array, much faster."""
        knots, pieces = self._list
        if not math.isfinite(x):
            return float(self(x))
        if self.repeats:
            x = (x - knots[0]) % self.period + knots[0]
        k = bisect_right(knots, x)
        y, b, c, d = pieces[k]
        t = x - knots[max(k - 1, 0)]
        return float(y + t * (b + t * (c + t * d)))


Tables = Mapping[str, Function]  # tables by their calls, as expressions find them
NONE: Tables = MappingProxyType({})  # of a scene without tables


@lru_cache(maxsize=256)
def function_of(table: NamedTable) -> Function:
    """The function of a table."""
    return Function(table)
