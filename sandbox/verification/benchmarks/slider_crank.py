"""The slider-crank of Flores, Leine and Glocker (2010)."""

from __future__ import annotations

import math

from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Json, at, spelled
from sandbox.verification.benchmarks.pieces import GROUND, G, body, pin

CRANK, ROD = 0.153, 0.306
MASSES, INERTIAS = (0.038, 0.038, 0.076), (7.4e-5, 5.9e-4, 2.7e-6)
"""Of crank, rod and slider."""
RATES = (150.0, -75.0)
"""Of crank and rod at the start, both level [rad/s]."""
COURSE = {
    0.01: (0.1508818943, 67.562263), 0.02: (0.2571128030, 72.282978),
    0.05: (0.7654140217, 68.749509), 0.1: (1.4547004378, 144.406332),
    0.2: (2.9275677994, 97.139411),
}
"""Turns of the crank and its rate [rad/s]."""
TURNS = 3.0


def crank_and_rod() -> list[Json]:
    """Both level at the start, the crank at 150 rad/s."""
    tip = CRANK * RATES[0]
    return [
        body("crank", 0.0, 0.0, CRANK / 2, MASSES[0], INERTIAS[0], velocity=[0.0, tip / 2],
             angular_velocity=RATES[0]),
        body("rod", CRANK, 0.0, ROD / 2, MASSES[1], INERTIAS[1], velocity=[0.0, tip / 2],
             angular_velocity=RATES[1])]


def scene(step: float) -> Json:
    """The slider in a groove that does not let it turn."""
    slider = body("slider", CRANK + ROD, 0.0, 0.0, MASSES[2], INERTIAS[2])
    return spelled(
        0.2, step, gravity=[0.0, -G], bodies=[GROUND, *crank_and_rod(), slider],
        joints=[pin("ground", "crank"), pin("crank", "rod"), pin("rod", "slider"),
                {"type": "slot", "name": "groove", "a": "ground", "b": "slider", "turns": False,
                 "start": [0.1, 0.0], "end": [0.6, 0.0]}],
        meters=[{"name": "turns", "value": "=crank.angle / tau", "unit": "1"}])


FASTEST = 2 * RATES[0]
"""At which the slider's kinetic energy comes and goes, twice a turn [rad/s]."""
WHY = "three turns times (2 h ω)²: what the slider takes comes and goes twice a turn"
BENCHMARKS = (Benchmark(
    "slider_crank", "Slider-crank without clearance",
    "A crank of 153 mm at 150 rad/s, a rod of 306 mm, a slider on the x axis, nothing drives it; "
    "weight, 0.2 s.",
    "Flores, Leine and Glocker (2010), with the numbers of Siconos' example SliderCrank. Digits by "
    "an integration of order 8 in one coordinate.",
    "No clearance, so that the motion is smooth: the slider is on its axis and level.",
    scene, (2e-4, 1e-4, 5e-5),
    (Criterion("turns of the crank", "1", [at("turns", t, row[0]) for t, row in COURSE.items()],
               TURNS, FASTEST, WHY, floor=1e-9),
     Criterion("rate of the crank", "rad/s",
               [at("crank.omega", t, row[1]) for t, row in COURSE.items()],
               FASTEST * math.tau * TURNS, FASTEST, f"2 ω of {WHY}", floor=1e-6)),
    {"bodies[slider].mass": 1.01 * MASSES[2]}, drawn="slider-crank"),)
