"""What wheels that meet give one another, worked out from a run's poses and forces."""

from __future__ import annotations

import numpy as np

from sandbox.elements.arrays import Arrays
from sandbox.model.model import Model
from sandbox.model.wheels import outward, play_left
from sandbox.numeric import Array


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
