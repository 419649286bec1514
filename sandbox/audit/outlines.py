"""Contacts against the shapes: positions, normals and gaps.

A row of one point lies in the middle between two outlines, half a gap from each, along the normal.
So does a row of several points between two convex shapes, which share a face. Between bodies of
several shapes (a disc in a V) the position of several points is none of them. It is their mean,
moved perpendicular to the force onto its line of action. The mean lies within the convex hulls of
both bodies, and so does the position along the force.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sandbox.audit.evidence import LEFT, Evidence
from sandbox.audit.figures import DIGITS, ROUNDING, Worst
from sandbox.model.joints import rotated
from sandbox.model.pairs import restitution_of
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.contacts import TOUCH
from sandbox.scene import geometry
from sandbox.scene.bodies import Circle, Polygon, Polyline, Solid
from sandbox.scene.geometry import core, solids, true_curves
from sandbox.scene.outlines.curves import on_spans, spans_of

ROWS = 20_000
"""Number of contacts that are compared with a curve at once."""
NEWTON = 25


class Seen(NamedTuple):
    """Position of contacts relative to one convex shape, [m] each."""

    distance: Array
    """Along the normal, from the support point of the shape to the contact point [m]."""
    aside: Array
    """Remaining distance of the point from the shape [m]."""
    turned: Array
    """Sine of the angle between the normal and the nearest one of the outline there."""


def seen(shape: Solid, points: Array, out: Array, radius: Array | float | None = None) -> Seen:
    """A shape relative to ``points`` [m, 2] near its outline, with outward normals ``out`` [m, 2].

    Both in the body's frame; ``radius`` [m] is that of a circle, where a drive sets it.
    """
    corner, grown = _core(shape, radius)
    distance = np.einsum("mi,mi->m", points, out) - _support(shape, out, radius)
    edges = [np.stack([corner[i], corner[(i + 1) % len(corner)]]) for i in range(len(corner))]
    off = [_from_line(points, edge) for edge in edges]
    if len(corner) <= 2:
        nearest = off[0]
        length = np.hypot(*nearest.T)
        turned = np.hypot(*(nearest / np.maximum(length, 1e-300)[:, None] - out).T)
        return Seen(distance, np.maximum(length - grown - np.maximum(distance, 0.0), 0.0), turned)
    along = np.array([edge[1] - edge[0] for edge in edges])
    faces = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    beyond = np.einsum("mei,ei->me", points[:, None] - corner, faces).max(axis=1)
    apart = np.where(beyond > 0, np.min([np.hypot(*one.T) for one in off], axis=0), beyond)
    turned = np.min([np.hypot(*(face - out).T) for face in faces], axis=0)
    return Seen(distance, np.maximum(apart - np.maximum(distance, 0.0), 0.0), turned)


def _core(shape: Solid, radius: Array | float | None = None) -> tuple[Array, Array | float]:
    """Corners [k, 2] and the radius about their convex hull [m]."""
    points, grown = core(shape)
    return np.array(points), grown if radius is None else radius


class TrueCurves(NamedTuple):
    """The smooth curves of one shape."""

    spans: Array
    """As :class:`sandbox.scene.outlines.curves.Spans` has them, all together, [n, 12]."""
    before: Integers
    """Number of the span before each, [n]; -1 at the end of an open curve."""
    after: Integers
    """Number of the span after each, [n]; -1 at the end of an open curve."""
    closed: bool
    radius: float
    """Of the surface about the curve [m]."""

    def seen(self, points: Array, out: Array) -> Seen:
        """As :func:`seen`, by Newton's method from the nearest node."""
        found = [self._seen(points[i:i + ROWS], out[i:i + ROWS])
                 for i in range(0, len(points), ROWS)]
        return Seen(*map(np.concatenate, zip(*found, strict=True)))

    def _seen(self, points: Array, out: Array) -> Seen:
        x, y = (points[:, None] - self.spans[:, [0, 6]]).transpose(2, 0, 1)
        k, w = (x**2 + y**2).argmin(axis=1), np.zeros(len(points))
        for _ in range(NEWTON):
            place, first, second = on_spans(self.spans[k], w)
            square = np.einsum("mi,mi->m", first, first)
            bend = square + np.einsum("mi,mi->m", place - points, second)
            slope = np.einsum("mi,mi->m", place - points, first)
            w = w - np.clip(slope / np.where(bend > square / 20, bend, square), -1.0, 1.0)
            there = np.where(w > 1, self.after[k], np.where(w < 0, self.before[k], -1))
            w = np.where(there < 0, np.clip(w, 0.0, 1.0), np.where(w > 1, 0.0, 1.0))
            k = np.where(there < 0, k, there)
        place, first, _ = on_spans(self.spans[k], w)
        normal = np.stack([first[:, 1], -first[:, 0]], axis=1) / np.hypot(*first.T)[:, None]
        turned = np.hypot(*(normal - out).T)
        if not self.closed:
            turned = np.minimum(turned, np.hypot(*(normal + out).T))
        distance = np.einsum("mi,mi->m", points - place, out)
        aside = np.hypot(*(points - place - distance[:, None] * out).T)
        return Seen(distance - self.radius, aside, turned)


