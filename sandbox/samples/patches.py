"""Where two bodies that touch may press on each other: in a point, or anywhere along a side.

A recording has one resultant of each pair. What else the two could carry hangs on how far they
touch: two sides in line may press at either end of what they share, a round one in one place.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.numeric import Array
from sandbox.samples.nearby import pieces_of
from sandbox.samples.stored import Stored
from sandbox.scene.bodies import Body, Capsule, Circle
from sandbox.scene.geometry import corners, count_solids, solids


class Face(NamedTuple):
    """What of one convex shape lies on a plane."""

    low: float
    """From where to where along the plane [m]; equal if round, or a corner."""
    high: float
    radius: float
    """Of its rounding [m]; 0 of a corner."""


def pressed(run: Stored, row: int, near: float) -> Array | None:
    """The one or two places [m], [k, 2], between which a contact row may press.

    ``near`` [m] is how far from the plane of the contact, half its gap away, a corner may be that
    presses. None where bodies of several shapes touch with several normals, of which the row has
    the mean.
    """
    a = run.arrays
    point, u = a["contact_point"][row], a["contact_normal"][row]
    pair = int(a["contact_body"][row]), int(a["contact_other"][row])
    along = np.array([-u[1], u[0]])
    place = float(point @ along)
    near += abs(float(a["contact_gap"][row])) / 2
    sides = faces(run, row, near)
    shared = [(max(one.low, two.low), min(one.high, two.high))
              for one in sides[0] for two in sides[1]]
    shared = [(min(ends), max(ends)) for ends in shared if ends[0] <= ends[1] + near]
    several = any(count_solids(run.mechanism.bodies[body]) > 1 for body in pair)
    if shared:
        low, high = min(ends[0] for ends in shared), max(ends[1] for ends in shared)
        if low - near <= place <= high + near:
            ends = [low] if high - low <= near else [low, high]
            return np.array([point + (end - place) * along for end in ends])
    return None if several else point[None]


def faces(run: Stored, row: int, near: float) -> tuple[list[Face], list[Face]]:
    """What of each shape of both bodies lies on the plane of a contact row, to ``near`` [m]."""
    a = run.arrays
    point, u, sample = a["contact_point"][row], a["contact_normal"][row], a["contact_sample"][row]
    one, two = (
        _faces(run, int(sample), int(a[body][row]), u, sign, float(point @ u), near)
        for body, sign in (("contact_body", -1.0), ("contact_other", 1.0)))
    return one, two


def _faces(
    run: Stored, sample: int, body: int, u: Array, sign: float, level: float, near: float,
) -> list[Face]:
    """Those of one body; the plane is ``level`` [m] out along the normal u.

    The body lies before it by a ``sign`` of -1, beyond it by one of +1; no shape crosses it.
    """
    return [face for piece in pieces_of(run, sample, body)
            for face in _on_plane(piece.corners, piece.grown, u, sign, level, near)]


def flat_sides(body: Body) -> Array:
    """The directions that its flat sides face, in its frame [rad], [k]."""
    found: list[float] = []
    for shape in body.shapes:
        for solid, _ in solids(shape):
            if isinstance(solid, Circle):
                continue
            ring = (np.array([solid.start, solid.end]) if isinstance(solid, Capsule)
                    else np.array(corners(solid)))
            along = np.roll(ring, -1, axis=0) - ring
            found += np.arctan2(-along[:, 0], along[:, 1]).tolist()
    return np.array(found)


def _on_plane(
    world: Array, grown: float, u: Array, sign: float, level: float, near: float,
) -> list[Face]:
    """The face of a shape whose corners in the world [k, 2] are rounded by ``grown``, if any."""
    off = sign * (world @ u - level) + grown
    if abs(off.max()) > near:
        return []
    on = (world @ np.array([-u[1], u[0]]))[off >= off.max() - near]
    return [Face(float(on.min()), float(on.max()), grown)]
