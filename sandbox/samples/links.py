"""What rods, ropes and cylinders carry, with its sign, worked out from a run's poses and forces."""

from __future__ import annotations

import numpy as np

from sandbox.elements.arrays import Arrays
from sandbox.model.anchors import apart
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers


def link_tensions(model: Model, arrays: Arrays, joints: Integers) -> Array:
    """Pull along the line of each of these links [N], negative where it pushes, [n, k].

    A link carries force along the line through its two points and nowhere else, so that what its
    reaction does not say is the side: whether ``b`` is drawn to ``a`` or driven away.
    """
    (x, y), force = apart(model, joints, arrays["body_pose"]), arrays["joint_force"][:, joints]
    size = arrays["joint_reaction"][:, joints]
    return np.where(x * force[..., 0] + y * force[..., 1] > 0, -size, size)
