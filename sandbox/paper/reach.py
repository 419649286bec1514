"""Which poses a finger can be brought to at one pull: stiffness, an antagonist, locks.

The joints of a free finger without weight do not know of each other: with the
tendon's arm h_i and the spring's torque per stiffness s_i = dlm_i hm_i, a joint
rests where

    T h_i(theta_i) = k_i s_i(theta_i) + T_a r_i + lock_i

(from equations (17) and (29)); T_a is the antagonist's tension and r_i its arm.
With springs alone

    T = k_i c_i(theta_i),   c_i = s_i / h_i  [m].

c_i rises from 0 up to the *fold*, an angle that depends on no pull and no
stiffness, and falls beyond: there the tendon's arm grows faster than the
spring's torque and no stiffness holds the joint; it runs on to its stop. All
poses are meant as reached slowly from the straight finger. What is reached is

- by stiffness between k0 and ``factor`` k0: an interval of each joint, a box in all;
- by an antagonist: a curve, one pose for each T_a;
- by locks: each joint alone may be held anywhere on its way from 0 to where it
  would rest free, as long as what the lock carries, T h - k0 s, is within its
  holding torque; where it is not, the joint slips on until it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from sandbox.numeric import Array
from sandbox.study.reference_fingers import FingerSet

Intervals = tuple[tuple[float, float], ...]
"""Of one joint's angle [rad], in order; a single angle is an interval of no width."""
GRID = 9501
"""Angles of each joint at which arms are kept: 0.01 deg apart; between them straight lines,
off by (1.7e-4)^2 / 8 of the second derivative, below 1e-8 rad."""


@dataclass(frozen=True)
class PoseBox:
    """All poses whose angles lie, each for itself, in one of its joint's intervals."""

    joints: tuple[Intervals, ...]

    def contains(self, pose: ArrayLike, tolerance: float = 1e-6) -> bool:
        """Whether each angle of ``pose`` [rad], shape [n], is within ``tolerance`` [rad] of it."""
        off = np.abs(self.nearest(pose) - np.asarray(pose, dtype=float))
        return bool((off <= tolerance).all())

    def nearest(self, pose: ArrayLike) -> Array:
        """The pose of the box that is nearest to ``pose`` [rad], shape [n]."""
        asked = np.asarray(pose, dtype=float)
        near = []
        for angle, intervals in zip(asked, self.joints, strict=True):
            found = np.array([np.clip(angle, low, high) for low, high in intervals])
            near.append(found[int(np.abs(found - angle).argmin())])
        return np.array(near)

    @property
    def volume(self) -> float:
        """[rad^n]."""
        return float(np.prod([sum(high - low for low, high in joint) for joint in self.joints]))


@dataclass(frozen=True)
class PoseCurve:
    """Poses, one for each tension of an antagonist."""

    tension: Array
    """T_a [N], shape [m]."""
    poses: Array
    """[rad], shape [m, n]."""

    def nearest(self, pose: ArrayLike) -> Array:
        """The pose of the curve that is nearest to ``pose`` [rad], shape [n]."""
        off = np.linalg.norm(self.poses - np.asarray(pose, dtype=float), axis=1)
        return np.asarray(self.poses[int(off.argmin())])


