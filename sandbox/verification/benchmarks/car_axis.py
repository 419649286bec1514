"""The car axis of the IVP test set: two small masses on stiff springs above a rocking axle."""

from __future__ import annotations

from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Json, at, lag, spelled
from sandbox.verification.benchmarks.pieces import mass

MASS, STIFFNESS, REST = 5e-4, 1.0, 0.5
"""eps^2 M / 2 with eps = 0.01, M = 10; of either spring [N/m], [m]."""
RATE = (STIFFNESS / MASS)**0.5
PLACES = {
    0.5: (0.047887818062, 0.497089687181, 1.043577149976, 0.404338653155),
    1.0: (0.027182095440, 0.498911552629, 1.024548795970, 0.426388006981),
    2.0: (-0.045604483643, 0.497445343219, 0.951740760593, 0.570263361597),
    3.0: (0.0493455784275, 0.496989460230, 1.041742524885, 0.373911027265),
}
"""x and y of the left mass, x and y of the right one [m]."""
VELOCITIES = (-0.0770583684041, 0.0074468665872, 0.0175568157537, 0.7703410437793)
"""The same order, at 3 s [m/s]."""


def scene(step: float) -> Json:
    """The axle turns about its left end; the left mass slides on the axle's own y axis."""
    def spring(name: str, x: float) -> Json:
        return {"type": "linear", "name": f"{name}_spring", "a": "axle", "b": name,
                "on_a": [x, 0.0], "stiffness": STIFFNESS, "rest_length": REST}

    return spelled(
        3.0, step, gravity=[0.0, -1.0],
        bodies=[{"name": "axle", "motion": "scheduled",
                 "path": {"angle": "=asin(0.1 * sin(10 * t))"}},
                *(mass(name, MASS, z, velocity=[-0.5, 0.0])
                  for name, z in (("left", 0.5j), ("right", 1.0 + 0.5j)))],
        joints=[{"type": "slot", "name": "slide", "a": "axle", "b": "left",
                 "start": [0.0, 0.2], "end": [0.0, 0.8]},
                {"type": "rod", "name": "body", "a": "left", "b": "right", "length": 1.0}],
        springs=[spring("left", 0.0), spring("right", 1.0)])


QUANTITIES = ("left.x", "left.y", "right.x", "right.y")
SPEEDS = ("left.vx", "left.vy", "right.vx", "right.vy")
WHY = "ω² = k/m: after ω t the phase of 0.1 m is (h ω)² ω t / 24 off"
CAR_AXIS = Benchmark(
    "car_axis", "Car axis",
    "A massless axle rocks about its left end, y_r = 0.1 sin 10 t at its right; two masses of "
    "0.5 g, 1 m apart, stand on it on springs of 1 N/m, the left one led along the axle's normal. "
    "A differential-algebraic problem of index 3.",
    "Test Set for IVP Solvers (Mazzia and Magherini, Bari). Digits at 3 s are the test set's, the "
    "others those of an integration of order 8 that meets them to ten digits.",
    "Nothing. The masses have an inertia that nothing turns.",
    scene, (1e-3, 5e-4, 2.5e-4),
    (Criterion("places of both masses", "m",
              [at(q, t, x) for t, row in PLACES.items()
               for q, x in zip(QUANTITIES, row, strict=True)],
              lag(0.1, RATE, 3.0), RATE, WHY),
     Criterion("velocities of both masses", "m/s",
              [at(q, 3.0, v) for q, v in zip(SPEEDS, VELOCITIES, strict=True)],
              RATE * lag(0.1, RATE, 3.0), RATE, WHY)),
    {"bodies[right].mass": 1.01 * MASS}, drawn="car axis")
BENCHMARKS = (CAR_AXIS,)
