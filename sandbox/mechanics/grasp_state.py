"""The grasp-state plane of two phalanges: which contacts hold, which slide, which eject.

Both contacts push where tau_2 > 0 and k_2 lies beyond the equilibrium curve
(:mod:`sandbox.mechanics.transmission`). Where f_1 < 0, the proximal phalanx separates and the
distal one slides along the fixed object, without friction. With O the object's centre (a point, or
a disc of radius r), a = r + rho_2 its distance from the distal axis [m] and D [m] its distance from
hinge 1, both constant,

    k_2(theta_2) = -l_1 cos theta_2 + sqrt(D^2 - (a - l_1 sin theta_2)^2)
    theta_1 + phi = constant, phi the angle of O seen from the proximal phalanx

so that theta_2 closes while theta_1 opens, until the first of

    tau_1 k_2 = (k_2 + l_1 cos theta_2) tau_2   the equilibrium curve: held by one contact
    theta_2 at its upper, theta_1 at its lower stop: held by the stop
    k_2 = l_2                                   the contact leaves the tip: ejection
    tau_2 = 0                                   the distal phalanx presses no more

Birglen, Laliberte and Gosselin, Underactuated Robotic Hands (2008).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import finite, not_negative, per_phalanx, positive
from sandbox.mechanics.springs import SpringSet
from sandbox.mechanics.statics import joint_torques
from sandbox.mechanics.tendon import TendonRoute
from sandbox.mechanics.transmission import TwoPhalanxForces, two_phalanx_forces
from sandbox.numeric import Array, Flags, Integers

# joint torques [N m], closing positive, of joint angles [rad]; shape [..., n] to [..., n]
Torques = Callable[[Array], Array]
_SCAN = 97  # poses tried along a slide for its first end, before bisection to rounding


class GraspState(IntEnum):
    """The outcome of a pose in which both phalanges touch."""

    STABLE = 0  #: both contacts push: f_1 > 0, f_2 > 0
    EQUILIBRIUM = 1  #: the proximal contact is lost; the finger rests on the equilibrium curve
    STOP = 2  #: the proximal contact is lost; the finger rests on a stop
    EJECTS = 3  #: the proximal contact is lost and the distal one slides off the tip
    DISTAL_LOST = 4  #: the distal phalanx does not press (tau_2 <= 0), at once or on the way


# what ends a slide before joint 2 is at its upper stop
_ENDS = np.array([GraspState.EQUILIBRIUM, GraspState.STOP, GraspState.EJECTS,
                  GraspState.DISTAL_LOST])


@dataclass(frozen=True)
class TwoPhalanges:
    """A finger of two phalanges and the size of its object."""

    lengths: tuple[float, float]  #: l_1, l_2 [m]
    torques: Torques  #: of (theta_1, theta_2), shape [..., 2]; :func:`tendon_torques` makes them
    lower: tuple[float, float]  #: lower stops [rad]; that of joint 2 is 0 or more
    upper: tuple[float, float]  #: upper stops [rad]
    apart: float = 0.0  #: a = r + rho_2 [m], from the distal axis to the object's centre, >= 0

    def __post_init__(self) -> None:
        positive("lengths", per_phalanx("lengths", self.lengths, 2, "m"), "m")
        low = per_phalanx("lower", self.lower, 2, "rad")
        high = per_phalanx("upper", self.upper, 2, "rad")
        if (low > high).any():
            raise ValueError(f"lower must not be above upper, got {self.lower} rad "
                             f"and {self.upper} rad")
        not_negative("lower of joint 2", low[1], "rad")
        not_negative("apart", self.apart, "m")


def tendon_torques(
    tension: float, tendon: TendonRoute, *, springs: SpringSet | None = None,
    stiffness: ArrayLike = 0.0,
) -> Torques:
    """Joint torques at constant tension as a function of the pose.

    Args:
        tension: T [N], >= 0.
        tendon: its route over n joints (:func:`sandbox.mechanics.tendon.route`).
        springs: across the same joints, slack at theta = 0; none by default.
        stiffness: k_i of the springs [N/m], >= 0, shape [n] or one for all.
    """
    pull = not_negative("tension", tension, "N")
    n = len(tendon.rt)
    if springs is None:
        return lambda theta: np.asarray(pull * tendon.arms(theta))
    k = np.broadcast_to(not_negative("stiffness", stiffness, "N/m"), (n,))
    return lambda theta: joint_torques(
        pull, tendon.arms(theta), k, springs.elongations(theta), springs.arms(theta))


class GraspMap(NamedTuple):
    """The outcome of every pose, and where it ends."""

    state: Integers  #: of :class:`GraspState`, shape [...]
    forces: TwoPhalanxForces  #: at the pose itself [N]; a negative one would have to pull
    theta: Array  #: joint angles in which it ends [rad], shape [..., 2]; stable: the pose itself
    k_2: Array  #: distal contact in which it ends [m], shape [...]


def grasp_states(
    finger: TwoPhalanges, *, theta_1: ArrayLike, theta_2: ArrayLike, k_1: ArrayLike,
    k_2: ArrayLike,
) -> GraspMap:
    """The grasp-state map: the outcome of every pose; slides are followed to their end.

    Args:
        finger: its lengths, torques and stops.
        theta_1: angle of the first joint [rad], shape [...].
        theta_2: of the second [rad], shape [...]; a grid with ``k_2`` as theta_2[:, None].
        k_1: proximal contact from hinge 1, along the phalanx [m], shape [...].
        k_2: distal contact from hinge 2 [m], shape [...].
    """
    angles = _poses(finger, theta_1, theta_2)
    near, far = positive("k_1", k_1, "m"), positive("k_2", k_2, "m")
    for name, at, length in zip(("k_1", "k_2"), (near, far), finger.lengths, strict=True):
        if (out := np.asarray(at > length)).any():
            raise ValueError(f"{name} must lie on its phalanx of {length:.6g} m, "
                             f"got {at[out].flat[0]:.6g} m")
    shape = np.broadcast_shapes(angles.shape[:-1], near.shape, far.shape)
    angles, far = np.broadcast_to(angles, (*shape, 2)), np.broadcast_to(far, shape)
    tau = finger.torques(np.asarray(angles))
    forces = two_phalanx_forces(
        angles[..., 1], near, far, finger.lengths[0], tau[..., 0], tau[..., 1])
    state = np.where(forces.distal > 0, GraspState.STABLE, GraspState.DISTAL_LOST)
    end, end_k = np.array(angles), np.array(far)
    if (slides := np.asarray((forces.distal > 0) & (forces.proximal <= 0))).any():
        slide = _Slide(finger, angles[slides], far[slides])
        state[slides], last = slide.outcome()
        end[slides], end_k[slides] = slide.pose(last)
    return GraspMap(state.astype(np.int64), forces, end, end_k)


class EjectionPath(NamedTuple):
    """The slide of a finger that lost its proximal contact, from the pose to its end."""

    state: GraspState  #: at its end; STABLE, and a path of one pose repeated, if it does not slide
    theta: Array  #: joint angles [rad], shape [samples, 2]
    k_2: Array  #: distal contact from hinge 2 [m], shape [samples]


def ejection_path(
    finger: TwoPhalanges, *, theta_1: float, theta_2: float, k_2: float, samples: int = 101,
) -> EjectionPath:
    """The slide of one pose in the grasp-state plane, in 2 or more ``samples`` even in theta_2.

    The other arguments are those of :func:`grasp_states`.
    """
    if samples < 2:
        raise ValueError(f"samples must be 2 or more, got {samples}")
    found = grasp_states(finger, theta_1=theta_1, theta_2=theta_2, k_1=finger.lengths[0], k_2=k_2)
    slide = _Slide(finger, _poses(finger, theta_1, theta_2)[None], np.array([k_2]))
    turned = np.linspace(theta_2, float(found.theta[1]), samples)[:, None]
    theta, along = slide.pose(turned)
    return EjectionPath(GraspState(int(found.state)), theta[:, 0], along[:, 0])


class _Slide:
    """m slides along a fixed object by one frictionless contact of the distal phalanx."""

    def __init__(self, finger: TwoPhalanges, theta: Array, k_2: Array) -> None:
        self.finger, self.start = finger, theta[..., 1]
        c, s = np.cos(self.start), np.sin(self.start)
        across = finger.apart - finger.lengths[0] * s
        self.distance = np.hypot(k_2 + finger.lengths[0] * c, across)
        self.bearing = theta[..., 0] + self._seen(self.start, k_2)

    def _seen(self, theta_2: Array, k_2: Array) -> Array:
        """The angle phi of the object's centre, from the proximal phalanx, closing positive."""
        c, s, a = np.cos(theta_2), np.sin(theta_2), self.finger.apart
        return np.asarray(np.arctan2(k_2 * s + a * c, self.finger.lengths[0] + k_2 * c - a * s))

    def pose(self, theta_2: Array) -> tuple[Array, Array]:
        """Joint angles [rad], shape [..., m, 2], and k_2 [m], [..., m], at angles [..., m]."""
        length = self.finger.lengths[0]
        across = self.finger.apart - length * np.sin(theta_2)
        within = np.maximum((self.distance - across) * (self.distance + across), 0.0)
        k_2 = np.sqrt(within) - length * np.cos(theta_2)
        theta_1 = self.bearing - self._seen(theta_2, k_2)
        return np.stack([theta_1, theta_2], axis=-1), np.asarray(k_2)

    def outcome(self) -> tuple[Array, Array]:
        """States, shape [m], and the angles theta_2 [rad] at which the slides end."""
        shares = np.linspace(0.0, 1.0, _SCAN)[:, None]
        tried = self.start + shares * (self.finger.upper[1] - self.start)
        reached = self._ended(tried).any(axis=0)
        first = np.where(reached.any(axis=0), reached.argmax(axis=0), _SCAN - 1)
        each = np.arange(len(self.start))
        low, high = tried[np.maximum(first - 1, 0), each], tried[first, each]
        for _ in range(50):  # of the first interval in which something happens, to rounding
            middle = (low + high) / 2
            there = self._ended(middle).any(axis=0)
            low, high = np.where(there, low, middle), np.where(there, middle, high)
        what = self._ended(high)
        return np.where(what.any(axis=0), _ENDS[what.argmax(axis=0)], GraspState.STOP), high

    def _ended(self, theta_2: Array) -> Flags:
        """Which of ``_ENDS`` has happened at angles [..., m], shape [4, ..., m]."""
        theta, k_2 = self.pose(theta_2)
        opened = theta[..., 0] <= self.finger.lower[0]
        theta[..., 0] = np.maximum(theta[..., 0], self.finger.lower[0])
        tau = self.finger.torques(theta)
        reach = k_2 + self.finger.lengths[0] * np.cos(theta_2)
        balanced = tau[..., 0] * k_2 >= reach * tau[..., 1]
        return np.stack([balanced, opened, k_2 >= self.finger.lengths[1], tau[..., 1] <= 0])


def _poses(finger: TwoPhalanges, theta_1: ArrayLike, theta_2: ArrayLike) -> Array:
    first, second = finite("theta_1", theta_1, "rad"), finite("theta_2", theta_2, "rad")
    for joint, turned in enumerate((first, second)):
        low, high = finger.lower[joint], finger.upper[joint]
        if (out := np.asarray((turned < low) | (turned > high))).any():
            raise ValueError(f"theta_{joint + 1} must lie between its stops, {low:.6g} and "
                             f"{high:.6g} rad, got {turned[out].flat[0]:.6g} rad")
    return np.stack(np.broadcast_arrays(first, second), axis=-1)
