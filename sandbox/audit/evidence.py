"""What checks of an audit share: the recording, as they read it, tolerances, and their results."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import KW_ONLY, dataclass, field
from functools import cached_property
from typing import Any, Literal, TypeVar

import numpy as np

from sandbox.model.joints import place_in_slot
from sandbox.model.model import NONE, held_of
from sandbox.model.pairs import pair_skins
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.loads import Batch, Loads
from sandbox.samples.samples import Samples
from sandbox.scene.geometry import count_solids
from sandbox.wording import Count

T = TypeVar("T")
Values = Array | float  # [n], or one for all samples
GAP, CLOSES = 1e-10, 1e-6  # Gap that a step may leave in a joint [m], and per h^2 [m/s^2]
LEFT = 1e-9  # Unevenness of a flat contact [m]: gaps close to 1e-13 / h of speed
FALLS = 10.0
"""Gap of a contact that a step may leave, per squared step [m/s^2]: v^2 / R + omega v has it
at 0.3 m/s on a radius of 10 mm. Bodies also fall so far in their first step."""
REBOUND = 0.01  # Change of velocity [m/s, rad/s] in a step that may be an impact
CLOSES_IN = 40.0  # Time constants in which a joint that was engaged closes (docs/engine.md)
NUMBERS = 500_000  # Bodies times samples, and contact rows; longer runs are thinned (400 MB)
ROUNDING = 1e-12  # Rounding error [m, rad] after a few dozen operations on lengths below 1 m
DIGITS = 1e-15  # Relative error of a number that is rounded a few times
SMALLEST_SCALE = 1e-12  # Least value [N, N m, J, rad/s] that relative errors refer to
EXACT = 1e-9  # Rounding error of sums of some ten forces, relative to the largest, with a margin
STILL = 1e-11, 1e-10  # The engine stops bodies that are slower [m/s, rad/s]
HELD = 1e-10  # Regularisation of impulses towards the last ones (docs/engine.md)
SOLVED = 1e-9  # Error of the rates of bounded rows, relative to the largest
STOPPED = 1e-8  # Allowed overrun of a hinge [rad]: a gap of 1e-10 m at an arm of 10 mm


def peak(values: Array) -> float:
    """The largest magnitude among values of any shape; 0 if there are none."""
    return float(np.abs(values).max(initial=0.0))


def whole(values: Array) -> float:
    """The scale of relative errors: the largest magnitude, or :data:`SMALLEST_SCALE`."""
    return max(peak(values), SMALLEST_SCALE)


def lost_rate(rates: Array, *, turning: bool) -> float:
    """Error of rates by :data:`STILL` and rounding [m/s or rad/s]."""
    return STILL[turning] + DIGITS * peak(rates)


@dataclass(frozen=True)
class Figure:
    """The result of one check."""

    name: str
    value: float  # nan where it was not computed
    unit: str
    threshold: float  # Largest value that passes; nan where nothing was computed
    verdict: Literal["pass", "look", "not computed"]
    why: str  # The comparison, or the reason why it was not computed
    source: str  # The equation


class NotComputed(Exception):
    """A check without a value, with the reason."""


@dataclass
class Worst:
    """The comparison that comes closest to its tolerance, or exceeds it most."""

    value: float = math.nan
    tolerance: float = math.nan
    where: str = ""
    ratio: float = -1.0
    count: int = 0
    left_out: list[str] = field(default_factory=list)  # Elements not compared, with the reason

    def add(self, where: str, error: Array, tolerance: Values, among: Flags | None = None) -> None:
        """Add errors [n] of one element and their tolerances; nan is the worst."""
        error, tolerance = np.broadcast_arrays(error, tolerance)
        if among is not None:
            error, tolerance = error[among], tolerance[among]
        if not len(error):
            return
        self.count += 1
        ratio = np.nan_to_num(error / tolerance, nan=np.inf)
        at = int(ratio.argmax())
        if ratio[at] > self.ratio:
            self.ratio, self.where = float(ratio[at]), where
            self.value, self.tolerance = float(error[at]), float(tolerance[at])

    def add_nearest(
        self, where: str, laws: Sequence[tuple[Array, Values]],
        among: Flags | None = None, *, throughout: bool = True,
    ) -> None:
        """Add the nearest of several laws (error, tolerance), one ``throughout`` or per sample."""
        error, tolerance = np.array([np.broadcast_arrays(*law) for law in laws]).swapaxes(0, 1)
        ratio = np.nan_to_num(error / tolerance, nan=np.inf)
        counted = ratio if among is None else ratio[:, among]
        k = counted.max(axis=1, initial=0.0).argmin() if throughout else ratio.argmin(axis=0)
        n = np.arange(error.shape[1])
        self.add(where, error[k, n], tolerance[k, n], among)

    def add_law(
        self, where: str, force: Array, rate: Array, limit: Array,
        floors: tuple[Values, float], tolerance: Values, among: Flags | None = None,
    ) -> None:
        """Add the distance of forces and rates [n] from a law of friction or of a limited drive.

        The law is f = limit and y <= 0, |f| <= limit and y = 0, or f = -limit and y >= 0. Errors of
        force and rate count relative to their ``floors``; the distance 1 is the ``tolerance``.
        """
        y, over = rate / floors[1], np.maximum(np.abs(force) - limit, 0.0) / floors[0]
        below, above = np.abs(force + limit) / floors[0], np.abs(force - limit) / floors[0]
        distance = np.minimum.reduce([
            np.maximum(np.abs(y), over), np.maximum(below, -y), np.maximum(above, y)])
        self.add(where, distance * tolerance, tolerance, among)

    def judge(self, value: float, tolerance: float) -> None:
        """Set the one value of a check."""
        self.value, self.tolerance, self.count = float(value), float(tolerance), 1


@dataclass
class Check:
    """One check of an audit; decorates the function that adds its comparisons."""

    name: str
    unit: str = ""
    source: str = ""  # The equation
    _: KW_ONLY
    asks: str  # The question that it answers; yes means pass
    compared: str = "{note}"  # The comparison, with ``{where}``, ``{count:noun}`` and ``{note}``
    none: str = ""  # Why nothing is compared; by default there is no element to count
    compare: Callable[[Evidence, Worst], str | None] = field(init=False)

    def __call__(self, compare: Callable[[Evidence, Worst], str | None]) -> Check:
        """Set the function; it returns a note, or raises :class:`NotComputed`."""
        self.compare = compare
        return self

    def figure(self, evidence: Evidence) -> Figure:
        """The figure of a recording; numbers that cannot be used make it "not computed"."""
        worst = Worst()
        try:
            note = self.compare(evidence, worst) or ""
        except NotComputed as reason:
            return self.missing(str(reason))
        except (ArithmeticError, ValueError, np.linalg.LinAlgError) as error:
            return self.missing(f"the numbers cannot be used: {error}")
        if not worst.count:
            return self.missing(
                "; ".join(worst.left_out[:4]) or self.none
                or f"there is no {self.compared.partition('{count:')[2].partition('}')[0]}")
        if math.isnan(worst.value) and evidence.model.mechanism.run.solver == "pymunk":
            return self.missing("pymunk does not give its numbers")
        passes = math.isfinite(worst.value) and math.isfinite(worst.tolerance) and (
            worst.value <= worst.tolerance)
        why = self.compared.format(where=worst.where, count=Count(worst.count), note=note)
        if worst.left_out:
            why += f"; left out: {'; '.join(worst.left_out[:4])}"
        return Figure(self.name, worst.value, self.unit, worst.tolerance,
                      "pass" if passes else "look", why, self.source)

    def missing(self, why: str) -> Figure:
        """The figure where it is not computed."""
        return Figure(self.name, math.nan, "", math.nan, "not computed", why, self.source)


class Evidence:
    """A recording, its loads, quantities from poses and velocities, and their accuracy.

    A single sample is ``alone``, without a step before; outlines touch within ``near`` [m].
    """

    def __init__(self, run: Samples, *, alone: bool = False, near: float | None = None) -> None:
        self._made: dict[Any, Any] = {}
        self.whole, self.model = run, run.model
        numbers = len(run) * max(1, len(self.model.bodies.name)) + len(run.arrays["contact_gap"])
        stride = max(1, -(-numbers // NUMBERS))
        self.run = run.pick(np.arange(stride - 1, len(run), stride)) if stride > 1 else run
        self.h = run.info.step
        # gaps that a step may leave: between touching outlines, and in a joint both ways [m]
        self.open = LEFT + ROUNDING + FALLS * self.h**2
        self.closed = 1.5 * max(GAP, CLOSES * self.h**2)
        self.near = self.open if near is None else near
        self.every_step = (not alone and stride == 1 and len(run) > 1
                           and abs(float(run.time[1] - run.time[0]) / self.h - 1) < 1e-6)
        self.loads, self.arrays = Loads(self.run), self.run.arrays
        self.frames = self.loads.frames
        self.velocity = self.frames.velocity  # at the samples, [3, nb, n]
        self.velocity_after = self.velocity + self.h / 2 * self.frames.acceleration  # of the steps
        # which elements hold in which samples, [elements, n]
        self.holds = {kind: held_of(self.model.bonds.of(kind), self.arrays["held"])
                      for kind in ("joint", "spring", "tendon")}
        # from the centres of mass of both bodies to the contact points [m], [m, 2] each
        self.contact_arms = np.split(self.loads.contact_sides.arm, 2)
        self.vectors = not self.model.joints.name or not np.isnan(
            self.arrays["joint_force"]).all()  # Whether joint forces were kept as vectors

    def require_every_step(self, why: str = "") -> None:
        """Refuse a check that sums over steps where some were not recorded."""
        if not self.every_step:
            raise NotComputed(f"{why}not every step was recorded; run.sample_rate = 1 / run.step "
                              "records them all")

    def pairs(self) -> Iterator[tuple[str, tuple[int, int], Flags]]:
        """Name and numbers of every two bodies that touch, and which contact rows are theirs."""
        names, a = self.model.bodies.name, self.arrays
        pair = a["contact_body"] * len(names) + a["contact_other"]
        for kind in np.unique(pair).tolist():
            one, two = divmod(kind, len(names))
            yield f"{names[one]}/{names[two]}", (one, two), pair == kind

    @cached_property
    def struck(self) -> Flags:
        """Samples in which contacts may have rebounded, which displaces the pose, [n] of bool."""
        result = np.zeros(len(self.run), dtype=bool)
        bounces = self.run.contacts.laws[2] > 0
        result[self.arrays["contact_sample"][bounces]] = True
        change = np.abs(self.frames.acceleration).max(axis=(0, 1), initial=0.0)
        return np.asarray(result & (self.h * change > REBOUND))

    @cached_property
    def displacement(self) -> Array:
        """Known displacement of the next pose by impacts in each sample's step, [3, nb, n]."""
        moved = np.zeros_like(self.frames.centre)
        if self.every_step:
            moved[:, :, :-1] = np.diff(self.frames.centre) - self.h * self.velocity_after[:, :, :-1]
        return np.where(self.struck, moved, 0.0)

    @property
    def known(self) -> slice:
        """Samples whose displacement is known: not the last one if an impact displaces it."""
        return slice(len(self.run) - int(self.every_step and bool(self.struck[-1])))

    @cached_property
    def angles(self) -> Array:
        """Angles of hinges from the bodies' poses [rad], lengths of actuators [m], [nj, n]."""
        joints, angle = self.model.joints, self.frames.pose[2]
        a, b = joints.bodies.T
        angles = joints.sense[:, None] * (angle[b] - angle[a]) - joints.zero[:, None]
        return np.where(self.loads.actuators[:, None], self.frames.gaps, angles)

    def places(self, bodies: Integers, anchor: Array, joint: Integers) -> Array:
        """Distances of points of bodies [m], or angles of hinges ``joint`` [rad], [k, n]."""
        one, two = (self.frames.places(bodies[:, k], np.nan_to_num(anchor[:, k])) for k in (0, 1))
        return np.where(joint[:, None] == NONE, np.hypot(two.x - one.x, two.y - one.y),
                        np.pad(self.angles, ((0, 1), (0, 0)))[joint])

    def rates_of(self, velocity: Array) -> Array:
        """Rates of hinges and actuators, nan of other joints, [nj, n]."""
        efforts, count = self.loads.joint_efforts, len(self.model.joints.name)
        rates = efforts.rates(count, velocity)
        rates[np.setdiff1d(np.arange(count), efforts.element)] = np.nan
        return rates

    @cached_property
    def rates(self) -> Array:
        """Rates of hinges [rad/s] and actuators [m/s] from the velocities of their bodies."""
        return self.rates_of(self.velocity)

    @cached_property
    def rates_after(self) -> Array:
        """The same at the end of each sample's step, along lines as they lie at the sample."""
        return self.rates_of(self.velocity_after)

    def once(self, make: Callable[[Evidence], T]) -> T:
        """The result of ``make`` for this recording, computed once."""
        if make not in self._made:
            self._made[make] = make(self)
        found: T = self._made[make]
        return found

    @cached_property
    def joints_hold(self) -> Flags:
        """Which joints hold and had time to close since they were engaged, [nj, n]."""
        bonds, time = self.model.bonds, self.run.time
        over = CLOSES_IN * np.append(bonds.over, 0.0)[bonds.joint, None]
        last = np.maximum.accumulate(np.where(self.holds["joint"], -np.inf, time), axis=1)
        return np.asarray(time - last > over + self.h)

    @cached_property
    def one_normal(self) -> Flags:
        """Contact rows with one normal: of one point, or of two convex bodies, [m] of bool."""
        a, bodies = self.arrays, self.model.mechanism.bodies
        simple = np.array([count_solids(body) <= 1 for body in bodies], dtype=bool)
        return np.asarray(simple[a["contact_body"]] & simple[a["contact_other"]]
                          | (a["contact_merged"] == 1))

    @cached_property
    def contact_depth(self) -> Array:
        """Depth of soft contacts by their forces, N / k [m], [m]; 0 of rigid ones.

        In a run with piles h^2 k G is known, G the response of the bodies.
        """
        a, normal = self.arrays, self.run.contacts.normal
        one, two = a["contact_body"], a["contact_other"]
        skins = pair_skins(self.model.mechanism)[0]
        stiffness = skins[one, two] if skins.size else np.zeros(len(one))
        if scale := self.run.info.contact_solver.get("stiffness", 0.0):
            response, (x, y) = np.zeros(len(one)), a["contact_normal"].T
            for body, arm in zip((one, two), self.contact_arms, strict=True):
                push, _, turn = self.loads.inverse[body].T
                response += push + turn * (arm[:, 0] * y - arm[:, 1] * x)**2
            stiffness = np.where(stiffness == 0, scale / (self.h**2 * response), stiffness)
        stiffness = np.where(a["contact_merged"] == 1, stiffness, stiffness / 8)
        return np.divide(np.abs(normal), stiffness, out=np.zeros_like(normal), where=stiffness > 0)

    def contact_rate(self, velocity: Array, along: Array, arms: Sequence[Array] = ()) -> Array:
        """Relative velocity of the first body ``along`` [m, 2] at contact rows, [m]."""
        a, total = self.arrays, np.zeros(len(along))
        for sign, key, arm in zip((1.0, -1.0), ("contact_body", "contact_other"),
                                  arms or self.contact_arms, strict=True):
            vx, vy, turn = velocity[:, a[key], a["contact_sample"]]
            total += sign * ((vx - turn * arm[:, 1]) * along[:, 0]
                             + (vy + turn * arm[:, 0]) * along[:, 1])
        return total

    def rates_twice(self, efforts: Batch, count: int) -> list[Array]:
        """Rates of elements at mid-step and at the step's end, [count, n] each."""
        return [efforts.rates(count, v) for v in (self.velocity, self.velocity_after)]

    def rate_error(self, rates: Array, response: Values = 0.0, *, turning: bool) -> Any:
        """Error of rates of bounded rows; ``response`` is that to a change of impulses."""
        return SOLVED * (1 + peak(rates)) + STILL[turning] + DIGITS / self.h + HELD * response

    def answer(self, efforts: Batch, element: int) -> Array:
        """Change of an element's rate by an effort of 1 N s or 1 N m s on separate bodies, [n]."""
        own = efforts.element == element
        inverse = self.loads.inverse[efforts.body[own], :, None]
        return np.asarray((inverse * efforts.wrench[own]**2).sum(axis=(0, 1)))

    @cached_property
    def last(self) -> Evidence:
        """The last sample alone."""
        return self.alone(len(self.run) - 1)

    def alone(self, sample: int, near: float | None = None) -> Evidence:
        """One of the samples of ``run``; ``near`` as of an evidence, by default that of this."""
        return Evidence(self.run.part(sample, sample + 1), alone=True,
                        near=self.near if near is None else near)

    @cached_property
    def left_allowed(self) -> Array:
        """Tolerance of m a - sum F [N] and of I alpha - sum M [N m] of a body, [2, nb]."""
        v = np.abs(self.velocity).max(axis=2, initial=0.0)
        speed = np.array([STILL[0] + DIGITS * np.hypot(v[0], v[1]), STILL[1] + DIGITS * v[2]])
        force, moment = self.loads.largest
        scale = np.array([force, np.maximum(moment, force * ROUNDING / EXACT)])
        mass = self.loads.weights.T[[0, 2]]
        return np.asarray(EXACT * np.maximum(scale, 1e-12) + mass * speed / self.h)

    @cached_property
    def joint_slack(self) -> Array:
        """Allowed gap of a joint [m], [nj, n].

        In a step an arm r that turns leaves r h^3 (w^3 / 6 + w alpha / 2) + r h^4 alpha^2 / 8. A
        path bends away as an arm with its radius of curvature.
        """
        joints, frames, h = self.model.joints, self.frames, self.h
        result = np.full(frames.gaps.shape, self.closed)
        alpha = np.abs(frames.acceleration[2])
        omega = np.abs(self.velocity[2]) + h * alpha
        bend = h**3 * (omega**3 / 6 + omega * alpha / 2) + h**4 * alpha**2 / 8
        for body, end in zip(joints.bodies.T, frames.anchors, strict=True):
            result += (np.hypot(end.arm_x, end.arm_y) + frames.gaps) * bend[body]
        for j, path in enumerate(joints.path):
            if path is not None:
                start = place_in_slot(self.model, j, self.model.bodies.pose)
                result[j, :1] += abs(float(start.across))  # no scene starts exactly on a curve
                a, b = joints.bodies[j].tolist()
                curve, speed = np.abs(frames.place_in_slot(j).bend), np.abs(
                    self.arrays["joint_speed"][:, j])
                change = np.hypot(*(frames.acceleration[:2, b] - frames.acceleration[:2, a]))
                result[j] += h**3 * (speed**3 * curve**2 / 6 + speed * change * curve / 2)
        return result
