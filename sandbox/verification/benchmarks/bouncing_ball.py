"""A ball that bounces on a floor until it lies: Newton's law of impact, again and again."""

from __future__ import annotations

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Digit, Json, spelled

G, DROP, RESTITUTION, RADIUS = 9.81, 1.0, 0.9, 0.1
SPEED = (2 * G * DROP)**0.5
"""At the first touch [m/s]."""
TOUCHES = (0.451523641, 1.264266195, 1.995734493, 2.654055962, 3.246545283)
APEXES = (0.81, 0.6561, 0.531441)
REST = 8.578949179
SLOW = 0.01
"""Speed of approach [m/s] from which on the engine gives nothing back."""
BLOWS = np.log(SLOW / SPEED) / np.log(RESTITUTION)
"""Down to that speed."""


def scene(step: float) -> Json:
    """The ball is let go with its lowest point 1 m above the floor."""
    return spelled(
        9.0, step, gravity=[0.0, -G],
        materials={"hard": {"friction": 0.0, "restitution": RESTITUTION}},
        bodies=[{"name": "floor", "motion": "fixed", "material": "hard",
                 "shapes": [{"type": "box", "size": [1.0, 0.2], "at": [0.0, -0.1]}]},
                {"name": "ball", "mass": 1.0, "at": [0.0, DROP + RADIUS], "material": "hard",
                 "shapes": [{"type": "circle", "radius": RADIUS}]}])


def blows(run: Recording) -> np.ndarray:
    """The samples in which a blow begins."""
    struck = np.asarray(run["ball/floor.normal"] > 2 * G)
    return np.flatnonzero(struck & ~np.concatenate([[False], struck[:-1]]))


def _touch(i: int) -> Digit:
    return Digit(f"touch {i + 1}", TOUCHES[i], lambda run: float(run.time[blows(run)[i]]))


def _apex(i: int) -> Digit:
    def found(run: Recording) -> float:
        first, last = blows(run)[i:i + 2]
        return float(run["ball.y"][first:last].max() - RADIUS)

    return Digit(f"apex {i + 1}", APEXES[i], found)


def _rest(run: Recording) -> float:
    """After the last sample in which it moves."""
    return float(run.time[np.flatnonzero(np.abs(run["ball.vy"]) > 1e-9)[-1]])


FLIGHT = 1 + (1 + RESTITUTION) * (2 - 1 / RESTITUTION)
"""Of each touch, in steps: its own, and what the blow before takes of the flight."""
GAINED = 2 * (1 + RESTITUTION)
"""Of all flights that follow, in steps, by the height that a blow gains."""
BOUNCING_BALL = Benchmark(
    "bouncing_ball", "Bouncing ball",
    "A ball falls by 1 m onto a floor that gives back 0.9 of its speed, and bounces until it "
    "lies, after t₁ (1 + e)/(1 − e) and endlessly many blows.",
    "siconos-tutorials, BouncingBallTS.cpp; closed form.",
    "Below 1 cm/s, from the 58th blow on, nothing is given back.",
    scene, (5e-4, 2e-4, 1e-4),
    (Criterion("heights of the first three apexes", "m", [_apex(i) for i in range(3)],
               len(APEXES) * DROP, (1 - RESTITUTION**2) * SPEED / DROP,
               "a blow is given in the step in which the gap would close, up to v h above the "
               "floor; of that way the ball keeps the energy that it should have lost, 1 − e²",
               1.0, floor=G * 5e-4**2 / 8, steady=False),
     Criterion("instants of the first five touches", "s", [_touch(i) for i in range(5)],
               1.0, 5 * FLIGHT, "each of them is found up to h early, and a blow that is given "
               "σ < h early shortens its flight by (1 + e)(2 − 1/e) σ", 1.0, steady=False),
     Criterion("instant from which on it lies", "s", [Digit("rest", REST, _rest)],
               1.0, (FLIGHT + GAINED) * float(BLOWS),
               "58 blows: their instants, and the energy that each keeps; and the last flights, "
               "below 1 cm/s, are not made", 1.0,
               floor=2 * RESTITUTION * SLOW / (G * (1 - RESTITUTION)), steady=False)),
    {"materials.hard.restitution": 0.89})
BENCHMARKS = (BOUNCING_BALL,)
