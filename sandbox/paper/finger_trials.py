"""One finger under one controller, once: as it is, or not as the controller takes it to be.

Controllers are those of the shipped scenes, and a retuned PID. Masses, damping and
the springs' arms can be off (the points M' and M'' scaled about the hinge, so that
a moment s = dlm hm changes with the square), the fingertip loaded, the stiffness
limited in its rate, the rotations read in steps. What a controller believes of the
finger stays nominal.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from sandbox.control.build import build
from sandbox.control.custom import Custom
from sandbox.engine.simulate import simulate
from sandbox.paper.finger_plant import HINGES, TARGET
from sandbox.recording.recording import Recording
from sandbox.samples.response import Effort, effort, settling_time
from sandbox.scene.elements.controllers import readings_of, targets_of, writes_of
from sandbox.scene.expand import expand
from sandbox.scene.library import shipped_scenes
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene
from sandbox.scene.values.signals import values
from sandbox.study.reference_fingers import SET_A

DRIVES = ("k1", "k2", "k3")
SPREAD = 0.2
"""How far off masses, damping and springs' arms are taken to be, at most."""
LOAD = 0.2
"""At the fingertip, across and opening [N]."""
CROSSING = 0.1
"""Time in which a slow spring goes from k0 to 3 k0 [s]: an assumption, not a measurement."""
RATE = 2.0 / CROSSING
"""Of a slow spring [k0/s]."""
GENTLE = 0.15
"""With slow springs the pull rises over this time [s], as long as the end joint's spring needs
from k0 to the 3.67 k0 that hold the pose."""
RESOLUTION = float(np.radians(0.01))
"""Of the encoders [rad]."""


@dataclass(frozen=True)
class TrialController:
    """A controller of the finger."""

    name: str
    scene: str
    """The shipped scene that it is taken from."""
    duration: float
    """How long one run is watched [s]."""
    change: Callable[[dict[str, Any]], None] | None = None
    """What is altered in the scene."""


def retune(scene: dict[str, Any]) -> None:
    """PID with derivative, higher gains and a reference that rises in 50 ms; found by trying."""
    scene["parameters"]["pull"] = 14.0
    gains = ((-4e5, -1e7, -3e3), (-8e4, -2e6, -100.0), (-1.5e4, -1e6, 0.0))
    for loop, hinge, (kp, ki, kd) in zip(scene["controllers"], HINGES, gains, strict=True):
        loop.update(kp=kp, ki=ki, kd=kd,
                    target={"ramp": {"to": f"={hinge}", "over": 0.05}})


PAPER = (TrialController("paper, 15 N", "finger_stiffness_15N", 4.0),
         TrialController("paper, 10 N", "finger_stiffness_10N", 4.0),
         TrialController("paper, dual", "finger_dual_control", 5.0))
RETUNED = TrialController("PID retuned", "finger_stiffness_15N", 1.0, retune)
MODEL = TrialController("model-based", "finger_model_control", 0.5)
LQR = TrialController("LQR", "finger_lqr_control", 0.5)
BETTER = (MODEL, LQR)


@dataclass(frozen=True)
class Mismatch:
    """What is not as the controller takes it to be."""

    mass: float = 1.0
    damping: float = 1.0
    arms: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Of the springs, joint by joint."""
    load: float = 0.0
    """At the fingertip [N]."""
    load_at: float = 0.0
    """Since when [s]; settling is counted from then."""
    slow: bool = False
    """Whether the stiffness is limited in its rate."""
    read_in_steps: bool = False
    """Whether rotations come from encoders, and rates from their differences."""


NOMINAL = Mismatch()


def corners() -> list[Mismatch]:
    """All 32 corners of masses, damping and each spring's arms within the spread."""
    ends = (1 - SPREAD, 1 + SPREAD)
    return [Mismatch(mass, damping, (one, two, three))
            for mass, damping, one, two, three in product(ends, repeat=5)]


@dataclass(frozen=True)
class Trial:
    """What came of a run, of all joints together."""

    settling: float
    """Last time that any rotation was outside 2 % of its target, from the start or the load
    on [s]; inf if one never settles."""
    overshoot: float
    """Largest of any joint, in % of its target."""
    steady_error: float
    """Largest of any joint at the end, in % of its target."""
    stiffness: Effort
    """Of the three springs together, in fractions of Table 2's stiffness; its peak and rate are
    those of the busiest one."""
    pull: Effort
    """[N]"""
    run: Recording