@dataclass(frozen=True)
class Reach:
    """Arms of a finger over its joints' angles. Make it with :func:`reach_of`."""

    angle: Array
    """From 0 to the upper stop [rad], shape [n, m]."""
    arm: Array
    """h_i of the tendon [m], shape [n, m]."""
    spring: Array
    """s_i = dlm_i hm_i [m^2], shape [n, m]."""
    stiffness: Array
    """k0_i [N/m], shape [n]."""

    @property
    def joints(self) -> int:
        """How many there are."""
        return len(self.angle)

    @property
    def ratio(self) -> Array:
        """c_i = s_i / h_i [m], shape [n, m]."""
        return self.spring / self.arm

    @property
    def fold(self) -> Array:
        """Up to which springs hold a joint stably [rad], shape [n]; the stop if that is nearer."""
        first = [_first_top(row) for row in self.ratio]
        return np.array([self.angle[i, at] for i, at in enumerate(first)])

    def at(self, values: Array, pose: ArrayLike) -> Array:
        """``values`` [n, m] read at the angles ``pose`` [rad], shape [n]."""
        asked = np.asarray(pose, dtype=float)
        return np.array([np.interp(asked[i], self.angle[i], values[i])
                         for i in range(self.joints)])

    def free(self, pull: float, stiffness: ArrayLike | None = None) -> Array:
        """Where the joints rest under springs alone [rad], shape [n].

        Args:
            pull: T [N].
            stiffness: k_i [N/m], shape [n]; by default k0.
        """
        k = self.stiffness if stiffness is None else np.asarray(stiffness, dtype=float)
        return self.rest(pull * self.arm - k[:, None] * self.spring)

    def rest(self, torque: Array) -> Array:
        """Where joints rest that close under ``torque`` [N m], shape [n, m], coming from 0 rad."""
        return np.array([_first_rest(*row) for row in zip(self.angle, torque, strict=True)])

    def needed_stiffness(self, pull: float, pose: ArrayLike) -> Array:
        """k_i = T h_i / s_i [N/m] that holds ``pose`` [rad], shape [n]; angles above 0."""
        return np.asarray(pull / self.at(self.ratio, pose))

    def stiffness_box(self, pull: float, factor: float) -> PoseBox:
        """Poses at one pull T [N] with every k_i between k0_i and ``factor`` k0_i."""
        soft = self.free(pull)
        stiff = self.free(pull, factor * self.stiffness)
        joints: list[Intervals] = []
        for i, fold in enumerate(self.fold):
            stop = self.angle[i, -1]
            if soft[i] <= fold or stiff[i] > fold:
                joints.append(((float(stiff[i]), float(soft[i])),))
            else:  # between the fold and the stop nothing holds
                joints.append(((float(stiff[i]), float(fold)), (float(stop), float(stop))))
        return PoseBox(tuple(joints))

    def load(self, pull: float) -> Array:
        """What a lock carries: T h_i - k0_i s_i [N m], shape [n, m]."""
        return pull * self.arm - self.stiffness[:, None] * self.spring

    def lock_box(self, pull: float, holding: float) -> PoseBox:
        """Poses at one pull T [N] with locks that hold up to ``holding`` [N m]."""
        free, load = self.free(pull), self.load(pull)
        return PoseBox(tuple(_held(self.angle[i], load[i], holding, free[i])
                         for i in range(self.joints)))

    def locked(self, pull: float, holding: float, asked: ArrayLike) -> Array:
        """Where joints end whose locks close at the angles ``asked`` [rad], shape [n].

        At once if the lock holds there; else where it comes to hold, slipping on;
        a joint that never gets to its angle rests free.
        """
        ends = []
        for angle, joint in zip(np.asarray(asked, dtype=float),
                                self.lock_box(pull, holding).joints, strict=True):
            ahead = [max(low, float(angle)) for low, high in joint if high >= angle]
            ends.append(ahead[0] if ahead else joint[-1][1])
        return np.array(ends)

    def with_antagonist(self, pull: float, tension: float, arms: ArrayLike) -> Array:
        """Where the joints rest with a second tendon [rad], shape [n].

        Args:
            pull: T [N].
            tension: T_a [N].
            arms: r_i, the same at all angles [m], shape [n].
        """
        return self.rest(self.load(pull) - tension * np.asarray(arms, dtype=float)[:, None])

    def antagonist_curve(self, pull: float, arms: ArrayLike, tensions: ArrayLike) -> PoseCurve:
        """Poses at one pull T [N], one for each antagonist tension [N]."""
        each = np.asarray(tensions, dtype=float)
        return PoseCurve(each, np.array([self.with_antagonist(pull, t, arms) for t in each]))

    def antagonist_arms(self, pull: float, tension: float, pose: ArrayLike) -> Array:
        """r_i [m] with which T_a = ``tension`` [N] brings the finger to ``pose`` [rad], shape [n].

        Raises:
            ValueError: a pose that the springs alone hold back already.
        """
        spare = self.at(self.load(pull), pose)
        if (spare < 0).any():
            joint = int(np.argmax(spare < 0))
            raise ValueError(f"pull must be more than the springs hold back at joint {joint + 1}, "
                             f"got {pull:.6g} N")
        return np.asarray(spare / tension)

    def stiffness_pulls(self, pose: ArrayLike, factor: float) -> Array:
        """Pulls [N] at which k0 to ``factor`` k0 holds each joint at ``pose``, shape [n, 2].

        Not a number where the angle lies beyond the fold.
        """
        least = self.stiffness * self.at(self.ratio, pose)
        least = np.where(np.asarray(pose) <= self.fold, least, np.nan)
        return np.stack([least, factor * least], axis=1)

    def lock_pulls(self, pose: ArrayLike, holding: float) -> Array:
        """Pulls [N] at which a lock can hold each joint at ``pose``, shape [n, 2].

        From where the joint gets there to where the lock begins to slip; the first
        above the second where it never holds.
        """
        highest = np.maximum.accumulate(self.ratio, axis=1)
        least = self.stiffness * self.at(highest, pose)
        most = (holding + self.stiffness * self.at(self.spring, pose)) / self.at(self.arm, pose)
        return np.stack([least, most], axis=1)


    def antagonist_pulls(self, pose: ArrayLike) -> Array:
        """Pulls [N] at which some antagonist of constant arms holds ``pose``, shape [n, 2].

        From where the springs alone would hold it to where T h' = k0 s': an
        antagonist of constant arm adds no stiffness, so beyond that the joint
        runs away from the pose. Without end where the tendon's arm does not grow.
        """
        least = self.stiffness * self.at(self.ratio, pose)
        grows = self.at(self._slope(self.arm), pose)
        stiffens = self.stiffness * self.at(self._slope(self.spring), pose)
        with np.errstate(divide="ignore"):
            most = np.where(grows > 0, stiffens / grows, np.inf)
        return np.stack([least, most], axis=1)

    def _slope(self, values: Array) -> Array:
        return np.array([np.gradient(values[i], self.angle[i]) for i in range(self.joints)])


