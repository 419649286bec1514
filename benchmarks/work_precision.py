"""Error against time: four frictionless fingers on one tree of rockers, here and in MuJoCo.

Each of the four closes on a disc of its own. Two things are looked at: the pose of all hinges
after 0.1 s, when nothing touches yet, and the twelve contact forces at rest. Both engines are
held against a run of sandbox at 0.05 ms, to which both tend. Times are those of the steps alone,
nothing recorded, at one step after the other; all other settings are the defaults here, and for
MuJoCo those that ``sandbox export`` writes.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from statistics import median
from typing import Any

import numpy as np

from benchmarks.measure import Figure, loop_seconds, mechanism
from sandbox.engine.simulate import simulate
from sandbox.export import export_mechanism
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.study.reference_fingers import SET_G, SET_G_TABLE
from sandbox.study.refine import at_instants

STEPS = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
"""Of sandbox [s]."""
SECOND_STEPS = (1e-3, 5e-4, 2.5e-4, 1e-4, 5e-5)
"""Of MuJoCo [s]: it needs finer ones."""
REFERENCE = 5e-5
DURATION, RAMP, FREE = 1.5, 0.5, 0.1
"""Until all is at rest; over which the pull rises; until when nothing has touched [s]."""
PULL = 4 * 3.75
PITCH = 0.105
"""Of the fingers [m]."""
DEGREES, PERCENT = 0.05, 1.0
"""What is wanted of the free pose and of the contact forces."""
ENOUGH = 1e-3
"""The step at which sandbox is to have both [s]."""
FINGERS = tuple(f"finger{i}" for i in range(1, 5))
PHALANGES = tuple(f"{f}.{name}" for f in FINGERS for name in ("proximal", "middle", "distal"))
HINGES = tuple(f"{f}.{name}" for f in FINGERS for name in ("mcp", "pip", "dip"))


def hand(step: float, duration: float, sample_rate: float) -> Mechanism:
    """Four Set G fingers, each above a fixed disc of 16 mm, nothing with friction."""
    disc = SET_G_TABLE[0]
    fingers = [{
        "type": "finger", "name": name, "at": [0, -PITCH * i], "material": "smooth",
        "lengths": SET_G.lengths, "radii": SET_G.radii, "masses": SET_G.masses,
        "guides": SET_G.guides, "damping": SET_G.damping, "limits": SET_G.limits,
        "springs": {"stiffness": 300, "from": SET_G.before[0], "to": SET_G.after[0]},
    } for i, name in enumerate(FINGERS)]
    discs = [{
        "name": f"disc{i}", "motion": "fixed", "material": "smooth",
        "at": [disc.centre[0], disc.centre[1] - PITCH * i],
        "shapes": [{"type": "circle", "radius": disc.disc_radius}],
    } for i in range(len(FINGERS))]
    return mechanism({
        "run": {"duration": duration, "step": step, "sample_rate": sample_rate},
        "materials": {"smooth": {"friction": 0.0}}, "bodies": discs,
        "parts": [*fingers, {"type": "rocker_tree", "name": "tree", "pulls": list(FINGERS)}],
        "drives": [{"type": "pull", "name": "actuator", "tendon": "tree",
                    "value": {"ramp": {"to": PULL, "over": RAMP}}}]})


@dataclass(frozen=True)
class Answer:
    """What an engine says, and how long it took."""

    pose: Array
    """Of all hinges at :data:`FREE` [deg]."""
    forces: Array
    """Normal forces of all phalanges at rest [N]."""
    seconds: float


def _at_free(run: Recording) -> Array:
    """Hinges' angles at :data:`FREE` [deg], by the cubic of the nearest samples."""
    return np.degrees([at_instants(run.time, run[f"{hinge}.angle"], np.array([FREE]))[0]
                       for hinge in HINGES])


