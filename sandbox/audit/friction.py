"""Friction: of tendons at guides, with the law of each span; of pins and slots."""

from __future__ import annotations

import numpy as np

from sandbox.audit.driven import HELD
from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import (
    DIGITS,
    EXACT,
    ROUNDING,
    STILL,
    Worst,
    check,
    lost_rate,
    peak,
    whole,
)
from sandbox.model.model import NONE
from sandbox.model.tendons import CordSpan, spans_of
from sandbox.numeric import Array, Flags
from sandbox.samples.cords import bends, lengths_at_start, piece_tensions, rest_lengths, span_length

SOLVED = 1e-9
"""Relative to the largest tension: tolerance of friction against its bound.

The solve leaves 1e-10 of the tensions on both sides, 2e-10 at most (docs/engine.md). The rest is
for the angle: :data:`ROUNDING` of a position turns a piece of 1 mm by 1e-9, and changes the bound
by mu / 2 of that fraction of both tensions.
"""
DRAG = 1e-7
"""Damping of a loop, relative to the effect of its stiffness in a step (docs/engine.md)."""
MEASURED = 1e-13
"""Change of rates [m/s, rad/s] below which the load of a joint is not measured again."""


@check("tendon.grip", source="T e^(-μφ) <= T' <= T e^(μφ)",
       asks="is the larger tension at a guide at most e^(mu phi) times the smaller?",
       compared="friction of guides against Euler's bound from the recorded poses, and its "
                "direction against the sliding, relative to the largest tension, "
                "{count:comparison}, worst: {where}",
       none="no guide has friction")
def _bounds(evidence: Evidence, worst: Worst) -> None:
    tendons, a, held = evidence.model.tendons, evidence.run.arrays, evidence.holds("tendon")
    spans = [span for k in range(len(tendons.name)) for span in spans_of(tendons, k)]
    behind = {span.into: span for span in spans}
    for k, guide in enumerate(tendons.grips.tolist()):
        span, friction = behind[k], a["guide_friction"][:, k]
        after = _tension(evidence, span)
        before, most = after - friction, whole(after)
        phi = np.maximum(bends(evidence.loads.frames, evidence.loads.cords, k), 0.0)
        # the absolute value, since a tendon that breaks may reverse the sign
        bound = np.tanh(0.5 * float(tendons.friction[k]) * phi) * np.abs(after + before)
        allowed = SOLVED + _drag(evidence, span, k) / most
        place = evidence.model.bodies.name[tendons.guide_body[guide]]
        name = f"{tendons.name[span.tendon]} at {place}"
        worst.add(name, np.maximum(np.abs(friction) - bound, 0.0) / most, allowed)
        if evidence.every_step:
            slid = np.diff(a["guide_slip"][:, k], prepend=a["guide_slip"][0, k])
            for what, error in (("sense", -np.sign(slid) * friction),
                                ("sliding", bound - np.abs(friction))):
                error = np.where(np.abs(slid) > ROUNDING, np.maximum(error, 0.0), 0.0)
                worst.add(f"{what} of {name}", error / most, allowed, held[span.tendon])


def _drag(evidence: Evidence, span: CordSpan, grip: int) -> float:
    """Largest force of the damping of a loop [N]; 0 of other tendons."""
    tendons, h = evidence.model.tendons, evidence.h
    if not tendons.closed[span.tendon]:
        return 0.0
    slid = np.diff(evidence.run.arrays["guide_slip"][:, grip], prepend=0.0)
    apart = h if evidence.every_step else float(np.diff(evidence.run.time[:2]).sum()) or h
    stiffness = float(tendons.stiffness[span.tendon] * rest_lengths(evidence.model)[span.tendon])
    shortest = min(float(span_length(evidence.loads.frames, evidence.loads.cords, each)[1].min())
                   for each in spans_of(tendons, span.tendon))
    return 5 * DRAG * h * stiffness / max(shortest, ROUNDING) * float(np.abs(slid).max()) / apart


def _tension(evidence: Evidence, span: CordSpan) -> Array:
    """Tension of a span, that of its first straight piece [N], [n]."""
    tendons = evidence.model.tendons
    piece = int(np.flatnonzero(tendons.stretch_first == span.guides[0])[0])
    return np.asarray(piece_tensions(
        evidence.model, evidence.run.arrays, np.array([piece]))[0])


@check("tendon.spans", source="T = EA (L - M) / M",
       asks="does the tension of each span of a tendon with friction match its stretch?",
       compared="tensions of {count:span} from the recorded poses and the sliding, relative to "
                "the largest of each, worst: {where}",
       none="no guide has friction")
