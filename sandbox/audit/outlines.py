"""Contacts against the shapes: where they are, which way they push, how far surfaces are apart."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import DIGITS, ROUNDING, Figure, Worst, missing
from sandbox.numeric import Array, Integers
from sandbox.samples.contacts import TOUCH
from sandbox.scene.elements.bodies import Capsule, Circle, Shape
from sandbox.scene.geometry import corners


class Seen(NamedTuple):
    """What contacts see of one of their bodies, a single convex shape, [m] each."""

    distance: Array
    """Along the normal, from the furthest that the shape reaches that way to the place [m]."""
    aside: Array
    """How far the place is from the shape otherwise [m]."""
    turned: Array
    """Between the normal and the nearest one that the outline has there, a sine."""


def seen(shape: Shape, points: Array, out: Array, radius: Array | float | None = None) -> Seen:
    """A shape from ``points`` [m, 2] near its outline, with ``out`` [m, 2] the normals out of it.

    Both in the body's frame; ``radius`` [m] is that of a circle, where a drive sets it.
    """
    if isinstance(shape, Circle | Capsule):
        ends = [shape.at] if isinstance(shape, Circle) else [shape.start, shape.end]
        grown = shape.radius if radius is None else radius
        corner = np.array(ends)
    else:
        corner, grown = np.array(corners(shape)), 0.0
    reach = (out @ corner.T).max(axis=1) + grown
    distance = np.einsum("mi,mi->m", points, out) - reach
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


def _from_line(points: Array, line: Array) -> Array:
    """From the nearest of a straight piece [2, 2] to points [m, 2]."""
    along = line[1] - line[0]
    square = float(along @ along)
    share = np.zeros(len(points))
    if square > 0:
        share = np.clip((points - line[0]) @ along / square, 0.0, 1.0)
    off: Array = points - line[0] - share[:, None] * along
    return off


def contact_geometry(evidence: Evidence) -> Figure:
    """Every contact lies in the middle between the two outlines, a gap apart, across both.

    Of a body with several shapes the place is somewhere among them: the other body tells.
    """
    name, source = "contact.place", "outlines"
    a, bodies = evidence.run.arrays, evidence.model.mechanism.bodies
    rows = np.flatnonzero(np.hypot(*a["contact_force"].T) > TOUCH)
    if not len(rows):
        return missing(name, why="nothing touches", source=source)
    worst = Worst()
    count = len(evidence.model.bodies.name)
    pair = a["contact_body"][rows] * count + a["contact_other"][rows]
    for kind in np.unique(pair).tolist():
        two = divmod(kind, count)
        own = rows[pair == kind]
        sides = [_side(evidence, own, b, sign) for b, sign in zip(two, (-1.0, 1.0), strict=True)
                 if len(bodies[b].shapes) == 1]
        if not sides:
            continue
        names = "/".join(evidence.model.bodies.name[b] for b in two)
        allowed = _allowed(evidence, own, two)
        off = [np.maximum(np.abs(side.distance - a["contact_gap"][own] / 2), side.aside)
               for side in sides]
        worst.add(names, np.max(off, axis=0), allowed)
        # at a corner only the other's outline has a direction
        if len(sides) == 2:
            turned = np.minimum(*(side.turned for side in sides))
            reach = min(_reach(evidence, b) for b in two)
            worst.add(f"normal of {names}", turned * reach, allowed)
    return worst.figure(
        name, "m", source=source, none="all that touches has several shapes",
        why="places, gaps and normals of contacts against the outlines of the shapes, {count} "
            "comparisons, worst: {where}")


def _side(evidence: Evidence, rows: Integers, body: int, sign: float) -> Seen:
    """What the contacts see of one body, out of which the recorded normal times ``sign`` leads."""
    a, frames, drives = evidence.run.arrays, evidence.loads.frames, evidence.model.drives
    sample = a["contact_sample"][rows]
    c, s = frames.cos[body, sample], frames.sin[body, sample]
    x, y = (a["contact_point"][rows] - np.stack([frames.x[body, sample], frames.y[body, sample]],
                                                axis=1)).T
    nx, ny = sign * a["contact_normal"][rows].T
    radius = None
    for i in drives.giving("radius").tolist():
        if drives.target[i] == body:
            radius = a["drive_value"][sample, i]
    return seen(evidence.model.mechanism.bodies[body].shapes[0],
                np.stack([c * x + s * y, c * y - s * x], axis=1),
                np.stack([c * nx + s * ny, c * ny - s * nx], axis=1), radius)


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

