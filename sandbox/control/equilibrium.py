"""The equilibrium law: the stiffness that balances the tendon at the target, and feedback on it.

At rest T h = k s with s = dlm hm (equations (17), (29), (30)). So k = T h / s at
the target holds it without any feedback, as far as the law knows the finger; and
a torque tau that shall resist a joint more is a stiffness of tau / s more, s at
the joint's present rotation. Near the straight finger s goes to 0: there springs
can do nothing, and the law reckons with the s of a small rotation instead.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from sandbox.scene.across import Crossing, crossings
from sandbox.scene.controllers import EquilibriumController
from sandbox.scene.mechanism import Mechanism


@dataclass(frozen=True)
class Joint:
    """What the law knows of a joint: two triangles at the hinge."""

    product: float
    """dt rt of the tendon's triangle [m^2]."""
    squares: float
    """dt^2 + rt^2 [m^2]."""
    beta_0: float
    """[rad], equation (12)."""
    spring_product: float
    """dm rm of the spring's triangle [m^2]."""
    spring_squares: float
    """dm^2 + rm^2 [m^2]."""
    delta_0: float
    """[rad], equation (24)."""
    rest: float
    """Length of the slack spring [m]."""

    def tendon_arm(self, theta: float) -> float:
        """The arm h = dt rt sin(beta) / lt [m], from (17)."""
        beta = self.beta_0 - theta
        return self.product * math.sin(beta) / math.sqrt(
            self.squares - 2 * self.product * math.cos(beta))

    def spring_moment(self, theta: float) -> float:
        """The spring's moment per stiffness s = dlm hm [N m / (N/m)], from (29) and (30)."""
        delta = self.delta_0 + theta
        length = math.sqrt(self.spring_squares - 2 * self.spring_product * math.cos(delta))
        return (length - self.rest) * self.spring_product * math.sin(delta) / length


def joint_model(spec: EquilibriumController, mechanism: Mechanism) -> list[Joint]:
    """The joints as the law takes them to be: as given, or as they are in the mechanism."""
    given = spec.geometry
    if given is None:
        return [_crossed(crossing) for crossing in crossings(mechanism, spec)]
    tendon = route(given.guides, given.lengths)
    springs = spring_set(given.on_previous, given.on_phalanx)
    rest = springs.lengths(np.zeros(len(given.lengths)))
    return [_joint(*row) for row in zip(
        tendon.dt, tendon.rt, tendon.beta_0, springs.dm, springs.rm,
        springs.delta(np.zeros(len(rest))), rest, strict=True)]


def _crossed(at: Crossing) -> Joint:
    # one joint as a finger of one phalanx: its length moves no guide
    tendon = route([at.guide_before, at.guide_after], [1.0])
    spring = spring_set([at.spring_before], [at.spring_after])
    return _joint(tendon.dt[0], tendon.rt[0], tendon.beta_0[0], spring.dm[0], spring.rm[0],
                  spring.delta([0.0])[0], at.rest)


def _joint(
    dt: float, rt: float, beta_0: float, dm: float, rm: float, delta_0: float, rest: float,
) -> Joint:
    return Joint(*map(float, (
        dt * rt, dt**2 + rt**2, beta_0, dm * rm, dm**2 + rm**2, delta_0, rest)))


class Equilibrium:
    """k = T h / s at the target + (kp e + kd rate + I) / s, with e = rotation - reference.

    - The reference goes from where the joint was at the beginning to the target along a
      straight line, within ``rise``; the feedforward is that of the target itself.
    - I, a torque, integrates ki e over straight lines between acts once the reference has
      arrived: on the way there the joint lags behind, which is no error of the model. It is
      left as it is while its drive's value is cut and it would lead further out.
    - s is taken no smaller than it is at the guard's rotation, and so never 0.
    """

    __slots__ = ("_arrived", "_errors", "_guards", "_half_ki", "_integrals", "_joints", "_kd",
                 "_kp", "_pull", "_resumes", "_rise", "_since", "_starts", "_wanted")

    def __init__(
        self, spec: EquilibriumController, joints: Sequence[Joint], period: float,
    ) -> None:
        n = len(joints)
        self._joints, self._pull, self._rise = list(joints), spec.pull, spec.rise
        self._kp, self._kd = spec.kp, spec.kd or (0.0,) * n
        self._half_ki = tuple(0.5 * period * ki for ki in spec.ki or (0.0,) * n)
        self._guards = [joint.spring_moment(spec.guard) for joint in joints]
        self._starts = self._errors = self._integrals = self._wanted = [0.0] * n
        self._since: float | None = None
        self._arrived, self._resumes = False, not spec.active

    def begin(
        self, readings: Sequence[float], targets: Sequence[float], inputs: Sequence[float],
    ) -> None:
        """Start the reference where the joints are.

        In the middle of a run the integrals take up the difference to what the drives have.
        """
        n = len(self._joints)
        self._starts = list(readings[:n])
        self._since, self._arrived = None, False
        self._integrals = [0.0] * n
        if self._resumes:
            self._integrals = [
                (now - ahead) * s - kd * rate
                for now, ahead, s, kd, rate in zip(
                    inputs, self._ahead(readings, targets), self._moments(readings), self._kd,
                    readings[n:2 * n], strict=True)]
        self._resumes = True

    def act(
        self, t: float, readings: Sequence[float], targets: Sequence[float],
        applied: Sequence[float],
    ) -> list[float]:
        """The stiffnesses; see the class."""
        n = len(self._joints)
        if self._since is None:
            self._since = t
        share = min(1.0, (t - self._since) / self._rise) if self._rise > 0 else 1.0
        errors = [angle - start - share * (target - start) for angle, start, target in zip(
            readings[:n], self._starts, targets, strict=True)]
        if self._arrived:
            self._integrate(errors, applied)
        self._errors, self._arrived = errors, share >= 1.0
        self._wanted = [
            ahead + (kp * e + kd * rate + integral) / s
            for ahead, kp, e, kd, rate, integral, s in zip(
                self._ahead(readings, targets), self._kp, errors, self._kd, readings[n:2 * n],
                self._integrals, self._moments(readings), strict=True)]
        return list(self._wanted)

    def _ahead(self, readings: Sequence[float], targets: Sequence[float]) -> list[float]:
        """T h / s at the targets."""
        pull = readings[-1] if self._pull is None else self._pull
        return [pull * joint.tendon_arm(target) / max(joint.spring_moment(target), guard)
                for joint, target, guard in zip(self._joints, targets, self._guards, strict=True)]

    def _moments(self, readings: Sequence[float]) -> list[float]:
        """The spring moments s at the present rotations, guarded."""
        return [max(joint.spring_moment(angle), guard) for joint, angle, guard in zip(
            self._joints, readings, self._guards, strict=False)]

    def _integrate(self, errors: list[float], applied: Sequence[float]) -> None:
        """Add one period, where it does not lead further out of what can be set."""
        self._integrals = [
            integral + step if not (cut := wanted - now) or step * cut < 0 else integral
            for integral, step, wanted, now in zip(
                self._integrals,
                (half * (e + before) for half, e, before in zip(
                    self._half_ki, errors, self._errors, strict=True)),
                self._wanted, applied, strict=True)]

    def report(self) -> dict[str, Any]:
        """Nothing to tell."""
        return {}
