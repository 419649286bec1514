"""Four-bar linkages, free and driven."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.hard.measures import GAP, closed, energy
from tests.hard.trial import AtMost, Measure, Order, Trial, spell
from tests.hard.trials.chains import SECOND_ORDER
from tests.hard.truth.linkages import Linkage, elbow
from tests.verification.case import GROUND, body, hinge, point


def angle_error(names: tuple[str, ...], linkage: Linkage) -> Measure:
    """Largest error of any body's angle at any sample [rad]."""

    def of(run: Recording) -> float:
        found = np.stack([run[f"{name}.angle"] for name in names], axis=1)
        return float(np.abs(found - linkage.motion(run.time)[0]).max())

    return Measure("angle error", "rad", of)


BARS = (0.04, 0.12, 0.08)
BASE = 0.1
"""Crank, coupler, rocker and base [m]: 40 + 120 < 80 + 100, so the crank goes round (Grashof)."""


@cache
def grashof(speed: float) -> Linkage:
    """The crank up at the start; uniform bars of 1 kg/m."""
    crank, coupler, rocker = BARS
    tip = 1j * crank
    joint = elbow(tip, BASE + 0j, coupler, rocker, 1.0)
    start = (np.pi / 2, float(np.angle(joint - tip)), float(np.angle(joint - BASE)))
    still = Linkage(
        masses=BARS, inertias=tuple(m**3 / 12 for m in BARS), start=start, rate=(0.0,) * 3,
        arms=((crank / 2, 0.0, 0.0), (crank, coupler / 2, 0.0), (0.0, 0.0, rocker / 2)),
        loops=((crank, coupler, -rocker),))
    return Linkage(still.masses, still.inertias, still.arms, still.loops, start,
                   tuple(still.rates(speed).tolist()))


def four_bar(step: float, speed: float, duration: float, **more: Any) -> Mechanism:
    """The bars of :func:`grashof` as bodies, in motion as their loop wants it."""
    linkage = grashof(speed)
    angle, rate = np.array(linkage.start), np.array(linkage.rate)
    u = np.exp(1j * angle)
    velocity = linkage.A @ (1j * u * rate)
    at = (0j, BARS[0] * u[0], BASE + 0j)
    bars = [body(name, complex(at[i]), angle[i], BARS[i] / 2, BARS[i], linkage.inertias[i],
                 velocity=point(complex(velocity[i])), angular_velocity=rate[i])
            for i, name in enumerate(("crank", "coupler", "rocker"))]
    return spell(duration, step, bodies=[GROUND, *bars], joints=[
        hinge("ground", "crank"), hinge("crank", "coupler"), hinge("ground", "rocker"),
        hinge("coupler", "rocker", BARS[2])], **more)


def _free_loop() -> Trial:
    speed, linkage = 20.0, grashof(20.0)
    start = float(linkage.kinetic(np.array([linkage.start]), np.array([linkage.rate]))[0])

    def off(run: Recording) -> float:
        return float(np.abs(energy(run, 0.0) / start - 1).max())

    return Trial(
        "grashof", "free four-bar whose crank goes round at 20 rad/s, without weight, 2 s",
        lambda step: four_bar(step, speed, 2.0),
        (angle_error(("crank", "coupler", "rocker"), linkage), Measure("energy error", "", off),
         GAP),
        (closed(1e-3),
         AtMost("angle error", 1e-3, 2e-2, "(w h)^2 of the 40 rad turned; joints closed to first "
                "order lose ten times that"),
         AtMost("energy error", 1e-3, 3e-3, "no forces, no energy: it swings with (w h)^2"),
         Order("angle error", (1e-3, 5e-4), 1.8, SECOND_ORDER)))


def _driven_loop() -> Trial:
    speed = 10.0

    def rocker(t: float) -> float:
        """Where the loop has it, the crank at pi/2 + w t."""
        tip = BARS[0] * np.exp(1j * (np.pi / 2 + speed * t))
        return float(np.angle(elbow(complex(tip), BASE + 0j, BARS[1], BARS[2], 1.0) - BASE))

    def of(run: Recording) -> float:
        truth = np.array([rocker(float(t)) for t in run.time])
        return float(np.abs(run["rocker.angle"] - truth).max())

    return Trial(
        "four_bar", "the same driven at 10 rad/s by a motor of 1 N m, 1 s",
        lambda step: four_bar(step, speed, 1.0, drives=[
            {"type": "motor", "name": "motor", "joint": "ground_crank", "value": speed,
             "torque": 1.0}]),
        (Measure("rocker error", "rad", of), GAP),
        (closed(1e-3),
         AtMost("rocker error", 1e-3, 1e-5, "a constant speed is met in each step; gaps of 1e-6"),))


def trials() -> list[Trial]:
    return [_free_loop(), _driven_loop()]