def scene_of(controller: TrialController, case: Mismatch = NOMINAL) -> dict[str, Any]:
    """The scene of a trial, without expectations."""
    scene: dict[str, Any] = copy.deepcopy(_shipped(controller.scene))
    for key in ("expect", "events", "meters"):
        scene.pop(key, None)
    scene["run"]["duration"] = controller.duration + case.load_at
    if controller.change is not None:
        controller.change(scene)
    finger = scene["parts"][0]
    finger["masses"] = [case.mass * m for m in SET_A.masses]
    finger["damping"] = [case.damping * d for d in SET_A.damping]
    for key, points in (("from", SET_A.before), ("to", SET_A.after)):
        finger["springs"][key] = [[factor * x, factor * y]
                                  for factor, (x, y) in zip(case.arms, points, strict=True)]
    scene["drives"] = [d for d in scene["drives"] if d["name"] != "tip_load"]
    if case.load:
        scene["drives"].append({
            "type": "force", "name": "tip_load", "body": "finger.distal", "frame": "body",
            "at": [SET_A.lengths[-1], 0], "direction": [0, 1],
            "value": {"ramp": {"to": case.load, "start": case.load_at, "over": 0}}})
    for loop in scene["controllers"]:
        _adapt(loop, case)
    if case.slow and controller not in PAPER:
        scene["drives"][0]["value"] = {"ramp": {"to": scene["parameters"]["pull"],
                                                "over": GENTLE}}
    return scene


def _adapt(loop: dict[str, Any], case: Mismatch) -> None:
    if loop["type"] == "equilibrium":
        loop["geometry"] = {"lengths": SET_A.lengths, "guides": SET_A.guides,
                            "from": SET_A.before, "to": SET_A.after}
    if not case.slow:
        return
    writes = loop["writes"]
    rates = {drive: RATE * k for drive, k in zip(DRIVES, SET_A.stiffness, strict=True)}
    if isinstance(writes, list):
        loop["slew"] = [rates[drive] for drive in writes]
    elif writes in rates:
        loop["slew"] = rates[writes]
    if loop["type"] == "equilibrium":
        loop["rise"] = GENTLE
    if loop["type"] == "state_feedback":
        loop["targets"] = [{"ramp": {"to": f"={hinge}", "over": GENTLE}} for hinge in HINGES] + [
            0, 0, 0]


@cache
def _shipped(name: str) -> dict[str, Any]:
    scene: dict[str, Any] = json.loads(shipped_scenes()[name].read_text(encoding="utf-8"))
    return scene


def trial(controller: TrialController, case: Mismatch = NOMINAL) -> Trial:
    """Run a controller once."""
    mechanism = expand(load_scene(scene_of(controller, case)))
    if case.read_in_steps:
        run = simulate(mechanism.model_copy(update={"controllers": ()}),
                       controllers=encoders(mechanism))
    else:
        run = simulate(mechanism)
    return judged(run, since=case.load_at)


def judged(run: Recording, since: float = 0.0) -> Trial:
    """The figures of a run; settling and overshoot from ``since`` [s] on."""
    chosen = run.time >= since - 1e-9
    time = run.time[chosen] - since
    angles = [run[f"finger.{hinge}.angle"][chosen] for hinge in HINGES]
    targets = [np.full(len(time), target) for target in TARGET]
    pairs = list(zip(angles, targets, strict=True))
    springs = [effort(run.time, run[f"{drive}.value"] / k0, 1.0)
               for drive, k0 in zip(DRIVES, SET_A.stiffness, strict=True)]
    return Trial(
        settling=max(settling_time(time, *pair) for pair in pairs),
        # of the target and not of a step, since after a load there is none
        overshoot=max(100 * max(0.0, float(np.max(a)) / t[0] - 1) for a, t in pairs),
        steady_error=max(100 * abs(float(a[-1]) / t[0] - 1) for a, t in pairs),
        stiffness=Effort(sum(e.variation for e in springs), max(e.peak for e in springs),
                         max(e.rate for e in springs)),
        pull=effort(run.time, run["pull.value"], float(run["pull.value"][0])), run=run)


def encoders(mechanism: Mechanism) -> list[Custom]:
    """The mechanism's controllers, reading rotations in steps and rates from their differences."""
    return [_blurred(mechanism, i) for i in range(len(mechanism.controllers))]


def _blurred(mechanism: Mechanism, index: int) -> Custom:
    spec = mechanism.controllers[index]
    law = build(spec, mechanism, 1e-3)
    names = [name for name in readings_of(spec) if not name.endswith(".rate")]
    limits: Any = spec.limits
    bounds = [limits] if isinstance(writes_of(spec), str) or not isinstance(
        limits[0], tuple) else limits
    signals = targets_of(spec)
    before: dict[str, float] = {}
    applied: list[float] = []

    def act(t: float, exact: Sequence[float]) -> list[float]:
        read = {name: RESOLUTION * round(value / RESOLUTION) if name.endswith(".angle") else value
                for name, value in zip(names, exact, strict=True)}
        for name in [name for name in read if name.endswith(".angle")]:
            rate = (read[name] - before.get(name, read[name])) / 1e-3
            before[name] = read[name]
            read[name.removesuffix(".angle") + ".rate"] = rate
        readings = [read[name] for name in readings_of(spec)]
        targets = [float(values(signal, np.array([t]))[0]) for signal in signals]
        if not applied:
            start = [SET_A.stiffness[DRIVES.index(name)] if name in DRIVES else 15.0
                     for name in writes_of(spec)]
            law.begin(readings, targets, start)
            applied.extend(start)
        wanted = law.act(t, readings, targets, applied)
        applied[:] = [min(max(want, low), high)
                      for want, (low, high) in zip(wanted, bounds, strict=True)]
        return list(applied)

    return Custom(spec.name, names, writes_of(spec), act)
