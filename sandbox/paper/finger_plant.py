"""The finger that pull and stiffness control: what holds a pose, how far, and how it moves there.

At rest, with tendon arms h_i, elongations dlm_i and arms hm_i of the springs and
the moments w_i of weight (0 without gravity), every joint has

    T h_i(theta) + w_i(theta) = k_i s_i(theta),    s_i = dlm_i hm_i,

from equations (17), (29) and (30). So one pose is held by a whole line of pulls
and stiffnesses, k_i = (T h_i + w_i) / s_i, as long as every k_i may be had:

    T_min = max_i (k_min,i s_i - w_i) / h_i,   T_max = min_i (k_max,i s_i - w_i) / h_i.

Near the pose, with x = theta - target,

    M x'' + D x' + K x = h dT - S dk,   S = diag(s),
    K = diag(k_i ds_i/dtheta - T dh_i/dtheta) - dw/dtheta,

where ds/dtheta = hm^2 + dlm dhm/dtheta; dh/dtheta = h^2 / lt - dt rt cos(beta) / lt
and dhm/dtheta = dm rm cos(delta) / lm - hm^2 / lm follow from (17) and (29).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.chain import transforms
from sandbox.mechanics.springs import SpringSet, spring_set
from sandbox.mechanics.statics import gravity_torques
from sandbox.mechanics.tendon import TendonRoute, route
from sandbox.numeric import Array
from sandbox.study.independent import Chain
from sandbox.study.reference_fingers import SET_A, FingerSet

HINGES = ("mcp", "pip", "dip")
NAMES = ("knuckle", "middle joint", "end joint")
"""What the hinges are called in pictures."""
TARGET = np.radians([5.0, 10.0, 15.0])
"""The pose that the paper asks for [rad] (Table 2)."""
SOFTEST, STIFFEST = 0.5, 6.0
"""Range of the controlled stiffness, in fractions of Table 2's."""
NEWTON_STEPS, CLOSE = 60, 1e-13
"""Most steps of :meth:`Plant.rest`, and the change of angle [rad] that ends it."""
TINY = 1e-6
"""Step of the central difference of the weight's moments [rad]."""


@dataclass(frozen=True)
class Linear:
    """M x'' + damping x' + stiffness x = h dT - S dk about a pose that is held."""

    mass: Array
    """M [kg m^2], shape [n, n]."""
    damping: Array
    """D [N m s/rad], shape [n, n]."""
    stiffness: Array
    """K [N m/rad], shape [n, n], with what the turning arms make of pull and spring forces."""
    by_stiffness: Array
    """-S: moments per stiffness [N m / (N/m)], shape [n, n]."""
    by_pull: Array
    """h: moments per pull [m], shape [n]."""

    def state_space(self, *, pull: bool = False) -> tuple[Array, Array]:
        """A and B of x, x' with inputs dk (and dT, if ``pull``), shapes [2n, 2n] and [2n, m]."""
        n = len(self.mass)
        forces = np.column_stack([self.by_stiffness, self.by_pull]) if pull else self.by_stiffness
        moved = np.linalg.solve(self.mass, np.hstack([-self.stiffness, -self.damping, forces]))
        a = np.block([[np.zeros((n, n)), np.eye(n)], [moved[:, :2 * n]]])
        return a, np.vstack([np.zeros((n, forces.shape[1])), moved[:, 2 * n:]])


