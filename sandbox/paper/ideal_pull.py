"""The pull at which controlled stiffness settles soonest: the slow motion in closed form.

After the first 0.1 s the finger follows its loops at rest: each joint sits where
T g(theta) = k with g = h / s (tendon's arm over the spring's moment per stiffness),
while k = k0 + Kp e + KI ∫e dt with e = theta - target. Differentiated,

    e' = - KI e / (Kp - T g'(theta)),   g' < 0,

so the rate falls with the pull, and the time from the first rest e_1 (where the
integral is still 0) into the band e_2 is

    t = ∫ (Kp - T g') / (KI e) de   from e_2 to e_1.

At little pull the knuckle begins far below its target, at much the others begin far
above theirs: in between lies the pull that settles soonest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.engine.simulate import simulate
from sandbox.model.compile import compile_mechanism
from sandbox.numeric import Array
from sandbox.paper.finger_plant import HINGES, NAMES, TARGET, Plant
from sandbox.samples.response import BAND, settling_time
from sandbox.scene.document import Scene
from sandbox.scene.elements.controllers import PidController
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene

SCENE = "finger_stiffness_10N"
PICTURE, NUMBERS = "ideal_pull.png", "ideal_pull.csv"
PULLS = (7.0, 7.5, 8.0, 8.5, 9.0, 10.0, 11.0, 12.0, 13.0, 15.0, 17.0, 19.0, 21.0, 22.5)
"""Simulated [N], within what holds the pose (6.83 to 22.9 N)."""
DURATION, STEP = 4.0, 4e-4
"""Of a run [s]; the step changes a settling time by less than a sample."""
FINE = 400
"""Points of the quadrature, evenly spaced in log e."""
WIDEST = np.radians(75.0)
"""Rotation up to which a first rest is looked for [rad]."""


@dataclass(frozen=True)
class StiffnessLoop:
    """The stiffness loop of one joint: k = k0 + kp e + ki ∫e dt, within limits."""

    k0: float
    kp: float
    """[N/(m rad)], positive."""
    ki: float
    """[N/(m rad s)], positive."""
    low: float
    high: float


@cache
def laws() -> tuple[StiffnessLoop, ...]:
    """The loops of the scene, joint by joint."""
    mechanism = expand(_scene(10.0))
    model = compile_mechanism(mechanism)
    found = []
    for loop in mechanism.controllers:
        if isinstance(loop, PidController) and loop.limits:
            spring = model.drives.target[model.names.drive[loop.writes]]
            own = float(model.springs.stiffness[spring])
            found.append(StiffnessLoop(own, -loop.kp, -loop.ki, *loop.limits))
    return tuple(found)


def _scene(pull: float) -> Scene:
    return load_scene(SCENE, overrides={
        "parameters.pull": pull, "run.duration": DURATION, "run.step": STEP, "expect": []})


def needed(joint: int, theta: Array, plant: Plant) -> Array:
    """Stiffness that holds a joint, for each newton of pull: g = h / s at ``theta`` [rad] [1/m]."""
    pose = np.tile(TARGET, (len(theta), 1))
    pose[:, joint] = theta
    return np.asarray(plant.stiffness(1.0, pose)[:, joint])


def first_rest(joint: int, law: StiffnessLoop, pull: float, plant: Plant) -> float:
    """Where a joint rests while its integral is 0 [rad]; nan if it does not."""
    theta = np.linspace(1e-3, WIDEST, 4000)
    stiffness = np.clip(law.k0 + law.kp * (theta - TARGET[joint]), law.low, law.high)
    over = pull * needed(joint, theta, plant) - stiffness
    crossed = np.flatnonzero((over[:-1] > 0) & (over[1:] <= 0))
    if not len(crossed):
        return float("nan")
    i = crossed[0]
    return float(theta[i] + (theta[i + 1] - theta[i]) * over[i] / (over[i] - over[i + 1]))


def predicted(pull: float, plant: Plant | None = None) -> Array:
    """Settling times of the joints at a pull [N], by the quadrature [s], shape [3]."""
    finger = plant or Plant()
    times = []
    for joint, law in enumerate(laws()):
        target = float(TARGET[joint])
        away = first_rest(joint, law, pull, finger) - target
        if abs(away) <= BAND * target:
            times.append(0.0)
            continue
        e = np.sign(away) * np.geomspace(BAND * target, abs(away), FINE)
        slope = np.gradient(needed(joint, target + e, finger), e, edge_order=2)
        times.append(float(np.trapezoid((law.kp - pull * slope) / (law.ki * e), e)))
    return np.array(times)


def simulated(pull: float) -> Array:
    """Settling times of the joints at a pull [N], from a run [s], shape [3]."""
    run = simulate(_scene(pull))
    return np.array([
        settling_time(run.time, run[f"finger.{hinge}.angle"], np.full(len(run), target))
        for hinge, target in zip(HINGES, TARGET, strict=True)])


def run(directory: Path, *, progress: Callable[[float], None] | None = None) -> str:
    """Picture and table into ``directory``.

    Raises:
        OutputError: a file cannot be written.
    """
    found = []
    for i, pull in enumerate(PULLS):
        found.append(simulated(pull))
        if progress is not None:
            progress((i + 1) / len(PULLS))
    runs = np.array(found)
    low, high = Plant().pull_range(TARGET)
    pulls = np.linspace(low, high, 161)[1:-1]
    curves = np.array([predicted(float(pull)) for pull in pulls])
    slowest = curves.max(axis=1)
    write_atomic(directory / NUMBERS, _table(runs))
    best = int(np.argmin(slowest))
    save_panels(directory / PICTURE, [_panel(pulls, curves, runs, float(pulls[best]))])
    off = float(np.max(np.abs(runs.max(axis=1) - [predicted(pull).max() for pull in PULLS])))
    return (f"soonest at {pulls[best]:.2f} N: {slowest[best]:.2f} s; within range from "
            f"{low:.2f} to {high:.2f} N\n"
            f"slowest joint of {len(PULLS)} runs: within {off:.3f} s of the quadrature")


def _table(runs: Array) -> str:
    return comma_separated(
        ["pull_N", *(f"{hinge}_s" for hinge in HINGES),
         *(f"{hinge}_predicted_s" for hinge in HINGES)],
        ((pull, *times, *predicted(pull)) for pull, times in zip(PULLS, runs, strict=True)),
        digits=6)


def _panel(pulls: Array, curves: Array, runs: Array, best: float) -> Panel:
    lines = [Curve(f"{name}, predicted", pulls, curves[:, i]) for i, name in enumerate(NAMES)]
    marks = [Curve(f"{name}, simulated", np.array(PULLS), runs[:, i], "points")
             for i, name in enumerate(NAMES)]
    soonest = Curve(f"soonest: {best:.1f} N", np.array([best, best]),
                    np.array([0.0, curves.max()]), "dashed")
    return Panel("When each rotation is settled, by the slow motion of the loops",
                 "pull [N]", "within 2 % for good after [s]", [*lines, *marks, soonest])