def _spans(evidence: Evidence, worst: Worst) -> None:
    """T = EA (L - M) / M, with the content M of each span from the recorded sliding."""
    tendons = evidence.model.tendons
    for tendon in range(len(tendons.name)):
        if spans := spans_of(tendons, tendon):
            _add_laws(evidence, spans, worst)


def _add_laws(evidence: Evidence, spans: list[CordSpan], worst: Worst) -> None:
    """Compare the spans of a tendon with the law at the step's end or at mid-step.

    The content M is that at the step's end. Where not every step was recorded, the rate of sliding
    is its mean since the last sample.
    """
    loads, tendons, h = evidence.loads, evidence.model.tendons, evidence.h
    tendon = spans[0].tendon
    if evidence.model.ties.tendon[tendon] >= 0 and (evidence.run.arrays["held"][
            :, evidence.model.ties.tendon[tendon]] == 0).any():
        return  # it spreads again while it is released
    damping = float(tendons.damping[tendon] / tendons.stiffness[tendon])
    all_spans = spans
    if spans[-1].out_of < 0 and tendons.drive[tendon] != NONE:
        spans = spans[:-1]
    tension = np.array([_tension(evidence, span) for span in spans])
    hangs = (tension == 0.0).all(axis=0)
    if hangs.any() and not evidence.every_step:
        return  # the contents where it became taut again are unknown
    measured = [span_length(loads.frames, loads.cords, span) for span in all_spans]
    length, free = (np.array(each) for each in zip(*measured, strict=True))
    wound = length - free
    rest = float(rest_lengths(evidence.model)[tendon])
    whole_length = float(lengths_at_start(evidence.model)[tendon])
    share = (rest / whole_length if rest <= whole_length
             else 1 + (rest - whole_length) / float(free[:, 0].sum()))
    came = np.array([_came(evidence, span) for span in spans])
    count = len(spans)
    inside = _inside(share * length[:count, 0], came, free[:count, 1:], wound[:count, 1:], hangs)
    slid = np.diff(came, axis=1, prepend=0.0 if evidence.every_step else came[:, :1])
    apart = float(np.diff(evidence.run.time[:2]).sum()) or h
    rates = [_rates(evidence, spans, v) for v in (evidence.velocity, evidence.velocity_after)]
    for n in range(len(spans)):
        most, step = whole(tension[n]), slid[n] * h / apart
        held = inside[n] - step - wound[n, 1:]
        k = float(tendons.stiffness[tendon]) * rest / held
        c = damping * k
        static = k * (length[n, 1:] - inside[n]) - c * step / h
        before = 2 * rates[0][n] - rates[1][n]
        laws = (static + (c + h * k) * rates[1][n],
                static + c * rates[0][n] + h * k / 4 * (rates[1][n] - before))
        allowed = (EXACT * most + k * ROUNDING
                   + (c + h * k) * lost_rate(rates[1][n], turning=False))
        if not evidence.every_step:  # the sliding of the last step differs from the mean
            changes = np.abs(np.diff(step, prepend=step[0], append=step[-1]))
            allowed = allowed + (most / held + c / h) * (changes[:-1] + changes[1:])
        worst.add_nearest(f"span {n} of {tendons.name[tendon]}", [
            (np.where(hangs, 0.0, np.abs(tension[n] - np.maximum(law, 0.0))) / most, allowed / most)
            for law in laws])


def _came(evidence: Evidence, span: CordSpan) -> Array:
    """Net length that has slid into a span since t = 0 [m], [n]."""
    slip = evidence.run.arrays["guide_slip"]
    nothing = np.zeros(len(slip))
    into = slip[:, span.into] if span.into >= 0 else nothing
    return np.asarray(into - (slip[:, span.out_of] if span.out_of >= 0 else nothing))


def _inside(start: Array, came: Array, free: Array, wound: Array, hangs: Flags) -> Array:
    """Length of tendon in each span [m], [spans, n], with the length that wheels have wound up.

    ``start`` is that at t = 0 and ``came`` what slid in. A slack tendon distributes itself in
    proportion to the ``free`` lengths.
    """
    inside = start[:, None] + came
    if hangs.any():
        last = np.maximum.accumulate(np.where(hangs, np.arange(len(hangs)), -1))
        even = wound + (inside - wound).sum(axis=0) * free / free.sum(axis=0)
        at = last.clip(0)
        inside = np.where(last >= 0, even[:, at] + came - came[:, at], inside)
    return inside


def _rates(evidence: Evidence, spans: list[CordSpan], velocity: Array) -> Array:
    """Rates at which spans lengthen as bodies move with ``velocity`` [m/s], [spans, n]."""
    loads, first = evidence.loads, evidence.model.tendons.stretch_first
    each = loads.piece_efforts.rates(len(first), velocity)
    return np.array([each[np.isin(first, span.guides[:-1])].sum(axis=0) for span in spans])


