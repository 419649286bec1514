"""Underactuated statics: joint torques at rest and the contact forces they press with.

At rest joint i carries, positive where it closes,

    tau_i = T h_i - k_i (lm_i - lm_0,i) hm_i   (+ gravity, + what else acts)

and the virtual work of the contacts, tau . dtheta = sum_c f_c n_c . dp_c, makes

    tau = J^T f,   J_cj = n_c . (z x (p_c - C_j)) for joints j up to the phalanx of c

with n the direction in which a contact pushes the phalanx. Frictionless contacts, one a phalanx, at
k_i from the near hinge of phalanx i give the closed form J_ij = k_i + sum_(m=j)^(i-1) L_m
cos(theta_(m+1) + ... + theta_i) (Birglen, Laliberte and Gosselin 2008).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import matrix, not_negative, per_phalanx, points, positive
from sandbox.numeric import Array, Flags


def joint_torques(
    tension: ArrayLike, tendon_arms: ArrayLike, stiffness: ArrayLike, elongations: ArrayLike,
    spring_arms: ArrayLike,
) -> Array:
    """tau_i = T h_i - k_i (lm - lm_0)_i hm_i [N m], shape [..., n].

    Args:
        tension: T [N], >= 0, shape [...].
        tendon_arms: h_i [m], shape [..., n].
        stiffness: k_i [N/m], >= 0, shape [..., n].
        elongations: of the springs from their rest lengths [m], shape [..., n].
        spring_arms: hm_i [m], shape [..., n].
    """
    n = np.atleast_1d(tendon_arms).shape[-1]
    h = per_phalanx("tendon_arms", np.atleast_1d(tendon_arms), n, "m")
    k = not_negative("stiffness", per_phalanx("stiffness", stiffness, n, "N/m"), "N/m")
    stretch = per_phalanx("elongations", elongations, n, "m")
    hm = per_phalanx("spring_arms", spring_arms, n, "m")
    pulled = not_negative("tension", tension, "N")[..., None]
    return np.asarray(pulled * h - k * stretch * hm)


def contact_jacobian(theta: ArrayLike, lengths: ArrayLike, distances: ArrayLike) -> Array:
    """Closed-form J of one contact on each phalanx [m], shape [..., n, n], lower triangular.

    Args:
        theta: joint angles [rad], shape [..., n].
        lengths: L_i of the phalanges [m], > 0, shape [n].
        distances: k_i of the contacts from the near hinges, along the phalanges [m], [..., n].
    """
    phalanges = np.atleast_1d(positive("lengths", lengths, "m"))
    n = len(phalanges)
    turned = np.cumsum(per_phalanx("theta", theta, n, "rad"), axis=-1)
    k = per_phalanx("distances", distances, n, "m")
    # reach[i, m]: of phalanx m along phalanx i, L_m cos(theta_(m+1) + ... + theta_i), m < i
    reach = phalanges * np.cos(turned[..., :, None] - turned[..., None, :])
    reach = reach * np.tril(np.ones((n, n)), -1)
    from_j = np.flip(np.cumsum(np.flip(reach, -1), axis=-1), -1)
    return np.asarray((from_j + k[..., :, None]) * np.tril(np.ones((n, n))))


def point_jacobian(
    contacts: ArrayLike, normals: ArrayLike, hinges: ArrayLike, phalanx: ArrayLike,
) -> Array:
    """J_cj = n_c . (z x (p_c - C_j)) of any contacts [m], shape [..., m, n].

    Args:
        contacts: p_c in the world [m], shape [..., m, 2].
        normals: n_c, unit, the direction of the force on the phalanx, shape [..., m, 2].
        hinges: C_j in the world [m], shape [..., n, 2].
        phalanx: which phalanx (0 ... n-1) each contact is on, shape [m].
    """
    p, c = points("contacts", contacts), points("hinges", hinges)
    n = points("normals", normals, p.shape[-2])
    on = np.asarray(phalanx)
    if on.shape != (p.shape[-2],) or (on < 0).any() or (on >= c.shape[-2]).any():
        raise ValueError(f"phalanx must name one of 0 to {c.shape[-2] - 1} for each of the "
                         f"{p.shape[-2]} contacts, got {on.tolist()}")
    lever = p[..., :, None, :] - c[..., None, :, :]
    rows = n[..., :, None, 1] * lever[..., 0] - n[..., :, None, 0] * lever[..., 1]
    return np.asarray(rows * (np.arange(c.shape[-2]) <= on[:, None]))


def contact_forces(jacobian: ArrayLike, torques: ArrayLike) -> Array:
    """Forces f = J^-T tau [N], shape [..., n]; a negative one would have to pull.

    Args:
        jacobian: J [m], as many contacts as joints, shape [..., n, n].
        torques: tau [N m], shape [..., n].

    Raises:
        ValueError: J not square, or singular: then the forces are not determined.
    """
    J = np.asarray(jacobian, dtype=np.float64)
    J = per_phalanx("jacobian", J, J.shape[-1] if J.ndim else 1, "m")
    if J.ndim < 2 or J.shape[-1] != J.shape[-2]:
        raise ValueError(f"jacobian must be as many contacts as joints, got shape {J.shape}")
    tau = per_phalanx("torques", torques, J.shape[-1], "N m")
    try:
        return np.asarray(np.linalg.solve(np.swapaxes(J, -1, -2), tau[..., None])[..., 0])
    except np.linalg.LinAlgError:
        raise ValueError("jacobian must not be singular: a contact has no arm (0 m)") from None


class Unilateral(NamedTuple):
    """Results of :func:`unilateral_forces`."""

    forces: Array  #: f_c >= 0 of the contacts [N], shape [m]; 0 for those that separate
    stops: Array  #: torques of the stops [N m], closing positive, shape [n]; 0 where none acts
    residual: Array  #: tau + stops - J^T f [N m], shape [n]; 0 in equilibrium


def unilateral_forces(
    jacobian: ArrayLike, torques: ArrayLike, *, lower: ArrayLike | None = None,
    upper: ArrayLike | None = None, inertia: ArrayLike | None = None,
) -> Unilateral:
    """Contact forces and stop torques that only push: a complementarity problem.

    From rest, joints accelerate by M^-1 (tau + stops - J^T f), and every contact and stop either
    pushes or separates: f >= 0, accelerations of separation a >= 0, f a = 0. That is the optimum of
    min |tau - G f|^2 in the norm of M^-1 over f >= 0, with G the columns of J^T and one for every
    stop. With a zero ``residual`` the pose is an equilibrium, and the forces do not depend on M.

    Args:
        jacobian: J of the contacts that touch [m], shape [m, n].
        torques: tau of everything else [N m], shape [n].
        lower: which joints are on their lower stop, shape [n] of bool.
        upper: which joints are on their upper stop.
        inertia: M of the joints [kg m^2], positive definite, shape [n, n];
            that of equal joints by default.
    """
    from scipy.optimize import nnls
    J = matrix("jacobian", jacobian, "m")
    m, n = J.shape
    tau = per_phalanx("torques", torques, n, "N m")
    stops = _stop_rows(n, lower, upper)
    G = np.concatenate([J, stops]).T
    M = np.eye(n) if inertia is None else matrix("inertia", inertia, "kg m^2")
    try:
        root = np.linalg.cholesky(M)
    except np.linalg.LinAlgError:
        raise ValueError("inertia must be positive definite in kg m^2") from None
    A, b = np.linalg.solve(root, G), np.linalg.solve(root, tau)
    scale = np.linalg.norm(A, axis=0)
    scale[scale == 0] = 1.0
    pushes = nnls(A / scale, b)[0] / scale if A.shape[1] else np.zeros(0)
    return Unilateral(pushes[:m], np.asarray(-(stops.T @ pushes[m:])), np.asarray(tau - G @ pushes))


def determined_forces(
    jacobian: ArrayLike, *, lower: ArrayLike | None = None, upper: ArrayLike | None = None,
) -> Flags:
    """Which contact forces equilibrium alone decides, shape [m] of bool.

    Forces x with G x = 0 may be added, G the columns of J^T and one for every acting stop. The
    force of a contact that takes part in none of them is determined. Arguments are those of
    :func:`unilateral_forces`.
    """
    J = matrix("jacobian", jacobian, "m")
    rows = np.concatenate([J, _stop_rows(J.shape[1], lower, upper)])
    size = np.linalg.norm(rows, axis=1, keepdims=True)
    unit = rows / np.where(size > 0, size, 1.0)
    left, values, _ = np.linalg.svd(unit)
    rank = int((values > 1e-9).sum())
    return np.asarray(np.abs(left[:len(J), rank:]).max(axis=1, initial=0.0) < 1e-6)


def _stop_rows(joints: int, lower: ArrayLike | None, upper: ArrayLike | None) -> Array:
    """One row of J [rad] for every stop that may act: it resists opening, or closing."""
    rows = []
    for name, stop, sign in (("lower", lower, -1.0), ("upper", upper, 1.0)):
        on = np.zeros(joints, dtype=bool) if stop is None else np.asarray(stop, dtype=bool)
        if on.shape != (joints,):
            raise ValueError(f"{name} must have a boolean for each of {joints} joints, got shape "
                             f"{on.shape}")
        rows.append(sign * np.eye(joints)[on])
    return np.concatenate(rows)
