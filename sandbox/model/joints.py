"""Geometry of joints in poses: anchors, wheels, forces along a line; their speeds at t = 0."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from sandbox.elements.arrays import Arrays
from sandbox.mechanics.teeth import Flank, gear_flank, nearest, rack_flank, rolled
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
from sandbox.scene.geometry import Vec
from sandbox.scene.outlines.curves import flattened

CHORDS = 1e-3  # distance of a path from its chords over its extent


def rotated(vectors: Array, angle: Array | float) -> Array:
    """Vectors [..., 2] rotated by angles [...] [rad]."""
    c, s, x, y = np.cos(angle), np.sin(angle), vectors[..., 0], vectors[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def xy(vectors: Array) -> tuple[Array, Array]:
    """The components of vectors [..., 2]."""
    return vectors[..., 0], vectors[..., 1]


def placed(pose: Array, points: Array) -> Array:
    """Points [..., 2] of frames with poses [..., 3] (x, y, angle) in the world [m]."""
    c, s, x, y = np.cos(pose[..., 2]), np.sin(pose[..., 2]), points[..., 0], points[..., 1]
    return np.stack([pose[..., 0] + c * x - s * y, pose[..., 1] + s * x + c * y], axis=-1)


def anchor_at(model: Model, joint: int | Integers, pose: Array, end: int) -> tuple[Array, Array]:
    """X and y of the anchors of joints [k] on ``a`` (``end`` 0) or ``b`` (1) in the world [m]."""
    body, point = model.joints.bodies[joint, end], model.joints.anchor[joint, end]
    return xy(placed(pose[..., body, :], point))


def apart(model: Model, joint: int | Integers, pose: Array) -> tuple[Array, Array]:
    """From the anchor on ``a`` to that on ``b`` [m], as :func:`anchor_at`."""
    (ax, ay), (bx, by) = (anchor_at(model, joint, pose, end) for end in (0, 1))
    return bx - ax, by - ay


def _along(model: Model, joint: int, pose: Array) -> tuple[Array, Array]:
    """A rack's pitch line in the world, a unit vector."""
    return xy(rotated(model.joints.along[joint], pose[..., model.joints.bodies[joint, 1], 2]))


def flank_of(model: Model, joint: int, pose: Array, side: int) -> Flank:
    """A flank of a ``gear`` or ``rack`` in poses [..., nb, 3]."""
    joints = model.joints
    a, b = (pose[..., body, 2] for body in joints.bodies[joint])
    (ra, rb), pressure = joints.radii[joint].tolist(), float(joints.pressure[joint])
    dx, dy = apart(model, joint, pose)
    if joints.kind[joint].keeps == "rack":
        return rack_flank(ra, pressure, side, along=_along(model, joint, pose), dx=dx, dy=dy,
                          turned=a - b)
    return gear_flank((ra, rb), bool(joints.inside[joint]), pressure, side, dx=dx, dy=dy,
                      angle_a=a, angle_b=b)


def slip_of(model: Model, joint: int, pose: Array) -> tuple[Any, float]:
    """Slip of circles that ``roll`` in poses [..., nb, 3], and its period [m]."""
    joints = model.joints
    a, b = (pose[..., body, 2] for body in joints.bodies[joint])
    ra, rb = joints.radii[joint].tolist()
    dx, dy = apart(model, joint, pose)
    return rolled((ra, rb), bool(joints.inside[joint]), dx=dx, dy=dy, angle_a=a, angle_b=b)


def flank_gaps(model: Model, joint: int, pose: Array) -> Array:
    """Gaps of teeth without play along both lines of action, 0 at t = 0 [m], [2, ...]."""
    sides = [[flank_of(model, joint, at, side) for at in (pose, model.bodies.pose)]
             for side in (1, -1)]
    return np.asarray([nearest(now.gap - start.gap, now.period) for now, start in sides])


def slipped(model: Model, joint: int, pose: Array) -> Array:
    """Slip of circles that ``roll`` since t = 0 [m]."""
    now, period = slip_of(model, joint, pose)
    return np.asarray(nearest(now - slip_of(model, joint, model.bodies.pose)[0], period))


def outward(model: Model, joint: int, pose: Array) -> tuple[Array, Array]:
    """From the centre of ``a`` to where its wheel meets the other, a unit vector."""
    (ax, ay), (x, y) = anchor_at(model, joint, pose, 0), meeting(model, joint, pose)
    length = np.maximum(np.hypot(x - ax, y - ay), 1e-300)
    return (x - ax) / length, (y - ay) / length


def meeting(model: Model, joint: int, pose: Array) -> tuple[Array, Array]:
    """Where two wheels meet: pitch circles touch there, and lines of action pass [m]."""
    joints = model.joints
    x, y = anchor_at(model, joint, pose, 0)
    ra, rb = joints.radii[joint].tolist()
    if joints.kind[joint].keeps == "rack":
        gx, gy = _along(model, joint, pose)
        return x + ra * gy, y - ra * gx
    share = ra / (ra - rb if joints.inside[joint] else ra + rb)
    dx, dy = apart(model, joint, pose)
    return x + share * dx, y + share * dy