@check("joint.friction", source="|F| <= μ N, against the motion",
       asks="is joint friction at most mu N and opposed to the motion?",
       compared="dry friction of joints against its bound and against the motion at the end of "
                "the step, {count:comparison}, worst: {where}",
       none="no joint has dry friction")
def _joints(evidence: Evidence, worst: Worst) -> None:
    model, a = evidence.model, evidence.run.arrays
    joints, whole_joints = model.joints, evidence.holds("joint")
    rates = evidence.loads.friction_efforts.rates(len(joints.name), evidence.velocity_after)
    for j in joints.rubbed.tolist():
        if not model.bodies.free[joints.bodies[j]].any():
            continue
        friction, holds = a["joint_friction"][:, j], a["joint_sticks"][:, j] == 1.0
        sliding = joints.friction[j] + joints.rubbing[j] * carried(evidence, j)
        most, largest = joints.static[j] * sliding, whole(joints.static[j] * sliding)
        alone = _alone(evidence, j)
        unsure = EXACT + MEASURED / (evidence.h * alone.min() * largest)
        name = joints.name[j]
        worst.add(f"bound of {name}", np.maximum(np.abs(friction) - most, 0.0) / largest, unsure)
        rate, fast = rates[j], 1 + peak(rates[j])
        low, high = _breaking_away(holds, rate, sliding, most)
        short = np.maximum(low - np.abs(friction), np.abs(friction) - high)
        worst.add(f"slip of {name}", np.where(holds, 0.0, np.maximum(short, 0.0)) / largest,
                  unsure, whole_joints[j])
        wrong = np.where(holds, np.abs(rate), np.maximum(rate * np.sign(friction), 0.0))
        held = HELD * alone * evidence.h * 2 * peak(friction)
        worst.add(name, wrong / fast, SOLVED + (
            STILL[joints.kind[j].rubs == "N m"] + DIGITS / evidence.h + held
            + evidence.h * _bend(evidence, j)) / fast, whole_joints[j])


def _breaking_away(
    holds: Flags, rate: Array, sliding: Array, most: Array,
) -> tuple[Array, Array]:
    """Least and largest friction where a joint slips, [n].

    It is that of sliding, or between both bounds where sliding may begin in this step
    (:mod:`sandbox.engine.friction`): the joint stuck in the sample before, or slipped the other
    way.
    """
    begins = np.append(True, holds[:-1] | (rate[1:] * rate[:-1] < 0))
    some = begins * (most - sliding) / 2
    return np.maximum(sliding - some, 0.0), sliding + some


def carried(evidence: Evidence, joint: int) -> Array:
    """Load of a joint that its friction depends on [N], [n]; of a groove the force across it."""
    force = evidence.run.arrays["joint_force"][:, joint]
    if evidence.model.joints.kind[joint].keeps != "groove":
        return np.asarray(np.hypot(force[:, 0], force[:, 1]))
    x, y = evidence.loads.frames.groove_direction(joint)
    return np.asarray(np.abs(x * force[:, 1] - y * force[:, 0]))


def _alone(evidence: Evidence, joint: int) -> Array:
    """Change of the rate of two separate bodies by friction of 1 N s or 1 N m s, [n]."""
    pushes, weights = evidence.loads.friction_efforts, evidence.loads.weights
    found = np.zeros(evidence.loads.frames.samples)
    for k in np.flatnonzero(pushes.element == joint).tolist():
        mass, _, inertia = weights[pushes.body[k]].tolist()
        if mass:
            found += (pushes.x[k]**2 + pushes.y[k]**2) / mass + pushes.moment[k]**2 / inertia
    return found


def _bend(evidence: Evidence, joint: int) -> Array | float:
    """Acceleration off the tangent of a groove as bodies turn [m/s^2], [n]."""
    joints, frames = evidence.model.joints, evidence.loads.frames
    if joints.kind[joint].keeps != "groove":
        return 0.0
    a, b = joints.bodies[joint].tolist()
    at, v = frames.anchors[1], evidence.velocity
    reach = np.hypot(at.x[joint] - frames.centre_x[a], at.y[joint] - frames.centre_y[a])
    speed = np.hypot(v[0, b] - v[0, a], v[1, b] - v[1, a])
    arm = np.hypot(at.arm_x[joint], at.arm_y[joint])
    turn = np.abs(v[2, a]) + np.abs(v[2, b])
    grows = evidence.h * (np.abs(frames.acceleration[2, a]) + np.abs(frames.acceleration[2, b]))
    return np.asarray((turn + grows) * ((turn + grows) * (reach + arm) + 2 * speed))
