"""The differential between one actuator and many tendons: equations (1)-(7).

A pulley of radius R whose axle moves by x_A and which turns by the angle
theta moves the two ends of its cord, both counted the way that it pulls, by

    x_1 = x_A + theta R,   x_2 = x_A - theta R            (1), (2)
    theta = (x_1 - x_A) / R = (x_1 - x_2) / (2 R)          (3)
    x_A = (x_1 + x_2) / 2                                  (4), (5), (6)

with x_1, x_2, x_A [m], theta [rad] and R [m], each of any shape. A left pulley
(X_S, x_1, x_2) and a right one (X_D, x_3, x_4) below the main one (X_P) give

    X_P = (X_S + X_D) / 2 = (x_1 + x_2 + x_3 + x_4) / 4    (7)
    theta_P = (X_S - X_D) / (2 R_P)

The paper prints one formula as (4) and (5): (4) is any pulley, (5) the left one.

A rocker with arms a (to string 1) and b (to string 2) is the same with
weights: virtual work F dx_A = T_1 dx_1 + T_2 dx_2 and the moment about its
middle pin T_1 a = T_2 b give T_1 = F b / (a + b), T_2 = F a / (a + b). That
holds at any tilt if the three pins are in line and the strings parallel;
``rocker_tensions_at`` is the moment balance for any pins and directions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import (
    finite,
    not_negative,
    per_phalanx,
    points,
    positive,
    together,
    vectors,
)
from sandbox.numeric import Array


def pulley_ends(x_axle: ArrayLike, theta: ArrayLike, radius: ArrayLike) -> tuple[Array, Array]:
    """Displacements (x_1, x_2) [m] of a cord's ends, equations (1), (2).

    Args:
        x_axle: x_A, of the axle [m].
        theta: turn of the wheel [rad].
        radius: R [m].

    Raises:
        ValueError: a radius that is not above 0, arrays of unequal length.
    """
    axle, turned = finite("x_axle", x_axle, "m"), finite("theta", theta, "rad")
    size = positive("radius", radius, "m")
    together(x_axle=axle, theta=turned, radius=size)
    return axle + turned * size, axle - turned * size


def pulley_turn(x_1: ArrayLike, x_axle: ArrayLike, radius: ArrayLike) -> Array:
    """Turn of a wheel [rad] from one end and its axle: theta = (x_1 - x_A) / R, equation (3).

    Args:
        x_1: displacement of the cord's first end [m].
        x_axle: x_A, of the axle [m].
        radius: R [m].

    Raises:
        ValueError: a radius that is not above 0, arrays of unequal length.
    """
    end, axle = finite("x_1", x_1, "m"), finite("x_axle", x_axle, "m")
    size = positive("radius", radius, "m")
    together(x_1=end, x_axle=axle, radius=size)
    return np.asarray((end - axle) / size)


def pulley_rotation(x_1: ArrayLike, x_2: ArrayLike, radius: ArrayLike) -> Array:
    """Turn of a wheel [rad] from its cord's ends [m]: theta = (x_1 - x_2) / (2 R), (3) with (4).

    Raises:
        ValueError: a radius that is not above 0, arrays of unequal length.
    """
    first, second = finite("x_1", x_1, "m"), finite("x_2", x_2, "m")
    size = positive("radius", radius, "m")
    together(x_1=first, x_2=second, radius=size)
    return np.asarray((first - second) / (2 * size))


def pulley_axle(x_1: ArrayLike, x_2: ArrayLike) -> Array:
    """Displacement of an axle [m]: x_A = (x_1 + x_2) / 2, equations (4), (5), (6).

    (4) is any pulley, (5) the left one with x_1, x_2, (6) the right one with
    x_3, x_4; of the axles of both it is that of the main pulley, (7).

    Raises:
        ValueError: arrays of unequal length, a value that is not finite.
    """
    first, second = finite("x_1", x_1, "m"), finite("x_2", x_2, "m")
    together(x_1=first, x_2=second)
    return np.asarray((first + second) / 2)


def main_displacement(x: ArrayLike) -> Array:
    """X_P [m] of a balanced tree: the mean of its leaves' displacements x [..., n], (7)."""
    return np.asarray(finite("x", x, "m").mean(axis=-1))


