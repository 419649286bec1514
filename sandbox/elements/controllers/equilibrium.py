"""The equilibrium law: the stiffness that balances the tendon at the target, and feedback on it.

At rest T h = k s with s = dlm hm (equations (17), (29), (30)). So k = T h / s at the target holds
an ideal finger without any feedback; and an additional torque tau against a joint is an additional
stiffness tau / s, s at the joint's present rotation. Near the straight finger s goes to 0: there
springs have no effect, and the law uses the s of a small rotation.

Geometry is in the frames of the paper's section 4: x along the straight finger, the
joint closing clockwise, so that a joint that counts counter-clockwise is mirrored.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from sandbox.elements.controllers.controller import Law, Row, SeveralController
from sandbox.elements.drives import StiffnessDrive
from sandbox.elements.element import TENDON, HingeName, Vec
from sandbox.elements.joints import Pin
from sandbox.elements.springs import LinearSpring
from sandbox.elements.tendons import Guide
from sandbox.errors import Problem
from sandbox.mechanics.springs import SpringSet, spring_set
from sandbox.mechanics.tendon import TendonRoute, route
from sandbox.values import numbers as of
from sandbox.values.signals import AngleSignal
from sandbox.values.spec import TYPE, Spec
from sandbox.wording import quoted, refuse_if

if TYPE_CHECKING:
    from sandbox.scene.mechanism import Mechanism


class FingerGeometry(Spec):
    """A finger's tendon and springs as the paper's section 4 gives them; slack at rotation 0."""

    lengths: of.Items[of.Length] = Field(min_length=1, max_length=32)
    """Lengths of the phalanges, the proximal one first [m]."""
    guides: of.Items[of.Point]
    """V_0 in the palm's frame from the first hinge, V_1 ... V_n in their phalanges' frames [m]."""
    on_previous: Annotated[of.Items[of.Point], Field(alias="from")]
    """M'' of each spring, on the body before the hinge, from the hinge [m]."""
    on_phalanx: Annotated[of.Items[of.Point], Field(alias="to")]
    """M' of each spring, in the frame of the body after the hinge [m]."""

    def _verify(self) -> None:
        n = len(self.lengths)
        for key, given, wanted in (("guides", self.guides, n + 1), ("from", self.on_previous, n),
                                   ("to", self.on_phalanx, n)):
            refuse_if(len(given) != wanted, f"'{key}': a finger of {n} phalanges has {wanted}, "
                      f"got {len(given)}", "wrong-type")


