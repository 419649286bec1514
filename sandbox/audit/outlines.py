"""Contacts against the shapes: places, normals and gaps of rows, and contacts without a force.

A row of one point, or of two convex shapes, lies half a gap from both outlines along the normal;
one of several points between other bodies lies within both convex hulls along the force. A contact
without a force has no row, but may carry one in another balance of the same pose.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sandbox.audit.evidence import DIGITS, LEFT, ROUNDING, Check, Evidence, Worst
from sandbox.elements.arrays import CONTACT, Arrays
from sandbox.model.joints import rotated
from sandbox.model.pairs import allowed_pairs
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples import nearby
from sandbox.samples.contacts import TOUCH
from sandbox.samples.nearby import PlacedPiece, apart, from_sides, pieces_of, radius_of
from sandbox.scene import geometry
from sandbox.scene.bodies import Box, Capsule, Circle, Polygon, Polyline, Shape
from sandbox.scene.geometry import corners, true_curves
from sandbox.scene.outlines.curves import on_spans, spans_of
from sandbox.scene.outlines.rings import wound

ROWS = 5_000  # Number of contacts that are compared with a shape at once
NEWTON = 25
AHEAD = 2e-3  # Gap beyond the margins of two shapes [m]: they meet on the path of fast bodies
ASKEW, ALIKE = 1e-6, 1e-3  # Angles between normals of one surface, and of one contact [rad]


class _Outline(NamedTuple):
    """The outline of one shape in its body's frame."""

    start: Array  # Corners, the material to the left of the sides [m], [k, 2]
    end: Array  # Where each side ends [m]
    radius: float  # Of the surface about the sides [m]
    flat: bool  # Whether normals are those of the sides
    spans: Array  # Smooth curves as sandbox.scene.outlines.curves.Spans has them, [n, 12]
    beside: Integers  # The spans before and after each, [2, n]; -1 at the ends of an open curve

    def distances(self, at: Array, out: Array, radius: Array | float) -> tuple[Array, Array]:
        """Distances of points [m, 2] from sides [m], and of normals there from ``out``; [m, k]."""
        if len(self.spans):
            return self._from_curves(at, out)
        along = self.end - self.start
        away = from_sides(at, self.start, along)
        length = np.hypot(*np.moveaxis(away, 2, 0))
        normal = away / np.maximum(length, 1e-300)[..., None]
        if self.flat:
            normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
            normal /= np.maximum(np.hypot(*along.T), 1e-150)[:, None]
        turned = np.hypot(*np.moveaxis(normal - out[:, None], 2, 0))
        return np.abs((length.T - radius).T), turned

    def _from_curves(self, at: Array, out: Array) -> tuple[Array, Array]:
        """The same of curves, by Newton's method from the nearest node."""
        x, y = (at[:, None] - self.spans[:, [0, 6]]).transpose(2, 0, 1)
        k, w = (x**2 + y**2).argmin(axis=1), np.zeros(len(at))
        for _ in range(NEWTON):
            place, first, second = on_spans(self.spans[k], w)
            square, slope = (first**2).sum(axis=1), ((place - at) * first).sum(axis=1)
            bend = square + ((place - at) * second).sum(axis=1)
            w = w - np.clip(slope / np.where(bend > square / 20, bend, square), -1.0, 1.0)
            there = np.where(w > 1, self.beside[1, k], np.where(w < 0, self.beside[0, k], -1))
            w = np.where(there < 0, np.clip(w, 0.0, 1.0), np.where(w > 1, 0.0, 1.0))
            k = np.where(there < 0, k, there)
        place, first, _ = on_spans(self.spans[k], w)
        normal = np.stack([first[:, 1], -first[:, 0]], axis=1) / np.hypot(*first.T)[:, None]
        turned = np.hypot(*(normal - out).T)
        if not self.flat:
            turned = np.minimum(turned, np.hypot(*(normal + out).T))
        off = np.abs(np.hypot(*(at - place).T) - self.radius)
        return off[:, None], turned[:, None]


