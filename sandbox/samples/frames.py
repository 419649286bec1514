"""Points, velocities and coupled coordinates of rigid bodies in all samples of a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sandbox.model.joints import Place, place_in_slot, rotated
from sandbox.numeric import Array, Integers
from sandbox.samples.outcome import Stored


class Places(NamedTuple):
    """Points of bodies over time, all [k, n] in m."""

    x: Array
    """In the world."""
    y: Array
    arm_x: Array
    """From the body's centre of mass, along the world's axes."""
    arm_y: Array


class Frames:
    """Poses of all bodies in some samples of a recording, and points of theirs."""

    def __init__(self, run: Stored) -> None:
        self.run, self.model = run, run.model
        self.x, self.y, self.angle = (
            np.ascontiguousarray(part) for part in run.arrays["body_pose"].transpose(2, 1, 0))
        """Poses of the bodies' frames in the world, [nb, n] m, m, rad."""
        self.samples = self.x.shape[1]
        still = self.model.bodies.fixed
        self.cos, self.sin = np.empty_like(self.angle), np.empty_like(self.angle)
        for function, into in ((np.cos, self.cos), (np.sin, self.sin)):
            into[~still] = function(self.angle[~still])
            into[still] = function(self.angle[still, :1])
        centre = run.arrays["body_centre"]
        self._centre = centre
        self.centre_x = self.x + self.cos * centre[:, :1] - self.sin * centre[:, 1:]
        """Centres of mass in the world, [nb, n] m."""
        self.centre_y = self.y + self.sin * centre[:, :1] + self.cos * centre[:, 1:]

    def places(self, bodies: Integers | Sequence[int], points: Array) -> Places:
        """Points given in the frames of ``bodies`` [k], as [k, 2] m."""
        on = np.asarray(bodies, dtype=np.int64)
        local = points.reshape(-1, 2) - self._centre[on]
        c, s = self.cos[on], self.sin[on]
        arm_x = c * local[:, :1] - s * local[:, 1:]
        arm_y = s * local[:, :1] + c * local[:, 1:]
        return Places(self.centre_x[on] + arm_x, self.centre_y[on] + arm_y, arm_x, arm_y)

    @cached_property
    def anchors(self) -> tuple[Places, Places]:
        """Anchors of all joints, on ``a`` and on ``b``, [nj, n]."""
        joints = self.model.joints
        return (self.places(joints.bodies[:, 0], joints.anchor[:, 0]),
                self.places(joints.bodies[:, 1], joints.anchor[:, 1]))

    def groove_direction(self, joint: int) -> tuple[Array, Array]:
        """Direction of a slot from its start to its end, in the world, [n] each."""
        place = self.place_in_slot(joint)
        return place.x, place.y

    def place_in_slot(self, joint: int) -> Place:
        """The place of a slot's point along its groove or path, [n] each."""
        arrays = self.run.arrays
        return place_in_slot(self.model, joint, arrays["body_pose"],
                             arrays["joint_length"][:, joint])

    @cached_property
    def velocity(self) -> Array:
        """Velocities of the centres of mass, and angular velocities, [3, nb, n]."""
        return np.ascontiguousarray(self.run.arrays["body_velocity"].transpose(2, 1, 0))

    @cached_property
    def acceleration(self) -> Array:
        """Accelerations of the centres of mass, and angular ones, [3, nb, n]."""
        return np.ascontiguousarray(self.run.arrays["body_acceleration"].transpose(2, 1, 0))

    @cached_property
    def gaps(self) -> Array:
        """Between the two anchors of every joint [m], [nj, n]."""
        a, b = self.anchors
        return np.hypot(b.x - a.x, b.y - a.y)


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
    """Direction of the force on the first body, [2]."""
    turns: int
    """The line turns with body 0 or 1, with the line between both points (2), or not (3)."""
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
    ends = [at[k] + rotated(arms[:, None, k], moved[:, 3 * k + 2]) for k in (0, 1)]
    way = ends[0] - ends[1]
    n = np.broadcast_to(along[:, None], way.shape).copy()
    between = turns == 2
    n[between] = way[between] / np.hypot(way[between, :, :1], way[between, :, 1:])
    for k in (0, 1):
        n[turns == k] = rotated(along[turns == k, None], moved[:, 3 * k + 2])
    point = np.where(turns[:, None, None] == 0, ends[1] + radii[:, None, 1:] * n,
                     ends[0] - radii[:, None, :1] * n)
    f = np.where(across[:, None, None], np.stack([-n[..., 1], n[..., 0]], axis=-1), n)
    moments = [(point - at[k])[..., 0] * f[..., 1] - (point - at[k])[..., 1] * f[..., 0]
               for k in (0, 1)]
    return np.concatenate([f, moments[0][..., None], -f, -moments[1][..., None]], axis=-1)


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