class EquilibriumController(SeveralController):
    """Holds the joints of a pulled finger by the stiffness of its springs, from T h = k dlm hm.

    k = T h / (dlm hm) at the targets, and what is left, torque = kp (rotation - reference)
    + kd rate + ki ∫(rotation - reference) dt, as stiffness torque / (dlm hm) at the present
    rotations. h is the tendon's arm, dlm the spring's elongation and hm its arm.
    """

    PER_DRIVE = ("limits", "slew", "joints", "targets", "kp", "ki", "kd")
    target_key = "targets"
    type: Literal["equilibrium"] = TYPE
    tendon: Annotated[of.Name, TENDON]
    """Name of the tendon that turns the joints."""
    joints: of.Items[HingeName] = Field(min_length=1, max_length=32)
    """Names of the hinges, in the order of ``writes``, the stiffness drives of their springs."""
    targets: of.Items[AngleSignal]
    """Of the joints' rotations over time [rad], each in its hinge's sense."""
    pull: Annotated[of.Force, of.POSITIVE] | None = None
    """T in the law [N]; by default the tension of the tendon."""
    kp: of.Items[of.Quantity]
    """Torque per error of rotation, one for each joint [N m/rad]."""
    ki: of.Items[of.Quantity] | None = None
    """Torque per integral of the error, which begins after ``rise``, one each [N m/(rad s)]."""
    kd: of.Items[of.Quantity] | None = None
    """Torque per rate of rotation, one for each joint [N m s/rad]; none by default."""
    rise: of.Instant = 0.0
    """Time in which the reference moves from the initial rotations to the targets [s]."""
    guard: Annotated[of.Angle, Field(gt=0)] = math.radians(2.0)
    """dlm hm, 0 in the straight finger, counts as no less than it is at this rotation [rad]."""
    geometry: FingerGeometry | None = None
    """Finger geometry that the law uses; by default the finger's own."""

    def _verify(self) -> None:
        super()._verify()
        if self.geometry is not None:
            n, given = len(self.writes), len(self.geometry.lengths)
            refuse_if(given != n, f"'geometry': expected {n} entries, one a drive, got {given}",
                      "wrong-type")

    @property
    def readings(self) -> tuple[str, ...]:
        motion = [f"{joint}.{kind}" for kind in ("angle", "rate") for joint in self.joints]
        return (*motion, *([f"{self.tendon}.tension"] if self.pull is None else []))

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        drives = {drive.name for drive in mechanism.drives}
        known = any(tendon.name == self.tendon for tendon in mechanism.tendons)
        for i, (pin, guides, spring) in enumerate(crossings(self, mechanism)):
            name, drive = quoted(self.joints[i]), self.writes[i]
            if known and pin and (guides is None or guides[0].radius or guides[1].radius):
                yield Problem("bad-control-law", f"the tendon {quoted(self.tendon)} does not run "
                              f"straight from a guide on one side of {name} to a guide on the "
                              "other", f"{path}.joints[{i}]")
            if pin and drive in drives and (
                    spring is None or {spring.a, spring.b} != {pin.a, pin.b}):
                yield Problem("bad-control-law", f"{quoted(drive)} does not set the stiffness of a "
                              f"linear spring across {name}", f"{path}.writes[{i}]",
                              allowed="a stiffness drive for each joint, in the joints' order")

    def law_problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        if next(self.problems(mechanism, ""), None) is not None:
            return
        try:
            joints = joint_model(self, mechanism)
        except ValueError as error:
            yield Problem("bad-control-law", f"the law cannot use this finger: {error}", path,
                          allowed="guides and springs' ends away from the hinges")
            return
        for name, joint in zip(self.joints, joints, strict=True):
            if not joint.spring_moment(self.guard) > 0:
                yield Problem("bad-control-law", f"the spring across {quoted(name)} has no moment "
                              f"at the guard's rotation, {math.degrees(self.guard):.4g} deg",
                              f"{path}.guard", allowed="a small rotation at which every spring is "
                              "stretched and has an arm")

    def make_law(self, mechanism: Mechanism, period: float) -> Law:
        return Equilibrium(self, joint_model(self, mechanism), period)


def crossings(spec: EquilibriumController, mechanism: Mechanism) -> Iterator[
        tuple[Pin | None, tuple[Guide, Guide] | None, LinearSpring | None]]:
    """Of each joint the hinge, the guides before and after it, and the spring across it."""
    springs = {drive.name: drive.spring for drive in mechanism.drives
               if isinstance(drive, StiffnessDrive)}
    guides = next((each.guides for each in mechanism.tendons if each.name == spec.tendon), ())
    spans = [pair for one, other in pairwise(guides) for pair in ((one, other), (other, one))]
    for name, drive in zip(spec.joints, spec.writes, strict=False):
        pin = next((each for each in mechanism.joints
                    if each.name == name and isinstance(each, Pin)), None)
        span = next((span for span in spans if pin is not None
                     and (span[0].body, span[1].body) == (pin.a, pin.b)), None)
        spring = next((each for each in mechanism.springs if each.name == springs.get(drive)), None)
        yield pin, span, spring if isinstance(spring, LinearSpring) else None


def _crossed(
    mechanism: Mechanism, pin: Pin, guides: tuple[Guide, Guide], spring: LinearSpring,
) -> JointGeometry:
    """The geometry of one joint as a finger of one phalanx, whose length moves no guide."""
    on_a, on_b = mechanism.anchors(pin)
    side = 1.0 if pin.positive == "clockwise" else -1.0
    c, s = math.cos(pin.zero), math.sin(pin.zero)

    def before(point: Vec) -> Vec:  # at rotation 0 the frame after it is turned by ``zero``
        x, y = point[0] - on_a[0], side * (point[1] - on_a[1])
        return c * x - s * y, s * x + c * y

    def after(point: Vec) -> Vec:
        return point[0] - on_b[0], side * (point[1] - on_b[1])

    ends = {spring.a: spring.on_a, spring.b: spring.on_b}
    rest = spring.rest_length
    if rest is None:
        rest = math.dist(*(mechanism.world(name, at) for name, at in ends.items()))
    return _joints(route([before(guides[0].at), after(guides[1].at)], [1.0]),
                   spring_set([before(ends[pin.a])], [after(ends[pin.b])]), [rest])[0]


