"""The least pull at which controlled stiffness holds a pose: closed form against simulations.

Below T_min = max_i (k_min,i dlm_i hm_i - w_i) / h_i the softest spring of some joint
opens it further than wanted. The paper's stiffness controllers are run at pulls on
both sides of it, and the least pull that still reaches the pose is found by halving.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.paper.finger_plant import HINGES, TARGET, Plant
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.load import load_scene

SCENE = "finger_stiffness_15N"
PICTURE, NUMBERS = "least_pull.png", "least_pull.csv"
DURATION, STEP = 6.0, 4e-4
"""Of a run [s]. The slowest pole of the loops is at 2/s for 7 N, so that e^-12 of an error is
left; at rest the step of 0.4 ms does not matter."""
SURE = 1e-3
"""A joint within this fraction of its target has reached it. At 0.01 N below T_min the knuckle
is 0.0092 deg short, 1.8e-3 of 5 deg: h / K = 0.92 deg/N there."""
BELOW, ABOVE = 4.0, 9.0
"""Pulls of which one fails and one does [N]; the sweep goes from one to the other."""
RESOLVED = 0.01
"""[N]"""
SWEPT = 11


@dataclass(frozen=True)
class RestPose:
    """Where the finger came to rest at a pull."""

    pull: float
    """[N]"""
    angles: Array
    """[rad], shape [3]."""

    @property
    def reached(self) -> bool:
        """Whether all joints are where they should be."""
        return bool((np.abs(self.angles / TARGET - 1) < SURE).all())


def reach(pull: float) -> RestPose:
    """Run the paper's stiffness controllers at a pull [N]."""
    run = simulate(load_scene(shipped_scenes()[SCENE], overrides={
        "parameters.pull": pull, "run.duration": DURATION, "run.step": STEP,
        "run.sample_rate": 100}))
    return RestPose(pull, np.array([run[f"finger.{hinge}.angle"][-1] for hinge in HINGES]))


def bisect(
    low: float = BELOW, high: float = ABOVE, *, report: Callable[[RestPose], None] | None = None,
) -> tuple[float, float]:
    """The pulls [N] between which the pose begins to be reached, :data:`RESOLVED` apart at most.

    Args:
        low: a pull that is too weak.
        high: one that is not.
        report: is given every point.
    """
    while high - low > RESOLVED:
        point = reach((low + high) / 2)
        if report is not None:
            report(point)
        low, high = (low, point.pull) if point.reached else (point.pull, high)
    return low, high


def expected(pull: float, plant: Plant | None = None) -> Array:
    """Where the finger rests under stiffness control at a pull [N], closed form [rad], shape [3].

    Its springs have what holds the targets, as far as that is within their range: a
    joint whose pull is too weak rests on its softest spring.
    """
    finger = plant or Plant()
    wanted = finger.stiffness(pull, TARGET)
    return finger.rest(pull, np.clip(wanted, finger.softest, finger.stiffest))


def run(directory: Path, *, progress: Callable[[float], None] | None = None) -> str:
    """Picture and table into ``directory``.

    Raises:
        OutputError: a file cannot be written.
    """
    points: list[RestPose] = []
    total = SWEPT + int(np.ceil(np.log2((ABOVE - BELOW) / RESOLVED)))

    def keep(point: RestPose) -> None:
        points.append(point)
        if progress is not None:
            progress(len(points) / total)

    for pull in np.linspace(BELOW, ABOVE, SWEPT):
        keep(reach(float(pull)))
    low, high = bisect(report=keep)
    predicted, _ = Plant().pull_range(TARGET)
    write_atomic(directory / NUMBERS, _table(points))
    save_panels(directory / PICTURE, _panels(points, predicted))
    rows = ", ".join(f"{hinge} {pull:.3f} N" for hinge, pull in zip(
        HINGES, Plant().least_pulls(TARGET), strict=True))
    off = max(float(np.abs(point.angles - expected(point.pull)).max()) for point in points)
    return (f"least pull predicted: {predicted:.4f} N ({rows})\n"
            f"found by {len(points) - SWEPT} runs: between {low:.4f} and {high:.4f} N\n"
            f"farthest of {len(points)} runs from the closed form: {np.degrees(off):.4f} deg")


def _table(points: list[RestPose]) -> str:
    return comma_separated(
        ["pull_N", *(f"{hinge}_rad" for hinge in HINGES), "reached", "expected_mcp_rad"],
        ((point.pull, *point.angles, int(point.reached), expected(point.pull)[0])
         for point in sorted(points, key=lambda p: p.pull)), digits=6)


def _panels(points: list[RestPose], predicted: float) -> list[Panel]:
    pulls = np.linspace(BELOW, ABOVE, 201)
    near = [point for point in points if abs(point.pull - predicted) < 0.12]
    fine = np.linspace(predicted - 0.12, predicted + 0.12, 121)
    whole = np.array([expected(pull)[0] for pull in pulls])
    close = np.array([expected(pull)[0] for pull in fine])
    return [
        Panel("Where the knuckle comes to rest", "pull [N]", "rotation of the knuckle [deg]",
              [Curve("closed form", pulls, np.degrees(whole)),
               _line(predicted, np.degrees(whole)), _marks("simulated", points[:SWEPT])]),
        Panel("Halving in on the least pull", "pull [N]", "rotation of the knuckle [deg]",
              [Curve("closed form", fine, np.degrees(close)),
               _line(predicted, np.degrees(close)), _marks("simulated", near)]),
    ]


def _line(pull: float, degrees: Array) -> Curve:
    return Curve(f"predicted: {pull:.3f} N", np.array([pull, pull]),
                 np.array([degrees.min(), degrees.max()]), "dashed")


def _marks(label: str, points: list[RestPose]) -> Curve:
    return Curve(label, np.array([point.pull for point in points]),
                 np.degrees([point.angles[0] for point in points]), "points")
