"""What wheels that meet give one another, worked out from a run's poses and forces."""

from __future__ import annotations

import numpy as np

from sandbox.model.wheels import outward, play_left
from sandbox.numeric import Array
from sandbox.samples.stored import Stored


def of_wheels(run: Stored, joint: int, quantity: str) -> Array:
    """``tangential``, ``radial`` [N] or ``gap`` [m] of a joint of wheels over time, [n]."""
    pose = run.arrays["body_pose"]
    if quantity == "gap":
        return play_left(run.model, joint, pose)
    x, y = outward(run.model, joint, pose)
    fx, fy = run.arrays["joint_force"][:, joint].T
    if quantity == "tangential":
        return np.asarray(x * fy - y * fx)
    one, other = run.model.joints.radii[joint]
    within = run.model.joints.inside[joint] and one > other  # a ring pushes inwards
    return np.asarray(-(x * fx + y * fy) if within else x * fx + y * fy)
