"""How well contacts hold a body: force closure, Ferrari and Canny's measure, isotropy, spread.

The friction cone of a contact with normal n, tangent t and coefficient mu has in the plane two
edges, n + mu t and n - mu t. With the moment about the centre of mass divided by a length rho every
edge is a wrench (fx, fy, m / rho). There is force closure if the origin lies inside the hull of
these points. Epsilon, the radius of the largest ball about the origin in it, is the load that
forces whose normal parts sum up to 1 can balance in its worst direction (Ferrari and Canny 1992,
their second measure). With rho the greatest distance of the outline from the centre of mass,
epsilon does not depend on units or size.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import not_negative, points, positive
from sandbox.numeric import Array

CLOSED = 1e-9  # balls with a smaller radius are rounding: wrenches are of the order of 1
SAME = 1e-9  # wrenches nearer than this, and angles [rad] that differ by less, count as one
NUMBERS = 1 << 16  # wrenches along edges in one batch, which then fits into the cache


def contact_wrenches(
    contacts: ArrayLike, normals: ArrayLike, friction: ArrayLike, *,
    centre: ArrayLike, length: float,
) -> Array:
    """The edges of all friction cones as wrenches (fx, fy, m / rho) of unit normal force.

    Args:
        contacts: points in the world [m], shape [..., m, 2].
        normals: unit, the direction in which each pushes the body, shape [..., m, 2].
        friction: mu of each contact, >= 0, shape [m] or [..., m].
        centre: the point that moments are about [m], shape [2] or [..., 2].
        length: rho [m], > 0.

    Returns:
        Shape [..., 2 m, 3]: all edges n + mu t, then all n - mu t, t being n turned by +90 degrees.
    """
    at, n = points("contacts", contacts), points("normals", normals, unit="1")
    if at.shape != n.shape:
        raise ValueError(f"normals must be as many as contacts, got shapes {n.shape}, {at.shape}")
    rho = positive("length", length, "m")
    mu = np.broadcast_to(not_negative("friction", friction, "1"), at.shape[:-1])
    arm = (at - points("centre", centre)[..., None, :]) / rho
    t = np.stack([-n[..., 1], n[..., 0]], axis=-1) * mu[..., None]
    force = np.concatenate([n + t, n - t], axis=-2)
    lever = np.concatenate([arm, arm], axis=-2)
    moment = lever[..., 0] * force[..., 1] - lever[..., 1] * force[..., 0]
    return np.concatenate([force, moment[..., None]], axis=-1)


def largest_ball(wrenches: ArrayLike) -> Array:
    """Radius of the largest ball about the origin in the convex hull of points, shape [...].

    0 where the origin lies outside, or on the surface, or where the hull has no inside. Every edge
    of the hull is found from its two ends: seen along it, all other points lie within half a turn,
    and the first and the last of them span the two facets that meet there. The points have the
    shape [..., k, 3] and are of the order of 1.
    """
    p = np.asarray(wrenches, dtype=np.float64)
    if p.ndim < 2 or p.shape[-1] != 3 or not np.isfinite(p).all():
        raise ValueError(f"wrenches must be finite, of shape [..., k, 3], got shape {p.shape}")
    k = p.shape[-2]
    flat = p.reshape(-1, k, 3)
    at_a_time = max(1, NUMBERS // max(1, k * k * (k - 1) // 2))
    found = [_balls(flat[i:i + at_a_time]) for i in range(0, len(flat), at_a_time)]
    return np.concatenate([np.zeros(0), *found]).reshape(p.shape[:-2])


def _balls(p: Array) -> Array:
    """Radii for sets of points [s, k, 3], [s]."""
    if p.shape[1] < 4:
        return np.zeros(len(p))
    i, j = np.triu_indices(p.shape[1], 1)
    along = p[:, j] - p[:, i]
    apart = np.linalg.norm(along, axis=-1, keepdims=True)
    along /= np.maximum(apart, SAME)
    across = np.cross(along, np.eye(3)[np.abs(along).argmin(axis=-1)])
    across /= np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), SAME)
    up = np.cross(along, across)
    level = [np.einsum("spc,spc->sp", p[:, i], axis) for axis in (across, up)]
    x, y = (axis @ p.swapaxes(1, 2) - own[..., None]
            for axis, own in zip((across, up), level, strict=True))
    on_edge = x * x + y * y <= SAME**2
    angle = np.where(on_edge, np.inf, np.arctan2(y, x))
    angle = np.where(on_edge, angle.min(axis=-1, keepdims=True), angle)
    edge = (apart[..., 0] > SAME) & np.isfinite(angle).all(axis=-1)
    angle = np.sort(np.where(edge[..., None], angle, 0.0), axis=-1)
    after = np.concatenate([angle[..., 1:], angle[..., :1] + 2 * np.pi], axis=-1)
    which, pair, place = np.nonzero(edge[..., None] & (after - angle >= np.pi - SAME))
    # outwards of the facet before the empty half turn; no facet lies behind it at all its edges,
    # since going round it the numbers of its corners cannot rise all the way
    last = angle[which, pair, place]
    least = np.full(len(p), np.inf)
    np.minimum.at(least, which, np.cos(last) * level[1][which, pair]
                  - np.sin(last) * level[0][which, pair])
    return np.where(np.isfinite(least) & (least > CLOSED), least, 0.0)


def grasp_epsilon(
    contacts: ArrayLike, normals: ArrayLike, friction: ArrayLike, *,
    centre: ArrayLike, length: float,
) -> Array:
    """Ferrari and Canny's epsilon of :func:`contact_wrenches`, shape [...]; 0 without closure."""
    return largest_ball(contact_wrenches(contacts, normals, friction, centre=centre, length=length))


def grasp_isotropy(
    contacts: ArrayLike, normals: ArrayLike, friction: ArrayLike, *,
    centre: ArrayLike, length: float,
) -> Array:
    """Minimum over maximum singular value of the grasp map, shape [...]: 1 if isotropic.

    The map takes the forces of the contacts, along their normals and, where mu > 0, along their
    tangents, to the wrench (fx, fy, m / rho) on the body. 0 where some wrench needs none of them.
    The arguments are those of :func:`contact_wrenches`.
    """
    n = points("normals", normals, unit="1")
    rough = np.broadcast_to(np.asarray(friction, dtype=np.float64) > 0, n.shape[:-1])
    along = contact_wrenches(contacts, n, 0.0, centre=centre, length=length)
    t = np.stack([-n[..., 1], n[..., 0]], axis=-1)
    across = contact_wrenches(contacts, t, 0.0, centre=centre, length=length)
    m = n.shape[-2]
    G = np.concatenate([along[..., :m, :], across[..., :m, :] * rough[..., None]], axis=-2)
    if 2 * m < 3:
        return np.zeros(n.shape[:-2])
    values = np.linalg.svd(G, compute_uv=False)
    share = values[..., 2] / np.where(values[..., 0] > 0, values[..., 0], 1.0)
    return np.where(share > CLOSED, share, 0.0)


def force_spread(forces: ArrayLike) -> Array:
    """Standard deviation over mean of forces [N], >= 0, not all 0, shape [..., k] to [...].

    Of k forces it is at most sqrt(k - 1), where one carries all.
    """
    f = not_negative("forces", forces, "N")
    mean = f.mean(axis=-1)
    if (mean == 0).any():
        raise ValueError("forces must not all be 0 N")
    return np.asarray(f.std(axis=-1) / mean)