@lru_cache(maxsize=256)
def _outline(shape: Shape) -> _Outline:
    flat = isinstance(shape, Box | Polygon)
    if isinstance(shape, Box | Polygon):
        radius, rings = 0.0, [np.array(corners(shape)), *(
            np.array(wound(hole, -1)) for hole in getattr(shape, "holes", ()))]
        start = np.concatenate(rings)
        end = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    else:
        points = np.array([shape.at] * 2 if isinstance(shape, Circle) else
                          [shape.start, shape.end] if isinstance(shape, Capsule) else shape.points)
        radius, start, end = shape.radius, points[:-1], points[1:]
    spans = [spans_of(nodes, closed=flat).terms for nodes in true_curves(shape)] if isinstance(
        shape, Polygon | Polyline) and shape.nodes else [np.zeros((0, 12))]
    numbers = np.split(np.arange(sum(map(len, spans))), np.cumsum([len(each) for each in spans]))
    beside = np.array([np.concatenate([np.roll(own, by) for own in numbers]) for by in (1, -1)])
    if not flat and beside.size:
        beside[0, 0] = beside[1, -1] = -1
    return _Outline(start, end, radius, flat, np.concatenate(spans), beside)


@Check("contact.place", "m", "outlines",
       asks="are contacts on the outlines of both bodies?",
       compared="points, gaps and normals of contacts against the outlines of the shapes; for "
                "merged contacts of several shapes, points along the force against the hulls; "
                "{count:comparison}, worst: {where}",
       none="nothing touches")
def _places(evidence: Evidence, worst: Worst) -> None:
    a, one_normal = evidence.arrays, evidence.one_normal
    presses = np.hypot(*a["contact_force"].T) > TOUCH
    for label, two, of in evidence.pairs():
        blurred, own = (np.flatnonzero(of & presses & rows) for rows in (~one_normal, one_normal))
        # forces that almost cancel have a distant line of action
        far = 8 * DIGITS * np.hypot(*a["contact_point"][blurred].T)
        worst.add(label, np.max([_beyond(evidence, blurred, b) for b in two], axis=0),
                  _allowed(evidence, blurred, two)[1] + far)
        rounding, moving = _allowed(evidence, own, two)
        sides = [[np.concatenate(part) for part in zip(*(
            _nearest(evidence, own[i:i + ROWS], b, sign, moving[i:i + ROWS])
            for i in range(0, max(len(own), 1), ROWS)), strict=True)]
            for b, sign in zip(two, (-1.0, 1.0), strict=True)]
        off, turned, circle = zip(*sides, strict=True)
        # the point of an impact, or of a meeting ahead, is that at its instant within the step
        gap, twist = a["contact_gap"][own], np.nan_to_num(a["contact_twist"][own])
        later = (evidence.run.contacts.laws[2, own] > 0) | (gap > AHEAD) | (twist != 0)
        moving = moving + later * np.abs(gap)
        allowed = np.where((circle[0] | circle[1]) & ~later, rounding, moving)
        worst.add(label, np.maximum(*off), allowed)
        # at a corner only the other's outline has a direction
        reach = min(reach_of(evidence, b) for b in two)
        worst.add(f"normal of {label}", np.minimum(*turned) * reach, allowed)


def _nearest(
    evidence: Evidence, rows: Integers, body: int, sign: float, allowed: Array,
) -> tuple[Array, Array, Flags]:
    """Distances of points and normals from the best sides of a body, and what is a circle."""
    a, half, found = evidence.arrays, evidence.arrays["contact_gap"][rows] / 2, []
    points, out = _in_frame(evidence, rows, body, sign * a["contact_normal"][rows])
    shapes = evidence.model.mechanism.bodies[body].shapes
    for number, shape in enumerate(shapes):
        radius = _radius(evidence, rows, body, number)
        found.append(_outline(shape).distances(points - half[:, None] * out, out, radius))
    off, turned = (np.concatenate(part, axis=1) for part in zip(*found, strict=True))
    circle = np.repeat([isinstance(shape, Circle) for shape in shapes],
                       [part.shape[1] for part, _ in found])
    least = off.min(axis=1)
    fit = off <= np.maximum(allowed, least)[:, None]
    return least, np.where(fit, turned, np.inf).min(axis=1), circle[off.argmin(axis=1)]


