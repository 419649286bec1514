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

from sandbox.elements.controllers import EquilibriumController
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from sandbox.scene.crossings import Crossing, Fingers


@dataclass(frozen=True)
class JointGeometry:
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


def joint_model(spec: EquilibriumController, fingers: Fingers) -> list[JointGeometry]:
    """The joints as the law takes them to be: as given, or as they are in the mechanism."""
    given = spec.geometry
    if given is None:
        return [_crossed(crossing) for crossing in fingers.crossings(spec)]
    tendon = route(given.guides, given.lengths)
    springs = spring_set(given.on_previous, given.on_phalanx)
    rest = springs.lengths(np.zeros(len(given.lengths)))
    return [_joint(*row) for row in zip(
        tendon.dt, tendon.rt, tendon.beta_0, springs.dm, springs.rm,
        springs.delta(np.zeros(len(rest))), rest, strict=True)]


def _crossed(at: Crossing) -> JointGeometry:
    # one joint as a finger of one phalanx: its length moves no guide
    tendon = route([at.guide_before, at.guide_after], [1.0])
    spring = spring_set([at.spring_before], [at.spring_after])
    return _joint(tendon.dt[0], tendon.rt[0], tendon.beta_0[0], spring.dm[0], spring.rm[0],
                  spring.delta([0.0])[0], at.rest)


def _joint(
    dt: float, rt: float, beta_0: float, dm: float, rm: float, delta_0: float, rest: float,
) -> JointGeometry:
    return JointGeometry(*map(float, (
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

    __slots__ = ("_arrived", "_balanced_at", "_balancing", "_errors", "_guards", "_half_ki",
                 "_integrals", "_joints", "_kd", "_kp", "_pull", "_resumes", "_rise", "_since",
                 "_starts", "_wanted")

    def __init__(
        self, spec: EquilibriumController, joints: Sequence[JointGeometry], period: float,
    ) -> None:
        n = len(joints)
        self._joints, self._pull, self._rise = list(joints), spec.pull, spec.rise
        self._kp, self._kd = spec.kp, spec.kd or (0.0,) * n
        self._half_ki = tuple(0.5 * period * ki for ki in spec.ki or (0.0,) * n)
        self._guards = [joint.spring_moment(spec.guard) for joint in joints]
        self._starts = self._errors = self._wanted = [0.0] * n
        self._integrals = [0.0] * n
        self._since: float | None = None
        self._arrived, self._resumes = False, not spec.active
        self._balanced_at: tuple[float, list[float]] | None = None
        self._balancing: list[float] = []

    def begin(
        self, readings: Sequence[float], targets: Sequence[float], inputs: Sequence[float],
    ) -> None:
        """Start the reference where the joints are.

        In the middle of a run the integrals take up the difference to what the drives have;
        joints without an integral gain could never get rid of it, and begin at 0.
        """
        n = len(self._joints)
        self._starts = list(readings[:n])
        self._since, self._arrived = None, False
        self._integrals = [0.0] * n
        if self._resumes:
            ahead = self._ahead(readings, targets)
            rates = readings[n:]
            for i, angle in enumerate(self._starts):
                error = 0.0 if self._rise > 0 else angle - targets[i]
                if self._half_ki[i]:
                    self._integrals[i] = (
                        (inputs[i] - ahead[i]) * self._moment(i, angle)
                        - self._kp[i] * error - self._kd[i] * rates[i])
        self._resumes = True

    def act(
        self, t: float, readings: Sequence[float], targets: Sequence[float],
        applied: Sequence[float],
    ) -> list[float]:
        """The stiffnesses; see the class."""
        if self._since is None:
            self._since = t
        fraction = min(1.0, (t - self._since) / self._rise) if self._rise > 0 else 1.0
        ahead, starts, n = self._ahead(readings, targets), self._starts, len(self._joints)
        errors, wanted = [], []
        for i in range(n):
            angle, start = readings[i], starts[i]
            error = angle - start - fraction * (targets[i] - start)
            if self._arrived:
                self._integrate(i, error, applied[i])
            torque = self._kp[i] * error + self._kd[i] * readings[n + i] + self._integrals[i]
            errors.append(error)
            wanted.append(ahead[i] + torque / self._moment(i, angle))
        self._errors, self._wanted, self._arrived = errors, wanted, fraction >= 1.0
        return list(wanted)

    def _ahead(self, readings: Sequence[float], targets: Sequence[float]) -> list[float]:
        """T h / s at the targets; worked out anew when one of them or T has changed."""
        pull = readings[-1] if self._pull is None else self._pull
        balanced_at = (pull, list(targets))
        if balanced_at != self._balanced_at:
            self._balanced_at = balanced_at
            self._balancing = [
                pull * joint.tendon_arm(target) / self._moment(i, target)
                for i, (joint, target) in enumerate(zip(self._joints, targets, strict=True))]
        return self._balancing

    def _moment(self, i: int, theta: float) -> float:
        """The spring moment s of a joint, no less than the guard's."""
        moment = self._joints[i].spring_moment(theta)
        guard = self._guards[i]
        return moment if moment > guard else guard

    def _integrate(self, i: int, error: float, applied: float) -> None:
        """Add one period, where it does not lead further out of what can be set."""
        step = self._half_ki[i] * (error + self._errors[i])
        cut = self._wanted[i] - applied
        if not cut or step * cut < 0:
            self._integrals[i] += step

    def report(self) -> dict[str, Any]:
        """Nothing to tell."""
        return {}
