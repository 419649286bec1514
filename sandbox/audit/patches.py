"""Where two bodies that touch may press on each other: in a point, or anywhere along a side.

A recording has one resultant of each pair. What else the two could carry hangs on how far they
touch: two sides in line may press at either end of what they share, a round one in one place.
"""

from __future__ import annotations

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import DIGITS, ROUNDING
from sandbox.audit.outlines import LEFT
from sandbox.numeric import Array
from sandbox.scene.elements.bodies import Capsule, Circle
from sandbox.scene.geometry import corners, count_solids, solids


def pressed(evidence: Evidence, row: int) -> Array | None:
    """The one or two places [m], [k, 2], between which a contact row of the one sample may press.

    None where bodies of several shapes touch with several normals, of which the row has the mean.
    """
    a, model = evidence.run.arrays, evidence.model
    point, u, gap = a["contact_point"][row], a["contact_normal"][row], a["contact_gap"][row]
    pair = int(a["contact_body"][row]), int(a["contact_other"][row])
    along = np.array([-u[1], u[0]])
    near = _near(evidence, pair) + abs(float(gap)) / 2
    level, place = float(point @ u), float(point @ along)
    sides = [_faces(evidence, body, sign * u, sign * level, along, near)
             for body, sign in zip(pair, (-1.0, 1.0), strict=True)]
    shared = [(max(one[0], two[0]), min(one[1], two[1])) for one in sides[0] for two in sides[1]]
    shared = [(min(ends), max(ends)) for ends in shared if ends[0] <= ends[1] + near]
    several = any(count_solids(model.mechanism.bodies[body]) > 1 for body in pair)
    if shared:
        low, high = min(ends[0] for ends in shared), max(ends[1] for ends in shared)
        if low - near <= place <= high + near:
            ends = [low] if high - low <= near else [low, high]
            return np.array([point + (end - place) * along for end in ends])
    return None if several else point[None]


def _near(evidence: Evidence, pair: tuple[int, int]) -> float:
    """How far from the plane of a contact a corner may be that presses [m]."""
    a, h = evidence.run.arrays, evidence.h
    pose, velocity = a["body_pose"][0, pair], a["body_velocity"][0, pair]
    size = float(np.abs(pose[:, :2]).max())
    return LEFT + ROUNDING + 8 * DIGITS * size + h * float(np.hypot(*velocity[:, :2].T).sum())


def _faces(
    evidence: Evidence, body: int, out: Array, level: float, along: Array, near: float,
) -> list[tuple[float, float]]:
    """From where to where along a plane [m] each shape of a body lies on it.

    The plane is ``level`` [m] out along the unit vector ``out``, on which no shape goes beyond.
    """
    x, y, angle = evidence.run.arrays["body_pose"][0, body]
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    found = []
    for number, shape in enumerate(evidence.model.mechanism.bodies[body].shapes):
        for solid, _ in solids(shape):
            if isinstance(solid, Circle):
                points, grown = [solid.at], _radius(evidence, body, number, solid.radius)
            elif isinstance(solid, Capsule):
                points, grown = [solid.start, solid.end], solid.radius
            else:
                points, grown = corners(solid), 0.0
            world = np.array(points) @ turn.T + (x, y)
            off = world @ out + grown - level
            if abs(off.max()) <= near:
                on = (world @ along)[off >= off.max() - near]
                found.append((float(on.min()), float(on.max())))
    return found


def _radius(evidence: Evidence, body: int, shape: int, radius: float) -> float:
    """Of a circle [m], as a drive may have set it."""
    drives = evidence.model.drives
    for drive in drives.giving("radius").tolist():
        if (int(drives.target[drive]), int(drives.shape[drive])) == (body, shape):
            return float(evidence.run.arrays["drive_value"][0, drive])
    return radius
