"""Motors that start at speed: an impact in one step, its energy loss and the work of joints.

A motor whose speed u differs from its hinge's rate q gives an impulse P and the work P (q + u) / 2
to the bodies. The motor itself loses P u: P (u - q) / 2 is lost, as in a clutch.

Joints do work of first order in that step. Their two sides separate at h/2 c, with c the required
acceleration, B a = c, and on average at h/4 of its change. With B^T R + C^T P = M dv, R the
impulses of joints, and d the difference of after and before:

    W = R . h/4 dc = h/4 (dv . M da - P . d(du/dt))
"""

from __future__ import annotations

from collections import defaultdict
from typing import NamedTuple

import numpy as np

from sandbox.audit.driven import SOLVED, initial_rate, set_while_running
from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT, peak
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags
from sandbox.values.signals import values


class StartsAtSpeed(NamedTuple):
    """Effects of motors that start at speed."""

    jumps: tuple[str, ...]
    """A description of each."""
    cost: float
    """Energy lost between motors and slower hinges [J]."""
    made: Array
    """Energy from joints [J], [n]."""
    unsure: float
    """Its error [J]."""
    within: Flags
    """Samples in the step of an impact, [n]."""


class _Jump(NamedTuple):
    """A motor that changes its hinge's rate between two samples."""

    drive: int
    rate: float
    """Of the hinge before [rad/s]."""
    speed: float
    """Of the motor afterwards [rad/s]."""


def starts(evidence: Evidence) -> StartsAtSpeed:
    """All starts in a run."""
    count, texts = len(evidence.run), []
    made, within, cost, unsure = np.zeros(count), np.zeros(count, dtype=bool), 0.0, 0.0
    for sample, jumps in sorted(_jumps(evidence).items()):
        j = evidence.model.drives.target[jumps[0].drive]
        done = (evidence.rates[j][sample] - jumps[0].rate) / (jumps[0].speed - jumps[0].rate)
        within[sample] = done < 0.75  # the rate of a sample is the mean of before and after
        impulses = [_impulse(evidence, sample, jump, bool(within[sample])) for jump in jumps]
        at = evidence.run.time[sample - 1] if sample else 0.0
        for jump, impulse in zip(jumps, impulses, strict=True):
            own = abs(impulse * (jump.speed - jump.rate)) / 2
            cost += own
            on_line = evidence.model.drives.kind[jump.drive].gives == "push"
            what, rate, push = (("actuator", "m/s", "N s") if on_line
                                else ("hinge", "rad/s", "N m s"))
            texts.append(f"{evidence.model.drives.name[jump.drive]} accelerates its {what} from "
                         f"{jump.rate:.4g} to {jump.speed:.4g} {rate} after {at:.4g} s with "
                         f"{impulse:.3g} {push}, which loses {own:.3g} J")
        own, off = _of_joints(evidence, sample, jumps, impulses, sample + int(within[sample]))
        made[sample] += own * (0.5 if within[sample] else 1.0)
        made[sample + 1:] += own
        unsure += off
    return StartsAtSpeed(tuple(texts), cost, made, unsure, within)


def _jumps(evidence: Evidence) -> dict[int, list[_Jump]]:
    """Motors that change the rates of their hinges at once, by the first sample after it."""
    a, drives = evidence.run.arrays, evidence.model.drives
    found: dict[int, list[_Jump]] = defaultdict(list)
    for i in np.flatnonzero(paced(evidence.model)).tolist():
        # at its limit a motor speeds its hinge up step by step
        holds = np.abs(a["drive_torque"][:, i]) < drives.most[i] * (1 - EXACT)
        value, rates = a["drive_value"][:, i], evidence.rates[drives.target[i]]
        least = SOLVED * (1 + peak(rates))
        (speed, change), rate = _first_speed(evidence, i), initial_rate(evidence, i)
        if holds[0] and abs(speed - rate) > change + least:
            found[0].append(_Jump(i, rate, speed))
        each = np.abs(np.diff(value))
        if len(each) < 2:
            continue
        before = np.concatenate([each[1:2], each[:-1]])
        after = np.concatenate([each[1:], each[-2:-1]])
        for s in np.flatnonzero((each > before + after + least) & holds[1:]).tolist():
            found[s + 1].append(_Jump(i, float(rates[s]), float(value[s + 1])))
    return found


