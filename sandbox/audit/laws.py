"""Force laws: springs, tendons, dampers, loads and dry friction, from the scene's numbers.

A law F(x, v) is compared at mid-step, with the recorded length (or pose) x and rate v, and at the
step's end, x + h v' with v' = v + h a / 2. An element follows one of them throughout, by its
stiffness and the step (docs/engine.md); a law of its own follows either in each step.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from sandbox.audit.evidence import EXACT, ROUNDING, Check, Evidence, Worst, lost_rate, peak, whole
from sandbox.model.joints import normal_in_slot
from sandbox.model.loads import load_at
from sandbox.model.model import NONE
from sandbox.model.programs import SpringLaw
from sandbox.numeric import Array, Flags
from sandbox.samples import cables
from sandbox.samples.cables import CableSpan, spans_of

GRIP = 1e-9  # Error of guide friction relative to the tension (docs/engine.md)
DRAG = 1e-7  # Damping of a loop, relative to the effect of its stiffness in a step (docs/engine.md)
MEASURED = 1e-13  # Change of rates [m/s, rad/s] below which joint loads are not measured again
State = tuple[Sequence[Array], Sequence[Array | float]]  # arguments [n] of a law, their errors


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
    """Place and rate at mid-step, with the mean place of three poses, and at the step's end."""
    mid, after = rates
    states = (0.0, mid, mid), (h / 2, after - mid, mid), (h, after, after)
    return [((place + ahead * speed, rate), (ROUNDING + ahead * off, off))
            for ahead, speed, rate in states
            for off in (lost_rate(rate, turning=turning),)]


def _as_built(evidence: Evidence, kind: str) -> Flags:
    """Where elements hold with the scene's rest length, not one of a later engagement, [.., n]."""
    bonds, holds = evidence.model.bonds, evidence.holds[kind]
    as_is = np.append(bonds.as_is, False)[bonds.of(kind), None]
    return np.where(as_is, np.logical_and.accumulate(holds, axis=1), holds)


def _compare_springs(evidence: Evidence, worst: Worst, *, straight: bool) -> None:
    """Compare straight or rotary springs; the damper of a rotary one is always at mid-step."""
    springs, loads, a = evidence.model.springs, evidence.loads, evidence.arrays
    which = np.flatnonzero(springs.straight == straight)
    rates = evidence.rates_twice(loads.spring_efforts, len(springs.name)) if len(which) else []
    holds = _as_built(evidence, "spring")
    places = evidence.places(springs.bodies, springs.anchor, springs.joint)
    for i in which.tolist():
        recorded, c, joint = a["spring_force"][:, i], float(springs.damping[i]), springs.joint[i]
        among = holds[i] if straight else holds[i] & evidence.joints_hold[joint]
        k = (a["drive_value"][:, springs.drive[i]] if springs.drive[i] != NONE
             else float(springs.stiffness[i]))
        own, force = springs.law[i], recorded
        if own is None and not straight:
            force, c = recorded - c * rates[0][i], 0.0

        def law(s: Array, v: Array, k: Array | float = k, c: float = c,
                own: SpringLaw | None = own) -> Array:
            return np.asarray(k * s + c * v if own is None else own.force(s, v, k))

        follow(worst, springs.name[i], force, law, states_of(
            evidence.h, places[i] - springs.rest[i], [v[i] for v in rates], turning=not straight),
            among, size=whole(recorded), throughout=own is None)


_springs = Check(
    "spring.law", source="F = k (L - L0) + c dL/dt",
    asks="is each spring force stiffness times stretch, plus damping?",
    compared="forces of {count:straight spring} from the recorded poses and velocities, relative "
             "to the largest of each, worst: {where}")(partial(_compare_springs, straight=True))