def rocker_tensions(pull: ArrayLike, a: ArrayLike, b: ArrayLike) -> tuple[Array, Array]:
    """Tensions (T_1, T_2) [N] of a rocker pulled with F: F b / (a + b), F a / (a + b).

    Pins in line and strings parallel; then the tilt does not matter.

    Args:
        pull: F on the middle pin [N].
        a: arm of string 1 [m].
        b: arm of string 2 [m].

    Raises:
        ValueError: an arm that is not above 0, or a pull below 0 (strings only pull).
    """
    force = not_negative("pull", pull, "N")
    arm_1, arm_2 = positive("a", a, "m"), positive("b", b, "m")
    together(pull=force, a=arm_1, b=arm_2)
    return np.asarray(force * arm_2 / (arm_1 + arm_2)), np.asarray(force * arm_1 / (arm_1 + arm_2))


def rocker_axle(x_1: ArrayLike, x_2: ArrayLike, a: ArrayLike, b: ArrayLike) -> Array:
    """Displacement of a rocker's middle pin [m]: (b x_1 + a x_2) / (a + b), exact at any tilt.

    The middle pin divides the line of the outer ones in a : b, so it does so
    too with their displacements; with a = b this is (4).

    Raises:
        ValueError: an arm that is not above 0.
    """
    first, second = finite("x_1", x_1, "m"), finite("x_2", x_2, "m")
    arm_1, arm_2 = positive("a", a, "m"), positive("b", b, "m")
    together(x_1=first, x_2=second, a=arm_1, b=arm_2)
    return np.asarray((arm_2 * first + arm_1 * second) / (arm_1 + arm_2))


def rocker_tilt(x_1: ArrayLike, x_2: ArrayLike, a: ArrayLike, b: ArrayLike) -> Array:
    """Tilt of a rocker [rad], level at 0: asin((x_1 - x_2) / (a + b)).

    The wheel of (3) has theta = (x_1 - x_2) / (2 R); a rocker a = b = R agrees
    with it to first order.

    Raises:
        ValueError: an arm that is not above 0, or ends further apart than the
            rocker is long.
    """
    first, second = finite("x_1", x_1, "m"), finite("x_2", x_2, "m")
    arm_1, arm_2 = positive("a", a, "m"), positive("b", b, "m")
    together(x_1=first, x_2=second, a=arm_1, b=arm_2)
    apart, length = np.broadcast_arrays(first - second, arm_1 + arm_2)
    if (far := np.abs(apart) > length).any():
        raise ValueError(
            f"x_1 - x_2 must be at most a + b = {length[far].flat[0]:.6g} m, "
            f"got {apart[far].flat[0]:.6g} m")
    return np.asarray(np.arcsin(apart / length))


def rocker_tensions_at(
    pull: ArrayLike, to_1: ArrayLike, to_2: ArrayLike,
    direction_1: ArrayLike, direction_2: ArrayLike,
) -> tuple[Array, Array, Array]:
    """Tensions of a rocker at rest from its moment balance: any pins, any strings.

    About the middle pin T_1 (r_1 x d_1) + T_2 (r_2 x d_2) = 0, and the pull
    balances both strings, F u = -(T_1 d_1 + T_2 d_2).

    Args:
        pull: F, size of the force on the middle pin [N], shape [...].
        to_1: r_1, from the middle pin to that of string 1 [m], world, shape [..., 2].
        to_2: r_2, likewise for string 2.
        direction_1: in which string 1 pulls the rocker, any length, shape [..., 2].
        direction_2: likewise for string 2.

    Returns:
        T_1, T_2 [N], shape [...], and u, the unit direction of the pull, shape [..., 2].

    Raises:
        ValueError: a direction of length 0; strings that turn the rocker the
            same way, or not at all, so that no tensions >= 0 balance it.
    """
    force = not_negative("pull", pull, "N")
    d_1, d_2 = _unit("direction_1", direction_1), _unit("direction_2", direction_2)
    r_1, r_2 = points("to_1", to_1), points("to_2", to_2)
    together(pull=force, to_1=r_1[..., 0], to_2=r_2[..., 0], direction_1=d_1[..., 0],
             direction_2=d_2[..., 0])
    moment_1, moment_2 = _cross(r_1, d_1), _cross(r_2, d_2)
    if (same := moment_1 * moment_2 >= 0).any():
        both = np.broadcast_arrays(moment_1, moment_2)
        raise ValueError(
            "to_1 and to_2 with their directions must turn the rocker opposite ways, got arms "
            f"{both[0][same].flat[0]:.6g} m and {both[1][same].flat[0]:.6g} m")
    share_1, share_2 = np.abs(moment_2), np.abs(moment_1)
    summed = share_1[..., None] * d_1 + share_2[..., None] * d_2
    size = np.linalg.norm(summed, axis=-1)
    if (size == 0).any():
        raise ValueError("direction_1 and direction_2 cancel: the pull is 0 N at any tension")
    return (np.asarray(force * share_1 / size), np.asarray(force * share_2 / size),
            np.asarray(-summed / size[..., None]))


