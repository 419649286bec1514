"""Forces that keep two bodies from moving along them, and how they turn as both move."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array

RANK = 1e-9  # directions with a smaller share than this are rounding
SMALL = 1e-7
"""Motions [m, and by the size of the object rad] over which forces are compared: the square of it
over that of the mechanism's lengths is left out, rounding over it is kept."""
Form = tuple[Array, tuple[float, float], Array, int]
"""Arms, radii, direction and what turns it, as a force between two bodies has them."""


@dataclass(frozen=True)
class Rigid:
    """A force between two bodies that keeps them from moving along it."""

    bodies: tuple[int, int]
    centres: Array
    """Of mass, [2, 2]."""
    arms: Array
    """From these to the centre of rounding of either side, or a point, [2, 2]."""
    radii: tuple[float, float]
    along: Array
    """Of the force on the first body, [2]."""
    turns: int
    """What turns its line: body 0 or 1; 2 the line between both points; 3 nothing."""
    force: float
    """The size of the force [N]."""
    across: bool = False
    """Whether it acts across that line, as friction does."""


def wrenches(rigids: Sequence[Rigid], size: float) -> tuple[Array, Array]:
    """Force and moment of unit forces on both bodies, [k, 6], and their slopes, [k, 6, 6].

    The slopes are derivatives by the motions of both bodies, central differences over
    :data:`SMALL` times the ``size`` of the object.
    """
    steps = SMALL * np.array([size, size, 1.0] * 2)
    moved = np.concatenate([np.zeros((1, 6)), np.diag(steps), -np.diag(steps)])
    found = _moved(rigids, moved)
    return found[:, 0], ((found[:, 1:7] - found[:, 7:]) / (2 * steps[:, None])).transpose(0, 2, 1)


def _moved(rigids: Sequence[Rigid], moved: Array) -> Array:
    """Force and moment on both bodies, [k, m, 6], moved by x, y and angle each, [m, 6]."""
    one_by_one = [(each.centres, each.arms, each.radii, each.along, each.turns, each.across)
                  for each in rigids]
    centres, arms, radii, along, turns, across = (
        np.array(each) for each in zip(*one_by_one, strict=True))
    at = [centres[:, None, k] + moved[:, 3 * k:3 * k + 2] for k in (0, 1)]
    ends = [at[k] + _turned(arms[:, k], moved[:, 3 * k + 2]) for k in (0, 1)]
    way = ends[0] - ends[1]
    n = np.broadcast_to(along[:, None], way.shape).copy()
    between = turns == 2
    n[between] = way[between] / np.hypot(way[between, :, :1], way[between, :, 1:])
    for k in (0, 1):
        n[turns == k] = _turned(along[turns == k], moved[:, 3 * k + 2])
    point = np.where(turns[:, None, None] == 0, ends[1] + radii[:, None, 1:] * n,
                     ends[0] - radii[:, None, :1] * n)
    f = np.where(across[:, None, None], np.stack([-n[..., 1], n[..., 0]], axis=-1), n)
    moments = [(point - at[k])[..., 0] * f[..., 1] - (point - at[k])[..., 1] * f[..., 0]
               for k in (0, 1)]
    return np.concatenate([f, moments[0][..., None], -f, -moments[1][..., None]], axis=-1)


def _turned(vectors: Array, angle: Array) -> Array:
    """Vectors [k, 2] turned by angles [m], [k, m, 2]."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors[:, :1], vectors[:, 1:]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def null_space(rows: Array) -> Array:
    """Orthonormal motions that leave all rows at 0, [n, k].

    Gauss-Jordan elimination with complete pivoting, then QR. An SVD of matrices of this size takes
    several times as long, since the threads of LAPACK wait for each other.
    """
    size, n = np.linalg.norm(rows, axis=1), rows.shape[1]
    left, order, rank = rows[size > 0] / size[size > 0, None], np.arange(n), 0
    while rank < min(left.shape):
        row, column = divmod(int(np.abs(left[rank:, rank:]).argmax()), n - rank)
        if abs(left[rank + row, rank + column]) <= RANK:
            break
        left[[rank, rank + row]] = left[[rank + row, rank]]
        for each in (left.T, order):
            each[[rank, rank + column]] = each[[rank + column, rank]]
        left[rank] /= left[rank, rank]
        share = left[:, rank].copy()
        share[rank] = 0.0
        left -= share[:, None] * left[rank]
        rank += 1
    motions = np.zeros((n, n - rank))
    motions[order[:rank]], motions[order[rank:]] = -left[:rank, rank:], np.eye(n - rank)
    return np.linalg.qr(motions).Q
