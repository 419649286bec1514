"""A string over a disc: its length as geometry."""

from __future__ import annotations

import math

from sandbox.study.orders import EXACT
from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Json, at, spelled
from sandbox.verification.benchmarks.pieces import GROUND

DISC, LEFT, RIGHT = 0.03, -0.10 - 0.05j, 0.08 - 0.12j
"""Radius about the origin; ends of the string [m]."""
LENGTH = 0.3065998890546526
"""Over the top of the disc [m]."""


def wrapped(left: complex, right: complex, radius: float) -> float:
    """Length of a string over a disc at the origin: two tangents and the arc between [m]."""
    a, b = abs(left), abs(right)
    between = math.pi + math.atan2(-right.imag, right.real) + math.atan2(-left.imag, -left.real)
    arc = between - math.acos(radius / a) - math.acos(radius / b)
    return math.sqrt(a * a - radius**2) + math.sqrt(b * b - radius**2) + radius * arc


MOVED = {0.5: 0.08 - 0.10j, 1.0: 0.08 - 0.08j}
"""Where the right end is later, led upwards at 40 mm/s."""


def scene(step: float) -> Json:
    """The left end is held, the right one led, and the string carries a weight that feels it."""
    return spelled(
        1.0, step,
        bodies=[GROUND, {"name": "end", "motion": "scheduled", "at": [RIGHT.real, RIGHT.imag],
                         "path": {"y": "=-0.12 + 0.04 * t"}}],
        tendons=[{"name": "string", "guides": [
            {"body": "ground", "at": [LEFT.real, LEFT.imag]},
            {"body": "ground", "radius": DISC, "side": "right"}, {"body": "end"}]}])


BENCHMARKS = (Benchmark(
    "wrapping", "String over a disc",
    "A string from (−0.10, −0.05) over the top of a disc of 30 mm at the origin to (0.08, −0.12) "
    "m: its length.",
    "The wrapping of MuJoCo's tendons, which gives the same 15 digits; closed form: two tangents "
    "and the arc between them.",
    "The right end is led upwards, so that the arc changes, and looked at in two more places.",
    scene, (2e-3, 1e-3, 5e-4),
    (Criterion("length of the string", "m",
               [at("string.length", 0.0, LENGTH),
                *(at("string.length", t, wrapped(LEFT, z, DISC)) for t, z in MOVED.items())],
               0.0, 1.0, "geometry alone: rounding, and 1e-12 of the cubic between samples", EXACT,
               2e-12),),
    {"tendons[string].guides[1].radius": 1.01 * DISC}),)