def of_wheels(model: Model, arrays: Arrays, joint: int, quantity: str) -> Array:
    """``tangential``, ``radial`` [N] or ``gap`` [m] of a joint of wheels over time, [n]."""
    pose = arrays["body_pose"]
    if quantity == "gap":  # to the nearer flank
        along = flank_gaps(model, joint, pose).min(axis=0) / math.cos(model.joints.pressure[joint])
        return np.asarray(along + model.joints.play[joint] / 2)
    x, y = outward(model, joint, pose)
    fx, fy = arrays["joint_force"][:, joint].T
    if quantity == "tangential":
        return np.asarray(x * fy - y * fx)
    one, other = model.joints.radii[joint]
    inwards = model.joints.inside[joint] and one > other  # by a ring
    return np.asarray((-1 if inwards else 1) * (x * fx + y * fy))


def link_tensions(model: Model, arrays: Arrays, joints: Integers) -> Array:
    """Tension of joints that act along the line through their points [N], [n, k]."""
    (x, y), force = apart(model, joints, arrays["body_pose"]), arrays["joint_force"][:, joints]
    size = arrays["joint_reaction"][:, joints]
    return np.where(x * force[..., 0] + y * force[..., 1] > 0, -size, size)


class Place(NamedTuple):
    """The point of a slot in poses [..., nb, 3] of its bodies; each value has the shape [...]."""

    along: Array  # from the start of the axis or path [m]
    across: Array  # distance to the left of the axis or path [m]
    off: Array  # distance from the recorded place on a path [m]; |across| on an axis
    x: Array  # direction of the axis or path in the world, a unit vector
    y: Array
    bend: Array  # curvature of the path [1/m], positive where it turns to the left; 0 of an axis


def place_in_slot(model: Model, joint: int, pose: Array, along: Array | None = None) -> Place:
    """The place of a slot's point along its axis or path, in poses [..., nb, 3].

    ``along`` are recorded places along a path [...]; the nearest ones by default.
    """
    joints = model.joints
    a, b = joints.bodies[joint].tolist()
    at_a, path = pose[..., a, :], joints.path[joint]
    point = rotated(placed(pose[..., b, :], joints.anchor[joint, 1]) - at_a[..., :2], -at_a[..., 2])
    shape = point.shape[:-1]
    if path is None:
        foot, end = joints.groove[joint]
        tangent = (end - foot) / max(float(np.hypot(*(end - foot))), 1e-300)
        begin = bend = np.zeros(shape)
    else:
        if along is None:
            along = np.reshape([path.nearest(one) for one in point.reshape(-1, 2)], shape)
        begin = along
        foot, tangent, bend = (np.reshape(one, (*shape, *one.shape[1:]))
                               for one in path.at(np.ravel(along)))
    (tx, ty), (ox, oy) = xy(tangent), xy(point - foot)
    ahead, across = tx * ox + ty * oy, tx * oy - ty * ox
    return Place(begin + ahead, across, np.abs(across) if path is None else np.hypot(ahead, across),
                 *xy(rotated(tangent, at_a[..., 2])), bend)


def normal_in_slot(model: Model, arrays: Arrays, joint: int) -> Array:
    """Force on ``b`` across the path of a slot over time [N], positive to its left, [n]."""
    place = place_in_slot(model, joint, arrays["body_pose"], arrays["joint_length"][:, joint])
    fx, fy = arrays["joint_force"][:, joint].T
    return np.asarray(place.x * fy - place.y * fx)


def slot_points(model: Model, joint: int) -> Array:
    """Points along a slot in the frame of ``a`` [m], [n, 2]: its ends, or chords of its path."""
    path = model.joints.path[joint]
    if path is None:
        return np.asarray(model.joints.groove[joint])
    extent = float(np.ptp(path.nodes[:, :2], axis=0).max())
    points = np.array(flattened(path.nodes, CHORDS * extent, closed=path.closed))
    return np.concatenate([points, points[:1]]) if path.closed else points


def slot_length(model: Model, joint: int) -> float:
    """Distance between the ends of a slot along it [m]; inf of a closed path."""
    if path := model.joints.path[joint]:
        return math.inf if path.closed else path.length
    return float(np.hypot(*(model.joints.groove[joint, 1] - model.joints.groove[joint, 0])))


def turning(model: Model, joint: int) -> float:
    """Angular velocity of ``b`` against ``a`` at t = 0 [rad/s]; 0 for bodies that are not free."""
    a, b = model.bodies.velocity[model.joints.bodies[joint], 2].tolist()
    return float(b - a)


def sliding(model: Model, joint: int) -> float:
    """Speed of the point of a slot along it at t = 0 [m/s]; 0 without length."""
    place, at = place_in_slot(model, joint, model.bodies.pose), model.ends(joint)[1]
    vx, vy = _parting(model, joint, (at, at))
    return float(vx * place.x + vy * place.y)


def lengthening(model: Model, joint: int) -> float:
    """Speed at which the two points of a joint separate at t = 0 [m/s]; 0 if they coincide."""
    one, two = model.ends(joint)
    vx, vy = _parting(model, joint, (one, two))
    x, y = two[0] - one[0], two[1] - one[1]
    length = math.hypot(x, y)
    return (vx * x + vy * y) / length if length > 0 else 0.0


def _parting(model: Model, joint: int, places: tuple[Vec, Vec]) -> Vec:
    """Velocity of a point of ``b`` minus that of a point of ``a``, by their places at t = 0."""
    found = []
    for body, (px, py) in zip(model.joints.bodies[joint].tolist(), places, strict=True):
        vx, vy, w = model.bodies.velocity[body].tolist()
        x, y = model.at_start(body, model.bodies.centre[body])
        found.append((vx - w * (py - y), vy + w * (px - x)))
    (ax, ay), (bx, by) = found
    return bx - ax, by - ay
