"""Painlevé's rod: sliding friction that lifts, and what happens where no force can answer it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Digit, Json, spelled

G, APART = 9.81, 3.0


@dataclass(frozen=True)
class SlidingRod:
    """A rod of 1 m and 1 kg whose tip slides left over the floor, its centre to the right."""

    degrees: float
    friction: float
    force: float
    """N [weights]."""
    ax: float
    ay: float
    turn: float
    """Of its centre [m/s²], and about it [rad/s²]."""

    @property
    def steep(self) -> float:
        """How fast N and all that follows from it change, A N = m (g − φ'² l sin φ/2) [1/s²].

        After half a step, φ changes A by A' φ'' h²/8, and φ' = φ'' h/2.
        """
        angle = np.radians(self.degrees)
        c, s = np.cos(angle), np.sin(angle)
        slope = -6 * c * s - 3 * self.friction * (c**2 - s**2)
        return float(abs(slope * self.force * self.turn) / 8 + self.turn**2 * s / (8 * G))


RODS = (
    SlidingRod(45.0, 0.5, 0.571429, 2.802857, -4.204286, -11.891516),
    SlidingRod(60.0, 0.5, 0.908694, 4.457142, -0.895716, -3.582863),
    SlidingRod(60.0, 1.0, 2.217482, 21.753501, 11.943501, 47.774004),
    SlidingRod(60.0, 1.3, 16.326407, 208.210672, 150.352056, 601.408222),
)
CAUGHT = ((60.0, 1.6), (45.0, 2.0))
"""Angle and friction where A < 0."""
SPEED, SLOW, AFTER = 5.0, 1.0, 4
"""Of the tips [m/s]; of those that are caught; the sample in which these are looked at."""


def _rod(name: str, i: int, degrees: float, speed: float) -> Json:
    return {"name": name, "mass": 1.0, "inertia": 1 / 12, "at": [APART * i, 0.0],
            "angle": float(np.radians(degrees)), "centre": [0.5, 0.0], "velocity": [-speed, 0.0],
            "shapes": [{"type": "polygon",
                        "points": [[0.0, 0.0], [0.2, 0.002], [0.2, -0.002]]}]}


def scene(step: float) -> Json:
    """Those that slide, then those that are caught, on one floor."""
    slide = [(f"rod{i + 1}", r.degrees, r.friction, SPEED) for i, r in enumerate(RODS)]
    caught = [(f"caught{i + 1}", *one, SLOW) for i, one in enumerate(CAUGHT)]
    bodies = [_rod(name, i, degrees, speed)
              for i, (name, degrees, _, speed) in enumerate((*slide, *caught))]
    return spelled(
        4 * step, step, gravity=[0.0, -G],
        bodies=[{"name": "floor", "motion": "fixed",
                 "shapes": [{"type": "box", "size": [30.0, 0.2], "at": [7.5, -0.1]}]}, *bodies],
        contacts=[{"between": [name, "floor"], "friction": mu}
                  for name, _, mu, _ in (*slide, *caught)])


def _first(quantity: str, weight: float = 1.0) -> Callable[[Recording], float]:
    return lambda run: float(run[quantity][0] / weight)


def _sliding(what: str, quantity: str, of: Callable[[SlidingRod], float],
             weight: float = 1.0) -> list[Digit]:
    return [Digit(f"{rod.degrees:g}°, μ = {rod.friction:g}: {what}", of(rod),
                  _first(quantity.format(i + 1), weight)) for i, rod in enumerate(RODS)]


def _stuck(degrees: float) -> tuple[float, float, float]:
    """Rate, its change and N once the tip has been caught, [rad/s], [rad/s²], [weights]."""
    angle = np.radians(degrees)
    w, turn = 1.5 * np.sin(angle) * SLOW, -1.5 * G * np.cos(angle)
    normal = 1 + (turn * np.cos(angle) - w**2 * np.sin(angle)) / (2 * G)
    return float(w), float(turn), float(normal)


def _caught(i: int, degrees: float) -> Digit:
    """Less what the weight has done to it since."""
    def found(run: Recording) -> float:
        rate = run[f"caught{i + 1}.omega"][AFTER]
        return float(rate - _stuck(degrees)[1] * run.time[AFTER])

    return Digit(f"{degrees:g}°, μ = {CAUGHT[i][1]:g}: rate after it", _stuck(degrees)[0], found)


def _held(i: int, degrees: float) -> Digit:
    def found(run: Recording) -> float:
        return float(run[f"caught{i + 1}/floor.normal"][AFTER] / G)

    return Digit(f"{degrees:g}°, μ = {CAUGHT[i][1]:g}: N after it", _stuck(degrees)[2], found)


STEEP = max(RODS, key=lambda rod: rod.steep)
START = ("in half a step, to the first sample, the rod of μ = 1.3 turns by φ'' h²/8, which "
         "changes A, and comes to φ'' h/2, whose centripetal force is no longer 0")
JERK = 3 * max(abs(_stuck(degrees)[0] * _stuck(degrees)[1]) for degrees, _ in CAUGHT) / G
PAINLEVE = Benchmark(
    "painleve", "Painlevé's rod",
    "A rod at an angle φ from the floor, at rest but for its tip's sliding, away from its centre. "
    "With A = 1 + 3 cos φ (cos φ − μ sin φ) the floor gives m g/A, which grows beyond all bounds; "
    "where A < 0 there is no force, but an impact without a collision: the tip is caught.",
    "Painlevé (1895), Génot and Brogliato (1999); closed form.",
    "Nothing. Once caught, the tip is at rest, by moments about it: ω = 3 v sin φ/(2 l); then it "
    "sticks.",
    scene, (1e-3, 5e-4, 2.5e-4),
    (Criterion("N at the start", "weights", _sliding("N", "rod{}/floor.normal",
                                                     lambda rod: rod.force, G),
               STEEP.force, STEEP.steep**0.5, START, floor=2e-6),
     Criterion("accelerations of the centre", "m/s²",
               _sliding("x", "rod{}.ax", lambda rod: rod.ax)
               + _sliding("y", "rod{}.ay", lambda rod: rod.ay),
               STEEP.ax, STEEP.steep**0.5, START, floor=2e-5),
     Criterion("angular accelerations", "rad/s²",
               _sliding("φ''", "rod{}.alpha", lambda rod: rod.turn),
               STEEP.turn, STEEP.steep**0.5, START, floor=6e-5),
     Criterion("rates after an impact without collision", "rad/s",
               [_caught(i, degrees) for i, (degrees, _) in enumerate(CAUGHT)],
               1.0, 1.5 * G, "the impact is in the first step: φ'' h", 1.0, steady=False),
     Criterion("N after that", "weights",
               [_held(i, degrees) for i, (degrees, _) in enumerate(CAUGHT)],
               1.0, 5 * JERK, "of a rod that turns about its tip, N' = 3 ω φ'' m l at most, in "
               "five steps", 1.0, steady=False)),
    {"contacts[3].friction": 1.301})
BENCHMARKS = (PAINLEVE,)
