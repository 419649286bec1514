"""Motors that start at speed: a blow in the first step, what it costs, what joints make of it.

A motor whose speed u at t = 0 is not its hinge's rate q brings all that hangs on the hinge to
speed in one step. Its impulse P does P (q + u) / 2 of work on the bodies; whatever turned at u
before gave P u: P (u - q) / 2 is lost, as in a clutch.

Joints do work in that step, to first order, not to second. They ask velocities v to lead along
the chord of the next step: their two sides part at h/2 c, where c is what they need of
acceleration, B a = c. Usually the bodies come along such a chord, too, and the mean is 0; out of
rest half of it is left. With B^T R + C^T P = M v, R what joints and P what motors gave,

    W = R . h/4 c = h/4 (v . M a - P du/dt)

so it is h/4 times the rate at which kinetic energy goes on to change, less what motors that go on
to change their speed do of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.audit.driven import initial_rate, set_while_running
from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT
from sandbox.numeric import Array
from sandbox.scene.mechanism import signal_of
from sandbox.scene.values.signals import values


class Start(NamedTuple):
    """What motors that start at speed do in the first step."""

    jumps: tuple[str, ...]
    """Of every motor that does, what happens to its hinge."""
    cost: float
    """Energy lost between motors that turn and hinges that do not yet [J]."""
    made: float
    """Energy that joints make [J]."""
    unsure: float
    """By how much that may be off [J]."""


def start_of(evidence: Evidence) -> Start:
    """The start of a run."""
    drives, jumps = evidence.model.drives, []
    cost = pushed = 0.0
    for i, kind in enumerate(drives.kind):
        if not kind.limited or np.isnan(drives.most[i]) or not len(evidence.run):
            continue
        (speed, change), rate = _speed(evidence, i), initial_rate(evidence, i)
        torque = evidence.run.arrays["drive_torque"][0, i]
        # at its limit a motor speeds its hinge up step by step
        if abs(speed - rate) <= change or not abs(torque) < drives.most[i] * (1 - EXACT):
            continue
        impulse = _impulse(evidence, i, speed, rate)
        own = abs(impulse * (speed - rate)) / 2
        jumps.append(f"{drives.name[i]} brings its hinge from {rate:.4g} to {speed:.4g} rad/s "
                     f"with {impulse:.3g} N m s, which costs {own:.3g} J")
        cost += own
        pushed += impulse * _changing(evidence, i)
    made, unsure = _of_joints(evidence, pushed)
    return Start(tuple(jumps), cost, made, unsure)


def _speed(evidence: Evidence, drive: int) -> tuple[float, float]:
    """What a motor is asked for at t = 0 and the change in a step [rad/s], from the first two."""
    mechanism, h = evidence.model.mechanism, evidence.h
    spec = mechanism.drives[drive]
    if spec.name in set_while_running(mechanism):
        return float(evidence.run.arrays["drive_value"][0, drive]), 0.0
    one, two = values(signal_of(spec, mechanism), np.array([h, 2 * h])).tolist()
    return float(2 * one - two), float(abs(two - one))


def _impulse(evidence: Evidence, drive: int, speed: float, rate: float) -> float:
    """Of a motor in the first step [N m s], from its work where that step was not recorded."""
    a = evidence.run.arrays
    if evidence.run.time[0] < evidence.h:
        return float(evidence.h * a["drive_torque"][0, drive])
    return float(a["drive_work"][0, drive] / np.float64((rate + speed) / 2))


def _first(evidence: Evidence) -> int:
    """The first sample of a step that is not the blow itself."""
    return int(evidence.run.time[0] < evidence.h)


def _changing(evidence: Evidence, drive: int) -> float:
    """At what rate the motor's hinge goes on to turn faster [rad/s^2]."""
    j, n = evidence.model.drives.target[drive], _first(evidence)
    change = evidence.rates_after[j] - evidence.rates[j]
    return float(change[n] / (evidence.h / 2)) if n < len(change) else 0.0


def _of_joints(evidence: Evidence, pushed: float) -> tuple[float, float]:
    """What joints made in the first step, and by how much that may be off [J].

    From the two samples after it, led back to t = 0; what lies between the first of these and
    that is what it may be off by. Of what moved before only the scene knows, and the
    joints' part on the way to the blow is as large as that after it at most.
    """
    time, first = evidence.run.time, _first(evidence)
    if len(time) < first + 2:
        return 0.0, np.inf
    one, two = first, first + 1
    power, before = _power(evidence, slice(one, two + 1))
    slope = (power[1] - power[0]) / (time[two] - time[one])
    begins = power[0] - slope * time[one]
    return (evidence.h / 4 * (begins - pushed),
            evidence.h / 4 * (abs(begins - power[0]) + before * abs(begins)))


def _power(evidence: Evidence, which: slice) -> tuple[Array, bool]:
    """(v - v at t = 0) . M a in some samples [W]; whether anything moved at t = 0."""
    a, free = evidence.run.arrays, evidence.model.bodies.free
    v0 = np.array([(*body.velocity, body.angular_velocity)
                   for body in evidence.model.mechanism.bodies])[free]
    weight = np.stack([a["body_mass"], a["body_mass"], a["body_inertia"]], axis=1)[free]
    v, change = (a[key][which][:, free] for key in ("body_velocity", "body_acceleration"))
    return np.einsum("nbi,nbi,bi->n", v - v0, change, weight), bool(v0.any())
