"""Rods that turn while they touch: a contact stays one, and its force is smooth."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.hard.trial import AtMost, Measure, Target, Trial, spell
from tests.hard.truth.rods import G, Rod

TOPPLING = Rod(0.2, 0.5, 1e-3, 0.1)
LADDER = Rod(1.0, 1.0, 1e-3, float(np.radians(30.0)))
STEPS = (5e-4, 1e-4)


def _rod(rod: Rod, at: tuple[float, float], angle: float) -> dict[str, Any]:
    return {"name": "rod", "at": at, "angle": angle, "mass": rod.mass, "inertia": rod.inertia,
            "centre": (0.0, rod.length / 2), "material": "surface", "shapes": [
                {"type": "capsule", "end": (0.0, rod.length), "radius": rod.radius}]}


def _ground(name: str, size: tuple[float, float], at: tuple[float, float]) -> dict[str, Any]:
    return {"name": name, "motion": "fixed", "material": "surface",
            "shapes": [{"type": "box", "size": size, "at": at}]}


FLOOR = _ground("floor", (4.0, 0.1), (0.0, -0.05))


def toppling(step: float) -> Mechanism:
    """On a floor so rough that it rolls to 43 deg: F / N is 0.37 at most."""
    return spell(0.5, step, gravity=(0.0, -G), materials={"surface": {"friction": 0.8}}, bodies=[
        FLOOR, _rod(TOPPLING, (0.0, TOPPLING.radius), -TOPPLING.start)])


def ladder(step: float) -> Mechanism:
    """Between smooth floor and wall, the wall at x = 0, its upper end there; to 47 deg."""
    r, far = LADDER.radius, LADDER.length * np.sin(LADDER.start)
    return spell(0.27, step, gravity=(0.0, -G), materials={"surface": {"friction": 0.0}}, bodies=[
        FLOOR, _ground("wall", (0.1, 4.0), (-0.05, 1.0)),
        _rod(LADDER, (r + float(far), r), LADDER.start)])


def _trial(name: str, what: str, machine: Callable[[float], Mechanism], rod: Rod,
           truth: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], sense: float,
           forces: tuple[str, str]) -> Trial:
    def angle(run: Recording) -> float:
        return float(np.abs(sense * run["rod.angle"] - truth(run.time)[0]).max())

    def force(quantity: str, row: int) -> Callable[[Recording], float]:
        def of(run: Recording) -> float:
            off = np.abs(run[quantity]) - np.abs(truth(run.time)[1][row])
            return float(np.abs(off).max() / (rod.mass * G))

        return of

    measures = (Measure("angle error", "rad", angle),
                *(Measure(f"error of {quantity.split('/')[1]}", "weights", force(quantity, row))
                  for row, quantity in enumerate(forces)))
    targets: list[Target] = []
    for step in STEPS:
        targets.append(AtMost("angle error", step, 1e-3, "smooth motion at w h < 3e-3"))
        targets += [AtMost(one.name, step, 5e-3, "every sample, the first too: no 0, no double")
                    for one in measures[1:]]
    return Trial(name, what, machine, measures, tuple(targets))


def trials() -> list[Trial]:
    return [
        _trial("toppling", "a rod topples on its round end without slip", toppling, TOPPLING,
               TOPPLING.toppling, -1.0, ("rod/floor.normal", "rod/floor.tangential")),
        _trial("ladder", "a rod slides down a smooth wall", ladder, LADDER, LADDER.ladder, 1.0,
               ("rod/floor.normal", "rod/wall.normal"))]
