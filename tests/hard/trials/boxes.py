"""Boxes at rest: light under heavy, and where the ground carries one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.hard.measures import late
from tests.hard.trial import AtMost, Measure, Target, Trial, spell
from tests.hard.truth.contacts import centre_of_pressure

G = 9.81
FLOOR: dict[str, Any] = {"name": "floor", "motion": "fixed", "shapes": [
    {"type": "box", "size": (1.0, 0.02), "at": (0.0, -0.01)}]}


def box(name: str, kilograms: float, size: tuple[float, float], bottom: float) -> dict[str, Any]:
    return {"name": name, "mass": kilograms, "at": (0.0, bottom + size[1] / 2),
            "shapes": [{"type": "box", "size": size}]}


def stack(ratio: float, step: float) -> Mechanism:
    """1 kg on a box that is so many times lighter."""
    return spell(1.0, step, gravity=(0.0, -G), bodies=[
        FLOOR, box("light", 1 / ratio, (0.04, 0.01), 0.0), box("heavy", 1.0, (0.04, 0.04), 0.01)])


def _stack(exponent: int) -> Trial:
    ratio = 10.0**exponent
    load = G * (1 + 1 / ratio)

    def floor(run: Recording) -> float:
        return float(np.abs(run["light/floor.normal"][late(run, 0.5)] / load - 1).max())

    def creep(run: Recording) -> float:
        """How far either is from where it started, beyond what overlap is left alone [m]."""
        off = [np.hypot(run["light.x"], run["light.y"] - 0.005),
               np.hypot(run["heavy.x"], run["heavy.y"] - 0.03)]
        return float(max(one.max() for one in off))

    targets: list[Target] = []
    for step in (1e-3, 5e-4):
        targets += [
            AtMost("floor's force error", step, 1e-6, "N = (M + m) g, every sample once at rest"),
            AtMost("creep", step, 1e-5, "rest")]
    return Trial(f"stack_1e{exponent}", f"1 kg on a box lighter by 1e{exponent}, 1 s",
                 lambda step: stack(ratio, step),
                 (Measure("floor's force error", "", floor), Measure("creep", "m", creep)),
                 tuple(targets))


def pressure_error(body: str, truth: float) -> Measure:
    """Largest error at rest of where the floor carries a body [m]."""

    def of(run: Recording) -> float:
        bodies = [one.name for one in run.mechanism.bodies]
        rows = (run.arrays["contact_body"] == bodies.index(body)) & (
            run.arrays["contact_other"] == bodies.index("floor"))
        rest = late(run, 0.2)[run.arrays["contact_sample"]]
        at = run.arrays["contact_point"][rows & rest, 0]
        return float(np.abs(at - truth).max()) if len(at) else np.inf

    return Measure("centre of pressure error", "m", of)


def _pressure(name: str, what: str, body: str, truth: float,
              machine: Callable[[float], Mechanism]) -> Trial:
    why = "moments"
    return Trial(name, what, machine, (pressure_error(body, truth),), tuple(
        AtMost("centre of pressure error", step, 1e-5, why) for step in (1e-3, 5e-4)))


def angle_piece(step: float) -> Mechanism:
    """An L of two boxes, 100 mm wide and high, 30 mm thick, its outer corner at x = 0."""
    foot = {"type": "box", "size": (0.1, 0.03), "at": (0.05, 0.015)}
    leg = {"type": "box", "size": (0.03, 0.07), "at": (0.015, 0.065)}
    return spell(0.5, step, gravity=(0.0, -G), bodies=[
        FLOOR, {"name": "piece", "mass": 1.0, "shapes": [foot, leg]}])


def pushed(step: float) -> Mechanism:
    """A cube of 1 kg and 100 mm that 3 N push at its top, and that friction holds."""
    return spell(
        0.5, step, gravity=(0.0, -G), bodies=[FLOOR, box("cube", 1.0, (0.1, 0.1), 0.0)],
        drives=[{"type": "force", "name": "push", "body": "cube", "at": (0.0, 0.05),
                 "direction": (1.0, 0.0), "value": 3.0}])


def trials() -> list[Trial]:
    foot, leg = 0.1 * 0.03, 0.03 * 0.07
    return [
        *(_stack(exponent) for exponent in (3, 6)),
        _pressure("angle_piece", "an L of two boxes at rest", "piece",
                  centre_of_pressure((foot, leg), (0.05, 0.015)), angle_piece),
        _pressure("pushed_cube", "1 kg pushed at its top by 3 N, at rest", "cube",
                  centre_of_pressure((G,), (0.0,), 3.0, 0.1), pushed)]