def _beyond(evidence: Evidence, rows: Integers, body: int) -> Array:
    """How far rows are beyond the hull of a body along their forces [m]."""
    force, beyond = evidence.arrays["contact_force"][rows], np.zeros(len(rows))
    for sign in (1.0, -1.0):
        points, out = _in_frame(evidence, rows, body, (sign * force.T / np.hypot(*force.T)).T)
        reach = [(out @ _outline(shape).start.T).max(axis=1)
                 + _radius(evidence, rows, body, number)
                 for number, shape in enumerate(evidence.model.mechanism.bodies[body].shapes)]
        beyond = np.maximum(beyond, (points * out).sum(axis=1) - np.max(reach, axis=0))
    return beyond


def _in_frame(evidence: Evidence, rows: Integers, body: int, out: Array) -> tuple[Array, Array]:
    """Places and directions ``out`` of rows in the body's frame, [m, 2] each."""
    a, frames = evidence.arrays, evidence.frames
    sample = a["contact_sample"][rows]
    x, y, angle = frames.pose[:, body, sample]
    return (rotated(a["contact_point"][rows] - np.stack([x, y], axis=1), -angle),
            rotated(out, -angle))


def _radius(evidence: Evidence, rows: Integers, body: int, shape: int) -> Array | float:
    """Radius about the sides of a shape [m]; of a circle that a drive may set at the rows."""
    return radius_of(evidence.run, evidence.arrays["contact_sample"][rows], body, shape,
                     _outline(evidence.model.mechanism.bodies[body].shapes[shape]).radius)


def _allowed(evidence: Evidence, rows: Integers, pair: tuple[int, int]) -> tuple[Array, Array]:
    """Tolerance by rounding, and by the motion in a step between two points in turn [m]."""
    a, frames, h = evidence.arrays, evidence.frames, evidence.h
    sample, size, speed = a["contact_sample"][rows], np.zeros(len(rows)), np.zeros((2, len(rows)))
    for b in pair:
        reach, step = reach_of(evidence, b), h / 2 * frames.acceleration[:, b, sample]
        size += np.hypot(*frames.pose[:2, b, sample]) + reach
        for k, sign in enumerate((-1, 1)):
            vx, vy, turn = evidence.velocity[:, b, sample] + sign * step
            speed[k] += np.hypot(vx, vy) + np.abs(turn) * reach
    rounding = ROUNDING + 8 * DIGITS * size
    return rounding, rounding + LEFT + h * speed.max(axis=0) + evidence.contact_depth[rows]


def reach_of(evidence: Evidence, body: int) -> float:
    """From the frame's origin to the furthest of a body's shapes [m]."""
    return geometry.reach_of(evidence.model.mechanism.bodies[body], (0.0, 0.0))


class Touch(NamedTuple):
    """Where two bodies touch, as a contact row has it."""

    body: int
    other: int
    normal: Array  # Into the body
    point: Array
    gap: float


def touched(evidence: Evidence, least: float = -np.inf) -> Evidence:
    """A single sample with a row of zero force for each plane of contact without a row.

    Rows with a normal force of no more than ``least`` [N] are removed first.
    """
    a, found = evidence.arrays, list[Touch]()
    kept = np.flatnonzero(evidence.run.contacts.normal > least)
    known: dict[tuple[int, int], list[tuple[Array, Array, bool]]] = {}
    for row in kept.tolist():
        one, two = int(a["contact_body"][row]), int(a["contact_other"][row])
        known.setdefault((min(one, two), max(one, two)), []).append((
            (1.0 if one < two else -1.0) * a["contact_normal"][row], a["contact_point"][row],
            pressed(evidence, row) is None))
    near = [touch for touch, parts in _near(evidence, allowed_pairs(evidence.model))
            if abs(parts) * evidence.h <= evidence.open]
    for touch in sorted(near, key=lambda touch: (touch.body, touch.other, touch.gap)):
        planes = known.setdefault((touch.body, touch.other), [])
        if not any(several or (np.hypot(*(normal - touch.normal)) <= ALIKE
                               and abs((touch.point - at) @ normal) <= 2 * evidence.near)
                   for normal, at, several in planes):
            planes.append((touch.normal, touch.point, False))
            found.append(touch)
    rows: Arrays = {}
    for key in CONTACT:
        new = np.zeros((len(found), *a[key].shape[1:]), dtype=a[key].dtype)
        if key == "contact_merged":
            new += 1
        elif found and hasattr(found[0], of := key.removeprefix("contact_")):
            new[:] = [getattr(touch, of) for touch in found]
        rows[key] = np.concatenate([a[key][kept], new])
    return Evidence(evidence.run.with_arrays({**a, **rows}), alone=True, near=evidence.near)


