"""A rod that topples on its tip: the floor's force, and where it begins to slip."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Digit, Json, spelled

G, LENGTH, MASS, START, APART = 9.81, 0.5, 0.2, 0.1, 2.0
ONSET = {0.1: 7.663677, 0.2: 15.519254, 0.3: 24.165715, 0.4: 51.422928, 0.5: 51.977855,
         0.8: 53.329357}
"""Where it begins to slip [deg], by friction: backward up to 0.3, forward from 0.4 on."""
ROUGH = tuple(ONSET).index(0.8) + 1
"""The rod that slips last."""
UPRIGHT, STEEPEST, TURNS = np.radians(45.0), 0.370579413, 48.1896851
"""Up to where forces are compared [rad]; the largest F/N; where F changes sign [deg]."""
SETTLED = 2
"""Samples that are left out: a contact that begins in motion."""


def rate(angle: float) -> float:
    """Of a rod that fell from upright, at an angle [rad]: ω² = 3 g (1 − cos θ)/l [rad/s]."""
    return float(np.sqrt(3 * G / LENGTH * (1 - np.cos(angle))))


def scene(step: float) -> Json:
    """One rod for each friction, at 0.1 rad and as fast as if it came from upright."""
    half, turn = LENGTH / 2, rate(START)
    rods: list[Json] = [{
        "name": f"rod{i + 1}", "mass": MASS, "inertia": MASS * LENGTH**2 / 12,
        "centre": [0.0, half], "at": [APART * i, 0.0], "angle": -START,
        "angular_velocity": -turn,
        "velocity": [turn * half * np.cos(START), -turn * half * np.sin(START)],
        "shapes": [{"type": "polygon", "points": [[0.0, 0.0], [1e-3, 0.1], [-1e-3, 0.1]]}],
    } for i in range(len(ONSET))]
    return spelled(
        0.55, step, gravity=[0.0, -G],
        bodies=[{"name": "floor", "motion": "fixed",
                 "shapes": [{"type": "box", "size": [20.0, 0.2], "at": [5.0, -0.1]}]}, *rods],
        contacts=[{"between": [f"rod{i + 1}", "floor"], "friction": mu}
                  for i, mu in enumerate(ONSET)])


def _contact(run: Recording, i: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle from upright [rad], N and F in weights, F along the fall."""
    pair = f"rod{i}/floor"
    return (-run[f"rod{i}.angle"], run[f"{pair}.normal"] / (MASS * G),
            -run[f"{pair}.tangential"] / (MASS * G))


def _onset(i: int, mu: float) -> Callable[[Recording], float]:
    """In the middle of the last sample inside the cone of friction and the first at its edge."""
    def found(run: Recording) -> float:
        angle, normal, along = _contact(run, i)
        k = int(np.argmax(np.abs(along) >= mu * normal * (1 - 1e-9)))
        return float(np.degrees(angle[k - 1] + angle[k]) / 2)

    return found


def _forces(run: Recording) -> tuple[np.ndarray, np.ndarray]:
    """By how much N and F of every sample are off, in weights, up to 45 degrees."""
    angle, normal, along = (values[SETTLED:] for values in _contact(run, ROUGH))
    upright = angle < UPRIGHT
    c, s = np.cos(angle[upright]), np.sin(angle[upright])
    return (np.abs(normal[upright] - (3 * c - 1)**2 / 4),
            np.abs(along[upright] - 0.75 * s * (3 * c - 2)))


def _steepest(run: Recording) -> float:
    angle, normal, along = _contact(run, ROUGH)
    return float((along / normal)[angle < UPRIGHT].max())


def _turns(run: Recording) -> float:
    angle, _, along = _contact(run, ROUGH)
    k = int(np.argmax(along < 0))
    share = along[k - 1] / (along[k - 1] - along[k])
    return float(np.degrees(angle[k - 1] + share * (angle[k] - angle[k - 1])))


FAST = rate(float(np.radians(max(ONSET.values()))))
TOPPLING_ROD = Benchmark(
    "toppling_rod", "Toppling rod",
    "A thin uniform rod falls over from upright. While its tip sticks the floor carries "
    "N = m g (3 cos θ − 1)²/4 and F = ¾ m g sin θ (3 cos θ − 2); it slips where |F| exceeds μ N, "
    "backward or forward.",
    "Textbook; closed form.",
    "It is met at 0.1 rad, with the rate that it has there. Of a contact that begins in motion "
    "the first two samples are off, by half of the centripetal force, up and down, whatever the "
    "step; they are left out. The tip is a corner of 1 : 50. "
    "μ = 0.37 (34.3°) is left out: with F/N ≤ 0.370579 its place hangs on 2 · 10⁻³ of F/N.",
    scene, (1e-3, 5e-4, 2.5e-4),
    (Criterion("force of the floor, every sample up to 45°", "weights",
               [Digit("largest error of N", 0.0, lambda run: float(_forces(run)[0].max())),
                Digit("largest error of F", 0.0, lambda run: float(_forces(run)[1].max())),
                Digit("largest F/N", STEEPEST, _steepest)],
               1.0, FAST, "(ω h)²"),
     Criterion("angles at which slip begins", "deg",
               [Digit(f"μ = {mu:g}", angle, _onset(i + 1, mu))
                for i, (mu, angle) in enumerate(ONSET.items())],
               np.degrees(2.0), FAST, "the step in which it begins, ω h; and what F/N, off by "
               "that, makes of it", 1.0, steady=False),
     Criterion("angle at which friction changes sign", "deg", [Digit("F = 0", TURNS, _turns)],
               np.degrees(1.0), FAST, "(ω h)²; and between two samples", 2.0, steady=False)),
    {"bodies[rod6].inertia": 1.02 * MASS * LENGTH**2 / 12})
BENCHMARKS = (TOPPLING_ROD,)
