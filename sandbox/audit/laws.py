"""Force laws: springs, tendons, dampers and loads, from the scene's numbers.

A law F(x, v) is compared at mid-step, with the recorded length (or pose) x and rate v, and at the
step's end, x + h v' with v' = v + h a / 2. An element follows one of them throughout, by its
stiffness and the step (docs/engine.md); a law of its own follows either in each step. The error by
rounding of x and v is found by evaluating the law beside them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT, ROUNDING, Worst, check, lost_rate, peak, whole
from sandbox.model.loads import load_at
from sandbox.model.model import NONE
from sandbox.model.programs import SpringLaw
from sandbox.numeric import Array, Flags
from sandbox.samples.cables import rest_lengths

State = tuple[Sequence[Array], Sequence[Array | float]]
"""Arguments of a law, [n] each, and their errors."""


def follow(
    worst: Worst, name: str, force: Array, law: Callable[..., Array], states: Sequence[State],
    among: Flags | None = None, *, size: Array | float | None = None, throughout: bool = True,
) -> None:
    """Compare a force, [n] or [k, n], with the nearest of several states of a law."""
    size, nearest = whole(force) if size is None else size, []
    for values, errors in states:
        here = law(*values)
        allowed = np.zeros_like(force)
        for k, off in enumerate(errors):
            allowed += np.fmax(*(np.abs(law(
                *values[:k], values[k] + sign * off, *values[k + 1:]) - here) for sign in (-1, 1)))
        error = np.atleast_2d(np.abs(force - here) / size)
        allowed = np.atleast_2d(allowed / size + EXACT)
        row, n = np.nan_to_num(error / allowed, nan=np.inf).argmax(axis=0), np.arange(len(here.T))
        nearest.append((error[row, n], allowed[row, n]))
    worst.add_nearest(name, nearest, among, throughout=throughout)


def states_of(h: float, place: Array, rates: Sequence[Array], *, turning: bool) -> list[State]:
    """Place and rate at mid-step and at the step's end."""
    return [((place + ahead * rate, rate), (ROUNDING + ahead * off, off))
            for ahead, rate in zip((0.0, h), rates, strict=True)
            for off in (lost_rate(rate, turning=turning),)]


def _as_built(evidence: Evidence, kind: str) -> Flags:
    """Where elements hold with the scene's rest length, not one of a later engagement, [.., n]."""
    bonds, holds = evidence.model.bonds, evidence.holds[kind].copy()
    for i, bond in enumerate(bonds.of(kind).tolist()):
        if bond >= 0 and bonds.as_is[bond]:
            holds[i] = np.logical_and.accumulate(holds[i])
    return holds


def _compare_springs(evidence: Evidence, worst: Worst, *, straight: bool) -> None:
    """Compare straight or rotary springs; the damper of a rotary one is always at mid-step."""
    springs, loads, a = evidence.model.springs, evidence.loads, evidence.arrays
    which = np.flatnonzero(springs.straight == straight)
    rates = evidence.rates_twice(loads.spring_efforts, len(springs.name)) if len(which) else []
    holds = _as_built(evidence, "spring")
    for i in which.tolist():
        recorded, c, joint = a["spring_force"][:, i], float(springs.damping[i]), springs.joint[i]
        among = holds[i] if straight else holds[i] & evidence.joints_hold[joint]
        place = (loads.distances(springs.bodies[i:i + 1], springs.anchor[i:i + 1])[0]
                 if straight else evidence.angles[joint])
        k = (a["drive_value"][:, springs.drive[i]] if springs.drive[i] != NONE
             else float(springs.stiffness[i]))
        own, force = springs.law[i], recorded
        if own is None and not straight:
            force, c = recorded - c * rates[0][i], 0.0

        def law(s: Array, v: Array, k: Array | float = k, c: float = c,
                own: SpringLaw | None = own) -> Array:
            return np.asarray(k * s + c * v if own is None else own.force(s, v, k))

        follow(worst, springs.name[i], force, law, states_of(
            evidence.h, place - springs.rest[i], [v[i] for v in rates], turning=not straight),
            among, size=whole(recorded), throughout=own is None)


_springs = check(
    "spring.law", source="F = k (L - L0) + c dL/dt",
    asks="is each spring force stiffness times stretch, plus damping?",
    compared="forces of {count:straight spring} from the recorded poses and velocities, relative "
             "to the largest of each, worst: {where}")(partial(_compare_springs, straight=True))