@lru_cache(maxsize=64)
def _true_curves(shape: Polygon | Polyline) -> TrueCurves:
    closed = isinstance(shape, Polygon)
    spans = [spans_of(nodes, closed=closed).terms for nodes in true_curves(shape)]
    numbers = np.split(np.arange(sum(map(len, spans))), np.cumsum([len(each) for each in spans]))
    before, after = (np.concatenate([np.roll(own, way) for own in numbers]) for way in (1, -1))
    if not closed:
        before[0] = after[-1] = -1
    radius = shape.radius if isinstance(shape, Polyline) else 0.0
    return TrueCurves(np.concatenate(spans), before, after, closed, radius)


def _support(shape: Solid, way: Array, radius: Array | float | None = None) -> Array:
    """Support of a shape along ``way`` [m, 2] from the frame's origin [m], [m]."""
    corner, grown = _core(shape, radius)
    reach: Array = (way @ corner.T).max(axis=1) + grown
    return reach


def _from_line(points: Array, line: Array) -> Array:
    """From the nearest of a straight piece [2, 2] to points [m, 2]."""
    along = line[1] - line[0]
    square = float(along @ along)
    share = np.zeros(len(points))
    if square > 0:
        share = np.clip((points - line[0]) @ along / square, 0.0, 1.0)
    off: Array = points - line[0] - share[:, None] * along
    return off


def _surfaces(
    evidence: Evidence, body: int,
) -> Iterator[tuple[int, Solid | TrueCurves, Array | None]]:
    """Surfaces of a body: number of the shape, solid or curves, and arcs of surface normals."""
    for number, shape in enumerate(evidence.model.mechanism.bodies[body].shapes):
        if isinstance(shape, Polygon | Polyline) and shape.nodes:
            yield number, _true_curves(shape), None
        else:
            yield from ((number, *piece) for piece in solids(shape))


def _solids(evidence: Evidence, body: int) -> Iterator[tuple[int, Solid]]:
    """The convex pieces of a body, each with the number of its shape."""
    for number, shape in enumerate(evidence.model.mechanism.bodies[body].shapes):
        yield from ((number, solid) for solid, _ in solids(shape))


def from_faces(out: Array, faces: Array) -> Array:
    """Sines of the angles between normals [m, 2] and the nearest of arcs [k, 4], within 90 deg."""
    start, end = faces[:, :2], faces[:, 2:]

    def side(one: Array, other: Array) -> Array:
        found: Array = one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
        return found

    n = out[:, None]
    within = ((side(start, n) >= 0) & (side(n, end) >= 0)
              & (np.einsum("mij,ij->mi", n, start + end) > 0))
    ends = np.minimum(np.hypot(*(n - start).T).T, np.hypot(*(n - end).T).T)
    return np.asarray(np.where(within, 0.0, ends).min(axis=1, initial=2.0))


class _Nearest(NamedTuple):
    """The shape of a body that each contact fits best."""

    off: Array
    """Distance of the point from that of the outline and the gap [m]."""
    turned: Array
    """As in :class:`Seen`, the least of all shapes that fit."""
    round: Flags
    """Whether the shape is a circle: two such touch in one point."""


def compare_outlines(evidence: Evidence, worst: Worst) -> None:
    """Compare contacts with the outlines; rows of several points with the hulls."""
    a = evidence.run.arrays
    rows = np.flatnonzero(np.hypot(*a["contact_force"].T) > TOUCH)
    count = len(evidence.model.bodies.name)
    pair = a["contact_body"][rows] * count + a["contact_other"][rows]
    for kind in np.unique(pair).tolist():
        two = divmod(kind, count)
        own = rows[pair == kind]
        _to_outlines(evidence, own[evidence.one_normal[own]], two, worst)
        _to_hulls(evidence, own[~evidence.one_normal[own]], two, worst)


def _to_outlines(evidence: Evidence, rows: Integers, pair: tuple[int, int], worst: Worst) -> None:
    """Places, gaps and normals of rows of one point, or of points on one face."""
    rounding, moving = _allowed(evidence, rows, pair)
    names = "/".join(evidence.model.bodies.name[b] for b in pair)
    one, two = (_nearest(evidence, rows, b, sign, moving)
                for b, sign in zip(pair, (-1.0, 1.0), strict=True))
    # the point of an impact is that at its instant within the step
    bounces = restitution_of(evidence.model.mechanism, *pair) > 0
    moving = moving + bounces * np.abs(evidence.run.arrays["contact_gap"][rows])
    allowed = np.where((one.round | two.round) & (not bounces), rounding, moving)
    worst.add(names, np.maximum(one.off, two.off), allowed)
    # at a corner only the other's outline has a direction
    reach = min(reach_of(evidence, b) for b in pair)
    worst.add(f"normal of {names}", np.minimum(one.turned, two.turned) * reach, allowed)


