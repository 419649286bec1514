"""IFToMM's A01: a point mass on a massless rod."""

from __future__ import annotations

import math

from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Json, at, spelled
from sandbox.verification.benchmarks.pieces import GROUND, G, mass

LENGTH = 1.0
TIPS = {
    1.0: (0.986291751132, -0.165010853126),
    2.0: (-0.793566195343, -0.608483930444),
    4.0: (0.577563628249, -0.816345671468),
    10.0: (-0.275087462576, -0.961419205099),
}
"""x and y of the mass [m]: sin(theta/2) = k sn(K - t sqrt(g/l), k), k = sin 45 deg."""
FASTEST = math.sqrt(2 * G / LENGTH)
"""At the bottom [rad/s]."""


def scene(step: float) -> Json:
    """Level at the start, at rest."""
    return spelled(10.0, step, gravity=[0.0, -G], bodies=[GROUND, mass("bob", 1.0, -LENGTH)],
                   joints=[{"type": "rod", "name": "rod", "a": "ground", "b": "bob"}])


BENCHMARKS = (Benchmark(
    "a01", "Simple pendulum (A01)",
    "A point mass of 1 kg on a massless rod of 1 m, let go level, for 10 s.",
    "IFToMM library of computational benchmark problems, A01. Digits by Jacobi's elliptic "
    "functions.",
    "Nothing; compared at four instants of the ten seconds.",
    scene, (2e-3, 1e-3, 5e-4),
    (Criterion("place of the mass", "m",
               [at(f"bob.{axis}", t, x) for t, row in TIPS.items()
                for axis, x in zip("xy", row, strict=True)],
               LENGTH * FASTEST * 10.0, FASTEST, "way at full speed for 10 s, ω² = 2 g/l"),),
    {"bodies[bob].at[0]": -1.01 * LENGTH}, drawn="pendulum A01"),)
