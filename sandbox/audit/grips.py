"""Figures of cords that guides hold by friction: Euler's bound at each, the law of each span."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT, ROUNDING, Figure, Worst, lost_rate, whole
from sandbox.model.model import NONE
from sandbox.model.spans import CordSpan, spans_of
from sandbox.model.ties import held_of
from sandbox.numeric import Array, Flags
from sandbox.samples.cords import (
    bends,
    lengths_at_start,
    piece_tensions,
    rest_lengths,
    span_length,
)

SOLVED = 1e-9
"""Share of the largest tension by which friction may miss its bound.

The solve leaves 1e-10 of the tensions on both sides, 2e-10 at most (docs/engine.md). The rest is
for the angle: :data:`ROUNDING` of a place turns a piece of 1 mm by 1e-9, and the bound with it by
mu / 2 of that share of both tensions.
"""
DRAG = 1e-7
"""Of a loop, as a share of what its stiffness does in a step (docs/engine.md)."""


def grip_figures(evidence: Evidence) -> Iterator[Figure]:
    """Friction of guides within its bound and against the slip; tensions of spans."""
    yield _bounds(evidence)
    yield _spans(evidence)


def _bounds(evidence: Evidence) -> Figure:
    """No tension grows by more than e^(mu phi) over a guide, and what slides is held back."""
    tendons, a, worst = evidence.model.tendons, evidence.run.arrays, Worst()
    spans = [span for k in range(len(tendons.name)) for span in spans_of(tendons, k)]
    behind = {span.into: span for span in spans}
    held = held_of(evidence.model.ties.tendon, a["held"])
    for k in range(len(tendons.grips)):
        span, friction = behind[k], a["guide_friction"][:, k]
        after = _tension(evidence, span)
        before, most = after - friction, whole(after)
        phi = np.maximum(bends(evidence.loads.frames, evidence.loads.cords, k), 0.0)
        share = np.tanh(0.5 * float(tendons.friction[k]) * phi)
        bound = share * np.abs(after + before)  # a cord that breaks may take back what it gave
        allowed = SOLVED + _drag(evidence, span, k) / most
        holds, name = held[span.tendon], f"{tendons.name[span.tendon]} at {_place(evidence, k)}"
        worst.add(name, np.maximum(np.abs(friction) - bound, 0.0) / most, allowed)
        # what slid since the sample before did so against the friction of its last step at most
        slid = np.diff(a["guide_slip"][:, k], prepend=a["guide_slip"][0, k])
        if evidence.every_step:
            back = np.where(np.abs(slid) > ROUNDING, -np.sign(slid) * friction, 0.0)
            worst.add(f"sense of {name}", np.maximum(back, 0.0) / most, allowed, holds)
            short = np.where(np.abs(slid) > ROUNDING, bound - np.abs(friction), 0.0)
            worst.add(f"sliding of {name}", np.maximum(short, 0.0) / most, allowed, holds)
    return worst.figure(
        "tendon.grip", "", source="T e^(-μφ) <= T' <= T e^(μφ)",
        none="no guide holds a tendon by friction",
        why="friction of guides against Euler's bound from the recorded poses, its sense against "
            "what slid, share of the largest tension, {count:comparison}, worst: {where}")


def _drag(evidence: Evidence, span: CordSpan, grip: int) -> float:
    """What keeps the speed of a loop a number [N], at most; 0 of cords that are tied."""
    tendons, h = evidence.model.tendons, evidence.h
    if not tendons.closed[span.tendon]:
        return 0.0
    slid = np.diff(evidence.run.arrays["guide_slip"][:, grip], prepend=0.0)
    apart = h if evidence.every_step else float(np.diff(evidence.run.time[:2]).sum()) or h
    stiffness = float(tendons.stiffness[span.tendon] * rest_lengths(evidence.model)[span.tendon])
    shortest = min(float(span_length(evidence.loads.frames, evidence.loads.cords, each)[1].min())
                   for each in spans_of(tendons, span.tendon))
    return 5 * DRAG * h * stiffness / max(shortest, ROUNDING) * float(np.abs(slid).max()) / apart


def _place(evidence: Evidence, grip: int) -> str:
    tendons = evidence.model.tendons
    return str(evidence.model.bodies.name[tendons.guide_body[tendons.grips[grip]]])


def _tension(evidence: Evidence, span: CordSpan) -> Array:
    """Of a span [N], [n]: that of its first straight piece."""
    tendons = evidence.model.tendons
    piece = int(np.flatnonzero(tendons.stretch_first == span.guides[0])[0])
    return np.asarray(piece_tensions(
        evidence.model, evidence.run.arrays, np.array([piece]))[0])


def _spans(evidence: Evidence) -> Figure:
    """T = EA (L - M) / M, what is in each span counted from what slid."""
    tendons, worst = evidence.model.tendons, Worst()
    for tendon in range(len(tendons.name)):
        if spans := spans_of(tendons, tendon):
            _add_laws(evidence, spans, worst)
    return worst.figure(
        "tendon.spans", "", source="T = EA (L - M) / M", none="no guide holds a tendon by friction",
        why="tensions of {count:span} from the recorded poses and what slid, share of the largest "
            "of each, worst: {where}")


def _add_laws(evidence: Evidence, spans: list[CordSpan], worst: Worst) -> None:
    """Of every span of a tendon the law, at the step's end or evenly about its pose.

    What slides in a step counts as it has slid, k (L - M) with M at its end; where not every step
    was recorded its rate is the mean of those since the last sample.
    """
    loads, tendons, h = evidence.loads, evidence.model.tendons, evidence.h
    tendon = spans[0].tendon
    if evidence.model.ties.tendon[tendon] >= 0 and (evidence.run.arrays["held"][
            :, evidence.model.ties.tendon[tendon]] == 0).any():
        return  # spread anew while it is let go
    damping = float(tendons.damping[tendon] / tendons.stiffness[tendon])
    all_spans = spans
    if spans[-1].out_of < 0 and tendons.drive[tendon] != NONE:
        spans = spans[:-1]
    tension = np.array([_tension(evidence, span) for span in spans])
    hangs = (tension == 0.0).all(axis=0)
    if hangs.any() and not evidence.every_step:
        return  # nobody knows what was where when it was taken up again
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
        if not evidence.every_step:  # as much more or less may have slid in the last step
            changes = np.abs(np.diff(step, prepend=step[0], append=step[-1]))
            allowed = allowed + (most / held + c / h) * (changes[:-1] + changes[1:])
        errors = [np.where(hangs, 0.0, np.abs(tension[n] - np.maximum(law, 0.0)))
                  for law in laws]
        best = min(errors, key=lambda error: float(np.nan_to_num(error, nan=np.inf).max(initial=0)))
        worst.add(f"span {n} of {tendons.name[tendon]}", best / most, allowed / most)


def _came(evidence: Evidence, span: CordSpan) -> Array:
    """What has slid into a span since t = 0, less what has slid out [m], [n]."""
    slip = evidence.run.arrays["guide_slip"]
    nothing = np.zeros(len(slip))
    into = slip[:, span.into] if span.into >= 0 else nothing
    return np.asarray(into - (slip[:, span.out_of] if span.out_of >= 0 else nothing))


def _inside(start: Array, came: Array, free: Array, wound: Array, hangs: Flags) -> Array:
    """What is in each span [m], [spans, n]: what was there at the start [spans], and what came.

    What wheels wound up counts. A cord that hangs spreads as its spans are ``free``; from then on
    it is counted from there.
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
    pieces = loads.cord_pulls._replace(element=np.tile(np.arange(len(first)), 2))
    each = loads.lengthening(pieces, len(first), velocity)
    return np.array([each[np.isin(first, span.guides[:-1])].sum(axis=0) for span in spans])
