"""How the phalanges of a finger accelerate: what the matrices W of (33) are made of.

With joint angles counted clockwise, frame i turns at omega_i = -sum_(j<=i)
theta_j' and alpha_i = -sum_(j<=i) theta_j''. The near hinge of phalanx i+1 lies
at L_i along x of phalanx i, and its acceleration is handed on as

    a_(i+1) = R_(i,i+1)^T (a_i + alpha_i z x (L_i, 0) - omega_i^2 (L_i, 0))

each a_i in frame i; a_1 is that of the palm at the first hinge.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.chain import link_transforms
from sandbox.mechanics.checks import finite, per_phalanx, points, together, vectors
from sandbox.numeric import Array


class LinkMotion(NamedTuple):
    """Turning of the phalanges and accelerations of their near hinges."""

    omega: Array
    """Angular velocities, counter-clockwise [rad/s], shape [..., n]."""
    alpha: Array
    """Angular accelerations, counter-clockwise [rad/s^2], shape [..., n]."""
    acceleration: Array
    """Of C_i, in frame i [m/s^2], shape [..., n, 2]."""


def finger_motion(
    theta: ArrayLike, rates: ArrayLike, accelerations: ArrayLike, lengths: ArrayLike,
) -> LinkMotion:
    """Motion of the phalanges' frames on a palm at rest, from the joints'.

    Args:
        theta: joint angles, closing positive [rad], shape [..., n].
        rates: theta' [rad/s], shape [..., n].
        accelerations: theta'' [rad/s^2], shape [..., n].
        lengths: L_i of the phalanges [m], shape [n].

    Raises:
        ValueError: a length not above 0, arrays of unequal length.
    """
    links = link_transforms(theta, lengths)
    n = links.shape[-3]
    rate = per_phalanx("rates", rates, n, "rad/s")
    growth = per_phalanx("accelerations", accelerations, n, "rad/s^2")
    shape = together(theta=links[..., 0, 0], rates=rate, accelerations=growth)
    omega, alpha = -np.cumsum(rate, axis=-1), -np.cumsum(growth, axis=-1)
    own = np.zeros((*shape, 2))
    reach = np.asarray(lengths, dtype=np.float64)
    for i in range(1, n):
        spun = reach[i - 1] * np.stack(
            np.broadcast_arrays(-omega[..., i - 1]**2, alpha[..., i - 1]), axis=-1)
        own[..., i, :] = np.einsum(
            "...ji,...j->...i", links[..., i, :2, :2], own[..., i - 1, :] + spun)
    return LinkMotion(np.asarray(omega), np.asarray(alpha), own)


def origin_acceleration(
    acceleration: ArrayLike, omega: ArrayLike, alpha: ArrayLike, centre: ArrayLike,
) -> Array:
    """Acceleration of a frame's origin from that of the centre of mass [m/s^2], shape [..., 2].

    a_C = a_G - alpha z x r + omega^2 r, all in one frame.

    Args:
        acceleration: a_G [m/s^2], shape [..., 2].
        omega: angular velocity, counter-clockwise [rad/s], shape [...].
        alpha: angular acceleration, counter-clockwise [rad/s^2], shape [...].
        centre: r, of mass, from the frame's origin [m], shape [..., 2].

    Raises:
        ValueError: arrays of unequal length, a value that is not finite.
    """
    a, r = vectors("acceleration", acceleration, "m/s^2"), points("centre", centre)
    spin, growth = finite("omega", omega, "rad/s"), finite("alpha", alpha, "rad/s^2")
    together(acceleration=a[..., 0], omega=spin, alpha=growth, centre=r[..., 0])
    across = np.stack([-r[..., 1], r[..., 0]], axis=-1)
    return np.asarray(a - growth[..., None] * across + (spin**2)[..., None] * r)
