"""A disc pinched between two pads: friction that holds does not creep."""

from __future__ import annotations

from sandbox.recording.recording import Recording
from sandbox.study.orders import EXACT
from sandbox.verification.benchmarks.benchmark import (
    Benchmark,
    Criterion,
    Digit,
    Json,
    at,
    spelled,
)

G, MASS, RADIUS, FRICTION, PUSH = 9.81, 0.045, 0.004, 0.7, 12.0
WEAK = 0.99 * MASS * G / (2 * FRICTION)
"""A push a hundredth below what holds the disc [N]."""
SLIDES, HOLDS = 0.5, 2.0
"""When the one that is held too weakly is looked at, and the other [s]."""


def _pinched(name: str, x: float, push: float) -> tuple[list[Json], list[Json], list[Json]]:
    bodies: list[Json] = [{"name": name, "mass": MASS, "at": [x, 0.0], "material": "rubber",
                           "shapes": [{"type": "circle", "radius": RADIUS}]}]
    joints, drives = [], []
    for side, way in (("left", 1.0), ("right", -1.0)):
        pad = f"{name}_{side}"
        bodies.append({"name": pad, "mass": 0.02, "inertia": 1e-5, "material": "rubber",
                       "at": [x - way * (RADIUS + 0.005), 0.0],
                       "shapes": [{"type": "box", "size": [0.01, 0.5]}]})
        joints.append({"type": "slot", "name": f"{pad}_guide", "a": "frame", "b": pad,
                       "start": [x - 0.1, 0.0], "end": [x + 0.1, 0.0], "turns": False})
        drives.append({"type": "force", "name": f"{pad}_push", "body": pad,
                       "direction": [way, 0.0], "value": push})
    return bodies, joints, drives


def scene(step: float) -> Json:
    """One disc between pads of 12 N, another between pads that are a hundredth too weak."""
    held, slides = _pinched("held", 0.0, PUSH), _pinched("slides", 0.5, WEAK)
    return spelled(
        HOLDS, step, gravity=[0.0, -G], sample_rate=500.0,
        materials={"rubber": {"friction": FRICTION}},
        bodies=[{"name": "frame", "motion": "fixed"}, *held[0], *slides[0]],
        joints=[*held[1], *slides[1]], drives=[*held[2], *slides[2]])


def _force(side: str) -> Digit:
    def found(run: Recording) -> float:
        return abs(float(run[f"held/held_{side}.tangential"][-1]))

    return Digit(f"friction of the {side} pad", MASS * G / 2, found)


PINCH = Benchmark(
    "pinch", "Pinch that must not creep",
    "Two pads press 12 N each on a disc of 45 g, r = 4 mm, with μ = 0.7: it has to stay where it "
    "is. Soft contact models let it sink by 50 to 2300 μm/s.",
    "MuJoCo, issue 3328.",
    "A second disc is pressed a hundredth too weakly and has to slide, with 0.01 g.",
    scene, (2e-3, 1e-3, 5e-4),
    (Criterion("height after 2 s", "m", [at("held.y", HOLDS, 0.0)], 1.0, 1.0,
               "stays: 1 nm, a hundred times less than any soft contact's creep in 2 ms", EXACT,
               1e-9),
     Criterion("friction at rest", "N", [_force("left"), _force("right")], 1.0, 1.0,
               "half the weight, nine digits", EXACT, 1e-9),
     Criterion("way of the one that slides", "m",
               [at("slides.y", SLIDES, -0.01 * G * SLIDES**2 / 2)], 1.0, 1.0,
               "a constant force: exact; it begins within g h²/8 = 5 μm of that", EXACT,
               G * 2e-3**2 / 8)),
    {"materials.rubber.friction": 0.703})
BENCHMARKS = (PINCH,)
