"""Wheels of joints (gears, racks, circles that roll) in poses of a mechanism."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sandbox.mechanics.teeth import Flank, gear_flank, nearest, rack_flank, rolled
from sandbox.model.anchors import anchor_at, apart
from sandbox.model.model import Model
from sandbox.numeric import Array


def _apart(model: Model, joint: int, pose: Array) -> dict[str, Any]:
    """From the centre on ``a`` to that on ``b`` [m]."""
    dx, dy = apart(model, joint, pose)
    return {"dx": dx, "dy": dy}


def _along(model: Model, joint: int, pose: Array) -> tuple[Array, Array]:
    """A rack's pitch line in the world, a unit vector."""
    x, y = model.joints.along[joint]
    angle = pose[..., model.joints.bodies[joint, 1], 2]
    c, s = np.cos(angle), np.sin(angle)
    return c * x - s * y, s * x + c * y


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
