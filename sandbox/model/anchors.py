"""Where the points that joints hold lie in poses of a mechanism."""

from __future__ import annotations

import numpy as np

from sandbox.model.model import Model
from sandbox.numeric import Array, Integers


def anchor_at(model: Model, joint: int | Integers, pose: Array, end: int) -> tuple[Array, Array]:
    """An anchor of a joint, or those of several [k], in the world [m].

    ``end`` is 0 on ``a`` and 1 on ``b``; ``pose`` [..., nb, 3] are the bodies' frames. The two
    coordinates have the shape [...] or [..., k].
    """
    body, (x, y) = model.joints.bodies[joint, end], model.joints.anchor[joint, end].T
    at = pose[..., body, :]
    c, s = np.cos(at[..., 2]), np.sin(at[..., 2])
    return at[..., 0] + c * x - s * y, at[..., 1] + s * x + c * y


def apart(model: Model, joint: int | Integers, pose: Array) -> tuple[Array, Array]:
    """From the anchor on ``a`` to that on ``b`` [m], as :func:`anchor_at`."""
    (ax, ay), (bx, by) = (anchor_at(model, joint, pose, end) for end in (0, 1))
    return bx - ax, by - ay
