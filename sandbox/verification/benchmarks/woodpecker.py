"""The woodpecker toy: a sleeve that jams on a pole, a bird on a spring that pecks it loose."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Digit, Json, spelled

G = 9.81
POLE, HOLE, HALF = 0.0025, 0.0031, 0.0058
"""Radius of the pole, of the hole in the sleeve; half the sleeve's height [m]."""
ARM, TAIL, BEAK = 0.010, 0.015, (-0.0201, 0.02)
"""From the sleeve to the spring, from there to the bird's centre, from there to the beak [m]."""
MASSES, INERTIAS = (3e-4, 4.5e-3), (5e-9, 7e-7)
"""Of sleeve and bird."""
STIFFNESS, FRICTION, RESTITUTION = 0.0056, 0.3, 0.5
"""Of the spring [N m/rad]; of all contacts; of the beak."""
START = (-0.1034, -0.2788)
"""Angles of sleeve and bird [rad]."""
SPEED, RATE = -0.3411, -7.4583
"""Of the sleeve [m/s] and the bird [rad/s]."""
CYCLE = (0.13075, -0.014500)
"""Period [s] and way down in it [m]."""
ANGLES = (-0.47797, 0.09466)
"""Of the bird, at least, and of the sleeve, at most, in the cycle [rad]."""
CYCLES, UNTIL = 4, 1.2
"""That are looked at, the last ones of so many seconds."""


def scene(step: float) -> Json:
    """The pole's right side; the sleeve's inner edge there, its centre led along the pole."""
    sleeve, bird = START
    joint = ARM * np.array([np.cos(sleeve), np.sin(sleeve)])
    along = np.array([np.cos(bird), np.sin(bird)])
    centre = joint + TAIL * along
    moved = np.array([0.0, SPEED]) + TAIL * RATE * np.array([-along[1], along[0]])
    x, y = BEAK
    return spelled(
        UNTIL, step, gravity=[0.0, -G],
        materials={"wood": {"friction": FRICTION, "restitution": RESTITUTION},
                   "metal": {"friction": FRICTION, "restitution": 0.0}},
        bodies=[
            {"name": "pole", "motion": "fixed", "material": "wood",
             "shapes": [{"type": "box", "size": [2 * POLE, 1.0], "at": [0.0, -0.4]}]},
            {"name": "line", "motion": "fixed"},
            {"name": "sleeve", "mass": MASSES[0], "inertia": INERTIAS[0], "centre": [0.0, 0.0],
             "angle": sleeve, "velocity": [0.0, SPEED], "material": "metal",
             "shapes": [{"type": "box", "size": [0.002, 2 * HALF], "at": [HOLE + 0.001, 0.0]}]},
            {"name": "bird", "mass": MASSES[1], "inertia": INERTIAS[1], "centre": [0.0, 0.0],
             "at": centre.tolist(), "angle": bird, "velocity": moved.tolist(),
             "angular_velocity": RATE, "material": "wood", "shapes": [
                 {"type": "polygon",
                  "points": [[x, y], [x + 0.003, y + 0.001], [x + 0.003, y - 0.001]]}]}],
        joints=[{"type": "slot", "name": "guide", "a": "line", "b": "sleeve",
                 "start": [0.0, -1.0], "end": [0.0, 0.5]},
                {"type": "pin", "name": "tail", "a": "sleeve", "b": "bird",
                 "on_a": [ARM, 0.0], "on_b": [-TAIL, 0.0]}],
        springs=[{"type": "rotary", "name": "spring", "joint": "tail", "stiffness": STIFFNESS,
                  "rest_angle": 0.0}])


def cycles(time: np.ndarray, height: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """When the bird's angle passes 0 upwards [s], and the sleeve's height then [m], [2, n]."""
    k = np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0))
    share = -angle[k] / (angle[k + 1] - angle[k])
    return np.stack([x[k] + share * (x[k + 1] - x[k]) for x in (time, height)])


def _mean(row: int) -> Callable[[Recording], float]:
    def found(run: Recording) -> float:
        passed = cycles(run.time, run["sleeve.y"], run["bird.angle"])[row, -CYCLES - 1:]
        return float((passed[-1] - passed[0]) / CYCLES)

    return found


def _late(quantity: str, sense: float) -> Callable[[Recording], float]:
    return lambda run: float(sense * (sense * run[quantity][run.time > UNTIL / 2]).max())


EVENTS = 4
"""Blows of a cycle: the beak, twice the sleeve, and when it comes loose."""
WOODPECKER = Benchmark(
    "woodpecker", "Woodpecker toy",
    "A sleeve with play slides down a pole; a bird on a spring tilts it, so that it jams by "
    "friction at its edges, swings back, hits the pole with its beak, and shakes it loose.",
    "Pfeiffer and Glocker; data of Siconos' example Woodpecker.",
    "Siconos and the papers make gaps and arms of first order in the angles, whose limit cycle "
    "has 0.14607 s and 19.476 mm; rigid bodies in a plane cannot be told to. With real corners "
    "the beak's way at 0.48 rad is another, and the cycle has 0.13075 s and 14.50 mm: digits by "
    "time stepping (Moreau) in three coordinates at 1 μs, a program that with gaps of first order "
    "comes to 0.1460 s and 19.45 mm. The sleeve is led along the pole's middle, as in the papers, "
    "and starts where it just touches, at −0.1034 rad.",
    scene, (1e-4, 5e-5, 2e-5),
    (Criterion("period", "s", [Digit("period", CYCLE[0], _mean(0))],
               1.0, EVENTS, "four blows a cycle, each within its step", 1.0, floor=1e-5,
               steady=False),
     Criterion("way down in a cycle", "m", [Digit("way", CYCLE[1], _mean(1))],
               0.5, EVENTS, "the same, at up to 0.5 m/s", 1.0, floor=1e-6, steady=False),
     Criterion("angles in the cycle", "rad",
               [Digit("bird, least", ANGLES[0], _late("bird.angle", -1.0)),
                Digit("sleeve, largest", ANGLES[1], _late("sleeve.angle", 1.0))],
               1.0, 16.0, "a blow within its step, at up to 16 rad/s", 1.0, floor=1e-5,
               steady=False)),
    {"materials.wood.friction": 0.29, "materials.metal.friction": 0.29})
BENCHMARKS = (WOODPECKER,)
