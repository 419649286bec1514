"""Contacts against the shapes: where they are, which way they push, how far surfaces are apart."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import DIGITS, ROUNDING, Figure, Worst, missing
from sandbox.numeric import Array, Integers
from sandbox.samples.contacts import TOUCH
from sandbox.scene.elements.bodies import Body, Capsule, Circle
from sandbox.scene.geometry import corners


class Near(NamedTuple):
    """Of points, seen from a body: the outline of its shapes that is nearest."""

    distance: Array
    """To it, negative inside [m], [m]."""
    normal: Array
    """Out of it there, in the body's frame, [m, 2]."""


def outline(body: Body, points: Array, radius: Array | None = None, shape: int = -1) -> Near:
    """The nearest outline of a body's shapes to ``points`` [m, 2] in its frame.

    ``radius`` [m] is that of the circle ``shape`` at each point, where a drive sets it.
    """
    distance = np.full(len(points), np.inf)
    normal = np.zeros((len(points), 2))
    for i, one in enumerate(body.shapes):
        if isinstance(one, Circle):
            own: Array | float = one.radius if radius is None or i != shape else radius
            found = _round(points, np.array([one.at]), own)
        elif isinstance(one, Capsule):
            found = _round(points, np.array([one.start, one.end]), one.radius)
        else:
            found = _polygon(points, np.array(corners(one)))
        nearer = found.distance < distance
        distance = np.where(nearer, found.distance, distance)
        normal = np.where(nearer[:, None], found.normal, normal)
    return Near(distance, normal)


def _round(points: Array, line: Array, radius: Array | float) -> Near:
    """A point or a straight piece with a radius."""
    start, along = line[0], line[-1] - line[0]
    square = float(along @ along)
    share = np.clip((points - start) @ along / square, 0.0, 1.0) if square > 0 else np.zeros(
        len(points))
    off = points - start - share[:, None] * along
    length = np.hypot(off[:, 0], off[:, 1])
    return Near(length - radius, off / np.maximum(length, 1e-300)[:, None])


def _polygon(points: Array, corner: Array) -> Near:
    """A convex one, its corners counter-clockwise."""
    edge = np.roll(corner, -1, axis=0) - corner
    length = np.hypot(edge[:, 0], edge[:, 1])
    out = np.stack([edge[:, 1], -edge[:, 0]], axis=1) / length[:, None]
    beyond = np.einsum("mei,ei->me", points[:, None] - corner, out)
    best = beyond.argmax(axis=1)
    inside = beyond[np.arange(len(points)), best]
    nearest = [_round(points, np.stack([corner[i], corner[(i + 1) % len(corner)]]), 0.0)
               for i in range(len(corner))]
    apart = np.min([near.distance for near in nearest], axis=0)
    return Near(np.where(inside > 0, apart, inside), out[best])


def contact_geometry(evidence: Evidence) -> Figure:
    """Every contact lies in the middle between the two outlines, a gap apart, across both."""
    name, source = "contact.place", "outlines"
    a = evidence.run.arrays
    rows = np.flatnonzero(np.hypot(*a["contact_force"].T) > TOUCH)
    if not len(rows):
        return missing(name, why="nothing touches", source=source)
    worst = Worst()
    count = len(evidence.model.bodies.name)
    pair = a["contact_body"][rows] * count + a["contact_other"][rows]
    for kind in np.unique(pair).tolist():
        own = rows[pair == kind]
        names = [evidence.model.bodies.name[b] for b in divmod(kind, count)]
        sides = [_side(evidence, own, b) for b in divmod(kind, count)]
        allowed = _allowed(evidence, own, divmod(kind, count))
        gap = a["contact_gap"][own]
        apart = [np.abs(side.distance - gap / 2) for side in sides]
        worst.add("/".join(names), np.maximum(*apart), allowed)
        direction = a["contact_normal"][own]
        # at a corner only the other's outline has a direction
        turned = np.min([np.hypot(*(sign * side.normal - direction).T)
                         for sign, side in zip((-1.0, 1.0), sides, strict=True)], axis=0)
        reach = _thickness(evidence, divmod(kind, count))
        worst.add(f"normal of {'/'.join(names)}", turned * reach, allowed)
    return worst.figure(
        name, "m", source=source, none="nothing touches",
        why="places, gaps and normals of contacts against the outlines of the shapes, {count} "
            "comparisons, worst: {where}")


def _side(evidence: Evidence, rows: Integers, body: int) -> Near:
    """What the contacts see of one body, normals in the world."""
    a, frames, drives = evidence.run.arrays, evidence.loads.frames, evidence.model.drives
    sample = a["contact_sample"][rows]
    c, s = frames.cos[body, sample], frames.sin[body, sample]
    x, y = (a["contact_point"][rows] - np.stack([frames.x[body, sample], frames.y[body, sample]],
                                                axis=1)).T
    local = np.stack([c * x + s * y, c * y - s * x], axis=1)
    radius, shape = None, -1
    for i in drives.giving("radius").tolist():
        if drives.target[i] == body:
            radius, shape = a["drive_value"][sample, i], int(drives.shape[i])
    near = outline(evidence.model.mechanism.bodies[body], local, radius, shape)
    nx, ny = near.normal.T
    return Near(near.distance, np.stack([c * nx - s * ny, s * nx + c * ny], axis=1))


def _allowed(evidence: Evidence, rows: Integers, pair: tuple[int, int]) -> Array:
    """Rounding; of several points in one row, which are a step's way apart, that way [m], [m]."""
    a, frames, h = evidence.run.arrays, evidence.loads.frames, evidence.h
    sample = a["contact_sample"][rows]
    size = sum(np.hypot(frames.x[b, sample], frames.y[b, sample]) + _reach(evidence, b)
               for b in pair)
    allowed = ROUNDING + 8 * DIGITS * size
    if _one_point(evidence, pair):
        return np.asarray(allowed)
    before = evidence.velocity - h / 2 * frames.acceleration
    speed = sum(np.hypot(before[0, b, sample], before[1, b, sample])
                + np.abs(before[2, b, sample]) * _reach(evidence, b) for b in pair)
    return np.asarray(allowed + LEFT + h * speed)


LEFT = 1e-9
"""How unevenly a flat contact may rest on its points [m]: gaps are closed to 1e-13 / h of speed."""


def _one_point(evidence: Evidence, pair: tuple[int, int]) -> bool:
    """Whether the two can touch in one point only: each is one shape, and one is a circle."""
    shapes = [evidence.model.mechanism.bodies[b].shapes for b in pair]
    return (all(len(each) == 1 for each in shapes)
            and any(isinstance(each[0], Circle) for each in shapes))


def _reach(evidence: Evidence, body: int) -> float:
    """From the frame's origin to the furthest of a body's shapes [m]."""
    most = 0.0
    for shape in evidence.model.mechanism.bodies[body].shapes:
        if isinstance(shape, Circle):
            points, grown = [shape.at], shape.radius
        elif isinstance(shape, Capsule):
            points, grown = [shape.start, shape.end], shape.radius
        else:
            points, grown = corners(shape), 0.0
        most = max(most, float(np.hypot(*np.array(points).T).max()) + grown)
    return most


def _thickness(evidence: Evidence, pair: tuple[int, int]) -> float:
    """A length by which an error of the normal counts [m]: the smaller body's reach."""
    return min(_reach(evidence, b) for b in pair)
