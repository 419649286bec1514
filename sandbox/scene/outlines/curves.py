"""Smooth curves as nodes, and the quintic spans between them.

A node is a point of the curve with its direction and curvature. Between two neighbours lies one
polynomial of the fifth degree for each coordinate, with both nodes' points, directions and
curvatures. Two nodes at the same place are a corner, or a jump of the curvature. The parameter w of
a span runs from 0 to 1; at both ends the speed |dp/dw| is the length of the arc with the span's
chord and turn (Hermite form: Farouki, *Pythagorean-Hodograph Curves*, section 6).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from sandbox.numeric import Array, Flags
from sandbox.scene.outlines.rings import Ring
from sandbox.values.numbers import Angle, Distance, Flag, Items, Length, Point
from sandbox.values.spec import TYPE, Spec
from sandbox.values.tables import Spline, check_distinct
from sandbox.wording import refuse_if

Node = tuple[float, float, float, float]
"""x, y [m], direction [rad], curvature [1/m], positive where the curve turns to the left."""
Curve = Callable[[Array], Array]  # nodes [n, 4] at parameters [n]
SMOOTH = 1e-6  # a change of direction that is no corner [rad]
CURVATURE = 1e-4  # error of a span's curvature as a share of the largest
MAX_NODES = 2000
ABSCISSAE, WEIGHTS = np.polynomial.legendre.leggauss(5)
ITERATIONS = 30
SAMPLES = 16  # points of each span from which the search for the nearest place starts


class Spans(NamedTuple):
    """The spans of one curve."""

    terms: Array
    """Polynomials: six terms of x, six of y, each from the constant one up [m], [n, 12]."""
    corner: Flags  # whether there is a corner between each and the span before it, [n]


def spans_of(nodes: Array, *, closed: bool) -> Spans:
    """The spans between nodes [n, 4]; of a closed curve the last leads back to the first."""
    start, end = nodes, np.roll(nodes, -1, axis=0)
    chord = end[:, :2] - start[:, :2]
    length = np.hypot(*chord.T)
    whole = length > 0.0
    if not closed:
        whole[-1] = False
    start, end, chord, length = start[whole], end[whole], chord[whole], length[whole]
    turn = _angle(end[:, 2] - start[:, 2])
    speed = length / np.sinc(turn / math.tau)
    p0, v0, a0 = start[:, :2], *_derivatives(start, speed)
    v1, a1 = _derivatives(end, speed)
    terms = [p0, v0, a0 / 2, 10 * chord - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1,
             -15 * chord + 8 * v0 + 7 * v1 + 1.5 * a0 - a1,
             6 * chord - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1]
    corner = np.abs(_angle(start[:, 2] - np.roll(end[:, 2], 1))) > SMOOTH
    return Spans(np.concatenate([np.stack([term[:, axis] for term in terms], axis=1)
                                 for axis in (0, 1)], axis=1), corner)


def _derivatives(nodes: Array, speed: Array) -> tuple[Array, Array]:
    """First and second over w, if the speed stays the same."""
    t = np.stack([np.cos(nodes[:, 2]), np.sin(nodes[:, 2])], axis=1)
    left = np.stack([-t[:, 1], t[:, 0]], axis=1)
    return speed[:, None] * t, (speed**2 * nodes[:, 3])[:, None] * left


def _angle(angle: Array) -> Array:
    """The same angle between -π and π."""
    return np.asarray((angle + math.pi) % math.tau - math.pi)


def on_spans(terms: Array, w: Array) -> tuple[Array, Array, Array]:
    """Points of spans [n, 12] at parameters [n], first and second derivatives, [n, 2] each."""
    power, n = np.array([w**n for n in range(6)]), np.arange(6.0)[:, None]

    def along(factor: Array, less: int) -> Array:
        return np.stack([((axis.T * factor)[less:] * power[:6 - less]).sum(axis=0)
                         for axis in (terms[:, :6], terms[:, 6:])], axis=1)

    return along(np.ones((6, 1)), 0), along(n, 1), along(n * (n - 1), 2)


def curvature(first: Array, second: Array) -> Array:
    """Of a curve with these derivatives [n, 2], [1/m]."""
    return np.asarray((first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
                      / np.hypot(*first.T) ** 3)


def nodes_along(curve: Curve, at: Array, tolerance: float) -> Array:
    """Nodes of a curve at parameters [n] and between, with spans within ``tolerance`` [m]."""
    while True:
        nodes, middle = curve(at), curve((at[:-1] + at[1:]) / 2)
        spans = spans_of(nodes, closed=False)
        if len(at) > MAX_NODES or len(spans.terms) < len(at) - 1:
            return nodes
        point, first, second = on_spans(spans.terms, np.full(len(middle), 0.5))
        away = point - middle[:, :2]
        off = np.abs(away[:, 0] * np.sin(middle[:, 2]) - away[:, 1] * np.cos(middle[:, 2]))
        bend = np.abs(curvature(first, second) - middle[:, 3])
        coarse = (off > tolerance) | (bend > CURVATURE * np.abs(nodes[:, 3]).max() + 1e-9)
        if not coarse.any():
            return nodes
        at = np.sort(np.concatenate([at, ((at[:-1] + at[1:]) / 2)[coarse]]))


def through(points: Array, *, closed: bool, corners: tuple[int, ...]) -> Array:
    """Nodes of the cubic spline through points [n, 2] over the chords' lengths, with corners.

    Without corners a closed one is periodic; else the third derivative does not jump next to an
    end.
    """
    if closed and not corners:
        return _interpolated(np.concatenate([points, points[:1]]), "periodic")[:-1]
    if closed:
        points = np.roll(points, -corners[0], axis=0)
        points = np.concatenate([points, points[:1]])
        corners = tuple(k - corners[0] for k in corners[1:])
    ends = [0, *(k for k in sorted(corners) if 0 < k < len(points) - 1), len(points) - 1]
    return np.concatenate([_interpolated(points[i:j + 1], "bent") for i, j in pairwise(ends)])


def _interpolated(points: Array, ends: str) -> Array:
    at = _chords(points)
    _, first, second = np.stack([Spline(at, axis, ends)(at) for axis in points.T], axis=2)
    return nodes_of(points, first, second)


def _chords(points: Array) -> Array:
    """Lengths of the chords of points [n, 2] up to each, [n]."""
    return np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))


def nodes_of(points: Array, first: Array, second: Array) -> Array:
    """Nodes at points of a curve with these derivatives, [n, 2] each."""
    return np.column_stack([points, np.arctan2(first[:, 1], first[:, 0]), curvature(first, second)])


def turned(nodes: Array, angle: float, at: tuple[float, float]) -> Array:
    """Nodes turned about the origin by ``angle`` [rad], then moved by ``at`` [m]."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, direction, bend = nodes.T
    return np.column_stack([at[0] + c * x - s * y, at[1] + s * x + c * y, direction + angle, bend])


