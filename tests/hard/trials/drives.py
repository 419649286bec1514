"""Motors and schedules: what moves by a given law, and what it does to what hangs on it."""

from __future__ import annotations

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.hard.trial import AtMost, Measure, Order, Trial, spell


def swinging_motor(step: float) -> Mechanism:
    """A wheel whose motor follows 5 sin(4 pi t) rad/s."""
    return spell(
        1.0, step, joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "wheel",
                             "on_b": (0.0, 0.0)}],
        bodies=[{"name": "wall", "motion": "fixed"},
                {"name": "wheel", "mass": 0.05, "inertia": 2e-5}],
        drives=[{"type": "motor", "name": "motor", "joint": "pin", "torque": 1.0,
                 "value": "=5 * sin(4 * pi * t)"}])


def _motor() -> Trial:
    def of(run: Recording) -> float:
        truth = 5 / (4 * np.pi) * (1 - np.cos(4 * np.pi * run.time))
        return float(np.abs(run["wheel.angle"] - truth).max())

    return Trial(
        "motor", "a motor whose speed is 5 sin(4 pi t), 1 s", swinging_motor,
        (Measure("angle error", "rad", of),),
        (AtMost("angle error", 1e-3, 1e-5, "the midpoint rule: h^2 / 24 of w' = 63 rad/s^2, "
                "and as much again for the first half step"),
         Order("angle error", (1e-3, 5e-4), 1.8, "asked: motors at mid-step")))


def started_schedule(step: float) -> Mechanism:
    """1 kg pinned to a body that a schedule moves at 0.5 m/s from the first instant on."""
    return spell(
        0.1, step, joints=[{"type": "pin", "name": "pin", "a": "cart", "b": "load",
                             "on_b": (0.0, 0.0)}],
        bodies=[{"name": "cart", "motion": "scheduled", "path": {"x": "=0.5 * t"}},
                {"name": "load", "mass": 1.0, "inertia": 1e-3, "velocity": (0.5, 0.0)}])


def _schedule() -> Trial:
    return Trial(
        "schedule", "1 kg pinned to a body that starts in motion on a schedule, 0.5 m/s",
        started_schedule,
        (Measure("reaction", "N", lambda run: float(run["pin.reaction"].max())),
         Measure("place error", "m", lambda run: float(
             np.abs(run["cart.x"] - 0.5 * run.time).max())),
         Measure("speed error", "m/s", lambda run: float(
             np.abs(run["cart.vx"] - 0.5).max()))),
        (AtMost("reaction", 1e-3, 1e-6, "both move alike: nothing to carry"),
         AtMost("place error", 1e-3, 1e-9, "a schedule is a place over time"),
         AtMost("speed error", 1e-3, 1e-9, "and has its speed from the start")))


def trials() -> list[Trial]:
    return [_motor(), _schedule()]
