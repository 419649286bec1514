"""Actions on the phalanges in motion: equations (32)-(33) in the plane, for any chain.

Points are (x, y, 1) and everything is seen from frame i, whose origin is the
near hinge C_i. With omega, alpha the turning of phalanx i (counter-clockwise
[rad/s], [rad/s^2]), a the acceleration of C_i and g gravity [m/s^2], both in
frame i, m its mass [kg] and (x_g, y_g) its centre of mass [m]:

    W   = [[-omega^2, -alpha, a_x], [alpha, -omega^2, a_y], [0, 0, 0]]
    W_g = [[0, 0, g_x], [0, 0, g_y], [0, 0, 0]]
    Y   = [[int x^2, int xy, m x_g], [int xy, int y^2, m y_g], [m x_g, m y_g, m]]

so that W p is the acceleration of point p, W_g p = g and Y = int p p^T dm. A
force f at P is the action f P^T - P f^T; with couples, in general

    Phi = [[0, -c, f_x], [c, 0, f_y], [-f_x, -f_y, 0]]

f [N] the force and c [N m] the moment about the frame's origin. Then

    Phi_e_i = -W Y + Y W^T + W_g Y - Y W_g^T + Phi_star                 (33)
    Phi_i   = Phi_e_i + A_(i,i+1) Phi_(i+1) A_(i,i+1)^T                 (32)

Phi_star holds the applied loads: contacts, both ends of springs and, at every
guide, T (u_before + u_after). Phi_i is what phalanx i does to phalanx i-1 at
C_i; the hinge's reaction on phalanx i is its negative, and c = 0 at an ideal
hinge. Couples of the hinge itself (damper, stop, motor, dry friction) are what
c shows when they are left out of Phi_star.

Printed otherwise: (32) leaves out the change of frame by A; (33) has a bracket
astray and W_g with a + for the T of its transpose.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import (
    finite,
    homogeneous,
    not_negative,
    points,
    together,
    vectors,
)
from sandbox.numeric import Array


def acceleration_matrix(omega: ArrayLike, alpha: ArrayLike, acceleration: ArrayLike) -> Array:
    """W [1/s^2, m/s^2], shape [..., 3, 3]: W (x, y, 1) is the acceleration of a link's point.

    Args:
        omega: the link's angular velocity, counter-clockwise [rad/s], shape [...].
        alpha: its angular acceleration, counter-clockwise [rad/s^2], shape [...].
        acceleration: of the frame's origin against an inertial one, in the
            link's own frame [m/s^2], shape [..., 2].

    Raises:
        ValueError: arrays of unequal length, a value that is not finite.
    """
    spin, growth = finite("omega", omega, "rad/s"), finite("alpha", alpha, "rad/s^2")
    a = vectors("acceleration", acceleration, "m/s^2")
    matrix = np.zeros((*together(omega=spin, alpha=growth, acceleration=a[..., 0]), 3, 3))
    matrix[..., 0, 0] = matrix[..., 1, 1] = -(spin**2)
    matrix[..., 1, 0] = growth
    matrix[..., 0, 1] = -matrix[..., 1, 0]
    matrix[..., :2, 2] = a
    return matrix


def gravity_matrix(gravity: ArrayLike) -> Array:
    """W_g [m/s^2], shape [..., 3, 3], from g in the link's own frame [m/s^2], shape [..., 2].

    Raises:
        ValueError: a g that is not two finite numbers.
    """
    g = vectors("gravity", gravity, "m/s^2")
    return acceleration_matrix(np.zeros(()), np.zeros(()), g)


def inertia_matrix(mass: ArrayLike, centre: ArrayLike, inertia: ArrayLike) -> Array:
    """Y [kg m^2, kg m, kg], shape [..., 3, 3]: the pseudo-tensor of inertia.

    In the plane only int x^2 + int y^2 enters the actions, whatever their
    shares; here each has half of ``inertia`` beside its m x_g^2 or m y_g^2.

    Args:
        mass: m [kg], shape [...].
        centre: of mass, in the link's frame [m], shape [..., 2].
        inertia: about the centre of mass, int r^2 dm [kg m^2], shape [...].

    Raises:
        ValueError: a mass or inertia below 0, arrays of unequal length.
    """
    m, about = not_negative("mass", mass, "kg"), not_negative("inertia", inertia, "kg m^2")
    at = points("centre", centre)
    shape = together(mass=m, inertia=about, centre=at[..., 0])
    p = np.concatenate([at, np.ones((*at.shape[:-1], 1))], axis=-1)
    matrix = m[..., None, None] * p[..., :, None] * p[..., None, :]
    matrix = np.broadcast_to(matrix, (*shape, 3, 3)).copy()
    matrix[..., 0, 0] += about / 2
    matrix[..., 1, 1] += about / 2
    return matrix


def force_action(force: ArrayLike, point: ArrayLike) -> Array:
    """The action f P^T - P f^T of a force [N, N m], shape [..., 3, 3].

    Args:
        force: f [N], shape [..., 2].
        point: P where it acts [m], in the same frame, shape [..., 2].

    Raises:
        ValueError: arrays of unequal length, a value that is not finite.
    """
    f, p = vectors("force", force, "N"), points("point", point)
    together(force=f, point=p)
    return _action(f, p[..., 0] * f[..., 1] - p[..., 1] * f[..., 0])


def couple_action(moment: ArrayLike) -> Array:
    """The action of a couple, counter-clockwise [N m], shape [...] -> [..., 3, 3]."""
    c = finite("moment", moment, "N m")
    return _action(np.zeros((*c.shape, 2)), c)


def action_force(action: ArrayLike) -> Array:
    """The force f of an action, in the frame it is seen from [N], shape [..., 2]."""
    return homogeneous("action", action)[..., :2, 2]


def action_moment(action: ArrayLike) -> Array:
    """The moment c of an action, about its frame's origin, counter-clockwise [N m], shape [...]."""
    return homogeneous("action", action)[..., 1, 0]


