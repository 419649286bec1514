"""Geometry of joints in poses of a mechanism: anchors, wheels, forces along a line."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sandbox.elements.arrays import Arrays
from sandbox.mechanics.teeth import Flank, gear_flank, nearest, rack_flank, rolled
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers


def rotated(vectors: Array, angle: Array | float) -> Array:
    """Vectors [..., 2] rotated by angles [...] [rad]."""
    c, s, x, y = np.cos(angle), np.sin(angle), vectors[..., 0], vectors[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def placed(pose: Array, points: Array) -> Array:
    """Points [..., 2] of frames with poses [..., 3] (x, y, angle) in the world [m]."""
    c, s, x, y = np.cos(pose[..., 2]), np.sin(pose[..., 2]), points[..., 0], points[..., 1]
    return np.stack([pose[..., 0] + c * x - s * y, pose[..., 1] + s * x + c * y], axis=-1)


def anchor_at(model: Model, joint: int | Integers, pose: Array, end: int) -> tuple[Array, Array]:
    """An anchor of a joint, or those of several [k], in the world [m].

    ``end`` is 0 on ``a`` and 1 on ``b``; ``pose`` [..., nb, 3] are the bodies' frames. The two
    coordinates have the shape [...] or [..., k].
    """
    body, point = model.joints.bodies[joint, end], model.joints.anchor[joint, end]
    at = placed(pose[..., body, :], point)
    return at[..., 0], at[..., 1]


def apart(model: Model, joint: int | Integers, pose: Array) -> tuple[Array, Array]:
    """From the anchor on ``a`` to that on ``b`` [m], as :func:`anchor_at`."""
    (ax, ay), (bx, by) = (anchor_at(model, joint, pose, end) for end in (0, 1))
    return bx - ax, by - ay


def _apart(model: Model, joint: int, pose: Array) -> dict[str, Any]:
    """From the centre on ``a`` to that on ``b`` [m]."""
    dx, dy = apart(model, joint, pose)
    return {"dx": dx, "dy": dy}


def _along(model: Model, joint: int, pose: Array) -> tuple[Array, Array]:
    """A rack's pitch line in the world, a unit vector."""
    way = rotated(model.joints.along[joint], pose[..., model.joints.bodies[joint, 1], 2])
    return way[..., 0], way[..., 1]


def flank_of(model: Model, joint: int, pose: Array, side: int) -> Flank:
    """A flank of a ``gear`` or ``rack`` in poses [..., nb, 3]."""
    joints = model.joints
    a, b = (pose[..., body, 2] for body in joints.bodies[joint])
    radii, pressure = joints.radii[joint], float(joints.pressure[joint])
    if joints.kind[joint].keeps == "rack":
        return rack_flank(float(radii[0]), pressure, side, along=_along(model, joint, pose),
                          turned=a - b, **_apart(model, joint, pose))
    return gear_flank((float(radii[0]), float(radii[1])), bool(joints.inside[joint]), pressure,
                      side, angle_a=a, angle_b=b, **_apart(model, joint, pose))


def slip_of(model: Model, joint: int, pose: Array) -> tuple[Any, float]:
    """By how much circles that ``roll`` have slipped in poses [..., nb, 3], and its period [m]."""
    joints = model.joints
    a, b = (pose[..., body, 2] for body in joints.bodies[joint])
    ra, rb = joints.radii[joint].tolist()
    return rolled((ra, rb), bool(joints.inside[joint]), angle_a=a, angle_b=b,
                  **_apart(model, joint, pose))


def flank_gaps(model: Model, joint: int, pose: Array) -> Array:
    """How far the teeth of a ``gear`` or ``rack`` are apart, were there no play, [2, ...] m.

    Along the lines of action of both flanks; at t = 0 both are 0.
    """
    found = []
    for side in (1, -1):
        now, start = (flank_of(model, joint, at, side) for at in (pose, model.bodies.pose))
        found.append(nearest(now.gap - start.gap, now.period))
    return np.asarray(found)


def slipped(model: Model, joint: int, pose: Array) -> Array:
    """By how much circles that ``roll`` have slipped since t = 0 [m]."""
    now, period = slip_of(model, joint, pose)
    return np.asarray(nearest(now - slip_of(model, joint, model.bodies.pose)[0], period))


def play_left(model: Model, joint: int, pose: Array) -> Array:
    """Way along the pitch circles until teeth with play meet, on the nearer side [m]."""
    along = flank_gaps(model, joint, pose).min(axis=0) / math.cos(model.joints.pressure[joint])
    return np.asarray(along + model.joints.play[joint] / 2)


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
    off = _apart(model, joint, pose)
    return x + share * off["dx"], y + share * off["dy"]


def of_wheels(model: Model, arrays: Arrays, joint: int, quantity: str) -> Array:
    """``tangential``, ``radial`` [N] or ``gap`` [m] of a joint of wheels over time, [n]."""
    pose = arrays["body_pose"]
    if quantity == "gap":
        return play_left(model, joint, pose)
    x, y = outward(model, joint, pose)
    fx, fy = arrays["joint_force"][:, joint].T
    if quantity == "tangential":
        return np.asarray(x * fy - y * fx)
    one, other = model.joints.radii[joint]
    within = model.joints.inside[joint] and one > other  # a ring pushes inwards
    return np.asarray(-(x * fx + y * fy) if within else x * fx + y * fy)


def link_tensions(model: Model, arrays: Arrays, joints: Integers) -> Array:
    """Pull along the line of each of these links [N], negative where it pushes, [n, k].

    A link carries force along the line through its two points and nowhere else, so that what its
    reaction does not say is the side: whether ``b`` is drawn to ``a`` or driven away.
    """
    (x, y), force = apart(model, joints, arrays["body_pose"]), arrays["joint_force"][:, joints]
    size = arrays["joint_reaction"][:, joints]
    return np.where(x * force[..., 0] + y * force[..., 1] > 0, -size, size)