def reversed_nodes(nodes: Array) -> Array:
    """The same curve run through the other way."""
    return np.asarray((nodes + np.array([0.0, 0.0, math.pi, 0.0]))[::-1] * [1.0, 1.0, 1.0, -1.0])


def is_smooth(one: Array, other: Array) -> bool:
    """Whether two nodes at the same place have the same direction and curvature."""
    return bool(abs(_angle(one[2] - other[2])) < SMOOTH
                and abs(one[3] - other[3]) <= 1e-6 * max(abs(one[3]), abs(other[3])))


def joined(curves: list[Array]) -> Array:
    """One curve after the other, the beginning of each moved to the end of the one before it."""
    found = list(curves[0])
    for nodes in curves[1:]:
        begin = np.concatenate([found[-1][:2], nodes[0, 2:]])
        if is_smooth(found[-1], begin):
            found.pop()
        found += [begin, *nodes[1:]]
    return np.array(found)


def flattened(nodes: Array, tolerance: float, *, closed: bool) -> Ring:
    """Points of a curve whose chords are within ``tolerance`` [m]."""
    terms = spans_of(nodes, closed=closed).terms
    chord = np.stack([terms[:, 1:6].sum(axis=1), terms[:, 7:].sum(axis=1)], axis=1)
    chord /= np.hypot(*chord.T)[:, None]
    bends = np.zeros(len(terms))
    for w in np.linspace(0.0, 1.0, 9):
        x, y = on_spans(terms, np.full(len(terms), w))[2].T
        bends = np.maximum(bends, np.abs(chord[:, 0] * y - chord[:, 1] * x))
    found: list[tuple[float, float]] = []
    for span, bend in zip(terms, bends, strict=True):
        count = max(1, math.ceil(math.sqrt(bend / (8 * tolerance))))  # chords are bend / 8 n² off
        points = on_spans(np.tile(span, (count, 1)), np.arange(count) / count)[0]
        found += [(x, y) for x, y in points.tolist()]
    if not closed:
        found.append((float(nodes[-1, 0]), float(nodes[-1, 1])))
    return tuple(found)


