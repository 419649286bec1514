"""The chain of phalanges: equation (31) in the plane, for any number of them.

Frame i has its origin at the near hinge C_i of phalanx i, x toward the next hinge, and turns
clockwise by theta_i [rad] against frame i-1 (closing, when the palm side is at negative y):

    A_(i-1,i) = [[ cos theta_i, sin theta_i, L_(i-1)],
                 [-sin theta_i, cos theta_i, 0      ],
                 [ 0,           0,           1      ]]

with L_(i-1) [m] the length of phalanx i-1; L_0 = 0: the base frame is at the first hinge. The
product of the first i of them takes points (x, y, 1) of phalanx i to the base; for three this is
(31), printed right: A_(M,d) = A_(M,p) A_(p,m) A_(m,d).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import finite, not_negative, per_phalanx, positive
from sandbox.numeric import Array


def pose(x: ArrayLike = 0.0, y: ArrayLike = 0.0, angle: ArrayLike = 0.0) -> Array:
    """Frames at (x, y) [m], turned counter-clockwise [rad], as matrices, [...] to [..., 3, 3]."""
    at_x, at_y, turned = finite("x", x, "m"), finite("y", y, "m"), finite("angle", angle, "rad")
    matrix = np.zeros((*np.broadcast_shapes(at_x.shape, at_y.shape, turned.shape), 3, 3))
    matrix[..., 0, 0] = matrix[..., 1, 1] = np.cos(turned)
    matrix[..., 1, 0] = np.sin(turned)
    matrix[..., 0, 1] = -matrix[..., 1, 0]
    matrix[..., 0, 2], matrix[..., 1, 2], matrix[..., 2, 2] = at_x, at_y, 1.0
    return matrix


def transforms(theta: ArrayLike, lengths: ArrayLike, base: ArrayLike | None = None) -> Array:
    """From every phalanx's frame to the world, shape [..., n, 3, 3], equation (31).

    Args:
        theta: joint angles [rad], shape [..., n].
        lengths: of the phalanges [m], > 0, shape [n].
        base: the palm's frame at the first hinge (:func:`pose`), shape [..., 3, 3]; the world by
            default.
    """
    phalanges = np.atleast_1d(positive("lengths", lengths, "m"))
    angles = per_phalanx("theta", theta, len(phalanges), "rad")
    product = np.eye(3) if base is None else finite("base", base, "")
    if product.shape[-2:] != (3, 3):
        raise ValueError(f"base must be 3x3 matrices, got shape {product.shape}")
    chained = []
    for i, before in enumerate((0.0, *phalanges[:-1])):
        product = product @ pose(np.full(angles.shape[:-1], before), angle=-angles[..., i])
        chained.append(product)
    return np.stack(chained, axis=-3)


def to_world(frames: ArrayLike, points: ArrayLike) -> Array:
    """Points of phalanges, each in its frame [m], shape [..., n, 2] or [2], in the world [m].

    ``frames`` are those of :func:`transforms`, shape [..., n, 3, 3].
    """
    matrix, local = np.asarray(frames, dtype=np.float64), finite("points", points, "m")
    turned = np.einsum("...ij,...j->...i", matrix[..., :2, :2], local)
    return np.asarray(turned + matrix[..., :2, 2])


def hinges(frames: ArrayLike) -> Array:
    """C_1 ... C_n in the world [m], shape [..., n, 2]: the frames' origins."""
    return np.asarray(frames, dtype=np.float64)[..., :2, 2]


def tip(frames: ArrayLike, length: float) -> Array:
    """The far end of the last phalanx, ``length`` [m] long, in the world [m], shape [..., 2]."""
    last = np.asarray(frames, dtype=np.float64)[..., -1, :, :]
    return np.asarray(last[..., :2, 2] + last[..., :2, 0] * not_negative("length", length, "m"))
