"""What controllers cost, and how long the five experiments of the paper's section 5 take."""

from __future__ import annotations

import itertools
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from benchmarks.command import process
from benchmarks.measure import Figure, interleaved, loop_seconds, mechanism
from sandbox.engine.simulate import simulate
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import Constant

EXPERIMENTS = ("finger_force_control", "finger_stiffness_15N", "finger_stiffness_10N",
               "finger_stiffness_too_weak", "finger_dual_control")
TOGETHER = 2
"""So many run side by side."""


def figures(*, quick: bool = False) -> list[Figure]:
    """Loops at 1 kHz on the hand and on a lone finger, whose steps are cheap; five commands."""
    repetitions, duration = (1, 0.2) if quick else (9, 2.0)
    shorter = {"run.duration": duration, "expect": [], "events": []}
    found: list[Figure] = []
    for name, machine, target in (
        ("twelve loops on the hand", _hand(duration), 1.2),
        ("four loops on a finger", mechanism("finger_dual_control", shorter), 1.2),
        ("the model-based law on a finger", mechanism("finger_model_control", shorter), None),
        ("state feedback on a finger", mechanism("finger_lqr_control", shorter), None),
    ):
        bare = _held(machine)
        with_loops, without = interleaved(
            [partial(_loop, machine), partial(_loop, bare)], repetitions)
        acts = machine.run.duration * 1000
        found += [
            Figure(f"{name}: loop with / without", with_loops / without, "", most=target),
            Figure("  all that acts in a millisecond", 1e6 * (with_loops - without) / acts, "us"),
            Figure("  steps and samples of a millisecond", 1e6 * without / acts, "us"),
        ]
    return [*found, Figure("the five experiments, commands and films", _together(quick), "s",
                           most=10.0)]


def _held(machine: Mechanism) -> Mechanism:
    """Without controllers, the drives at what those ended with: much the same motion to step."""
    ended = simulate(machine)
    final = {drive.name: float(ended[f"{drive.name}.value"][-1]) for drive in machine.drives}
    drives = tuple(drive.model_copy(update={"value": Constant(constant=final[drive.name])})
                   for drive in machine.drives)
    return machine.model_copy(update={"controllers": (), "drives": drives})


def _loop(machine: Mechanism) -> float:
    return loop_seconds(simulate(machine))


def _hand(duration: float) -> Mechanism:
    """The four-finger hand with the stiffness of every spring held by a loop."""
    hinges = [f"finger{i}.{hinge}" for i, hinge in itertools.product(
        (1, 2, 3, 4), ("mcp", "pip", "dip"))]
    pull = {"type": "pull", "name": "actuator", "tendon": "tree",
            "value": {"ramp": {"to": "15 N", "over": "0.5 s"}}}
    return mechanism("adaptive_grasp", {
        "run.duration": duration, "expect": [],
        "drives": [pull, *({"type": "stiffness", "name": f"k{i}", "spring": f"{hinge}_spring"}
                           for i, hinge in enumerate(hinges))],
        "controllers": [
            {"type": "pid", "name": f"loop{i}", "reads": f"{hinge}.angle", "target": "20 deg",
             "writes": f"k{i}", "kp": -200, "ki": -200, "limits": [150, 900]}
            for i, hinge in enumerate(hinges)],
    })


def _together(quick: bool) -> float:
    """Wall time of the experiments' commands, two at a time [s]."""
    scenes = EXPERIMENTS[:1] if quick else EXPERIMENTS
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        with ThreadPoolExecutor(TOGETHER) as pool:
            list(pool.map(lambda scene: process(
                "-m", "sandbox", "run", scene, "--out", str(Path(folder) / scene)), scenes))
        return time.perf_counter() - began