@dataclass(frozen=True)
class Path:
    """A smooth curve by its arc length, in the frame of a body; straight beyond open ends."""

    nodes: Array
    """x, y, direction, curvature, [n, 4]; not finite where the curve turns back on itself."""
    closed: bool

    @cached_property
    def terms(self) -> Array:
        """Polynomials of its spans, [k, 12]."""
        return spans_of(self.nodes, closed=self.closed).terms

    @cached_property
    def starts(self) -> Array:
        """Arc lengths at the starts of the spans, and the whole length [m], [k + 1]."""
        count = len(self.terms)
        return np.append(0.0, np.cumsum(_arc(self.terms, np.ones(count))))

    @property
    def is_smooth(self) -> bool:
        """Whether it has a direction everywhere and never turns back on itself."""
        if not np.isfinite(self.nodes).all():
            return False
        first = np.array([on_spans(self.terms, np.full(len(self.terms), w))[1]
                          for w in np.linspace(0.0, 1.0, 16 * SAMPLES + 1)])
        return bool(((first[1:] * first[:-1]).sum(axis=2) > 0.0).all())

    @property
    def length(self) -> float:
        """Whole length [m]."""
        return float(self.starts[-1])

    def at(self, place: Array) -> tuple[Array, Array, Array]:
        """Points [n, 2] m, unit tangents [n, 2] and curvatures [n] 1/m at arc lengths [n].

        The curvature is positive where the path turns to the left.
        """
        place = np.asarray(np.mod(place, self.length) if self.closed else place)
        k = np.clip(np.searchsorted(self.starts, place, side="right") - 1, 0, len(self.terms) - 1)
        terms, lengths = self.terms[k], np.diff(self.starts)[k]
        ahead = place - self.starts[k]
        within = np.clip(ahead, 0.0, lengths)
        w = within / lengths
        for _ in range(4):
            speed = np.hypot(*on_spans(terms, w)[1].T)
            w = np.clip(w + (within - _arc(terms, w)) / speed, 0.0, 1.0)
        point, first, second = on_spans(terms, w)
        tangent = first / np.hypot(*first.T)[:, None]
        beyond = ahead - within
        return (point + beyond[:, None] * tangent, tangent,
                np.where(beyond == 0.0, curvature(first, second), 0.0))

    def nearest(self, point: Array) -> float:
        """Arc length of the place nearest to a point [2] of the body's frame [m]."""
        grid = np.linspace(self.starts[:-1], self.starts[1:], SAMPLES, endpoint=False).ravel()
        grid = grid if self.closed else np.append(grid, self.length)
        best = grid[np.argmin(np.hypot(*(self.at(grid)[0] - point).T))]
        for _ in range(ITERATIONS):
            foot, tangent, bend = (one[0] for one in self.at(np.array([best])))
            off = point - foot
            left = tangent[0] * off[1] - tangent[1] * off[0]
            best += float(tangent @ off) / max(1.0 - bend * left, 0.1)
        return float(best % self.length if self.closed else best)


def _arc(terms: Array, w: Array) -> Array:
    """Arc lengths of spans [k, 12] up to parameters [k]."""
    at = (np.multiply.outer(ABSCISSAE, w) + w) / 2
    speed = [np.hypot(*on_spans(terms, one)[1].T) for one in at]
    return np.asarray(WEIGHTS @ speed * w / 2)


def path_through(points: tuple[tuple[float, float], ...], *, closed: bool) -> Path:
    """The smooth path through points [m]: the quintic spline over the chords' lengths.

    Fewer than six points of an open path have a spline of lower degree.
    """
    from scipy.interpolate import make_interp_spline

    ring = np.array([*points, points[0]] if closed else points)
    degree = 5 if closed or len(points) > 5 else 3 if len(points) > 3 else 2
    at = _chords(ring)
    spline = make_interp_spline(at, ring, degree, bc_type="periodic" if closed else None)
    first, second = (spline(at[:len(points)], order) for order in (1, 2))
    with np.errstate(invalid="ignore", divide="ignore"):
        return Path(nodes_of(np.array(points), first, second), closed)


class SmoothCurve(Spec):
    """A smooth curve through points: a closed outline, or an open line such as a track.

    Contacts follow the curve itself, a cubic spline, not chords. A closed one is a solid. An open
    one belongs to a body that does not move freely; both of its sides can be touched.
    """

    type: Literal["curve"] = TYPE
    points: Annotated[Items[Point], Field(min_length=3, max_length=1000)]
    """Points of the curve in order [m]; the last of a closed one is not the first."""
    closed: Flag = True
    """Whether it continues from the last point to the first and bounds a solid."""
    corners: Items[Annotated[int, Field(ge=0)]] = ()
    """Indices of the points with a corner, from 0; the curve is smooth elsewhere."""
    radius: Distance = 0.0
    """Of an open curve: distance of its surface from the curve."""
    tolerance: Length = 1e-5
    """Maximum deviation of its chords in pictures and in its area; contacts do not depend on it."""
    at: Point = (0.0, 0.0)
    """Position of the points' origin in the body's frame."""
    angle: Angle = 0.0
    """Rotation about that origin in the body's frame."""

    def _verify(self) -> None:
        refuse_if(self.closed and self.radius, "'radius' belongs to an open curve",
                  allowed="'\"closed\": false', or no 'radius'")
        last = max(self.corners, default=0)
        refuse_if(last >= len(self.points), f"there is no point {last}", "out-of-range",
                  allowed=f"0 to {len(self.points) - 1}")
        check_distinct(self.points, closed=self.closed)

    def curve(self) -> Array:
        """Its nodes, [n, 4]."""
        with np.errstate(invalid="ignore", divide="ignore"):
            nodes = through(np.array(self.points), closed=self.closed,
                            corners=tuple(sorted(set(self.corners))))
        refuse_if(not np.isfinite(nodes).all(), "this curve turns back on itself at a point",
                  "bad-outline", allowed="points round an area, or a corner where it turns back")
        return nodes