@check("tendon.law", source="T = k (L - L0) + c dL/dt",
       asks="does each tendon tension follow from its drive or its stretch, never below 0?",
       compared="tensions of {count:tendon} from the recorded poses, velocities and drives, "
                "relative to the largest of each, worst: {where}",
       none="no tendon slides freely")
def _tendons(evidence: Evidence, worst: Worst) -> None:
    loads, tendons, a = evidence.loads, evidence.model.tendons, evidence.arrays
    if not tendons.name:
        return
    holds = _as_built(evidence, "tendon")
    rates = evidence.rates_twice(loads.cable_efforts, len(tendons.name))
    stretch = evidence.frames.lengths - rest_lengths(loads.model)[:, None]
    for i, name in enumerate(tendons.name):
        tension, c = a["tendon_tension"][:, i], float(tendons.damping[i])
        if len(tendons.gripped(i)):
            continue
        if tendons.drive[i] != NONE:
            pull = a["drive_value"][:, tendons.drive[i]]
            worst.add(name, np.abs(tension - pull) / whole(pull), ROUNDING, holds[i])
            continue
        k = (float(tendons.stiffness[i]) if tendons.stiffener[i] == NONE
             else a["drive_value"][:, tendons.stiffener[i]])

        def law(s: Array, v: Array, k: Array | float = k, c: float = c,
                slack: Flags = tension == 0.0) -> Array:
            """The damper alone does not pull a slack tendon."""
            return np.where(slack & (s <= ROUNDING), 0.0, np.maximum(k * s + c * v, 0.0))

        follow(worst, name, tension, law, states_of(
            evidence.h, stretch[i], [v[i] for v in rates], turning=False), holds[i])


_rotary_springs = check(
    "spring.torque", source="τ = k (q - q0) + c dq/dt",
    asks="does each rotary spring's torque follow from its angle?",
    compared="torques of {count:rotary spring} from the recorded poses and velocities, relative to "
             "the largest of each, worst: {where}")(partial(_compare_springs, straight=False))


@check("damper.law", source="τ = -c dq/dt",
       asks="is each hinge damper's torque its damping times the hinge's rate?",
       compared="torques of the dampers of {count:hinge} from the recorded velocities, relative "
                "to the largest of each, worst: {where}")
def _dampers(evidence: Evidence, worst: Worst) -> None:
    model, holds = evidence.model, evidence.holds["joint"]
    for j in model.joints.hinges.tolist():
        if model.bodies.free[model.joints.bodies[j]].any():
            c, rate = float(model.hinge_damping[j]), evidence.rates[j]
            follow(worst, model.joints.name[j], evidence.arrays["joint_damping"][:, j],
                   lambda v, c=c: -c * v, [((rate,), (lost_rate(rate, turning=True),))], holds[j])


@check("load.law", source="F = F(x, v, a, t)", asks="does each load, such as drag, follow its law?",
       compared="forces and torques of {count:load on a body|loads on bodies} from the recorded "
                "poses, velocities and accelerations, relative to the largest of each, worst: "
                "{where}",
       none="there is no load")
def _loads(evidence: Evidence, worst: Worst) -> None:
    """F(x, v, a, t) at the sample or, for stiff laws, F(x + h v, v, a, t) at the step's end."""
    a, loads, frames, h = evidence.arrays, evidence.model.loads, evidence.frames, evidence.h
    for i, name in enumerate(loads.name):
        body = int(loads.body[i])
        force = np.stack([*a["load_force"][:, i].T, a["load_torque"][:, i]])
        pose = np.stack([frames.centre_x[body], frames.centre_y[body], frames.angle[body]])
        states: list[State] = []
        for ahead, velocity in ((0.0, evidence.velocity[:, body]),
                                (h, evidence.velocity_after[:, body]))[:1 + (
                                    loads.law[i] is not None)]:
            rate = [lost_rate(v, turning=k == 2) for k, v in enumerate(velocity)]
            off = [ROUNDING * max(1.0, peak(x)) + ahead * r
                   for x, r in zip(pose, rate, strict=True)]
            states.append(((*(pose + ahead * velocity), *velocity, *frames.acceleration[:, body]),
                           (*off, *rate, *(2 * r / h for r in rate))))
        most = whole(force[:2])  # a torque's rounding is that of its force
        size = np.array([[most], [most], [max(whole(force[2]), most * ROUNDING / EXACT)]])
        def law(*values: Array, load: int = i) -> Array:
            pose, velocity, acceleration = np.array(values).reshape(3, 3, -1)
            return load_at(evidence.model, load, pose, velocity, acceleration, evidence.run.time)

        follow(worst, name, force, law, states, size=size, throughout=False)
