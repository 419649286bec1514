"""Linkages with loops, redundant ones among them."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.hard.measures import GAP, closed, energy
from tests.hard.trial import AtMost, Measure, Order, Target, Trial, spell
from tests.hard.trials.chains import SECOND_ORDER
from tests.hard.truth.loops import G, parallelogram


def bar(name: str, near: tuple[float, float], angle: float, length: float, kilograms: float,
        **more: Any) -> dict[str, Any]:
    """A uniform bar whose frame sits at its near end."""
    return {"name": name, "mass": kilograms, "inertia": kilograms * length**2 / 12, "at": near,
            "angle": angle, "centre": (length / 2, 0.0), **more}


def pin(a: str, b: str, on_b: tuple[float, float] = (0.0, 0.0)) -> dict[str, Any]:
    return {"type": "pin", "name": f"{a}_{b}", "a": a, "b": b, "on_b": on_b}


def four_bars(loops: int, step: float) -> Mechanism:
    """IFToMM A02: cranks upright beside each other, their tips moving at 1 m/s."""
    bodies: list[dict[str, Any]] = [{"name": "ground", "motion": "fixed"}]
    joints = []
    for i in range(loops + 1):
        bodies.append(bar(f"crank{i}", (float(i), 0.0), np.pi / 2, 1.0, 1.0,
                          velocity=(0.5, 0.0), angular_velocity=-1.0))
        joints.append(pin("ground", f"crank{i}"))
    for i in range(loops):
        bodies.append(bar(f"coupler{i}", (float(i), 1.0), 0.0, 1.0, 1.0, velocity=(1.0, 0.0)))
        joints += [pin(f"crank{i}", f"coupler{i}"),
                   pin(f"crank{i + 1}", f"coupler{i}", (1.0, 0.0))]
    return spell(10.0, step, sample_rate=100.0, gravity=(0.0, -G), bodies=bodies, joints=joints)


def _tip(run: Recording, crank: int) -> np.ndarray:
    angle = run[f"crank{crank}.angle"]
    return np.stack([run[f"crank{crank}.x"] - crank + np.cos(angle),
                     run[f"crank{crank}.y"] + np.sin(angle)], axis=1)


def _tips(loops: int) -> Measure:
    def of(run: Recording) -> float:
        angle = parallelogram(run.time, loops)[0]
        truth = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return max(float(np.linalg.norm(_tip(run, crank) - truth, axis=1).max())
                   for crank in (0, loops))

    return Measure("tip error", "m", of)


def _a02(loops: int) -> Trial:
    cranks = loops + 1
    start = cranks * (1 / 6 + G / 2) + loops * (1 / 2 + G)
    span = start + G * (cranks / 2 + loops)  # from the lowest pose on

    def off(run: Recording) -> float:
        return float(np.abs(energy(run) - start).max() / span)

    targets: list[Target] = [
        AtMost("tip error", 1e-3, 5e-3, "asked over 10 s; 1e-3 m is the aim"),
        AtMost("energy error", 1e-3, 1e-3, "asked, of all that weight can give"), closed(1e-3)]
    if loops == 2:
        targets.append(Order("tip error", (1e-3, 5e-4), 1.8, SECOND_ORDER))
    return Trial(
        f"a02_{loops}", f"IFToMM A02, {loops} four-bar(s) in a row through their singular pose",
        lambda step: four_bars(loops, step),
        (_tips(loops), Measure("energy error", "", off), GAP), tuple(targets))


def trials() -> list[Trial]:
    return [_a02(loops) for loops in (1, 2, 10, 40)]
