"""Distances and normals between convex shapes of bodies in a sample."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sandbox.numeric import Array, Integers
from sandbox.scene.bodies import Body, Circle
from sandbox.scene.geometry import core, count_solids, solids

if TYPE_CHECKING:
    from sandbox.samples.samples import Samples

SAME = 1e-12  # Rounding error of lengths below a metre [m]


class PlacedPiece(NamedTuple):
    """A convex shape of a body, in the world."""

    corners: Array  # [k, 2]; of a circle its centre, of a capsule the two of its ends [m]
    grown: float  # Radius about their convex hull [m]
    faces: Array | None  # Arcs of surface normals in the body's frame; None if all of it is surface


def pieces_of(run: Samples, sample: int, body: int) -> Iterator[PlacedPiece]:
    """The convex shapes of a body in a sample."""
    x, y, angle = run.arrays["body_pose"][sample, body]
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    for number, shape in enumerate(run.mechanism.bodies[body].shapes):
        for solid, faces in solids(shape):
            points, grown = core(solid)
            if isinstance(solid, Circle):
                grown = float(radius_of(run, sample, body, number, grown))
            yield PlacedPiece(np.array(points) @ turn.T + (x, y), grown, faces)


def radius_of(
    run: Samples, samples: int | Integers, body: int, shape: int, radius: float,
) -> Array | float:
    """Radius of a shape in samples [m], which is ``radius`` unless a drive sets it."""
    model = run.model
    for drive in model.drives.giving("radius").tolist():
        if (int(model.drives.target[drive]), int(model.drives.shape[drive])) == (body, shape):
            return np.asarray(run.arrays["drive_value"][samples, drive])
    return radius


def apart(one: PlacedPiece, two: PlacedPiece) -> tuple[float, Array, Array] | None:
    """Gap between two outlines [m], normal out of the first, and the place in the middle [m].

    None for round pieces with a deep overlap. The distance of polygons is the largest along the
    normals of their sides, unless corner is nearest to corner. This normal is exact at any
    distance; the direction between two nearest points is exact where radii separate them.
    """
    along, normal = _along_sides(one.corners, two.corners)
    sharp = not (one.grown or two.grown)
    if along < -SAME and not sharp:
        return None
    off, p, q = _from_corners(one.corners, two.corners)
    other, on_two, on_one = _from_corners(two.corners, one.corners)
    p, q = (p, q) if off <= other else (on_one, on_two)
    way = q - p
    length = float(np.hypot(*way))
    if (sharp and along < 0) or length <= along + SAME:
        length = along
    elif length > SAME:
        normal = way / length
    else:
        return None
    gap = length - one.grown - two.grown
    return gap, normal, (p + one.grown * normal + q - two.grown * normal) / 2


def _sides(ring: Array) -> Array:
    """From each corner to the next [e, 2]; one side of two corners, none of one."""
    return ring[1:] - ring[:-1] if len(ring) <= 2 else np.roll(ring, -1, axis=0) - ring


def _along_sides(one: Array, two: Array) -> tuple[float, Array]:
    """The largest distance of rings along the normals of their sides, and that normal."""
    sides = np.concatenate([_sides(one), _sides(two)])
    sides = sides[np.hypot(*sides.T) > 0]
    if not len(sides):
        return -np.inf if np.hypot(*(two[0] - one[0])) <= SAME else 0.0, np.zeros(2)
    out = np.stack([sides[:, 1], -sides[:, 0]], axis=1) / np.hypot(*sides.T)[:, None]
    out = np.concatenate([out, -out])
    off = (out @ two.T).min(axis=1) - (out @ one.T).max(axis=1)
    best = int(np.argmax(off))
    return float(off[best]), out[best]


def _from_corners(points: Array, ring: Array) -> tuple[float, Array, Array]:
    """The least distance of points from the sides of a ring, and the nearest point of either."""
    along = _sides(ring) if len(ring) > 1 else np.zeros((1, 2))
    away = from_sides(points, ring[:len(along)], along)
    off = np.hypot(*np.moveaxis(away, -1, 0))
    p, e = np.unravel_index(int(np.argmin(off)), off.shape)
    return float(off[p, e]), points[p], points[p] - away[p, e]


def from_sides(points: Array, start: Array, along: Array) -> Array:
    """From the nearest place on each side to each point [m], [p, e, 2]."""
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    share = np.clip(((points[:, None] - start) * along).sum(axis=2) / square, 0.0, 1.0)
    return np.asarray(points[:, None] - start - share[..., None] * along)


class Face(NamedTuple):
    """The part of one convex shape that lies on a plane."""

    low: float  # Interval along the plane [m]; of a round shape or a corner without length
    high: float
    radius: float  # Of the shape there [m]; 0 of a corner


def pressed(run: Samples, row: int, near: float) -> tuple[Array | None, list[Face | None]]:
    """The one or two points [m], [k, 2], between which a contact row may press; its two faces.

    ``near`` [m] is the distance from the plane of the contact, besides half its gap, within which a
    corner presses. None for bodies of several shapes that touch with several normals.
    """
    a = run.arrays
    point, u, sample = (a[f"contact_{key}"][row] for key in ("point", "normal", "sample"))
    pair = int(a["contact_body"][row]), int(a["contact_other"][row])
    along = np.array([-u[1], u[0]])
    place, level = float(point @ along), float(point @ u)
    near += abs(float(a["contact_gap"][row])) / 2
    sides: tuple[list[Face], list[Face]] = [], []
    # one body lies before the plane, the other beyond it; no shape crosses it
    for side, body, sign in zip(sides, pair, (-1.0, 1.0), strict=True):
        for corners, grown, _ in pieces_of(run, int(sample), body):
            off = sign * (corners @ u - level) + grown
            if abs(off.max()) <= near:
                on = (corners @ along)[off >= off.max() - near]
                side.append(Face(float(on.min()), float(on.max()), grown))
    here = [next((each for each in side if each.low - near <= place <= each.high + near), None)
            for side in sides]
    shared = [(max(one.low, two.low), min(one.high, two.high))
              for one in sides[0] for two in sides[1]]
    shared = [(min(ends), max(ends)) for ends in shared if ends[0] <= ends[1] + near]
    several = any(count_solids(run.mechanism.bodies[body]) > 1 for body in pair)
    if shared:
        low, high = min(ends[0] for ends in shared), max(ends[1] for ends in shared)
        if low - near <= place <= high + near:
            ends = [low] if high - low <= near else [low, high]
            return np.array([point + (end - place) * along for end in ends]), here
    return None if several else point[None], here


def flat_sides(body: Body) -> Array:
    """Directions of the normals of a body's flat sides, in its frame [rad], [k]."""
    found: list[float] = []
    for shape in body.shapes:
        for solid, _ in solids(shape):
            ring = np.array(core(solid)[0])
            along = np.roll(ring, -1, axis=0) - ring
            if len(ring) > 1:
                found += np.arctan2(-along[:, 0], along[:, 1]).tolist()
    return np.array(found)
