"""Force laws: springs, tendons, dampers and loads, from the scene's numbers.

Lengths and rates follow from the recorded poses and velocities; s = q - q0. The force is

    at the pose            F = k s
    at mid-step            F = k s + c dq/dt                with the recorded velocities
    at the step's end      F = k s + (c + h k) dq/dt        with those half a step on, v + h a / 2

An element follows one of these throughout, by its stiffness and the step (docs/engine.md). A tendon
never pushes, and a slack one stays slack while s < 0. A spring with a law f of its own has, in each
step, f(s, ds/dt) at mid-step or f(s + h ds/dt, ds/dt) at the step's end.
"""

from __future__ import annotations

import itertools

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT, ROUNDING, Worst, check, lost_rate, whole
from sandbox.model.loads import load_at
from sandbox.model.model import NONE
from sandbox.numeric import Array, Flags
from sandbox.samples.cords import lengths, rest_lengths


@check("spring.law", source="F = k (L - L0) + c dL/dt",
       asks="is each spring force stiffness times stretch, plus damping?",
       compared="forces of {count:straight spring} from the recorded poses and velocities, "
                "relative to the largest of each, worst: {where}",
       none="there is no straight spring")
def _springs(evidence: Evidence, worst: Worst) -> None:
    _compare_springs(evidence, worst, straight=True)


@check("tendon.law", source="T = k (L - L0) + c dL/dt",
       asks="does each tendon tension follow from its drive or its stretch, never below 0?",
       compared="tensions of {count:tendon} from the recorded poses, velocities and drives, "
                "relative to the largest of each, worst: {where}",
       none="no tendon slides freely")
def _tendons(evidence: Evidence, worst: Worst) -> None:
    loads, tendons, a = evidence.loads, evidence.model.tendons, evidence.run.arrays
    if not tendons.name:
        return
    holds = _as_built(evidence, "tendon")
    middle, end = (loads.cord_efforts.rates(len(tendons.name), v)
                   for v in (evidence.velocity, evidence.velocity_after))
    stretch = lengths(loads.frames, loads.cords) - rest_lengths(loads.model)[:, None]
    for i, name in enumerate(tendons.name):
        tension = a["tendon_tension"][:, i]
        if len(tendons.gripped(i)):
            continue
        if tendons.drive[i] != NONE:
            pull = a["drive_value"][:, tendons.drive[i]]
            worst.add(name, np.abs(tension - pull) / whole(pull), ROUNDING, holds[i])
            continue
        k = (float(tendons.stiffness[i]) if tendons.stiffener[i] == NONE
             else a["drive_value"][:, tendons.stiffener[i]])
        _compare(evidence, worst, name, tension, k, float(tendons.damping[i]), stretch[i],
                 middle[i], end[i], holds[i], pulls_only=True)


@check("spring.torque", source="τ = k (q - q0) + c dq/dt",
       asks="does each rotary spring's torque follow from its angle?",
       compared="torques of {count:rotary spring} from the recorded poses and velocities, "
                "relative to the largest of each, worst: {where}",
       none="there is no rotary spring")
def _rotary_springs(evidence: Evidence, worst: Worst) -> None:
    _compare_springs(evidence, worst, straight=False)


@check("damper.law", source="τ = -c dq/dt",
       asks="is each hinge damper's torque its damping times the hinge's rate?",
       compared="torques of the dampers of {count:hinge} from the recorded velocities, relative "
                "to the largest of each, worst: {where}",
       none="there is no hinge")
def _dampers(evidence: Evidence, worst: Worst) -> None:
    model, holds = evidence.model, evidence.holds("joint")
    for j in model.joints.hinges.tolist():
        if model.bodies.free[model.joints.bodies[j]].any():
            c, rate = float(model.hinge_damping[j]), evidence.rates[j]
            torque = evidence.run.arrays["joint_damping"][:, j]
            allowed = EXACT * whole(torque) + c * lost_rate(rate, turning=True)
            worst.add(model.joints.name[j], np.abs(torque + c * rate) / whole(torque),
                      allowed / whole(torque), holds[j])


@check("load.law", source="F = F(x, v, a, t)", asks="does each load, such as drag, follow its law?",
       compared="forces and torques of {count:load on a body|loads on bodies} from the recorded "
                "poses, velocities and accelerations, relative to the largest of each, worst: "
                "{where}",
       none="there is no load")
def _loads(evidence: Evidence, worst: Worst) -> None:
    """F(x, v, a, t) at the sample or, for stiff laws, F(x + h v, v, a, t) at the step's end."""
    for i, name in enumerate(evidence.model.loads.name):
        _compare_load(evidence, worst, i, name)


# -- springs and tendons --------------------------------------------------------------------


