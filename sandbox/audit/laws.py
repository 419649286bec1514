"""Figures of laws: forces of springs, cords, dampers and loads from the scene's numbers.

Lengths and rates follow from the recorded poses and velocities; s = L - L0. The force is

    at the pose            F = k s
    at mid-step            F = k s + c dL/dt                with the recorded velocities
    at the step's end      F = k s + (c + h k) dL/dt        with those half a step on, v + h a / 2

An element keeps one of these throughout, by its stiffness against the step (docs/engine.md). A cord
never pushes, and a slack one stays slack while s < 0. A spring with a law f of its own has, in each
step, f(s, ds/dt) at mid-step or f(s + h ds/dt, ds/dt) at the step's end.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT, ROUNDING, Figure, Worst, lost_rate, whole
from sandbox.model.loads import load_at
from sandbox.model.model import NONE
from sandbox.model.ties import held_of, held_one
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.cords import lengths, rest_lengths


def law_figures(evidence: Evidence) -> Iterator[Figure]:
    """Springs, cords, rotary springs and dampers; the work that all of them do."""
    yield _springs(evidence)
    yield _cords(evidence)
    yield _rotary(evidence)
    yield _dampers(evidence)
    yield _loads(evidence)


def _springs(evidence: Evidence) -> Figure:
    loads, springs, a = evidence.loads, evidence.model.springs, evidence.run.arrays
    laws, hold = _Laws(evidence), _held(evidence, evidence.model.ties.spring)
    if springs.straight.any():
        middle, end = (loads.lengthening(loads.spring_pulls, len(springs.name), v)
                       for v in (evidence.velocity, evidence.velocity_after))
        for i in np.flatnonzero(springs.straight).tolist():
            if springs.law[i] is not None:
                _own(evidence, laws.worst, i, evidence.spring_lengths[i] - springs.rest[i],
                     middle[i], end[i], hold[i], turning=False)
                continue
            laws.add(springs.name[i], a["spring_force"][:, i], _stiffness(evidence, i),
                     float(springs.damping[i]), evidence.spring_lengths[i] - springs.rest[i],
                     middle[i], end[i], hold[i])
    return laws.worst.figure(
        "spring.law", "", source="F = k (L - L0) + c dL/dt", none="there is no straight spring",
        why="forces of {count:straight spring} from the recorded poses and velocities, relative to "
            "the largest of each, worst: {where}")


def _cords(evidence: Evidence) -> Figure:
    """Tensions; 0 where the law would push."""
    loads, tendons, a = evidence.loads, evidence.model.tendons, evidence.run.arrays
    laws, hold = _Laws(evidence, pulls_only=True), _held(evidence, evidence.model.ties.tendon)
    if tendons.name:
        middle, end = (loads.lengthening(loads.cord_pulls, len(tendons.name), v)
                       for v in (evidence.velocity, evidence.velocity_after))
        rest, found = rest_lengths(loads.model), lengths(loads.frames, loads.cords)
        for i, name in enumerate(tendons.name):
            if len(tendons.gripped(i)):
                continue
            tension = a["tendon_tension"][:, i]
            if tendons.drive[i] != NONE:
                pull = a["drive_value"][:, tendons.drive[i]]
                most = whole(pull)
                laws.worst.add(name, np.abs(tension - pull) / most, ROUNDING, hold[i])
                continue
            k = (float(tendons.stiffness[i]) if tendons.stiffener[i] == NONE
                 else a["drive_value"][:, tendons.stiffener[i]])
            laws.add(name, tension, k, float(tendons.damping[i]),
                     found[i] - rest[i], middle[i], end[i], hold[i])
    return laws.worst.figure(
        "tendon.law", "", source="T = k (L - L0) + c dL/dt", none="no tendon slides freely",
        why="tensions of {count:tendon} from the recorded poses, velocities and drives, relative "
            "to the largest of each, worst: {where}")


def _held(evidence: Evidence, ties: Integers) -> Flags:
    """In which samples elements have the lengths at rest of the scene and hold, [elements, n].

    One that is taken up as it is has another length at rest from then on.
    """
    own, holds = evidence.model.ties, held_of(ties, evidence.run.arrays["held"])
    for i in np.flatnonzero(ties >= 0):
        if own.as_is[ties[i]]:
            holds[i] = np.logical_and.accumulate(holds[i])
    return holds


def _stiffness(evidence: Evidence, spring: int) -> Array | float:
    """Of a spring [N/m, N m/rad], [n] where a drive sets it."""
    springs = evidence.model.springs
    if springs.drive[spring] != NONE:
        return np.asarray(evidence.run.arrays["drive_value"][:, springs.drive[spring]])
    return float(springs.stiffness[spring])


class _Laws:
    """Holds forces against the three laws, each element against the one that it keeps best."""

    def __init__(self, evidence: Evidence, *, pulls_only: bool = False) -> None:
        self.h, self.worst, self.pulls_only = evidence.h, Worst(), pulls_only

    def add(self, name: str, force: Array, k: Array | float, c: float, stretch: Array,
            middle: Array, end: Array, among: Flags) -> None:
        """Force [n] of an element; its stretch [n] and rates [n] at the middle and the end.

        ``among`` are the samples in which it holds.
        """
        most, laws = whole(force), []
        stiffest = float(np.max(k, initial=0.0))
        for lead, rate, ahead in ((0.0, middle, 0.0), (c, middle, 0.0),
                                  (c + self.h * k, end, self.h)):
            law = k * stretch + lead * rate
            if self.pulls_only:  # what hangs slack is not pulled by its damper alone
                slack = (force == 0.0) & (stretch + ahead * rate <= ROUNDING)
                law = np.where(slack, 0.0, np.maximum(law, 0.0))
            allowed = (EXACT * most + stiffest * ROUNDING
                       + np.max(lead) * lost_rate(rate, turning=False))
            laws.append((np.abs(force - law) / most, allowed / most))
        self.worst.add_nearest(name, laws, among)


def _rotary(evidence: Evidence) -> Figure:
    """At the pose, or where the step leads what is too stiff for it; dampers at the middle."""
    springs, a, worst, h = evidence.model.springs, evidence.run.arrays, Worst(), evidence.h
    hold = _held(evidence, evidence.model.ties.spring)
    for i in np.flatnonzero(~springs.straight).tolist():
        j = springs.joint[i]
        k = _stiffness(evidence, i)
        turn, torque = evidence.angles[j] - springs.rest[i], a["spring_force"][:, i]
        holds = hold[i] & evidence.joints_hold[j]
        if springs.law[i] is not None:
            _own(evidence, worst, i, turn, evidence.rates[j], evidence.rates_after[j], holds,
                 turning=True)
            continue
        damping = springs.damping[i] * evidence.rates[j]
        most = whole(torque)
        allowed: float = EXACT * most + float(np.max(k, initial=0.0)) * (
            ROUNDING + h * lost_rate(evidence.rates_after[j], turning=True))
        worst.add_nearest(springs.name[i], [
            (np.abs(torque - k * (turn + ahead) - damping) / most, allowed / most)
            for ahead in (0.0, h * evidence.rates_after[j])], holds)
    return worst.figure(
        "spring.torque", "", source="τ = k (q - q0) + c dq/dt", none="there is no rotary spring",
        why="torques of {count:rotary spring} from the recorded poses and velocities, relative to "
            "the largest of each, worst: {where}")


def _own(
    evidence: Evidence, worst: Worst, spring: int, stretch: Array, middle: Array, end: Array,
    among: Flags, *, turning: bool,
) -> None:
    """The force of a spring with a law, as that has it at one of both places in each sample.

    What rounding of stretch and rate may make of it is found by trying.
    """
    law, h = evidence.model.springs.law[spring], evidence.h
    assert law is not None  # others are not asked
    force, k = evidence.run.arrays["spring_force"][:, spring], _stiffness(evidence, spring)
    most, laws = whole(force), []
    for rate, ahead in ((middle, 0.0), (end, h)):
        there, off = stretch + ahead * rate, lost_rate(rate, turning=turning)
        own = law.force(there, rate, k)
        may = np.zeros(len(force))
        for s in (-1.0, 1.0):
            for r in (-1.0, 1.0):
                other = law.force(there + s * (ROUNDING + ahead * off), rate + r * off, k)
                may = np.fmax(may, np.abs(other - own))
        laws.append((np.abs(force - own) / most, EXACT + may / most))
    worst.add_nearest(evidence.model.springs.name[spring], laws, among, throughout=False)


def _dampers(evidence: Evidence) -> Figure:
    """Of hinges, those of rotary springs included; where nothing is free they carry nothing."""
    model, a, worst = evidence.model, evidence.run.arrays, Worst()
    for j in model.joints.hinges.tolist():
        if not model.bodies.free[model.joints.bodies[j]].any():
            continue
        c, torque, rate = float(model.hinge_damping[j]), a["joint_damping"][:, j], evidence.rates[j]
        most = whole(torque)
        allowed = EXACT * most + c * lost_rate(rate, turning=True)
        worst.add(model.joints.name[j], np.abs(torque + c * rate) / most, allowed / most,
                  held_one(model.ties.joint[j], a["held"]))
    return worst.figure(
        "damper.law", "", source="τ = -c dq/dt", none="there is no hinge",
        why="torques of the dampers of {count:hinge} from the recorded velocities, relative to the "
            "largest of each, worst: {where}")


def _loads(evidence: Evidence) -> Figure:
    """Forces and torques of all loads against their laws.

    F(x, v, a, t) at the sample or, of what is stiff, F(x + h v, v, a, t) at the step's end.
    """
    model, worst = evidence.model, Worst()
    for i, name in enumerate(model.loads.name):
        _compare_load(evidence, worst, i, name)
    return worst.figure(
        "load.law", "", source="F = F(x, v, a, t)", none="there is no load",
        why="forces and torques of {count:load on a body|loads on bodies} from the recorded poses, "
            "velocities and accelerations, relative to the largest of each, worst: {where}")


def _compare_load(evidence: Evidence, worst: Worst, i: int, name: str) -> None:
    a, loads, frames = evidence.run.arrays, evidence.model.loads, evidence.loads.frames
    body, h, n = int(loads.body[i]), evidence.h, frames.samples
    found = np.stack([a["load_force"][:, i, 0], a["load_force"][:, i, 1], a["load_torque"][:, i]])
    pose = np.stack([frames.centre_x[body], frames.centre_y[body], frames.angle[body]])
    acceleration, each, nearest = frames.acceleration[:, body], np.arange(n), []
    for velocity, ahead in ((evidence.velocity[:, body], 0.0),
                            (evidence.velocity_after[:, body], h)):
        if ahead and loads.law[i] is None:
            continue
        given = pose + ahead * velocity, velocity, acceleration
        law = load_at(evidence.model, i, *given, evidence.run.time)
        may = _load_rounding(evidence, i, given, law, ahead)
        most = max(whole(found[0]), whole(found[1]))  # a torque's rounding is that of its force
        size = np.array([[most]] * 2 + [[max(whole(found[2]), most * ROUNDING / EXACT)]])
        error, allowed = np.abs(found - law) / size, may / size + EXACT
        k = np.nan_to_num(error / allowed, nan=np.inf).argmax(axis=0)
        nearest.append((error[k, each], allowed[k, each]))
    worst.add_nearest(name, nearest, throughout=False)


def _load_rounding(
    evidence: Evidence, i: int, given: tuple[Array, Array, Array], law: Array, ahead: float,
) -> Array:
    """What rounding of all that is recorded may make of a load, found by trying, [3, n]."""
    pose, velocity, acceleration = given
    may = np.zeros_like(law)
    for k in range(3):
        rate = lost_rate(velocity[k], turning=k == 2)
        off = np.zeros((3, 1))
        off[k] = 1.0
        size = float(np.abs(pose[k]).max(initial=0.0))
        for d in (-1.0, 1.0):
            moved = (pose + d * off * (ROUNDING * max(1.0, size) + ahead * rate),
                     velocity + d * off * rate, acceleration + d * off * 2 * rate / evidence.h)
            for tried in ((moved[0], velocity, acceleration), (pose, moved[1], acceleration),
                          (pose, velocity, moved[2])):
                other = load_at(evidence.model, i, *tried, evidence.run.time)
                may = np.fmax(may, np.abs(other - law))
    return may
