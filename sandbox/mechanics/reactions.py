"""Joint reactions from the world's own numbers: d'Alembert over everything beyond a joint.

Cut joint i. What lies beyond it, body i and all that hangs on it, is in balance
with the inertial forces, so the joint gives to body i

    R_i = sum_(k beyond i) (m_k a_k - F_k)                                       [N]
    M_i = sum_(k beyond i) (I_k alpha_k - N_k + (c_k - C_i) x (m_k a_k - F_k))   [N m]

with F_k, N_k the loads on body k about its centre of mass c_k, C_i the joint.
No frames, no recursion: an independent way to what (32)-(33) give, and one
that holds for trees as well as for chains. Any leading axes (time) broadcast.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import not_negative, per_phalanx, points, together, vectors
from sandbox.numeric import Array


class JointReactions(NamedTuple):
    """What every joint does to the body beyond it, in the world."""

    force: Array
    """Of the parent on body i at its joint [N], shape [..., n, 2]."""
    moment: Array
    """About the joint, counter-clockwise [N m], shape [..., n]; 0 for an ideal hinge."""


def joint_reactions(
    joints: ArrayLike, centres: ArrayLike, accelerations: ArrayLike, alphas: ArrayLike,
    masses: ArrayLike, inertias: ArrayLike, forces: ArrayLike, moments: ArrayLike, *,
    parents: Sequence[int] | None = None,
) -> JointReactions:
    """Reactions of the joints of a chain or tree of n bodies, each hung on one joint.

    Args:
        joints: C_i, of each body to its parent, world [m], shape [..., n, 2].
        centres: c_i of mass, world [m], shape [..., n, 2].
        accelerations: a_i of the centres, world [m/s^2], shape [..., n, 2].
        alphas: angular accelerations, counter-clockwise [rad/s^2], shape [..., n].
        masses: m_i [kg], shape [n].
        inertias: I_i about the centres [kg m^2], shape [n].
        forces: F_i, sum of the loads with weight, without reactions [N], shape [..., n, 2].
        moments: N_i, their moment about c_i, counter-clockwise [N m], shape [..., n].
        parents: of every body, -1 for what is fixed; body i on body i-1 by default.

    Raises:
        ValueError: arrays of unequal length, a mass or inertia below 0, parents
            that do not exist or run in a ring.
    """
    at = points("joints", joints)
    n = at.shape[-2] if at.ndim > 1 else 0
    c, a = points("centres", centres, n), vectors("accelerations", accelerations, "m/s^2", n)
    F, N = vectors("forces", forces, "N", n), per_phalanx("moments", moments, n, "N m")
    alpha = per_phalanx("alphas", alphas, n, "rad/s^2")
    together(joints=at[..., 0], centres=c[..., 0], accelerations=a[..., 0], alphas=alpha,
             forces=F[..., 0], moments=N)
    m = not_negative("masses", per_phalanx("masses", masses, n, "kg"), "kg")
    inertia = not_negative("inertias", per_phalanx("inertias", inertias, n, "kg m^2"), "kg m^2")
    beyond = subtrees(range(-1, n - 1) if parents is None else parents, n)
    needed = m[:, None] * a - F
    force = np.asarray(beyond @ needed)
    # Moments are summed about one point amid the joints, then taken to each joint:
    # n terms instead of n^2, and no digits lost by a world origin far away.
    amid = at.mean(axis=-2, keepdims=True)
    about = (inertia * alpha - N + _cross(c - amid, needed)) @ beyond.T
    return JointReactions(force, np.asarray(about - _cross(at - amid, force)))


def subtrees(parents: Sequence[int], count: int) -> Array:
    """Which bodies lie beyond each joint: [i, k] is 1 where k is body i or hangs on it.

    Args:
        parents: of every body, -1 for what is fixed, shape [count].
        count: n, of bodies.

    Raises:
        ValueError: another number of parents, one that does not exist, a ring.
    """
    up = np.asarray(parents, dtype=np.int64)
    if up.shape != (count,) or (up < -1).any() or (up >= count).any():
        raise ValueError(f"parents must name -1 or one of the {count} bodies for each of them, "
                         f"got {up.tolist()}")
    beyond = np.eye(count)
    for body in range(count):
        above, steps = int(up[body]), 0
        while above >= 0:
            beyond[above, body], above, steps = 1.0, int(up[above]), steps + 1
            if steps > count:
                raise ValueError(f"parents must not run in a ring, got {up.tolist()}")
    return beyond


def gather_loads(
    centres: ArrayLike, body: ArrayLike, at: ArrayLike, force: ArrayLike, *,
    sample: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """Forces at points, summed to one force and one moment a body.

    Args:
        centres: of mass, world [m], shape [n, 2], or [samples, n, 2] with ``sample``.
        body: on which each force acts, shape [m] of int.
        at: where it acts, world [m], shape [m, 2].
        force: [N], world, shape [m, 2].
        sample: of which row of ``centres`` each force is, shape [m] of int.

    Returns:
        Forces [N], shaped as ``centres``, and moments about the centres,
        counter-clockwise [N m], without its last axis.

    Raises:
        ValueError: arrays of unequal length, a body or sample that does not exist.
    """
    c, on = points("centres", centres), np.asarray(body, dtype=np.int64)
    p, f = points("at", at, on.size), vectors("force", force, "N", on.size)
    index = (on,) if sample is None else (np.asarray(sample, dtype=np.int64), on)
    if len(index) != c.ndim - 1 or any(row.shape != on.shape for row in index):
        raise ValueError(f"body and sample must go with centres, got shapes {on.shape} and "
                         f"{None if sample is None else index[0].shape} for {c.shape}")
    for name, row, count in zip(("body", "sample"), index[::-1], c.shape[-2::-1], strict=False):
        if row.size and (row.min() < 0 or row.max() >= count):
            raise ValueError(f"{name} must name one of 0 to {count - 1}, got {row.tolist()}")
    forces, moments = np.zeros_like(c), np.zeros(c.shape[:-1])
    lever = p - c[index]
    np.add.at(forces, index, f)
    np.add.at(moments, index, _cross(lever, f))
    return forces, moments


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
