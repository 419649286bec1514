"""Figures of touch: places, two-sided laws of contacts and impacts, slack tendons.

With f the tangential and N the normal force of a contact, y its rate of sliding and u the rate at
which its gap opens:

- **slides**: f = -mu N where y > 0, f = mu N where y < 0, |f| <= mu N where y = 0.
- **closes**: N > 0 only where the gap is closed or closes in the step, and no overlap grows.
- **bounces**: u+ = -e u-, just before and after the instant of an impact.
- **swallowed**: the normal impulses J of a step take no more than sum J |u-| (1 - e) / 2.

An impact happens s after the pose of its step. All other forces change u by d in the step, so that
u- = u_0 + (1/2 + s / h) d and u+ = u_1 - (1/2 - s / h) d.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property

import numpy as np

from sandbox.audit.evidence import REBOUND, Evidence
from sandbox.audit.figures import EXACT, ROUNDING, STILL, Figure, Worst, judged, missing, peak
from sandbox.audit.outlines import contact_geometry, reach_of
from sandbox.audit.touching import overlaps
from sandbox.elements.arrays import Arrays
from sandbox.model.pairs import friction_of, restitution_of, static_friction_of
from sandbox.model.ties import held_of
from sandbox.numeric import Array, Flags
from sandbox.samples.contacts import TOUCH

CONE = 1e-6
"""Share of the friction limit by which sums over the points of a contact may miss it."""
SLIPS = 1e-3
"""Nearer to the limit than this fraction, a contact counts as slipping."""
SLACK = 1e-9
"""A tension [N] below which a cord hangs."""
SOLVED = 2e-9
"""Share of the fastest by which rates may be off."""
HELD = 2e-7
"""How strongly the solver holds impulses to the last ones, for both rows (docs/engine.md)."""
JOINT = 10.0
"""Acceleration [m/s^2] that joints may add in the step of an impact, besides that beside it."""
STARTS = 0.1
"""Sliding that was slower than this share of itself may have begun in the step."""
LANDS = 0.2
"""Share of a step's approach by which one point may miss the surface: the normal turns in it. Of
several points each has its own gap."""
ROUND = 0.01
"""Radius [m] at which surfaces that slide may bend away from their tangent within a step."""
DEEP = 0.01
"""Share of the smaller body up to which outlines may overlap that do not touch: chords of curves.
"""
UNSOLVED = 1e-6
"""Rate [m/s, rad/s] by which a step may violate the laws of contacts and friction."""
POSES = 20
"""Samples in which outlines are searched for overlaps without a contact force."""
NO_IMPACT = ("no impact with restitution is alone in a recorded step; run.sample_rate = "
             "1 / run.step records them all")


def contact_figures(evidence: Evidence) -> Iterator[Figure]:
    """Places, friction and gaps of contacts, impacts, slack of tendons."""
    yield contact_geometry(evidence)
    yield _friction(evidence)
    rows = _Rows(evidence)
    for figure in (_slides, _closes, _bounces, _swallowed):
        yield figure(rows)
    yield _residual(evidence)
    yield _slack(evidence)


def used_friction(evidence: Evidence) -> Array:
    """Tangential force of every contact row against static friction, [m]; 1 is the cone's edge.

    Where the coefficient is 0, so is the limit: then any tangential force
    counts against the normal force itself.
    """
    a, contacts = evidence.run.arrays, evidence.run.contacts
    count = len(evidence.model.bodies.name)
    pair = a["contact_body"] * count + a["contact_other"]
    kinds = np.unique(pair)
    mu = np.array([static_friction_of(evidence.model.mechanism, *divmod(int(k), count))
                   for k in kinds])
    limit = mu[np.searchsorted(kinds, pair)] * contacts.normal if len(kinds) else np.zeros(0)
    rough = limit > TOUCH
    size = np.abs(contacts.tangential)
    smooth = 1.0 + np.maximum(size - limit, 0.0) / np.maximum(contacts.normal, TOUCH)
    return np.where(rough, size / np.where(rough, limit, 1.0), np.where(size > TOUCH, smooth, 0.0))


def _friction(evidence: Evidence) -> Figure:
    """No contact may exceed its friction limit; which ones stick and slip at the end.

    What adds up forces across normals that differ (a disc wedged in a V) has no limit of its own.
    """
    name, source = "contact.friction", "|t| <= μ n"
    a = evidence.run.arrays
    if not len(a["contact_gap"]):
        return missing(name, why="nothing touches", source=source)
    used, sure = used_friction(evidence), evidence.one_normal
    if not sure.any():
        return missing(name, source=source, why="all contacts merge several points with "
                       "different normals")
    last = np.flatnonzero((a["contact_sample"] == len(evidence.run) - 1)
                          & (evidence.run.contacts.normal > TOUCH))
    states = []
    for row in last:
        one, two = int(a["contact_body"][row]), int(a["contact_other"][row])
        mu, static = (of(evidence.model.mechanism, one, two)
                      for of in (friction_of, static_friction_of))
        state = ("has several normals" if not sure[row] else "frictionless" if mu == 0
                 else "slips" if used[row] > 1 - SLIPS or abs(used[row] * static / mu - 1) < SLIPS
                 else f"sticks, {100 * (1 - used[row]):.0f} % from the limit")
        names = evidence.model.bodies.name
        states.append(f"{names[one]}/{names[two]} {state}")
    end = "at the end: " + "; ".join(states) if states else "nothing touches at the end"
    return judged(name, float(used[sure].max(initial=0.0)), "", 1 + CONE, source=source,
                  why=f"largest ratio of friction to its limit in the whole run; {end}")


def _residual(evidence: Evidence) -> Figure:
    """The largest violation of the laws of contacts, limits and friction, from the solver."""
    name, source, found = "contact.residual", "0 <= p, 0 <= y, p y = 0", (
        evidence.run.info.contact_solver)
    if "residual" not in found:
        return missing(name, why="there is no contact, limit or motor, or its solver said nothing",
                       source=source)
    how = "sparse Newton method, compliant contacts" if "compliant_steps" in found else "active set"
    relaxed = f"{found['relaxed_steps']:.0f} steps approximate, "
    return judged(
        name, found["residual"], "m/s", UNSOLVED, source=source,
        why=f"largest rate by which a step violates the laws of contacts and friction ({how}), "
            f"{relaxed}{found['steps_above_1e-8']:.0f} above 1e-8 m/s, worst: at "
            f"{found['time_s']:.5g} s")


def _slack(evidence: Evidence) -> Figure:
    """Time for which tendons that have pulled hang slack again."""
    name, source = "tendon.slack", "T > 0"
    tendons, time = evidence.model.mechanism.tendons, evidence.run.time
    if not tendons or len(time) < 2:
        return missing(name, source=source,
                       why="there is no tendon" if not tendons else "there are too few samples")
    hangs = evidence.run.arrays["tendon_tension"] <= SLACK
    hangs &= held_of(evidence.model.ties.tendon, evidence.run.arrays["held"]).T
    once = np.maximum.accumulate(~hangs, axis=0)
    seconds = np.count_nonzero(hangs & once, axis=0) * float(time[1] - time[0])
    never = [t.name for t, pulled in zip(tendons, once[-1], strict=True) if not pulled]
    some = [f"{t.name} for {s:.3g} s" for t, s in zip(tendons, seconds, strict=True) if s > 0]
    slack = [*some, *(f"{each} never pulled" for each in never)]
    value = math.inf if never else float(seconds.max())
    return judged(name, value, "s", 0.0, source=source,
                  why=("slack tendons: " + "; ".join(slack[:4]) if slack
                       else "no tendon was slack after it had pulled"))


class _Rows:
    """Motion of the two bodies at every contact row, [m] each; of impacts at their instants."""

    def __init__(self, evidence: Evidence) -> None:
        self.evidence, self.h, a = evidence, evidence.h, evidence.run.arrays
        self.sample, self.one = a["contact_sample"], a["contact_merged"] == 1
        self.sides = a["contact_body"], a["contact_other"]
        self.normal, self.force = evidence.run.contacts.normal, evidence.run.contacts.tangential
        self.out = a["contact_normal"]
        self.along = np.stack([-self.out[:, 1], self.out[:, 0]], axis=1)
        self.names = evidence.model.bodies.name
        self.pair = self.sides[0] * len(self.names) + self.sides[1]
        self.kinds, place = np.unique(self.pair, return_inverse=True)
        self.friction, self.static, self.restitution = (
            np.array([of(evidence.model.mechanism, *divmod(kind, len(self.names)))
                      for kind in self.kinds.tolist()], dtype=float)[place]
            for of in (friction_of, static_friction_of, restitution_of))
        weights = evidence.loads.weights
        self.inverse = np.divide(1, weights, out=np.zeros_like(weights), where=weights > 0)
        self.change = self.h * evidence.loads.frames.acceleration
        self.before = evidence.velocity - self.change / 2
        self.after = evidence.velocity_after
        self.hit, self.instant = self._impacts(a)
        self.arms = self._arms(a)

    def add(self, worst: Worst, error: Array, allowed: Array, among: Flags) -> None:
        """Compare the rows of each pair that are ``among`` those to judge."""
        for kind in self.kinds.tolist():
            worst.add("/".join(self.names[b] for b in divmod(kind, len(self.names))), error,
                      allowed, among & (self.pair == kind))

    def _impacts(self, a: Arrays) -> tuple[Flags, Array]:
        """Which rows bounce in their step, and the instants after the pose [s]; nan if unknown."""
        time, count = self.evidence.run.time, len(self.names)
        hit, instant = np.zeros(len(self.pair), dtype=bool), np.full(len(self.pair), np.nan)
        if not len(hit):
            return hit, instant
        key = self.sample * count**2 + self.pair
        order = np.argsort(key)
        pair, when = a["impact_body"] * count + a["impact_other"], a["impact_time"]
        later = np.searchsorted(time, when)
        for sample in (np.maximum(later - 1, 0), np.minimum(later, len(time) - 1)):
            after, wanted = when - time[sample], sample * count**2 + pair
            row = order[np.searchsorted(key, wanted, sorter=order).clip(max=len(key) - 1)]
            near = ((np.abs(after) <= self.h * (1 + EXACT)) & (key[row] == wanted)
                    & (self.restitution[row] > 0))
            force = self.h * a["contact_force"][row]
            own = near & (np.hypot(*(a["impact_impulse"] - force).T)
                          <= EXACT * np.hypot(*force.T))
            hit[row[own | (near & ~self.one[row])]] = True
            instant[row[own]] = after[own]
        return hit, instant

    def _arms(self, a: Arrays) -> tuple[Array, Array]:
        """From the centres of mass to the place, of impacts at their instants [m], [m, 2] each.

        The place of an impact is recorded on the first body, led back to the pose. That on the
        other follows from the motion of both; across the force from the recorded moment, exactly.
        """
        (one, two), force = self.evidence.contact_arms, a["contact_force"]
        s = np.nan_to_num(self.instant)
        mean = [(self.before[:2, b, self.sample]
                 + (self.h + s) / 2 * self.others[:2, b, self.sample]).T for b in self.sides]
        moved = s[:, None] * (mean[0] - mean[1])
        off = (np.nan_to_num(a["contact_twist"]) + moved[:, 0] * force[:, 1]
               - moved[:, 1] * force[:, 0]) / np.maximum((force**2).sum(axis=1), ROUNDING**2)
        moved += off[:, None] * np.stack([-force[:, 1], force[:, 0]], axis=1)
        return one, two + np.where(self.inverse[self.sides[1], :1] > 0, moved, 0.0)

    @cached_property
    def others(self) -> Array:
        """Accelerations of free bodies by all forces but contacts and joints, [3, nb, n]."""
        loads = self.evidence.loads
        total, sides = loads.totals.copy(), loads.contact_sides
        for axis, push in zip(total, (*sides.force.T, sides.moment), strict=True):
            np.subtract.at(axis, (sides.body, sides.sample), push)
        return np.asarray(self.inverse.T[:, :, None] * total)

    def rate(self, velocity: Array, along: Array) -> Array:
        """Of the first body's place against the other's, ``along`` [m, 2]."""
        return self.evidence.contact_rate(velocity, along, self.arms)

    def count(self, among: Flags) -> Array:
        """How many of some rows each free body has in each sample, at the more of both sides."""
        n = np.zeros(self.before.shape[1:])
        for b in self.sides:
            np.add.at(n, (b[among], self.sample[among]), 1)
        n[~self.evidence.model.bodies.free] = 0
        return np.maximum(*(n[b, self.sample] for b in self.sides))

    @cached_property
    def struck(self) -> Flags:
        """Rows of a body that bounces in the step."""
        return np.asarray(self.count(self.hit) > 0)

    @cached_property
    def alone(self) -> Flags:
        """Impacts at one point, of bodies that nothing else touches, fast enough to be judged."""
        known = self.hit & self.one & ~np.isnan(self.instant)
        fast, others = self.gap_rates[0] < -2 * REBOUND, self.count(np.ones_like(self.hit)) > 1
        return np.asarray(known & fast & ~others)

    @cached_property
    def joined(self) -> Flags:
        """Rows of free bodies that joints, cords or springs act on."""
        return np.asarray(self.evidence.held_by_others[np.stack(self.sides)].any(axis=0))

    @property
    def spins(self) -> tuple[Array, Array]:
        """How fast either body turns in the step, at most [rad/s]."""
        turning = np.abs(self.evidence.velocity[2]) + np.abs(self.change[2])
        one, two = (turning[b, self.sample] for b in self.sides)
        return one, two

    @cached_property
    def landing(self) -> Array:
        """How far bodies come nearer in a step at the rate before it [m]."""
        return np.maximum(-self.h * self.rate(self.before, self.out), 0.0)

    @cached_property
    def gap_rates(self) -> tuple[Array, Array]:
        """At which gaps open just before and after each impact [m/s]."""
        d = self.h * self.rate(self.others, self.out)
        share = np.nan_to_num(self.instant) / self.h
        return (self.rate(self.before, self.out) + (0.5 + share) * d,
                self.rate(self.after, self.out) - (0.5 - share) * d)

    @cached_property
    def sliding(self) -> tuple[Array, Array]:
        """Rates of sliding at the beginning and end of the step, or after the impact [m/s]."""
        drives, belt = self.evidence.model.drives, np.zeros(len(self.pair))
        for i in drives.giving("surface").tolist():
            on = (np.stack(self.sides) == drives.target[i]).any(axis=0)
            value = self.evidence.run.arrays["drive_value"][self.sample, i]
            belt += np.where(on, drives.sense[i] * value, 0.0)
        turn = sum(sign * self.before[2, b, self.sample]**2 * (arm * self.along).sum(axis=1)
                   for sign, b, arm in zip((-1.0, 1.0), self.sides, self.arms, strict=True))
        share = np.nan_to_num(self.instant) / self.h
        change = np.where(self.hit, (share - 0.5) * self.rate(self.others, self.along), turn / 2)
        return (self.rate(self.before, self.along) - belt,
                self.rate(self.after, self.along) + self.h * change - belt)

    @cached_property
    def unsure(self) -> Array:
        """By how much rates may be off [m/s]: rounding, the solve, held impulses.

        At impacts also by arms, which are known to second order, and by what joints, cords and
        springs do in the step, which the samples beside it bound.
        """
        h, evidence = self.h, self.evidence
        fast = (np.abs(evidence.velocity) + np.abs(self.change)).max(axis=(0, 1))[self.sample]
        spin = sum(self.spins)
        answer = sum(self.inverse[b, 0] + self.inverse[b, 2] * (arm**2).sum(axis=1)
                     for b, arm in zip(self.sides, self.arms, strict=True))
        most = peak(np.hypot(self.normal, self.force))
        off = STILL[0] + SOLVED * (1 + fast) + ROUNDING / h + HELD * h * answer * most
        beside = [np.abs(self.rate(np.roll(self.change, k, axis=2), self.out)) for k in (-1, 1)]
        impact = (fast * (spin * np.nan_to_num(self.instant))**2
                  + np.where(self.joined, 2 * (np.maximum(*beside) + h * JOINT), 0.0))
        return np.asarray(off + np.where(self.hit, impact, 0.0)
                          + np.where(self.one, 0.0, 2 * spin * (evidence.open + self.landing)))


def _slides(rows: _Rows) -> Figure:
    """Friction that slides is at its bound, against the sliding; what is within it sticks."""
    (first, last), worst = rows.sliding, Worst()
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
    return worst.figure(
        "contact.slides", "", source="f = -μ N y / |y|",
        none="no contact with friction has one normal and at most one impact per step",
        why="difference between friction and μ N against the sliding, and excess over the static "
            "limit where nothing slides, relative to N, {count:pair}, worst: {where}")


def _closes(rows: _Rows) -> Figure:
    """What carries is closed, or closes in the step; what overlaps carries, or parts."""
    evidence, h, worst = rows.evidence, rows.h, Worst()
    gap, first, last = (evidence.run.arrays["contact_gap"], rows.rate(rows.before, rows.out),
                        rows.rate(rows.after, rows.out))
    # curved surfaces that stay closed have no rate at mid-step, and one at the step's end
    low, high = np.sort([gap + h * last, gap + h * (first + last) / 2], axis=0)
    error = np.maximum(np.maximum(np.minimum(gap, low), np.minimum(gap, 0.0) - high), 0.0)
    slide = np.abs(rows.sliding).max(axis=0)
    bend = slide**2 / ROUND + sum(
        spin * (slide + spin * np.hypot(*arm.T))
        for spin, arm in zip(rows.spins, rows.arms, strict=True))
    rows.add(worst, np.where(rows.normal < 0, np.inf, error),
             evidence.open + np.where(rows.one, LANDS, 1.0) * rows.landing
             + h * rows.unsure + h**2 * bend + 2 * evidence.contact_depth,
             evidence.one_normal & ~rows.struck & (np.abs(rows.normal) > TOUCH))
    for sample in np.unique(np.linspace(0, len(evidence.run) - 1, POSES).astype(int)).tolist():
        for pair, depth in overlaps(evidence.alone(sample)):
            worst.add("/".join(rows.names[b] for b in pair), np.array([depth]),
                      evidence.open + DEEP * min(reach_of(evidence, b) for b in pair))
    return worst.figure(
        "contact.closes", "m", source="N > 0 only at gap = 0", none="nothing touches",
        why="gaps of contacts with a force, and overlaps that grow with their force or without "
            f"one, {{count:comparison}}, of overlaps in {POSES} samples, worst: {{where}}")


def _bounces(rows: _Rows) -> Figure:
    """Speed of parting over speed of approach against the coefficient of restitution."""
    (before, after), worst = rows.gap_rates, Worst()
    speed = np.maximum(-before, REBOUND)
    rows.add(worst, np.abs(after / speed - rows.restitution), rows.unsure / speed, rows.alone)
    return worst.figure(
        "contact.bounces", "", source="u+ = -e u-", none=NO_IMPACT,
        why="coefficients of restitution from the gap rates before and after an impact, against "
            "the scene, {count:pair}, worst: {where}")


def _swallowed(rows: _Rows) -> Figure:
    """Kinetic energy that the impacts of a step take, beyond what restitution explains.

    Of several impacts in one step the approaches are not recorded. Without friction and joints each
    is at most what all impulses of the step on its two bodies can make.
    """
    (before, after), alone, count = rows.gap_rates, rows.alone, len(rows.evidence.run)
    impulse, restitution = rows.h * rows.normal, np.where(rows.hit, rows.restitution, 0.0)
    approach, pushes = np.zeros(len(impulse)), np.zeros((2, *rows.before.shape[1:]))
    sides = [(b, np.hypot(*arm.T)) for b, arm in zip(rows.sides, rows.arms, strict=True)]
    for b, arm in sides:
        np.add.at(pushes[0], (b, rows.sample), impulse)
        np.add.at(pushes[1], (b, rows.sample), impulse * arm)
    for b, arm in sides:
        push, turn = pushes[:, b, rows.sample]
        approach += rows.inverse[b, 0] * push + rows.inverse[b, 2] * arm * turn
    approach = np.where(alone, after - before, approach) / (1 + restitution)
    off = rows.unsure + ~alone * rows.h * np.abs(rows.rate(rows.others, rows.out))
    taken, energy, allowed = (
        np.bincount(rows.sample, rows.struck * impulse * each, count) for each in (
            -(before + after + (1 - restitution) * approach) / 2, rows.hit * approach / 2, off))
    unknown = rows.struck & ~alone & (
        (rows.force != 0) | rows.joined | (~rows.one & (restitution < 1)))
    at, worst = np.setdiff1d(rows.sample[rows.hit & (before < -2 * REBOUND)],
                             rows.sample[unknown]), Worst()
    error, allowed = np.maximum(taken, 0.0)[at] / energy[at], EXACT + allowed[at] / energy[at]
    if len(at):
        time = rows.evidence.run.time[at[(error / allowed).argmax()]]
        worst.add(f"at {time:.5g} s", error, allowed)
    return worst.figure(
        "impact.swallowed", "", source="ΔT = Σ J (u- + u+) / 2", none=NO_IMPACT,
        why="kinetic energy that impacts took beyond what restitution allows, relative to that of "
            "their approach, worst: {where}")
