"""The loop (move, find contacts, solve, record) of the hand, and what recording costs in it."""

from __future__ import annotations

from functools import partial

import numpy as np

from benchmarks.measure import Figure, interleaved, loop_seconds, mechanism
from sandbox.engine.simulate import simulate
from sandbox.scene.mechanism import Mechanism


def rarely(machine: Mechanism) -> Mechanism:
    """The same motion, of which only the last step is kept."""
    run = machine.run
    return machine.model_copy(update={
        "run": run.model_copy(update={"sample_rate": 1 / run.duration})})


def figures(*, quick: bool = False) -> list[Figure]:
    """Ratio of the loop that records at 1 kHz to the one that does not, and both [us per step]."""
    machine = mechanism("adaptive_grasp", {
        "run.duration": 0.2 if quick else 2.0, "run.sample_rate": 1000.0})
    silent = rarely(machine)
    steps = round(machine.run.duration / machine.run.step)
    kept, last = (simulate(each).arrays["body_pose"] for each in (machine, silent))
    if len(last) != 1 or not np.array_equal(kept[-1], last[-1]):
        raise AssertionError("recording has changed the motion")
    recorded, bare = interleaved(
        [partial(lambda each: loop_seconds(simulate(each)), each) for each in (machine, silent)],
        1 if quick else 15)
    return [
        Figure("step loop, recording at 1 kHz / recording nothing", recorded / bare, "", most=1.15),
        Figure("  recording at 1 kHz", 1e6 * recorded / steps, "us/step"),
        Figure("  recording nothing", 1e6 * bare / steps, "us/step"),
    ]