def change_frame(action: ArrayLike, transform: ArrayLike) -> Array:
    """An action seen from another frame: A Phi A^T, shape [..., 3, 3].

    Args:
        action: Phi, seen from frame j, shape [..., 3, 3].
        transform: A_(i,j), taking points of frame j to frame i, shape [..., 3, 3].

    Raises:
        ValueError: matrices of another shape, arrays of unequal length.
    """
    phi, matrix = homogeneous("action", action), homogeneous("transform", transform)
    together(action=phi, transform=matrix)
    return np.asarray(matrix @ phi @ np.swapaxes(matrix, -1, -2))


def external_action(
    acceleration: ArrayLike, inertia: ArrayLike, *, gravity: ArrayLike | None = None,
    applied: ArrayLike | None = None,
) -> Array:
    """Phi_e = -W Y + Y W^T + W_g Y - Y W_g^T + Phi_star, equation (33), shape [..., 3, 3].

    Args:
        acceleration: W (:func:`acceleration_matrix`), shape [..., 3, 3].
        inertia: Y (:func:`inertia_matrix`), shape [..., 3, 3].
        gravity: W_g (:func:`gravity_matrix`), shape [..., 3, 3]; none by default.
        applied: Phi_star, the sum of the applied actions, shape [..., 3, 3]; none
            by default.

    Raises:
        ValueError: matrices of another shape, arrays of unequal length.
    """
    W, Y = homogeneous("acceleration", acceleration), homogeneous("inertia", inertia)
    fall = np.zeros((3, 3)) if gravity is None else homogeneous("gravity", gravity)
    loads = np.zeros((3, 3)) if applied is None else homogeneous("applied", applied)
    together(acceleration=W, inertia=Y, gravity=fall, applied=loads)
    driven = (fall - W) @ Y
    return np.asarray(driven - np.swapaxes(driven, -1, -2) + loads)


def transmitted_actions(external: ArrayLike, links: ArrayLike) -> Array:
    """Phi_i of every phalanx on the one before, equation (32), shape [..., n, 3, 3].

    From the tip, which carries nothing further, to the palm; each in its own
    frame i, moments about C_i.

    Args:
        external: Phi_e_i (:func:`external_action`), from the palm out, shape
            [..., n, 3, 3].
        links: A_(i-1,i) (:func:`sandbox.mechanics.chain.link_transforms` or
            ``links_between``), shape [..., n, 3, 3]. The first, to the palm, is
            not needed here.

    Raises:
        ValueError: as many links as phalanges are needed.
    """
    phi_e, A = homogeneous("external", external), homogeneous("links", links)
    if phi_e.ndim < 3 or A.ndim < 3 or phi_e.shape[-3] != A.shape[-3]:
        raise ValueError("external and links must have a matrix for every phalanx, "
                         f"got shapes {phi_e.shape} and {A.shape}")
    found = np.zeros(together(external=phi_e, links=A))
    carried = np.zeros((3, 3))
    for i in reversed(range(found.shape[-3])):
        found[..., i, :, :] = phi_e[..., i, :, :] + carried
        carried = change_frame(found[..., i, :, :], A[..., i, :, :])
    return found


class HingeReactions(NamedTuple):
    """What every hinge does to the phalanx beyond it."""

    force: Array
    """Of phalanx i-1 on phalanx i at C_i, in the world [N], shape [..., n, 2]."""
    force_own: Array
    """The same in the frame of phalanx i [N], shape [..., n, 2]."""
    moment: Array
    """About C_i on phalanx i, counter-clockwise [N m], shape [..., n]; 0 for an ideal hinge."""


def hinge_reactions(actions: ArrayLike, frames: ArrayLike) -> HingeReactions:
    """Reactions of the hinges from the transmitted actions: -Phi_i read off.

    Args:
        actions: Phi_i (:func:`transmitted_actions`), shape [..., n, 3, 3].
        frames: of the phalanges in the world, equation (31)
            (:func:`sandbox.mechanics.chain.transforms`), shape [..., n, 3, 3].

    Raises:
        ValueError: matrices of another shape, arrays of unequal length.
    """
    phi, matrix = homogeneous("actions", actions), homogeneous("frames", frames)
    together(actions=phi, frames=matrix)
    own = -action_force(phi)
    world = np.einsum("...ij,...j->...i", matrix[..., :2, :2], own)
    return HingeReactions(np.asarray(world), np.asarray(own), np.asarray(-action_moment(phi)))


def _action(force: Array, moment: Array) -> Array:
    matrix = np.zeros((*np.broadcast_shapes(force.shape[:-1], moment.shape), 3, 3))
    matrix[..., :2, 2] = force
    matrix[..., 2, :2] = -force
    matrix[..., 1, 0] = moment
    matrix[..., 0, 1] = -moment
    return matrix