def _unit(name: str, value: ArrayLike) -> Array:
    vector = vectors(name, value, "m")
    size = np.linalg.norm(vector, axis=-1, keepdims=True)
    if (size == 0).any():
        raise ValueError(f"{name} must be longer than 0 m")
    return np.asarray(vector / size)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


@dataclass(frozen=True)
class Split:
    """A node of a differential tree: what hangs on its two sides, and its arms.

    A side is another ``Split``, or None for a leaf (one tendon). Equal arms
    make it a pulley.
    """

    first: Split | None = None
    second: Split | None = None
    a: float = 1.0
    """Arm of the first side [m, or any one unit for both]."""
    b: float = 1.0
    """Arm of the second side."""


def balanced_tree(leaves: int) -> Split | None:
    """A tree of even splits for ``leaves`` = 2, 4, 8 ... tendons (None, a leaf, for 1).

    Raises:
        ValueError: a number that is not a power of two.
    """
    if leaves < 1 or leaves & (leaves - 1):
        raise ValueError(f"leaves must be a power of two, got {leaves}")
    if leaves == 1:
        return None
    return Split(balanced_tree(leaves // 2), balanced_tree(leaves // 2))


def tree_shares(tree: Split | None) -> Array:
    """T_leaf / F of every leaf, from first to last, shape [n]; they sum to 1.

    Raises:
        ValueError: an arm that is not above 0.
    """
    if tree is None:
        return np.ones(1)
    first, second = rocker_tensions(1.0, tree.a, tree.b)
    return np.concatenate([first * tree_shares(tree.first), second * tree_shares(tree.second)])


def tree_displacement(tree: Split | None, x: ArrayLike) -> Array:
    """X_P [m], of the actuator, from the leaves' displacements x [m], shape [..., n].

    By virtual work F X_P = sum(T_i x_i), so X_P = sum(share_i x_i); with even
    splits it is the mean, equation (7).

    Raises:
        ValueError: as many displacements as the tree has leaves are needed.
    """
    shares = tree_shares(tree)
    return np.asarray(per_phalanx("x", x, len(shares), "m") @ shares)


def shaft_displacements(turn: ArrayLike, radii: Sequence[float]) -> Array:
    """x_j = R_j phi [m] of cords on one shaft's pulleys, shape [..., n].

    Args:
        turn: phi, of the shaft [rad], shape [...].
        radii: R_j [m], shape [n].

    Raises:
        ValueError: a radius that is not above 0.
    """
    return np.asarray(finite("turn", turn, "rad")[..., None] * positive("radii", radii, "m"))


def shaft_moment(tensions: ArrayLike, radii: Sequence[float]) -> Array:
    """M = sum(T_j R_j) [N m] that holds a shaft against its cords' tensions [N], shape [..., n].

    Raises:
        ValueError: a radius that is not above 0, a tension below 0, arrays of
            unequal length.
    """
    sizes = np.atleast_1d(positive("radii", radii, "m"))
    pulled = per_phalanx("tensions", tensions, len(sizes), "N")
    return np.asarray(not_negative("tensions", pulled, "N") @ sizes)
