"""Figures of laws: what springs, cords and dampers carry, worked out again from the scene.

Stiffness, length at rest and damping are the scene's, lengths and rates follow from the recorded
poses and velocities; the recorded force has to be what the law makes of them:

    at the pose            F = k s
    at the middle          F = k s + c dL/dt                with the recorded velocities
    at the step's end      F = k s + (c + h k) dL/dt        with those half a step on, v + h a / 2

with s = L - L0. The second is the first where c = 0; which of them an element keeps hangs on how
stiff it is against the step (docs/engine.md), and it has to keep one of them throughout. A cord
never pushes, and once slack stays so while s is below 0. A spring with a law of its own has

    F = f(s, ds/dt) at the middle,   or   F = f(s + h ds/dt, ds/dt) at the step's end

in each step one of the two, by the law's slope there.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT, ROUNDING, Figure, Worst, lost_rate, whole
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
        why="forces of {count:straight spring} from the recorded poses and velocities, share of "
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
            if len(tendons.gripped(i)):  # a span each: sandbox.audit.grips
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
        why="tensions of {count:tendon} from the recorded poses and velocities, or their drives, "
            "share of the largest of each, worst: {where}")


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
        most = whole(force)
        stiffest = float(np.max(k, initial=0.0))
        best: tuple[float, Array, Array] | None = None
        for lead, rate, ahead in ((0.0, middle, 0.0), (c, middle, 0.0),
                                  (c + self.h * k, end, self.h)):
            law = k * stretch + lead * rate
            if self.pulls_only:  # what hangs slack is not pulled by its damper alone
                slack = (force == 0.0) & (stretch + ahead * rate <= ROUNDING)
                law = np.where(slack, 0.0, np.maximum(law, 0.0))
            allowed = (EXACT * most + stiffest * ROUNDING
                       + np.max(lead) * lost_rate(rate, turning=False))
            ratio = np.where(among, np.abs(force - law) / allowed, 0.0)
            top = float(np.where(np.isnan(ratio), np.inf, ratio).max(initial=0.0))
            if best is None or top < best[0]:
                best = top, np.abs(force - law) / most, np.full(len(force), allowed / most)
        assert best is not None  # there are three laws
        self.worst.add(name, best[1], best[2], among)


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
        errors = [np.abs(torque - k * (turn + ahead) - damping)
                  for ahead in (0.0, h * evidence.rates_after[j])]
        best = min((error[holds] for error in errors),
                   key=lambda error: float(np.nan_to_num(error, nan=np.inf).max(initial=0)))
        worst.add(springs.name[i], best / most, allowed / most)
    return worst.figure(
        "spring.torque", "", source="τ = k (q - q0) + c dq/dt", none="there is no rotary spring",
        why="torques of {count:rotary spring} from the recorded poses and velocities, share of "
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
    most, ratio = whole(force), np.full(len(force), np.inf)
    error, allowed = ratio.copy(), ratio.copy()
    for rate, ahead in ((middle, 0.0), (end, h)):
        there, off = stretch + ahead * rate, lost_rate(rate, turning=turning)
        own = law.force(there, rate, k)
        may = np.zeros(len(force))
        for s in (-1.0, 1.0):
            for r in (-1.0, 1.0):
                other = law.force(there + s * (ROUNDING + ahead * off), rate + r * off, k)
                may = np.fmax(may, np.abs(other - own))
        may = EXACT * most + may
        closer = np.abs(force - own) / may < ratio
        ratio = np.where(closer, np.abs(force - own) / may, ratio)
        error = np.where(closer, np.abs(force - own), error)
        allowed = np.where(closer, may, allowed)
    error, allowed = (np.where(np.isfinite(ratio), each, bad)
                      for each, bad in ((error, most), (allowed, EXACT * most)))
    worst.add(evidence.model.springs.name[spring], error / most, allowed / most, among)


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
        why="torques of the dampers of {count:hinge} from the recorded velocities, share of the "
            "largest of each, worst: {where}")
