"""A mass on a spring that slides on a rough floor until it sticks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.verification.benchmarks.benchmark import (
    Benchmark,
    Criterion,
    Digit,
    Json,
    at,
    lag,
    spelled,
)

G, MASS, STIFFNESS, FRICTION, START = 9.81, 1.0, 10.0, 0.1, 0.5
RATE = (STIFFNESS / MASS)**0.5
HALF = np.pi / RATE
"""From turn to turn [s]."""
TURNS = (-0.3038, 0.1076, 0.0886)
"""2 μ g / ω² less each time; the last one is inside |x| ≤ μ g / ω², where it sticks."""


def scene(step: float) -> Json:
    """The spring acts at the floor's height, so that the block does not tilt."""
    return spelled(
        3.5, step, gravity=[0.0, -G], materials={"rough": {"friction": FRICTION}},
        bodies=[{"name": "floor", "motion": "fixed", "material": "rough",
                 "shapes": [{"type": "box", "size": [4.0, 0.2], "at": [0.0, -0.1]}]},
                {"name": "block", "mass": MASS, "at": [START, 0.05], "material": "rough",
                 "shapes": [{"type": "box", "size": [0.2, 0.1]}]}],
        springs=[{"type": "linear", "name": "spring", "a": "floor", "b": "block",
                  "on_a": [-2.0, 0.0], "on_b": [0.0, -0.05], "stiffness": STIFFNESS,
                  "rest_length": 2.0}])


def _turn(i: int, place: bool) -> Callable[[Recording], float]:
    """Of the cubic through the four samples before it, since friction changes sign there."""
    def found(run: Recording) -> float:
        near = np.abs(run.time - (i + 1) * HALF) < HALF / 4
        first = int(np.argmax(near))
        k = first + int(np.argmax((-1)**(i + 1) * run["block.x"][near]))
        t, x = run.time[k - 4:k], run["block.x"][k - 4:k]
        curve = np.polyfit(t - t[-1], x, 3)
        roots = np.roots(np.polyder(curve))
        root = float(roots[np.argmin(np.abs(roots))].real)
        return float(np.polyval(curve, root)) if place else float(t[-1]) + root

    return found


def _stop(run: Recording) -> float:
    """After the last sample in which it moves."""
    return float(run.time[np.flatnonzero(np.abs(run["block.vx"]) > 1e-9)[-1]])


FRICTION_OSCILLATOR = Benchmark(
    "friction_oscillator", "Friction oscillator",
    "A block of 1 kg on a spring of 10 N/m slides on a floor with μ = 0.1. It turns three times, "
    "each time 2 μ g m/k nearer, and sticks at the third.",
    "Textbook; siconos-tutorials has it as FrictionOscillator. Closed form.",
    "Nothing.",
    scene, (2e-3, 1e-3, 5e-4),
    (Criterion("places of the turns", "m",
               [Digit(f"turn {i + 1}", TURNS[i], _turn(i, True)) for i in range(2)]
               + [at("block.x", 3.4, TURNS[2], "sticks at")],
               lag(START, RATE, 3 * HALF) + 6 * FRICTION * G / RATE**2, RATE,
               "ω² = k/m: its phase; and in the step of each turn, of which there are three, "
               "friction may push the wrong way: 2 μ g h²", 2.0, steady=False),
     Criterion("instants of the turns", "s",
               [Digit(f"turn {i + 1}", (i + 1) * HALF, _turn(i, False)) for i in range(2)]
               + [Digit("sticks", 3 * HALF, _stop)],
               1.0, 3.0, "a block that turns stands still up to the end of that step: up to h "
               "late each time", 1.0, steady=False)),
    {"materials.rough.friction": 0.101})
BENCHMARKS = (FRICTION_OSCILLATOR,)