def common(ranges: Array) -> tuple[float, float] | None:
    """What ranges [n, 2] share, or None."""
    low, high = float(ranges[:, 0].max()), float(ranges[:, 1].min())
    return (low, high) if low <= high else None


def reach_of(finger: FingerSet, points: int = GRID) -> Reach:
    """The arms of a finger at ``points`` angles of each joint, from 0 to its upper stop."""
    angle = np.linspace(0.0, np.array(finger.limits), points).T
    tendon = route(finger.guides, finger.lengths)
    springs = spring_set(finger.before, finger.after)
    return Reach(angle, tendon.arms(angle.T).T,
                 (springs.elongations(angle.T) * springs.arms(angle.T)).T,
                 np.array(finger.stiffness))


def _first_top(values: Array) -> int:
    """Where ``values`` cease to rise for the first time."""
    falls = np.flatnonzero(np.diff(values) <= 0)
    return int(falls[0]) if len(falls) else len(values) - 1


def _first_rest(angle: Array, torque: Array) -> float:
    """Where a joint that starts at the first angle stops: no torque, or its stop."""
    against = np.flatnonzero(torque <= 0)
    if not len(against):
        return float(angle[-1])
    at = int(against[0])
    if at == 0:
        return float(angle[0])
    fraction = torque[at - 1] / (torque[at - 1] - torque[at])
    return float(angle[at - 1] + fraction * (angle[at] - angle[at - 1]))


def _held(angle: Array, load: Array, holding: float, free: float) -> Intervals:
    """Where on [0, ``free``] the load is at most ``holding``; a stop holds whatever comes."""
    angles = np.append(angle[angle < free], free)
    over = np.interp(angles, angle, load) - holding
    edges: list[float] = [] if over[0] > 0 else [float(angles[0])]
    for i in np.flatnonzero((over[:-1] > 0) != (over[1:] > 0)):
        fraction = over[i] / (over[i] - over[i + 1])
        edges.append(float(angles[i] + fraction * (angles[i + 1] - angles[i])))
    edges += [free] if len(edges) % 2 else [free, free]
    return _pairs(edges)


def _pairs(edges: Sequence[float]) -> Intervals:
    return tuple(zip(edges[::2], edges[1::2], strict=True))
