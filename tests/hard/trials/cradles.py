"""Balls that touch and are struck together: one after the other, the fastest approach first."""

from __future__ import annotations

from functools import partial

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.hard.trial import AtMost, Measure, Trial, spell
from tests.hard.truth.contacts import struck_in_sequence
from tests.hard.truth.integrate import motion

G = 9.81
RADIUS, SPEED, WAY = 0.01, 1.0, 0.01
CORD, RAISED, BALLS = 0.2, 0.5, 5
"""Of the cradle: length of its cords [m], angle of its first ball [rad]."""


def row(balls: int, restitution: float, step: float) -> Mechanism:
    """A ball that runs into others, which touch, on a plane without weight."""
    bodies = [{"name": f"ball{i}", "mass": 0.1, "material": "hard",
               "at": (2 * RADIUS * i - (0.0 if i else WAY), 0.0),
               "velocity": (0.0 if i else SPEED, 0.0),
               "shapes": [{"type": "circle", "radius": RADIUS}]} for i in range(balls)]
    return spell(0.03, step, bodies=bodies,
                 materials={"hard": {"friction": 0.0, "restitution": restitution}})


def _row(balls: int, restitution: float) -> Trial:
    truth = struck_in_sequence([SPEED, *[0.0] * (balls - 1)], restitution)

    def off(run: Recording) -> float:
        return float(max(abs(run[f"ball{i}.vx"][-1] - truth[i]) for i in range(balls)))

    shown = ", ".join(f"{v:.3g}" for v in truth)
    return Trial(
        f"row_{balls}_e{restitution:g}", f"{balls} balls, e = {restitution:g}: {shown} m/s",
        partial(row, balls, restitution), (Measure("speed error", "m/s", off),), tuple(
            AtMost("speed error", step, 1e-6, "impacts in sequence, whatever the step")
            for step in (1e-3, 5e-4)))


def cradle(step: float) -> Mechanism:
    """Five balls that touch, each on a pin of its own, the first raised and let go."""
    bodies = [{"name": f"ball{i}", "mass": 0.1, "material": "hard", "at": (2 * RADIUS * i, 0.0),
               "angle": 0.0 if i else -RAISED, "centre": (0.0, -CORD), "inertia": 5e-6,
               "shapes": [{"type": "circle", "radius": RADIUS, "at": (0.0, -CORD)}]}
              for i in range(BALLS)]
    return spell(
        0.6, step, gravity=(0.0, -G), bodies=[{"name": "beam", "motion": "fixed"}, *bodies],
        materials={"hard": {"friction": 0.0, "restitution": 1.0}},
        joints=[{"type": "pin", "name": f"pin{i}", "a": "beam", "b": f"ball{i}",
                 "on_b": (0.0, 0.0)} for i in range(BALLS)])


def _cradle() -> Trial:
    pivot = 5e-6 + 0.1 * CORD**2

    def swing(times: np.ndarray) -> np.ndarray:
        """Of the first ball to the impact, of the last one from there on: one pendulum [rad]."""
        return motion(times, lambda q, _: -0.1 * G * CORD / pivot * np.sin(q),
                      np.array([-RAISED]), np.zeros(1))[0, :, 0]

    def first_last(run: Recording) -> float:
        truth = swing(run.time)
        return float(max(np.abs(run["ball0.angle"] - np.minimum(truth, 0.0)).max(),
                         np.abs(run[f"ball{BALLS - 1}.angle"] - np.maximum(truth, 0.0)).max()))

    def middle(run: Recording) -> float:
        return float(max(np.abs(run[f"ball{i}.angle"]).max() for i in range(1, BALLS - 1)))

    late = "the impact falls on a step: up to h late at 3.5 rad/s"
    return Trial(
        "cradle", "Newton's cradle, five balls on pins, from letting go to the far turn", cradle,
        (Measure("swing error", "rad", first_last), Measure("middle's swing", "rad", middle)),
        tuple(target for step in (1e-3, 5e-4) for target in (
            AtMost("swing error", step, 5 * step, late),
            AtMost("middle's swing", step, 5 * step, "they pass the blow on and stay"))))


def trials() -> list[Trial]:
    return [*(_row(balls, e) for e in (1.0, 0.9) for balls in (2, 3, 5)), _cradle()]
