"""Newton's cradle."""

from __future__ import annotations

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.hard.trial import AtMost, Measure, Trial, spell
from tests.hard.truth.integrate import motion

G = 9.81
RADIUS = 0.01
CORD, RAISED, BALLS = 0.2, 0.5, 5
"""Of the cradle: length of its cords [m], angle of its first ball [rad]."""


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
    return [_cradle()]