def _compare_springs(evidence: Evidence, worst: Worst, *, straight: bool) -> None:
    """Compare straight or rotary springs; the damper of a rotary one is always at mid-step."""
    springs, loads, a = evidence.model.springs, evidence.loads, evidence.run.arrays
    which = np.flatnonzero(springs.straight == straight)
    if not len(which):
        return
    middle, end = (loads.spring_efforts.rates(len(springs.name), v)
                   for v in (evidence.velocity, evidence.velocity_after))
    holds = _as_built(evidence, "spring")
    for i in which.tolist():
        force, damping, among = a["spring_force"][:, i], float(springs.damping[i]), holds[i]
        if straight:
            place = loads.distances(springs.bodies[i:i + 1], springs.anchor[i:i + 1])[0]
        else:
            place, among = evidence.angles[springs.joint[i]], (
                among & evidence.joints_hold[springs.joint[i]])
        stretch = place - springs.rest[i]
        k = (a["drive_value"][:, springs.drive[i]] if springs.drive[i] != NONE
             else float(springs.stiffness[i]))
        if springs.law[i] is not None:
            _compare_own(evidence, worst, i, stretch, middle[i], end[i], k, among)
            continue
        if not straight:
            force, damping = force - damping * middle[i], 0.0
        _compare(evidence, worst, springs.name[i], force, k, damping, stretch, middle[i], end[i],
                 among, largest=whole(a["spring_force"][:, i]), turning=not straight)


def _as_built(evidence: Evidence, kind: str) -> Flags:
    """Where elements hold with the scene's rest length, [elements, n].

    An element that is engaged "as is" has another rest length from then on.
    """
    ties, holds = evidence.model.ties, evidence.holds(kind).copy()
    for i, tie in enumerate(ties.of(kind).tolist()):
        if tie >= 0 and ties.as_is[tie]:
            holds[i] = np.logical_and.accumulate(holds[i])
    return holds


def _compare(
    evidence: Evidence, worst: Worst, name: str, force: Array, k: Array | float, c: float,
    stretch: Array, middle: Array, end: Array, among: Flags, *, largest: float | None = None,
    pulls_only: bool = False, turning: bool = False,
) -> None:
    """Compare a force [n] with the nearest of the three laws.

    Args:
        evidence: the recording.
        worst: takes the comparison.
        name: of the element.
        force: recorded, [n].
        k: stiffness, [n] where a drive sets it.
        c: damping.
        stretch: at the pose, [n].
        middle: rate at mid-step, [n].
        end: rate at the step's end, [n].
        among: samples in which it holds, [n].
        largest: force that errors refer to; by default the largest.
        pulls_only: whether it never pushes.
        turning: whether it turns.
    """
    h, most, laws = evidence.h, largest or whole(force), []
    for lead, rate, ahead in ((0.0, middle, 0.0), (c, middle, 0.0), (c + h * k, end, h)):
        law = k * stretch + lead * rate
        if pulls_only:  # the damper alone does not pull a slack tendon
            slack = (force == 0.0) & (stretch + ahead * rate <= ROUNDING)
            law = np.where(slack, 0.0, np.maximum(law, 0.0))
        allowed = (EXACT * most + float(np.max(k, initial=0.0)) * ROUNDING
                   + np.max(lead) * lost_rate(rate, turning=turning))
        laws.append((np.abs(force - law) / most, allowed / most))
    worst.add_nearest(name, laws, among)


def _compare_own(
    evidence: Evidence, worst: Worst, spring: int, stretch: Array, middle: Array, end: Array,
    k: Array | float, among: Flags,
) -> None:
    """Compare a spring with its own law, at mid-step or the step's end of each sample.

    The effect of rounding of stretch and rate is found by evaluating the law beside them.
    """
    springs, h, laws = evidence.model.springs, evidence.h, []
    law, force = springs.law[spring], evidence.run.arrays["spring_force"][:, spring]
    assert law is not None  # others are compared elsewhere
    for rate, ahead in ((middle, 0.0), (end, h)):
        there = stretch + ahead * rate
        off = lost_rate(rate, turning=not springs.straight[spring])
        own, may = law.force(there, rate, k), np.zeros(len(force))
        for s, r in itertools.product((-1.0, 1.0), repeat=2):
            other = law.force(there + s * (ROUNDING + ahead * off), rate + r * off, k)
            may = np.fmax(may, np.abs(other - own))
        laws.append((np.abs(force - own) / whole(force), EXACT + may / whole(force)))
    worst.add_nearest(springs.name[spring], laws, among, throughout=False)


# -- loads ------------------------------------------------------------------------------------


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
    """Effect of rounding of pose, velocity and acceleration on a load, by evaluating it; [3, n]."""
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