@Check("tendon.law", source="T = k (L - L0) + c dL/dt",
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
    stretch = evidence.frames.lengths - cables.rest_lengths(loads.model)[:, None]
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

        follow(worst, name, tension, law, states_of(  # the mean place is of springs alone
            evidence.h, stretch[i], [v[i] for v in rates], turning=False)[::2], holds[i])


_rotary_springs = Check(
    "spring.torque", source="τ = k (q - q0) + c dq/dt",
    asks="does each rotary spring's torque follow from its angle?",
    compared="torques of {count:rotary spring} from the recorded poses and velocities, relative to "
             "the largest of each, worst: {where}")(partial(_compare_springs, straight=False))


@Check("damper.law", source="τ = -c dq/dt",
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


@Check("load.law", source="F = F(x, v, a, t)", asks="does each load, such as drag, follow its law?",
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
        pose, acceleration = frames.centre[:, body], frames.acceleration[:, body]
        states: list[State] = []
        for ahead, velocity in ((0.0, evidence.velocity[:, body]),
                                (h, evidence.velocity_after[:, body]))[:1 + (
                                    loads.law[i] is not None)]:
            rate = [lost_rate(v, turning=k == 2) for k, v in enumerate(velocity)]
            off = [ROUNDING * max(1.0, peak(x)) + ahead * r
                   for x, r in zip(pose, rate, strict=True)]
            states.append(((*(pose + ahead * velocity), *velocity, *acceleration),
                           (*off, *rate, *(2 * r / h for r in rate))))
        most = whole(force[:2])  # a torque's rounding is that of its force
        size = np.array([[most], [most], [max(whole(force[2]), most * ROUNDING / EXACT)]])
        def law(*values: Array, load: int = i) -> Array:
            pose, velocity, acceleration = np.array(values).reshape(3, 3, -1)
            return load_at(evidence.model, load, pose, velocity, acceleration, evidence.run.time)

        follow(worst, name, force, law, states, size=size, throughout=False)


@Check("tendon.grip", source="T e^(-μφ) <= T' <= T e^(μφ)",
       asks="is the larger tension at a guide at most e^(mu phi) times the smaller?",
       compared="friction of guides against Euler's bound from the recorded poses, and its "
                "direction against the sliding, relative to the largest tension, "
                "{count:comparison}, worst: {where}",
       none="no guide has friction")
def _bounds(evidence: Evidence, worst: Worst) -> None:
    tendons, a, h = evidence.model.tendons, evidence.arrays, evidence.h
    spans = [span for k in range(len(tendons.name)) for span in spans_of(tendons, k)]
    behind = {span.into: span for span in spans}
    for k, guide in enumerate(tendons.grips.tolist()):
        span, friction = behind[k], a["guide_friction"][:, k]
        after = _tension(evidence, span)
        most, floor, slip = whole(after), GRIP * whole(after), a["guide_slip"][:, k]
        if tendons.closed[span.tendon]:  # the damping of a loop
            slid = np.diff(slip, prepend=0.0)
            apart = h if evidence.every_step else float(np.diff(evidence.run.time[:2]).sum()) or h
            rest = cables.rest_lengths(evidence.model)[span.tendon]
            stiffness = float(tendons.stiffness[span.tendon] * rest)
            shortest = min(float(cables.span_length(evidence.frames, each)[1].min())
                           for each in spans_of(tendons, span.tendon))
            floor += 5 * DRAG * h * stiffness / max(shortest, ROUNDING) * peak(slid) / apart
        phi = np.maximum(cables.bends(evidence.frames, k), 0.0)
        # the absolute value, since a tendon that breaks may reverse the sign
        bound = np.tanh(0.5 * float(tendons.friction[k]) * phi) * np.abs(2 * after - friction)
        place = evidence.model.bodies.name[tendons.guide_body[guide]]
        name = f"{tendons.name[span.tendon]} at {place}"
        worst.add(name, np.maximum(np.abs(friction) - bound, 0.0) / most, floor / most)
        if evidence.every_step:
            slid = np.diff(slip, prepend=slip[0])
            worst.add_law(f"sliding of {name}", friction, -slid, bound,
                          (floor, ROUNDING), floor / most, evidence.holds["tendon"][span.tendon])


def _tension(evidence: Evidence, span: CableSpan) -> Array:
    """Tension of a span, that of its first straight piece [N], [n]."""
    piece = np.flatnonzero(evidence.model.tendons.stretch_first == span.guides[0])[:1]
    return np.asarray(cables.piece_tensions(evidence.model, evidence.arrays, piece)[0])


@Check("tendon.spans", source="T = EA (L - M) / M",
       asks="does the tension of each span of a tendon with friction match its stretch?",
       compared="tensions of {count:span} from the recorded poses and the sliding, relative to "
                "the largest of each, worst: {where}",
       none="no guide has friction")
def _spans(evidence: Evidence, worst: Worst) -> None:
    """Tendons are left out where they were released, or contents after slack are unknown."""
    tendons = evidence.model.tendons
    for tendon in range(len(tendons.name)):
        spans = spans_of(tendons, tendon)
        measured = spans[:-1] if spans and spans[-1].out_of < 0 and (
            tendons.drive[tendon] != NONE) else spans
        tension = np.array([_tension(evidence, span) for span in measured])
        if spans and evidence.holds["tendon"][tendon].all() and (
                evidence.every_step or not (tension == 0.0).all(axis=0).any()):
            _add_laws(evidence, worst, spans, tension)


def _add_laws(evidence: Evidence, worst: Worst, spans: list[CableSpan], tension: Array) -> None:
    """Compare spans with the law at the step's end or at mid-step; M is that at its end."""
    loads, tendons, h = evidence.loads, evidence.model.tendons, evidence.h
    tendon, count, slip = spans[0].tendon, len(tension), evidence.arrays["guide_slip"]
    damping = float(tendons.damping[tendon] / tendons.stiffness[tendon])
    slack = (tension == 0.0).all(axis=0)
    measured = [cables.span_length(evidence.frames, span) for span in spans]
    length, free = (np.array(each) for each in zip(*measured, strict=True))
    wound = (length - free)[:count, 1:]
    rest = float(cables.rest_lengths(evidence.model)[tendon])
    over = rest - float(cables.lengths_at_start(evidence.model)[tendon])
    share = rest / (rest - over) if over <= 0 else 1 + over / float(free[:, 0].sum())
    slips = np.column_stack([slip, np.zeros(len(slip))])  # a span without a guide has the last
    came = np.array([slips[:, span.into] - slips[:, span.out_of] for span in spans[:count]])
    inside = share * length[:count, :1] + came
    if slack.any():  # a slack tendon distributes itself in proportion to the free lengths
        last = np.maximum.accumulate(np.where(slack, np.arange(len(slack)), -1))
        share_of = free[:count, 1:] / free[:count, 1:].sum(axis=0)
        even = wound + (inside - wound).sum(axis=0) * share_of
        inside = np.where(last >= 0, even[:, last] + came - came[:, last], inside)
    slid = np.diff(came, axis=1, prepend=0.0 if evidence.every_step else came[:, :1])
    apart = float(np.diff(evidence.run.time[:2]).sum()) or h
    each = [loads.cable_efforts.power(v) for v in (evidence.velocity, evidence.velocity_after)]
    for n, span in enumerate(spans[:count]):
        pieces = np.tile(np.isin(tendons.stretch_first, span.guides[:-1]), 2)  # both ends of each
        now, after = (rates[pieces].sum(axis=0) for rates in each)
        most, step = whole(tension[n]), slid[n] * h / apart
        held = inside[n] - step - wound[n]
        k = float(tendons.stiffness[tendon]) * rest / held
        c = damping * k
        static = k * (length[n, 1:] - inside[n]) - c * step / h
        laws = static + (c + h * k) * after, static + c * now + h * k / 2 * (after - now)
        allowed = EXACT * most + k * ROUNDING + (c + h * k) * lost_rate(after, turning=False)
        if not evidence.every_step:  # the sliding of the last step differs from the mean
            changes = np.abs(np.diff(step, prepend=step[0], append=step[-1]))
            allowed = allowed + (most / held + c / h) * (changes[:-1] + changes[1:])
        worst.add_nearest(f"span {n} of {tendons.name[tendon]}", [
            (np.where(slack, 0.0, np.abs(tension[n] - np.maximum(law, 0.0))) / most, allowed / most)
            for law in laws])


@Check("joint.friction", source="|F| <= μ N, against the motion",
       asks="is joint friction at most mu N and opposed to the motion?",
       compared="dry friction of joints against its bound and against the motion at the end of "
                "the step, {count:comparison}, worst: {where}",
       none="no joint has dry friction")
def _joints(evidence: Evidence, worst: Worst) -> None:
    """A joint sticks within its static bound, or slips: f = -high where y > 0, f = high for y < 0.

    Where sliding begins, friction is up to half way to the static bound.
    """
    model, a, h = evidence.model, evidence.arrays, evidence.h
    joints, frames, pushes = model.joints, evidence.frames, evidence.loads.friction_efforts
    rates = pushes.rates(len(joints.name), evidence.velocity_after)
    for j in joints.frictional.tolist():
        if not model.bodies.free[joints.bodies[j]].any():
            continue
        friction, sticks = a["joint_friction"][:, j], a["joint_sticks"][:, j] == 1.0
        sliding = joints.friction[j] + joints.coefficient[j] * carried(evidence, j)
        most, rate, name = joints.static[j] * sliding, rates[j], joints.name[j]
        largest, fast, alone = whole(most), 1 + peak(rate), evidence.answer(pushes, j)
        unsure = EXACT + MEASURED / (h * alone.min() * largest)
        begins = np.append(True, sticks[:-1] | (rate[1:] * rate[:-1] < 0))
        some, size = begins * (most - sliding) / 2, np.abs(friction)
        slips = np.maximum(np.maximum(sliding - some, 0.0) - size, size - sliding - some)
        beyond = np.where(sticks, size - most, slips)
        worst.add(f"bound of {name}", np.maximum(size - most, 0.0) / largest, unsure)
        worst.add(f"slip of {name}", np.maximum(beyond, 0.0) / largest, unsure,
                  evidence.holds["joint"][j])
        slip = np.where(sticks, np.abs(rate), np.maximum(rate * np.sign(friction), 0.0))
        floor = evidence.rate_error(rate, alone * h * 2 * peak(friction),
                                    turning=joints.kind[j].friction_unit == "N m")
        if joints.kind[j].keeps == "groove":  # acceleration off its tangent as bodies turn
            (one, two), at, v = joints.bodies[j].tolist(), frames.anchors[1], evidence.velocity
            reach = np.hypot(at.x[j] - frames.centre[0, one], at.y[j] - frames.centre[1, one])
            speed = np.hypot(v[0, two] - v[0, one], v[1, two] - v[1, one])
            turn = (np.abs(v[2]) + h * np.abs(frames.acceleration[2]))[[one, two]].sum(axis=0)
            arm = np.hypot(at.arm_x[j], at.arm_y[j])
            floor = floor + h * (turn * (turn * (reach + arm) + 2 * speed))
        worst.add(name, slip / fast, floor / fast, evidence.holds["joint"][j])


def carried(evidence: Evidence, joint: int) -> Array:
    """Load of a joint that its friction depends on [N], [n]; of a groove the force across it."""
    if evidence.model.joints.kind[joint].keeps == "groove":
        return np.abs(normal_in_slot(evidence.model, evidence.arrays, joint))
    return np.asarray(np.hypot(*evidence.arrays["joint_force"][:, joint].T))
