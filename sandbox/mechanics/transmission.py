"""How a finger shares out its tendon's pull: ratios, the equilibrium curve, isotropy.

With tendon arms h_i [m] and tension T [N] a finger without springs has joint torques in the ratios
X_i = h_i / h_1, and frictionless contacts have the forces f = J^-T T h. The force transfer ratio is
sum(f_i) / T. Two phalanges, contacts at k_1, k_2 [m] along them, proximal length l_1 [m]:

    f_2 = tau_2 / k_2,   f_1 = (tau_1 - (k_2 + l_1 cos theta_2) f_2) / k_1   [N]

so the proximal contact holds (f_1 > 0) only beyond the equilibrium curve

    k_2 > e = X l_1 cos(theta_2) / (1 - X),   X = tau_2 / tau_1

with X = h_2 / h_1 if there are no springs. Equal forces f on all phalanges take arms
h = J^T (1, ..., 1) f / T, which depend on the contacts and on the pose.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import finite, not_negative, positive
from sandbox.mechanics.statics import contact_jacobian
from sandbox.numeric import Array


def transmission_ratios(arms: ArrayLike) -> Array:
    """X_i = h_i / h_1 [1] of tendon arms or joint torques of one unit, h_1 > 0, shape [..., n]."""
    h = finite("arms", arms, "m")
    return np.asarray(h / positive("arms of joint 1", h[..., :1], "m"))


def force_transfer_ratio(forces: ArrayLike, tension: ArrayLike) -> Array:
    """sum(f_i) / T [1], shape [...]: the normal forces got out of a tension put in.

    f_i >= 0 [N] are the contact forces, shape [..., m], T > 0 [N] the tension, shape [...].
    """
    pulled = positive("tension", tension, "N")
    total = not_negative("forces", forces, "N").sum(axis=-1)
    return np.asarray(total / pulled)


class TwoPhalanxForces(NamedTuple):
    """Contact forces of a finger of two phalanges; a negative one would have to pull."""

    proximal: Array  #: f_1 [N], shape [...]
    distal: Array  #: f_2 [N], shape [...]


def two_phalanx_forces(
    theta_2: ArrayLike, k_1: ArrayLike, k_2: ArrayLike, length_1: float,
    torque_1: ArrayLike, torque_2: ArrayLike,
) -> TwoPhalanxForces:
    """f_2 = tau_2 / k_2 and f_1 = (tau_1 - (k_2 + l_1 cos theta_2) f_2) / k_1.

    Args:
        theta_2: angle of the second joint [rad], shape [...].
        k_1: of the proximal contact from hinge 1, along the phalanx [m], > 0, shape [...].
        k_2: of the distal contact from hinge 2 [m], > 0, shape [...].
        length_1: l_1, hinge to hinge [m], > 0.
        torque_1: tau_1 [N m], closing positive, shape [...].
        torque_2: tau_2 [N m], shape [...].
    """
    turned = finite("theta_2", theta_2, "rad")
    near, far = positive("k_1", k_1, "m"), positive("k_2", k_2, "m")
    first, second = finite("torque_1", torque_1, "N m"), finite("torque_2", torque_2, "N m")
    distal = second / far
    reach = far + positive("length_1", length_1, "m") * np.cos(turned)
    return TwoPhalanxForces(*np.broadcast_arrays((first - reach * distal) / near, distal))


def equilibrium_distance(theta_2: ArrayLike, length_1: float, ratio: ArrayLike) -> Array:
    """Distance e = X l_1 cos(theta_2) / (1 - X) [m]: k_2 of no proximal force.

    The proximal contact holds where k_2 > e, and always where e < 0.

    Args:
        theta_2: angle of the second joint [rad], shape [...].
        length_1: l_1 of the proximal phalanx [m], > 0.
        ratio: X = tau_2 / tau_1 [1], h_2 / h_1 without springs, between 0 and 1, shape [...]: from
            1 on no distance lets both phalanges push while cos(theta_2) > 0.
    """
    turned, X = finite("theta_2", theta_2, "rad"), positive("ratio", ratio, "")
    if (high := np.asarray(X >= 1)).any():
        raise ValueError(f"ratio must be below 1, got {X[high].flat[0]:.6g}")
    return np.asarray(X * positive("length_1", length_1, "m") * np.cos(turned) / (1 - X))


def force_isotropy(forces: ArrayLike) -> Array:
    """min(f_i) / max(f_i) [1], [..., m] to [...], of contact forces f_i >= 0 [N], not all 0.

    1 where all phalanges press alike, 0 if one does not press.
    """
    f = not_negative("forces", forces, "N")
    return np.asarray(f.min(axis=-1) / positive("largest of forces", f.max(axis=-1), "N"))


def isotropic_arms(theta: ArrayLike, lengths: ArrayLike, distances: ArrayLike) -> Array:
    """J^T (1, ..., 1) [m]: the arms, up to a common factor, that press equally; shape [..., n].

    For a springless finger. Divided by its last they are the ratio h_1 : ... : 1. Arguments are
    those of :func:`~sandbox.mechanics.statics.contact_jacobian`, ``distances`` > 0.
    """
    k = positive("distances", distances, "m")
    return np.asarray(contact_jacobian(theta, lengths, k).sum(axis=-2))