def paced(model: Model) -> Flags:
    """Drives that keep a speed of a hinge or actuator, [nd]."""
    limited = np.array([kind.limited and kind.timely == "end" for kind in model.drives.kind],
                       dtype=bool)
    return np.asarray(limited & np.isnan(model.drives.slope))


def _first_speed(evidence: Evidence, drive: int) -> tuple[float, float]:
    """A motor's speed at t = 0 and its change in a step [rad/s], from the first two steps."""
    mechanism, h = evidence.model.mechanism, evidence.h
    spec = mechanism.drives[drive]
    if spec.name in set_while_running(mechanism):
        return float(evidence.run.arrays["drive_value"][0, drive]), 0.0
    one, two = values(
        spec.signal(mechanism), np.array([h, 2 * h]), mechanism.functions).tolist()
    return float(2 * one - two), float(abs(two - one))


def _impulse(evidence: Evidence, sample: int, jump: _Jump, within: bool) -> float:
    """Impulse of a motor [N m s]; from its work if that step is not the sample's."""
    a = evidence.run.arrays
    if within:
        return float(evidence.h * a["drive_torque"][sample, jump.drive])
    work = a["drive_work"][sample, jump.drive]
    if sample:
        work = work - a["drive_work"][sample - 1, jump.drive]
    return float(work / np.float64((jump.rate + jump.speed) / 2))


def _of_joints(
    evidence: Evidence, sample: int, jumps: list[_Jump], impulses: list[float], after: int,
) -> tuple[float, float]:
    """Energy from joints in an impact, and its error [J].

    From the sample before it and the first two samples ``after`` it, extrapolated back; the error
    is the extrapolation. The acceleration before t = 0 is unknown; its effect on joints is at most
    that of the acceleration later.
    """
    a, time, h, weight = evidence.run.arrays, evidence.run.time, evidence.h, evidence.loads.weights
    if after + 1 >= len(time):
        return 0.0, np.inf
    if sample:
        v, acceleration = (a[f"body_{key}"][sample - 1] for key in ("velocity", "acceleration"))
        began, moved = float(time[sample - 1]), 0.0
    else:
        v = initial_velocity(evidence)
        acceleration, began, moved = np.zeros_like(v), 0.0, float((v * weight).any())
    powers = [float(((a["body_velocity"][n] - v) * weight
                     * (a["body_acceleration"][n] - acceleration)).sum())
              - sum(impulse * (_change(evidence, jump.drive, n)
                               - (_change(evidence, jump.drive, sample - 1) if sample else 0.0))
                    for jump, impulse in zip(jumps, impulses, strict=True))
              for n in (after, after + 1)]
    led = (powers[1] - powers[0]) / (time[after + 1] - time[after]) * (time[after] - began)
    made = h / 4 * (powers[0] - led)
    return made, h / 4 * abs(led) + moved * abs(made)


def initial_velocity(evidence: Evidence) -> Array:
    """Velocities of all bodies at t = 0, from the scene [m/s, m/s, rad/s], [nb, 3]."""
    bodies = evidence.model.mechanism.bodies
    rows = [(*body.velocity, body.angular_velocity) for body in bodies]
    return np.array(rows, dtype=float).reshape(-1, 3)


def _change(evidence: Evidence, drive: int, sample: int) -> float:
    """Angular acceleration of a motor's hinge [rad/s^2]."""
    j = evidence.model.drives.target[drive]
    return float((evidence.rates_after[j, sample] - evidence.rates[j, sample]) / (evidence.h / 2))