def _nearest(
    evidence: Evidence, rows: Integers, body: int, sign: float, allowed: Array,
) -> _Nearest:
    """The best of a body's shapes, out of which the recorded normal times ``sign`` leads."""
    half = evidence.run.arrays["contact_gap"][rows] / 2
    least, turned = (np.full(len(rows), np.inf) for _ in range(2))
    circle = np.zeros(len(rows), dtype=bool)
    points, out = _in_frame(evidence, rows, body, sign)
    for number, shape, faces in _surfaces(evidence, body):
        one = (shape.seen(points, out) if isinstance(shape, TrueCurves) else
               seen(shape, points, out, _radius(evidence, rows, body, number)))
        if faces is not None:  # only the surface of the outline counts
            one = one._replace(turned=np.maximum(one.turned, from_faces(out, faces)))
        off = np.maximum(np.abs(one.distance - half), one.aside)
        closer, fit = off < least, np.maximum(off, least) <= allowed
        turned = np.where(fit, np.minimum(turned, one.turned),
                          np.where(closer, one.turned, turned))
        circle = np.where(closer, isinstance(shape, Circle), circle)
        least = np.minimum(least, off)
    return _Nearest(least, turned, circle)


def _to_hulls(evidence: Evidence, rows: Integers, pair: tuple[int, int], worst: Worst) -> None:
    """Compare rows of several points with the hulls of both bodies along their force."""
    a, bodies, beyond = evidence.run.arrays, evidence.model.mechanism.bodies, np.zeros(len(rows))
    force = a["contact_force"][rows]
    along = force / np.hypot(*force.T)[:, None]
    for b in pair:
        for sign in (1.0, -1.0):
            points, out = _in_frame(evidence, rows, b, sign, along)
            reach = np.max([_support(shape, out, _radius(evidence, rows, b, number))
                            for number, shape in _solids(evidence, b)],
                           axis=0, initial=-np.inf)
            beyond = np.maximum(beyond, np.einsum("mi,mi->m", points, out) - reach)
    # forces that almost cancel have a distant line of action
    far = 8 * DIGITS * np.hypot(*a["contact_point"][rows].T)
    worst.add("/".join(bodies[b].name for b in pair), beyond,
              _allowed(evidence, rows, pair)[1] + far)


def _in_frame(
    evidence: Evidence, rows: Integers, body: int, sign: float, way: Array | None = None,
) -> tuple[Array, Array]:
    """Places [m, 2] and ``sign`` times the normals, or ``way``, [m, 2], in the body's frame."""
    a, frames = evidence.run.arrays, evidence.loads.frames
    sample = a["contact_sample"][rows]
    x, y, angle = frames.x[body, sample], frames.y[body, sample], frames.angle[body, sample]
    out = sign * (a["contact_normal"][rows] if way is None else way)
    return (rotated(a["contact_point"][rows] - np.stack([x, y], axis=1), -angle),
            rotated(out, -angle))


def _radius(evidence: Evidence, rows: Integers, body: int, shape: int) -> Array | None:
    """Radius of a circle that a drive sets, at the instants of the rows [m]."""
    a, drives = evidence.run.arrays, evidence.model.drives
    for i in drives.giving("radius").tolist():
        if drives.target[i] == body and drives.shape[i] == shape:
            return np.asarray(a["drive_value"][a["contact_sample"][rows], i])
    return None


def _allowed(evidence: Evidence, rows: Integers, pair: tuple[int, int]) -> tuple[Array, Array]:
    """Tolerance by rounding, and by the motion in a step between two points in turn [m]."""
    a, frames, h = evidence.run.arrays, evidence.loads.frames, evidence.h
    sample = a["contact_sample"][rows]
    size = sum(np.hypot(frames.x[b, sample], frames.y[b, sample]) + reach_of(evidence, b)
               for b in pair)
    rounding = np.asarray(ROUNDING + 8 * DIGITS * size)
    step = h / 2 * frames.acceleration
    speed = np.max([sum(np.hypot(v[0, b, sample], v[1, b, sample])
                        + np.abs(v[2, b, sample]) * reach_of(evidence, b) for b in pair)
                    for v in (evidence.velocity - step, evidence.velocity + step)], axis=0)
    return rounding, np.asarray(rounding + LEFT + h * speed + evidence.contact_depth[rows])


def reach_of(evidence: Evidence, body: int) -> float:
    """From the frame's origin to the furthest of a body's shapes [m]."""
    return geometry.reach_of(evidence.model.mechanism.bodies[body], (0.0, 0.0))