def ours(step: float, repetitions: int) -> Answer:
    """The answer of sandbox."""
    free = simulate(hand(step, FREE + 4 * step, 1 / step))
    whole = hand(step, DURATION, 1 / DURATION)
    runs = [simulate(whole) for _ in range(repetitions)]
    forces = np.array([runs[0][f"{body}.contact.normal"][-1] for body in PHALANGES])
    return Answer(_at_free(free), forces, median(map(loop_seconds, runs)))


def second(mujoco: Any, step: float, repetitions: int) -> Answer:
    """The answer of MuJoCo: its ramp is made step by step, the rest in one call."""
    model = mujoco.MjModel.from_xml_string(
        export_mechanism(hand(step, DURATION, 1 / DURATION)).text)
    model.opt.timestep = step
    data, spent, pose = mujoco.MjData(model), [], np.zeros(0)
    for _ in range(repetitions):
        mujoco.mj_resetData(model, data)
        if model.nkey:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        full = data.ctrl.copy()
        began = time.perf_counter()
        for k in range(round(RAMP / step)):
            data.ctrl[:] = full * (k * step / RAMP)
            mujoco.mj_step(model, data)
            if k + 1 == round(FREE / step):
                mujoco.mj_forward(model, data)
                pose = np.degrees([data.sensor(f"{hinge}.angle").data[0] for hinge in HINGES])
        data.ctrl[:] = full
        mujoco.mj_step(model, data, nstep=round((DURATION - RAMP) / step))
        spent.append(time.perf_counter() - began)
    mujoco.mj_forward(model, data)
    forces = np.array([data.sensor(f"{body}.contact.normal").data[0] for body in PHALANGES])
    return Answer(pose, forces, median(spent))


@cache
def reference() -> Answer:
    """The truth, as good as any."""
    return ours(REFERENCE, 1)


def _curve(
    name: str, steps: Sequence[float], answer: Callable[[float], Answer], enough: float = 0.0,
) -> tuple[list[Figure], float]:
    """Errors and time at each step; the least time at which both errors are small enough [s]."""
    truth, found, least = reference(), list[Figure](), np.inf
    for step in steps:
        it = answer(step)
        pose = float(np.abs(it.pose - truth.pose).max())
        forces = 100 * float(np.abs(it.forces / truth.forces - 1).max())
        label = f"{name} at h = {1e3 * step:g} ms"
        wanted = (DEGREES, PERCENT) if step == enough else (None, None)
        found += [Figure(f"  {label}: free pose off by", pose, "deg", most=wanted[0]),
                  Figure(f"  {label}: contact forces off by", forces, "%", most=wanted[1]),
                  Figure(f"  {label}: time", 1e3 * it.seconds, "ms")]
        if pose <= DEGREES and forces <= PERCENT:
            least = min(least, it.seconds)
    return found, least


def figures(*, quick: bool = False) -> list[Figure]:
    """Both curves, and how much sooner sandbox is there; without MuJoCo sandbox's curve alone."""
    repetitions = 1 if quick else 9
    first, least = _curve("sandbox", STEPS[1:3] if quick else STEPS,
                          lambda step: ours(step, repetitions), ENOUGH)
    wanted = f"{PERCENT:g} % and {DEGREES:g} deg"
    found = [Figure(f"sandbox's time to {wanted}", 1e3 * least, "ms")]
    try:
        mujoco = import_module("mujoco")
    except ImportError:
        print("MuJoCo is not installed (pip install mujoco): not compared", file=sys.stderr)
        return [*found, *first]
    other, its_least = _curve("MuJoCo", SECOND_STEPS[2:3] if quick else SECOND_STEPS,
                              lambda step: second(mujoco, step, min(repetitions, 3)))
    found += [Figure(f"MuJoCo's time to {wanted}", 1e3 * its_least, "ms"),
              Figure("  MuJoCo's time / sandbox's", its_least / least, "", least=8)]
    return [*found, *first, *other]
