"""The chain of phalanges: equation (31) in the plane, for any number of them.

Frame i has its origin at the near hinge C_i of phalanx i, x toward the next
hinge, and turns clockwise by theta_i against frame i-1 (closing, when the palm
side is at negative y):

    A_(i-1,i) = [[ cos theta_i, sin theta_i, L_(i-1)],
                 [-sin theta_i, cos theta_i, 0      ],
                 [ 0,           0,           1      ]]

with L_0 = 0: the base frame sits at the first hinge. The product of the first
i of them takes points of phalanx i to the base; for three this is (31).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import Array, finite, not_negative, per_phalanx, positive


def pose(x: float = 0.0, y: float = 0.0, angle: float = 0.0) -> Array:
    """A frame in the world as a 3x3 matrix: origin [m], angle counter-clockwise [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, x], [s, c, y], [0.0, 0.0, 1.0]])


def link_transform(theta: ArrayLike, length_before: ArrayLike) -> Array:
    """A_(i-1,i), shape [..., 3, 3].

    Args:
        theta: joint angle, clockwise [rad], shape [...].
        length_before: L_(i-1) [m], 0 for the first hinge.

    Raises:
        ValueError: a length below 0.
    """
    angle, length = np.broadcast_arrays(
        finite("theta", theta, "rad"), not_negative("length_before", length_before, "m"))
    matrix = np.zeros((*angle.shape, 3, 3))
    matrix[..., 0, 0] = matrix[..., 1, 1] = np.cos(angle)
    matrix[..., 0, 1] = np.sin(angle)
    matrix[..., 1, 0] = -matrix[..., 0, 1]
    matrix[..., 0, 2] = length
    matrix[..., 2, 2] = 1.0
    return matrix


def transforms(theta: ArrayLike, lengths: ArrayLike, base: ArrayLike | None = None) -> Array:
    """From every phalanx's frame to the world, shape [..., n, 3, 3], equation (31).

    Args:
        theta: joint angles [rad], shape [..., n].
        lengths: of the phalanges [m], shape [n].
        base: the palm's frame at the first hinge (:func:`pose`), shape [..., 3, 3];
            the world by default.

    Raises:
        ValueError: a length not above 0, another number of angles than phalanges.
    """
    phalanges = np.atleast_1d(positive("lengths", lengths, "m"))
    angles = per_phalanx("theta", theta, len(phalanges), "rad")
    links = link_transform(angles, np.concatenate([[0.0], phalanges[:-1]]))
    product = np.eye(3) if base is None else finite("base", base, "m")
    chained = []
    for i in range(len(phalanges)):
        product = product @ links[..., i, :, :]
        chained.append(product)
    return np.stack(chained, axis=-3)


def to_world(frames: ArrayLike, points: ArrayLike) -> Array:
    """Points of phalanges in the world [m], shape [..., n, 2].

    Args:
        frames: from :func:`transforms`, shape [..., n, 3, 3].
        points: one a phalanx, in its own frame [m], shape [..., n, 2] or [2] for all alike.
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
