"""The slider-crank with clearance as published, up to the first touch of its guide."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Digit, Json
from sandbox.verification.benchmarks.slider_with_play import machine

TOUCH, UNTIL = 0.0026909036, 0.0026920
"""Of the upper left corner [s]; the next one follows at 0.0026922543 s."""
ANGLES = {"crank": 0.355129243, "rod": -0.171430644, "slider": -2.6909e-5}
BEFORE = {"crank": 109.58016850, "rod": -49.345789362}
AFTER = {"crank": 109.5706813989, "rod": -49.3858196402, "slider": 23.2874476872}
"""Rates [rad/s]."""
BLOW = 1.26440154e-3
"""Normal impulse [N s]."""
FRICTION = 0.01
SLOWS, FASTEST = 1.5e4, 125.0
"""Angular acceleration of crank and rod, rate of the crank, at most there [rad/s^2], [rad/s]."""


def scene(step: float) -> Json:
    """The slider begins to turn by −0.01 rad/s."""
    return machine(UNTIL - 4 * step, step, friction=FRICTION, turning=-0.01)


def _struck(run: Recording) -> int:
    return int(np.argmax(run["slider/upper.normal"] > 0))


def _rate(body: str, samples: int) -> Callable[[Recording], float]:
    return lambda run: float(run[f"{body}.omega"][_struck(run) + samples])


def _angle(body: str) -> Callable[[Recording], float]:
    return lambda run: float(run[f"{body}.angle"][_struck(run)])


def _impulse(quantity: str) -> Callable[[Recording], float]:
    """Of the one step in which it is."""
    def found(run: Recording) -> float:
        force = run[f"slider/upper.{quantity}"][_struck(run)]
        return float(abs(force) * run.info.step)

    return found


FIRST_TOUCH = Benchmark(
    "first_touch", "First touch of the slider with clearance",
    "The slider turns by −0.01 rad/s at the start and μ = 0.01, so one corner hits the guide "
    "before the other: the blow, slipping, and what it does to the three bodies.",
    "Flores, Leine and Glocker (2010), with the numbers of Siconos' example SliderCrank. Digits by "
    "an integration of order 8.",
    "Looked at up to just before the next corner hits, 1.35 μs later.",
    scene, (4e-7, 2e-7, 1e-7),
    (Criterion("instant", "s",
               [Digit("touch", TOUCH, lambda run: float(run.time[_struck(run)]))],
               1.0, 1.0, "the step in which it happens", 1.0, steady=False),
     Criterion("angles", "rad", [Digit(body, angle, _angle(body))
                                 for body, angle in ANGLES.items()],
               1.0, FASTEST, "ω h of the crank", 1.0, floor=1e-9, steady=False),
     Criterion("rates before", "rad/s", [Digit(body, rate, _rate(body, -1))
                                         for body, rate in BEFORE.items()],
               2.0, SLOWS, "of the last sample before the blow, two steps early at most", 1.0,
               steady=False),
     Criterion("rates after", "rad/s", [Digit(body, rate, _rate(body, 1))
                                        for body, rate in AFTER.items()],
               2.0, SLOWS, "of the first sample after it, two steps late at most", 1.0,
               steady=False),
     Criterion("impulses of the blow", "N s",
               [Digit("normal", BLOW, _impulse("normal")),
                Digit("friction", FRICTION * BLOW, _impulse("tangential"))],
               1.4 * 400.0 / 0.84 * BLOW, 1.0, "h of 400 m/s², by which the corner is nearing "
               "the guide at 0.84 m/s more slowly", 1.0, steady=False)),
    {"materials.steel.friction": 0.02}, quick=(4e-7, 2e-7))
BENCHMARKS = (FIRST_TOUCH,)
