"""Contacts: positions, two-sided laws of contacts and impacts; slack tendons.

With f the tangential and N the normal force of a contact, y its rate of sliding and u the rate at
which its gap opens:

- **slides**: f = -mu N where y > 0, f = mu N where y < 0, |f| <= mu N where y = 0.
- **closes**: N > 0 only where the gap is closed or closes in the step, and no overlap grows.
- **bounces**: u+ = -e u- at an impact, or less where this leaves the kinetic energy as it is,
  unless the gap may close again in the step.
- **swallowed**: normal impulses J take at most sum J |u-| (1 - e) / 2 and what friction adds.

An impact happens s after the pose of its step. All other forces change u by d in the step, so that
u- = u_0 + (1/2 + s / h) d and u+ = u_1 - (1/2 - s / h) d.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from sandbox.audit.evidence import EXACT, REBOUND, ROUNDING, STILL, Check, Evidence, Worst, peak
from sandbox.audit.outlines import overlaps, reach_of
from sandbox.elements.arrays import Arrays
from sandbox.model.pairs import pair_skins
from sandbox.numeric import Array, Flags
from sandbox.samples.contacts import TOUCH

CONE = 1e-6  # Relative error of the friction limit by sums over the points of a contact
SLACK = 1e-9  # Tension [N] of a slack tendon
SOLVED = 2e-9  # Error of rates relative to the fastest
HELD = 2e-7  # Regularisation of impulses towards the last ones, for both rows (docs/engine.md)
JOINT = 10.0  # Acceleration [m/s^2] that joints may add in the step of an impact
STEADY = {"gravity", "spring", "load", "force"}  # Loads that go on through an impact
STARTS = 0.1  # Relative speed of sliding before the step below which it may begin in the step
LANDS = 0.2  # Error of the gap of one point, relative to the approach: the normal turns
ROUND = 0.01  # Least radius of curvature [m] of sliding surfaces
DEEP = 0.01  # Allowed overlap without a contact, relative to the smaller body: chords of curves
UNSOLVED = 1e-6  # Rate [m/s, rad/s] by which a step may violate the laws of contacts and friction
POSES = 20  # Number of samples in which overlaps without a contact force are searched
NO_IMPACT = ("no impact with restitution is alone in a recorded step; run.sample_rate = "
             "1 / run.step records them all")


@Check("contact.friction", source="|t| <= μ n", asks="is contact friction at most mu N?",
       compared="ratio of friction to its limit, {count:pair}, worst: {where}",
       none="no contact has one normal")
def _friction(evidence: Evidence, worst: Worst) -> None:
    """Without friction any tangential force counts relative to the normal force."""
    if not len(evidence.arrays["contact_gap"]):
        worst.left_out.append("nothing touches")
    rows = evidence.once(_Rows)
    limit, size = rows.static * rows.normal, np.abs(rows.force)
    smooth = 1.0 + np.maximum(size - limit, 0.0) / np.maximum(rows.normal, TOUCH)
    used = np.where(limit > TOUCH, size / np.maximum(limit, TOUCH),
                    np.where(size > TOUCH, smooth, 0.0))
    rows.add(worst, used, 1 + CONE, evidence.one_normal)


class _Rows:
    """Motion of both bodies at every contact row, [m] each; of impacts at their instants."""

    def __init__(self, evidence: Evidence) -> None:
        self.evidence, self.h, a = evidence, evidence.h, evidence.arrays
        self.sample, self.one = a["contact_sample"], a["contact_merged"] == 1
        self.sides = a["contact_body"], a["contact_other"]
        self.normal, self.force = evidence.run.contacts.normal, evidence.run.contacts.tangential
        self.out = a["contact_normal"]
        self.along = np.stack([-self.out[:, 1], self.out[:, 0]], axis=1)
        self.names, loads = evidence.model.bodies.name, evidence.loads
        self.pair = self.sides[0] * len(self.names) + self.sides[1]
        self.friction, self.static, self.restitution = evidence.run.contacts.laws
        self.inverse = loads.inverse
        self.change = self.h * loads.frames.acceleration
        self.before, self.after = evidence.velocity - self.change / 2, evidence.velocity_after
        # accelerations of free bodies by all forces but contacts and joints
        self.others = self.inverse.T[:, :, None] * loads.others
        # by those that an impact may change within its step
        self.answers = self.inverse.T[:, :, None] * loads.sum_of(
            batch for batch in loads.batches if batch.kind not in STEADY)
        self.hit, instant = self._impacts(a)
        self.instant = np.nan_to_num(instant)
        self.arms = self._arms(a)
        # rates at which gaps open, and just before and after each impact [m/s]
        d, share = self.h * self.rate(self.others, self.out), self.instant / self.h
        self.opening = self.rate(self.before, self.out), self.rate(self.after, self.out)
        self.gap_rates = (self.opening[0] + (0.5 + share) * d, self.opening[1] - (0.5 - share) * d)
        self.struck = self.count(self.hit) > 0  # Rows of a body that bounces in the step
        model = evidence.model
        held = np.concatenate([model.joints.bodies.ravel(), model.tendons.guide_body,
                               model.springs.bodies.ravel()])
        # rows of a free body that joints, tendons or springs act on
        self.joined = (np.isin(self.sides, held) & model.bodies.free[[*self.sides]]).any(axis=0)
        turning = np.abs(evidence.velocity[2]) + np.abs(self.change[2])
        self.spins = [turning[b, self.sample] for b in self.sides]
        self.landing = np.maximum(-self.h * self.opening[0], 0.0)  # approach in a step [m]
        # impacts at one point of bodies without other contacts, fast enough to be judged, after
        # which the gap does not close again within the step
        left = (self.h - self.instant) * (self.bend + np.abs(d) / self.h)
        self.alone = (self.hit & self.one & ~np.isnan(instant) & (self.count(self.pair >= 0) <= 1)
                      & (self.gap_rates[0] < -2 * REBOUND)
                      & (-2 * self.restitution * self.gap_rates[0] > left))

    def add(
        self, worst: Worst, error: Array, allowed: Array | float, among: Flags | bool = True,
    ) -> None:
        """Compare the rows of each pair that are ``among`` the selected ones."""
        for name, _, own in self.evidence.pairs():
            worst.add(name, error, allowed, among & own)

    def _impacts(self, a: Arrays) -> tuple[Flags, Array]:
        """Rows that bounce in their step, and the instants after the pose [s]; nan if unknown."""
        time, count = self.evidence.run.time, len(self.names)
        hit, instant = np.zeros(len(self.pair), dtype=bool), np.full(len(self.pair), np.nan)
        key = self.sample * count**2 + self.pair
        order, when = np.argsort(key), a["impact_time"]
        later = np.searchsorted(time, when)
        for sample in (later - 1, later) if len(hit) else ():
            sample = sample.clip(0, len(time) - 1)
            wanted = sample * count**2 + a["impact_body"] * count + a["impact_other"]
            row = order[np.searchsorted(key, wanted, sorter=order).clip(max=len(key) - 1)]
            after, force = when - time[sample], self.h * a["contact_force"][row]
            near = ((np.abs(after) <= self.h * (1 + EXACT)) & (key[row] == wanted)
                    & (self.restitution[row] > 0))
            own = near & (np.hypot(*(a["impact_impulse"] - force).T) <= EXACT * np.hypot(*force.T))
            hit[row[own | (near & ~self.one[row])]] = True
            instant[row[own]] = after[own]
        return hit, instant

    def _arms(self, a: Arrays) -> tuple[Array, Array]:
        """From the centres of mass to the contact, at the instant of a meeting, [m, 2] m each."""
        (one, two), (fx, fy) = self.evidence.contact_arms, a["contact_force"].T
        drift, pull = (np.subtract(*(each[:2, b, self.sample] for b in self.sides))
                       for each in (self.before, self.others))
        twist, moment = np.nan_to_num(a["contact_twist"]), drift[0] * fy - drift[1] * fx
        # without restitution the twist tells the instant
        ahead = ~self.hit & (np.abs(twist) <= self.h * np.abs(moment)) & (moment != 0)
        s = np.where(ahead, -twist / moment, self.instant)
        moved = s * (drift + self.hit * (self.h + s) / 2 * pull)
        off = (twist + moved[0] * fy - moved[1] * fx) / np.maximum(fx**2 + fy**2, ROUNDING**2)
        moved += off * np.stack([-fy, fx])
        return one, two + np.where(self.inverse[self.sides[1], :1] > 0, moved.T, 0.0)

    def rate(self, velocity: Array, along: Array) -> Array:
        """Relative velocity of the first body at the contact ``along`` [m, 2]."""
        return self.evidence.contact_rate(velocity, along, self.arms)

    def count(self, among: Flags) -> Array:
        """Number of selected rows of a free body in its sample, the larger of both sides, [m]."""
        n = np.zeros(self.before.shape[1:])
        for b in self.sides:
            np.add.at(n, (b[among], self.sample[among]), 1)
        n[~self.evidence.model.bodies.free] = 0
        return np.maximum(*(n[b, self.sample] for b in self.sides))

    @cached_property
    def sliding(self) -> tuple[Array, Array]:
        """Rates of sliding at the beginning and end of the step, or after the impact [m/s]."""
        drives, belt = self.evidence.model.drives, np.zeros(len(self.pair))
        for i in drives.giving("surface").tolist():
            on = (np.stack(self.sides) == drives.target[i]).any(axis=0)
            value = self.evidence.arrays["drive_value"][self.sample, i]
            belt += np.where(on, drives.sense[i] * value, 0.0)
        turn = sum(sign * self.before[2, b, self.sample]**2 * (arm * self.along).sum(axis=1)
                   for sign, b, arm in zip((-0.5, 0.5), self.sides, self.arms, strict=True))
        by_others = (self.instant / self.h - 0.5) * self.rate(self.others, self.along)
        return (self.rate(self.before, self.along) - belt, self.rate(self.after, self.along) - belt
                + self.h * np.where(self.hit, by_others, turn))

    @cached_property
    def bend(self) -> Array:
        """Most that curvature and turning change the rate of a gap [m/s^2]."""
        slide = np.abs(self.sliding).max(axis=0)
        return np.asarray(slide**2 / ROUND + sum(
            spin * (slide + spin * np.hypot(*arm.T))
            for spin, arm in zip(self.spins, self.arms, strict=True)))

    @cached_property
    def rubbing(self) -> Array:
        """Power of friction in impacts, from the rates just before and after them [W]."""
        by_others = (self.instant + self.h / 2) * self.rate(self.others, self.along)
        return np.asarray(self.force * (sum(self.sliding) + by_others) / 2)

    @cached_property
    def unsure(self) -> Array:
        """Error of rates [m/s]; at impacts also by arms, and by joints, tendons and springs."""
        h, evidence, spin = self.h, self.evidence, sum(self.spins)
        fast = (np.abs(evidence.velocity) + np.abs(self.change)).max(axis=(0, 1))[self.sample]
        answer = sum(self.inverse[b, 0] + self.inverse[b, 2] * (arm**2).sum(axis=1)
                     for b, arm in zip(self.sides, self.arms, strict=True))
        most = peak(np.hypot(self.normal, self.force))
        off = STILL[0] + SOLVED * (1 + fast) + ROUNDING / h + HELD * h * answer * most
        beside = [np.abs(self.rate(np.roll(self.change, k, axis=2), self.out)) for k in (-1, 1)]
        impact = fast * (spin * self.instant)**2 + self.joined * 2 * (
            np.maximum(*beside) + h * JOINT) + (h / 2 + np.abs(self.instant)) * sum(
            np.abs(self.rate(self.answers, way)) for way in (self.out, self.along))
        return np.asarray(off + np.where(self.hit, impact, 0.0)
                          + np.where(self.one, 0.0, 2 * spin * (evidence.open + self.landing)))


@Check("contact.slides", source="f = -μ N y / |y|",
       asks="is contact friction mu N against the sliding?",
       compared="difference between friction and μ N against the sliding, and excess over the "
                "static limit where nothing slides, relative to N, {count:pair}, worst: {where}",
       none="no contact with friction has one normal and at most one impact per step")
def _slides(evidence: Evidence, worst: Worst) -> None:
    rows = evidence.once(_Rows)
    first, last = rows.sliding
    size = np.maximum(rows.normal, ROUNDING)
    sticks = np.abs(rows.force) / size - rows.static
    slides = np.abs(-np.sign(last) * rows.force / size - rows.friction)
    # in the step in which it begins to slide friction is up to half way to the static one
    starts = (first * last <= 0) | (np.abs(first) <= STARTS * np.abs(last))
    slides = slides - starts * (rows.static - rows.friction) / 2
    # what sticks gives way where it is soft
    gives = (np.abs(last) <= rows.unsure) | (rows.evidence.contact_depth > 0)
    error = np.maximum(np.where(gives, sticks, slides), 0.0)
    rows.add(worst, error, CONE + EXACT * peak(rows.normal) / size,
             rows.evidence.one_normal & (rows.friction > 0)
             & np.where(rows.hit, rows.alone, ~rows.struck))


@Check("contact.closes", "m", "N > 0 only at gap = 0",
       asks="do contacts push exactly where bodies touch?",
       compared="gaps of contacts with a force, and overlaps that grow with their force or "
                f"without one, {{count:comparison}}, of overlaps in {POSES} samples, worst: "
                "{where}",
       none="nothing touches")
def _closes(evidence: Evidence, worst: Worst) -> None:
    rows, h = evidence.once(_Rows), evidence.h
    gap, (first, last) = evidence.arrays["contact_gap"], rows.opening
    # curved surfaces that stay closed have no rate at mid-step, and one at the step's end
    low, high = np.sort([gap + h * last, gap + h * (first + last) / 2], axis=0)
    error = np.maximum(np.maximum(np.minimum(gap, low), np.minimum(gap, 0.0) - high), 0.0)
    rows.add(worst, np.where(rows.normal < 0, np.inf, error),
             evidence.open + np.where(rows.one, LANDS, 1.0) * rows.landing
             + h * rows.unsure + h**2 * rows.bend + 2 * evidence.contact_depth,
             evidence.one_normal & ~rows.struck & (np.abs(rows.normal) > TOUCH))
    for sample in np.unique(np.linspace(0, len(evidence.run) - 1, POSES).astype(int)).tolist():
        for pair, depth in overlaps(evidence.alone(sample)).items():
            worst.add("/".join(rows.names[b] for b in pair), np.array([depth]),
                      evidence.open + DEEP * min(reach_of(evidence, b) for b in pair))


@Check("contact.bounces", source="u+ = -e u-",
       asks="do impacts rebound with the coefficient of restitution?",
       compared="coefficients of restitution from the gap rates before and after an impact, "
                "against the scene, {count:pair}, worst: {where}",
       none=NO_IMPACT)
def _bounces(evidence: Evidence, worst: Worst) -> None:
    rows = evidence.once(_Rows)
    before, after = rows.gap_rates
    speed = np.maximum(-before, REBOUND)
    off, push = after / speed - rows.restitution, rows.normal + np.abs(rows.force)
    added = np.abs(rows.normal * (before + after) / 2 + rows.rubbing) / (push * speed)
    error = np.minimum(np.abs(off), np.maximum(off, added))
    rows.add(worst, error, rows.unsure / speed, rows.alone)


@Check("impact.swallowed", source="ΔT = Σ J (u- + u+) / 2",
       asks="do impacts lose no more energy than restitution allows?",
       compared="kinetic energy that impacts took beyond what restitution allows, relative to "
                "that of their approach, worst: {where}",
       none=NO_IMPACT)
def _swallowed(evidence: Evidence, worst: Worst) -> None:
    """Approaches of several impacts in one step are at most the effect of all its impulses."""
    rows = evidence.once(_Rows)
    (before, after), alone, count = rows.gap_rates, rows.alone, len(evidence.run)
    impulse, restitution = rows.h * rows.normal, np.where(rows.hit, rows.restitution, 0.0)
    approach, pushes = np.zeros(len(impulse)), np.zeros((2, *rows.before.shape[1:]))
    arms = [np.hypot(*arm.T) for arm in rows.arms]
    for b, arm in zip(rows.sides, arms, strict=True):
        for total, push in zip(pushes, (impulse, impulse * arm), strict=True):
            np.add.at(total, (b, rows.sample), push)
    for b, arm in zip(rows.sides, arms, strict=True):
        push, turn = pushes[:, b, rows.sample]
        approach += rows.inverse[b, 0] * push + rows.inverse[b, 2] * arm * turn
    approach = np.where(alone, after - before, approach) / (1 + restitution)
    given = np.maximum(rows.rubbing, 0.0) / np.maximum(rows.normal, ROUNDING)
    off = rows.unsure + ~alone * rows.h * np.abs(rows.rate(rows.others, rows.out))
    taken, energy, allowed = (
        np.bincount(rows.sample, rows.struck * impulse * each, count) for each in (
            -(before + after + (1 - restitution) * approach) / 2 - given,
            rows.hit * approach / 2, off))
    unknown = rows.struck & ~alone & (
        (rows.force != 0) | rows.joined | (~rows.one & (restitution < 1)))
    at = np.setdiff1d(rows.sample[rows.hit & (before < -2 * REBOUND)], rows.sample[unknown])
    error, allowed = np.maximum(taken, 0.0)[at] / energy[at], EXACT + allowed[at] / energy[at]
    if len(at):
        time = evidence.run.time[at[(error / allowed).argmax()]]
        worst.add(f"at {time:.5g} s", error, allowed)


@Check("contact.residual", "m/s", "0 <= p, 0 <= y, p y = 0",
       asks="were contacts, limits and friction solved in every step?",
       none="there is no contact, limit or motor, or its solver recorded nothing")
def _residual(evidence: Evidence, worst: Worst) -> str:
    found = evidence.run.info.contact_solver
    if "residual" not in found:
        return ""
    worst.judge(found["residual"], UNSOLVED)
    how = "sparse Newton method, compliant contacts" if "compliant_steps" in found else "active set"
    return (f"largest rate by which a step violates the laws of contacts and friction ({how}), "
            f"{found['relaxed_steps']:.0f} steps approximate, {found['steps_above_1e-8']:.0f} "
            f"above 1e-8 m/s, largest at {found['time_s']:.5g} s (over time: solver.residual)")


@Check("skin.depth", asks="is no skin squeezed by more than its thickness?",
       compared="largest depth relative to the thickness of the skin, {count:body|bodies}, worst: "
                "{where}", none="no skin with a thickness is touched")
def _depth(evidence: Evidence, worst: Worst) -> None:
    """Two skins in series share the depth as their compliances."""
    a, mechanism = evidence.arrays, evidence.model.mechanism
    one, two = a["contact_body"], a["contact_other"]
    stiffness = pair_skins(mechanism)[0]
    for i, body in enumerate(mechanism.bodies):
        material = mechanism.materials.get(body.material or "")
        skin = material.skin if material else None
        touched = (one == i) | (two == i)
        if skin and skin.thickness and touched.any():
            share = stiffness[one, two][touched] / skin.stiffness
            depth = np.maximum(-a["contact_gap"][touched], 0.0)
            worst.add(body.name, share * depth / skin.thickness, 1.0)


@Check("tendon.slack", "s", "T > 0", asks="do tendons stay taut once they have pulled?")
def _slack(evidence: Evidence, worst: Worst) -> str:
    tendons, time = evidence.model.tendons.name, evidence.run.time
    if not tendons or len(time) < 2:
        worst.left_out.append("there are too few samples" if tendons else "there is no tendon")
        return ""
    slack = evidence.arrays["tendon_tension"] <= SLACK
    slack &= evidence.holds["tendon"].T
    once = np.maximum.accumulate(~slack, axis=0)
    seconds = np.count_nonzero(slack & once, axis=0) * float(time[1] - time[0])
    never = [name for name, pulled in zip(tendons, once[-1], strict=True) if not pulled]
    some = [f"{name} for {s:.3g} s" for name, s in zip(tendons, seconds, strict=True) if s > 0]
    found = [*some, *(f"{each} never pulled" for each in never)]
    worst.judge(math.inf if never else seconds.max(), 0.0)
    return ("slack tendons: " + "; ".join(found[:4]) if found
            else "no tendon was slack after it had pulled")