@dataclass(frozen=True)
class Plant:
    """A finger of linear springs slack at rotation 0, its tendon pulled by T."""

    finger: FingerSet = SET_A
    gravity: tuple[float, float] = (0.0, 0.0)
    """In the palm's frame: x along the straight finger, the palm side at -y [m/s^2]."""

    @cached_property
    def _tendon(self) -> TendonRoute:
        return route(self.finger.guides, self.finger.lengths)

    @cached_property
    def _springs(self) -> SpringSet:
        return spring_set(self.finger.before, self.finger.after)

    @property
    def softest(self) -> Array:
        """k_min [N/m], shape [n]."""
        return SOFTEST * np.asarray(self.finger.stiffness)

    @property
    def stiffest(self) -> Array:
        """k_max [N/m], shape [n]."""
        return STIFFEST * np.asarray(self.finger.stiffness)

    def tendon_arms(self, theta: ArrayLike) -> Array:
        """h_i [m], shape [..., n]."""
        return self._tendon.arms(theta)

    def spring_moments(self, theta: ArrayLike) -> Array:
        """s_i = dlm_i hm_i: moments per stiffness [N m / (N/m)], shape [..., n]."""
        return self._springs.elongations(theta) * self._springs.arms(theta)

    def weight(self, theta: ArrayLike) -> Array:
        """w_i of the phalanges' weight, closing positive [N m], shape [..., n]."""
        lengths = np.asarray(self.finger.lengths)
        centres = np.stack([lengths / 2, 0 * lengths], axis=-1)
        return gravity_torques(
            transforms(theta, lengths), self.finger.masses, centres, self.gravity)

    def shortening(self, theta: ArrayLike) -> Array:
        """Of the whole tendon, equation (19) [m], shape [...]."""
        return self._tendon.shortening(theta)

    # -- what holds a pose ---------------------------------------------------------------

    def stiffness(self, pull: ArrayLike, theta: ArrayLike) -> Array:
        """k_i = (T h_i + w_i) / s_i that hold ``theta`` at a pull T [N], shape [..., n].

        Args:
            pull: T [N], shape [...].
            theta: shape [n] or [..., n]; not 0, where springs have no moment.
        """
        pulled = np.asarray(pull, dtype=float)[..., None] * self.tendon_arms(theta)
        return np.asarray((pulled + self.weight(theta)) / self.spring_moments(theta))

    def least_pulls(self, theta: ArrayLike) -> Array:
        """Pull below which the softest spring of joint i opens it [N]; T_min is the largest."""
        return self._pulls(self.softest, theta)

    def greatest_pulls(self, theta: ArrayLike) -> Array:
        """Pull above which the stiffest spring of joint i yields [N]; T_max is the least."""
        return self._pulls(self.stiffest, theta)

    def _pulls(self, stiffness: Array, theta: ArrayLike) -> Array:
        moments = stiffness * self.spring_moments(theta) - self.weight(theta)
        return np.asarray(moments / self.tendon_arms(theta))

    def pull_range(self, theta: ArrayLike) -> tuple[float, float]:
        """T_min and T_max [N]: with pulls between them some stiffness in range holds the pose."""
        return float(np.max(self.least_pulls(theta))), float(np.min(self.greatest_pulls(theta)))

    # -- near a pose -----------------------------------------------------------------------

    def linear(self, pull: float, stiffness: ArrayLike, theta: ArrayLike) -> Linear:
        """The linearised motion about ``theta``, held or not.

        Args:
            pull: T [N].
            stiffness: k [N/m], shape [n].
            theta: [rad], shape [n].
        """
        at = np.asarray(theta, dtype=float)
        arms, slopes = self.tendon_arms(at), self._slopes(at)
        springs = np.asarray(stiffness) * slopes[1] - pull * slopes[0]
        mass = Chain(self.finger, lambda _: 0.0).mass_matrix(at)
        return Linear(mass, np.diag(self.finger.damping), np.diag(springs) - self._sag(at),
                      -np.diag(self.spring_moments(at)), arms)

    def _slopes(self, theta: Array) -> tuple[Array, Array]:
        """dh/dtheta [m/rad] and ds/dtheta [N m/rad / (N/m)], shape [n] each."""
        t, s = self._tendon, self._springs
        h, lt = t.arms(theta), t.lengths(theta)
        hm, lm = s.arms(theta), s.lengths(theta)
        dh = (h**2 - t.dt * t.rt * np.cos(t.beta(theta))) / lt
        dhm = (s.dm * s.rm * np.cos(s.delta(theta)) - hm**2) / lm
        return dh, hm**2 + s.elongations(theta) * dhm

    def _sag(self, theta: Array) -> Array:
        """dw/dtheta [N m/rad], shape [n, n], by central differences."""
        if not any(self.gravity):
            return np.zeros((len(theta), len(theta)))
        step = TINY * np.eye(len(theta))
        return np.asarray((self.weight(theta + step) - self.weight(theta - step)).T / (2 * TINY))

    def rest(self, pull: float, stiffness: ArrayLike) -> Array:
        """The pose [rad], shape [n], in which constant springs hold a constant pull.

        Newton's method from the straight finger with stops at both ends.

        Raises:
            ValueError: it does not converge (the pull turns a joint beyond what springs hold).
        """
        k, top = np.asarray(stiffness, dtype=float), np.asarray(self.finger.limits)
        theta = np.zeros(len(top))
        for _ in range(NEWTON_STEPS):
            moment = (pull * self.tendon_arms(theta) + self.weight(theta)
                      - k * self.spring_moments(theta))
            step = np.linalg.solve(self.linear(pull, k, theta).stiffness, moment)
            after = np.clip(theta + step, 0.0, top)
            if np.abs(after - theta).max() < CLOSE:
                # at a stop the moment must lean on it; a slope of the wrong sign leads away
                leans = np.where(theta <= 0, moment <= 0, np.where(theta >= top, moment >= 0, True))
                if leans.all():
                    return np.asarray(after)
                break
            theta = after
        raise ValueError(f"no pose of rest at a pull of {pull:g} N was found")