def overlaps(evidence: Evidence) -> dict[tuple[int, int], float]:
    """Near pairs without a row, and the largest overlap of outlines that approach [m], or 0."""
    allowed, deepest = allowed_pairs(evidence.model), dict[tuple[int, int], float]()
    one, two = (evidence.arrays[f"contact_{key}"] for key in ("body", "other"))
    allowed[one, two] = allowed[two, one] = False
    for touch, parts in _near(evidence, allowed):
        pair = touch.body, touch.other
        depth = -touch.gap if parts * evidence.h < -evidence.open else 0.0
        deepest[pair] = max(deepest.get(pair, 0.0), depth)
    return deepest


def _near(evidence: Evidence, allowed: Flags) -> Iterator[tuple[Touch, float]]:
    """Where outlines of allowed pairs [nb, nb] are near, and their rate of separation [m/s]."""
    frames, velocity = evidence.frames, evidence.velocity_after[:, :, 0]
    owned = [(body, piece) for body in np.flatnonzero(allowed.any(axis=1)).tolist()
             for piece in pieces_of(evidence.run, 0, body)]
    of = np.array([body for body, _ in owned], dtype=np.int64)
    low, high = (np.array([edge(p.corners, axis=0) + sign * p.grown for _, p in owned]
                          ).reshape(-1, 2) for edge, sign in ((np.min, -1), (np.max, 1)))
    reach = evidence.near + 8 * DIGITS * float(np.abs(low).max(initial=0.0))
    for i, (body, piece) in enumerate(owned):
        beside = ((low[i + 1:] <= high[i] + reach) & (high[i + 1:] >= low[i] - reach)).all(axis=1)
        for other, beyond in (owned[j] for j in (
                i + 1 + np.flatnonzero(beside & allowed[body, of[i + 1:]])).tolist()):
            here = apart(piece, beyond)
            if here is None or here[0] > evidence.near or not (
                    _surface(evidence, body, piece, here[1])
                    and _surface(evidence, other, beyond, -here[1])):
                continue
            gap, normal, at = here
            one, two = (velocity[:2, b] + velocity[2, b] * np.array(
                [frames.centre[1, b, 0] - at[1], at[0] - frames.centre[0, b, 0]])
                for b in (body, other))
            yield Touch(body, other, -normal, at, gap), float((two - one) @ normal)


def _surface(evidence: Evidence, body: int, piece: PlacedPiece, out: Array) -> bool:
    """Whether ``out`` is within an arc of normals of the outline's surface on this piece."""
    if piece.faces is None:
        return True
    x, y = rotated(out, -evidence.arrays["body_pose"][0, body, 2])
    ax, ay, bx, by = piece.faces.T
    within = (ax * y - ay * x >= 0) & (x * by - y * bx >= 0) & (x * (ax + bx) + y * (ay + by) > 0)
    return bool((within | (np.minimum(np.hypot(ax - x, ay - y), np.hypot(bx - x, by - y))
                           <= ASKEW)).any())


def pressed(evidence: Evidence, row: int) -> Array | None:
    """The points between which a contact row of the single sample may press."""
    a = evidence.arrays
    pair = int(a["contact_body"][row]), int(a["contact_other"][row])
    size, speed = np.abs(a["body_pose"][0, pair, :2]).max(), np.hypot(
        *a["body_velocity"][0, pair, :2].T).sum()
    return nearby.pressed(evidence.run, row, float(
        evidence.near + 8 * DIGITS * size + evidence.h * speed))[0]