class JointGeometry(NamedTuple):
    """A joint in the law: two triangles at the hinge, of the tendon and of the spring."""

    product: float  # dt rt of the tendon's triangle [m^2]
    squares: float  # dt^2 + rt^2 [m^2]
    beta_0: float  # [rad], equation (12)
    spring_product: float  # dm rm of the spring's triangle [m^2]
    spring_squares: float  # dm^2 + rm^2 [m^2]
    delta_0: float  # [rad], equation (24)
    rest: float  # length of the slack spring [m]

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


def joint_model(spec: EquilibriumController, mechanism: Mechanism) -> list[JointGeometry]:
    """The joints in the law, of a controller without :meth:`problems`."""
    given = spec.geometry
    if given is None:
        return [_crossed(mechanism, pin, guides, spring)
                for pin, guides, spring in crossings(spec, mechanism) if pin and guides and spring]
    springs = spring_set(given.on_previous, given.on_phalanx)
    return _joints(route(given.guides, given.lengths), springs,
                   springs.lengths(np.zeros(len(given.lengths))))


def _joints(tendon: TendonRoute, springs: SpringSet, rest: ArrayLike) -> list[JointGeometry]:
    delta = springs.delta(np.zeros(len(springs.dm)))
    rows = zip(tendon.dt, tendon.rt, tendon.beta_0, springs.dm, springs.rm, delta,
               np.asarray(rest), strict=True)
    return [JointGeometry(*map(float, (
        dt * rt, dt**2 + rt**2, beta_0, dm * rm, dm**2 + rm**2, delta_0, slack)))
        for dt, rt, beta_0, dm, rm, delta_0, slack in rows]


class Equilibrium(Law):
    """k = T h / s at the target + (kp e + kd rate + I) / s, with e = rotation - reference.

    - The reference moves linearly from the joint's first rotation to the target within ``rise``.
    - I integrates ki e over straight lines between acts once the reference has arrived. It stops
      while its drive's value is cut and it would increase the cut.
    - s is at least that at the guard's rotation, and so never 0.
    """

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

    def begin(self, readings: Row, targets: Row, inputs: Row) -> None:
        """Start the reference; during a run integrals begin at the drives' values, if they act."""
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

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        if self._since is None:
            self._since = t
        fraction = min(1.0, (t - self._since) / self._rise) if self._rise > 0 else 1.0
        ahead, starts, n = self._ahead(readings, targets), self._starts, len(self._joints)
        errors, wanted = [], []
        for i in range(n):
            angle, start = readings[i], starts[i]
            error = angle - start - fraction * (targets[i] - start)
            if self._arrived:
                self._integrals[i] = self.integrated(
                    self._integrals[i], self._half_ki[i] * (error + self._errors[i]),
                    self._wanted[i] - applied[i])
            torque = self._kp[i] * error + self._kd[i] * readings[n + i] + self._integrals[i]
            errors.append(error)
            wanted.append(ahead[i] + torque / self._moment(i, angle))
        self._errors, self._wanted, self._arrived = errors, wanted, fraction >= 1.0
        return list(wanted)

    def _ahead(self, readings: Sequence[float], targets: Sequence[float]) -> list[float]:
        """T h / s at the targets."""
        pull = readings[-1] if self._pull is None else self._pull
        return [pull * joint.tendon_arm(target) / self._moment(i, target)
                for i, (joint, target) in enumerate(zip(self._joints, targets, strict=True))]

    def _moment(self, i: int, theta: float) -> float:
        """The spring moment s of a joint, no less than the guard's."""
        return max(self._guards[i], self._joints[i].spring_moment(theta))
