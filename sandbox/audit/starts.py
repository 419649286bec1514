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

    jumps: list[str]
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
    a, drives, count, texts = evidence.run.arrays, evidence.model.drives, len(evidence.run), []
    made, within, cost, unsure = np.zeros(count), np.zeros(count, dtype=bool), 0.0, 0.0
    for sample, jumps in sorted(_jumps(evidence).items()):
        _, before, speed = jumps[0]
        rate = evidence.rates[drives.target[jumps[0].drive]][sample]
        # the rate of a sample is the mean of before and after
        inside = within[sample] = (rate - before) / (speed - before) < 0.75
        impulses = []
        for drive, before, speed in jumps:
            work = np.diff(a["drive_work"][:, drive], prepend=0.0)[sample]
            impulse = float(evidence.h * a["drive_torque"][sample, drive] if inside
                            else work / np.float64((before + speed) / 2))
            impulses.append(impulse)
            cost += (lost := abs(impulse * (speed - before)) / 2)
            what, unit, push = (("actuator", "m/s", "N s") if drives.kind[drive].gives == "push"
                                else ("hinge", "rad/s", "N m s"))
            texts.append(f"{drives.name[drive]} accelerates its {what} from {before:.4g} to "
                         f"{speed:.4g} {unit} after "
                         f"{evidence.run.time[sample - 1] if sample else 0.0:.4g} s with "
                         f"{impulse:.3g} {push}, which loses {lost:.3g} J")
        own, off = _of_joints(evidence, sample, jumps, impulses, sample + int(inside))
        made[sample:] += own
        made[sample] -= own / 2 * inside
        unsure += off
    return StartsAtSpeed(texts, cost, made, unsure, within)


def _jumps(evidence: Evidence) -> dict[int, list[_Jump]]:
    """Motors that change the rates of their hinges at once, by the first sample after it."""
    a, drives, mechanism = evidence.run.arrays, evidence.model.drives, evidence.model.mechanism
    found: dict[int, list[_Jump]] = defaultdict(list)
    set_by, times = set_while_running(mechanism), np.array([evidence.h, 2 * evidence.h])
    for i in np.flatnonzero(paced(evidence.model)).tolist():
        # at its limit a motor speeds its hinge up step by step
        holds = np.abs(a["drive_torque"][:, i]) < drives.most[i] * (1 - EXACT)
        value, rates = a["drive_value"][:, i], evidence.rates[drives.target[i]]
        least, rate, spec = SOLVED * (1 + peak(rates)), initial_rate(evidence, i), (
            mechanism.drives[i])
        one, two = (value[[0, 0]] if spec.name in set_by else
                    values(spec.signal(mechanism), times, mechanism.functions)).tolist()
        if holds[0] and abs(2 * one - two - rate) > abs(two - one) + least:
            found[0].append(_Jump(i, rate, 2 * one - two))
        each = np.abs(np.diff(value))
        if len(each) > 1:
            beside = np.append(each[1], each[:-1]) + np.append(each[1:], each[-2])
            for s in np.flatnonzero((each > beside + least) & holds[1:]).tolist():
                found[s + 1].append(_Jump(i, float(rates[s]), float(value[s + 1])))
    return found


def paced(model: Model) -> Flags:
    """Drives that keep a speed of a hinge or actuator, [nd]."""
    limited = np.array([kind.limited and kind.timely == "end" for kind in model.drives.kind],
                       dtype=bool)
    return np.asarray(limited & np.isnan(model.drives.slope))


def _of_joints(
    evidence: Evidence, sample: int, jumps: list[_Jump], impulses: list[float], after: int,
) -> tuple[float, float]:
    """Energy from joints in an impact, and its error [J].

    From the sample before it and the first two samples ``after`` it, extrapolated back; the error
    is the extrapolation. The acceleration before t = 0 is unknown; its effect on joints is at most
    that of the acceleration later.
    """
    time, h, weight = evidence.run.time, evidence.h, evidence.loads.weights.T
    if after + 1 >= len(time):
        return 0.0, np.inf
    velocity, acceleration = evidence.velocity, evidence.loads.frames.acceleration
    target = evidence.model.drives.target[[jump.drive for jump in jumps]]
    changes = (evidence.rates_after - evidence.rates)[target] / (h / 2)
    if sample:
        v, a, change = velocity[..., sample - 1], acceleration[..., sample - 1], changes[
            :, sample - 1]
        began, moved = float(time[sample - 1]), 0.0
    else:
        v, began = initial_velocity(evidence).T, 0.0
        a, change, moved = np.zeros_like(v), np.zeros(len(jumps)), float((v * weight).any())
    one, two = (float(((velocity[..., n] - v) * weight * (acceleration[..., n] - a)).sum()
                      - np.array(impulses) @ (changes[:, n] - change))
                for n in (after, after + 1))
    led = (two - one) / (time[after + 1] - time[after]) * (time[after] - began)
    made = h / 4 * (one - led)
    return made, h / 4 * abs(led) + moved * abs(made)


def initial_velocity(evidence: Evidence) -> Array:
    """Velocities of all bodies at t = 0, from the scene [m/s, m/s, rad/s], [nb, 3]."""
    bodies = evidence.model.mechanism.bodies
    rows = [(*body.velocity, body.angular_velocity) for body in bodies]
    return np.array(rows, dtype=float).reshape(-1, 3)
