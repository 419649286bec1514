"""The loop (read, tendons, write, step, record) against the bare ``space.step`` inside it."""

from __future__ import annotations

import time

import numpy as np

from benchmarks.measure import Figure, interleaved, loop_seconds, mechanism
from sandbox.engine.clock import make_clock
from sandbox.engine.forces import apply_forces
from sandbox.engine.inputs import Inputs
from sandbox.engine.simulate import simulate
from sandbox.engine.tables import make_tables
from sandbox.engine.world import World
from sandbox.model.compile import compile_mechanism
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism


def bare(machine: Mechanism) -> tuple[float, Array]:
    """Time in pymunk's ``Space.step`` alone over the same motion [s], and the last state.

    The steps are made through pymunk's public interface, forces and all, but
    only ``step`` is on the clock.
    """
    run = machine.run
    clock = make_clock(run.duration, run.step, run.sample_rate)
    world = World(compile_mechanism(machine))
    constants, state, result, _ = make_tables(
        world.model, clock.step, world.order, world.motor_impulses, world.body, world.force)
    inputs, spent = Inputs(world, clock), 0.0
    for k in range(1, clock.steps + 1):
        apply_forces(constants, state, result, inputs.rows(k, 1)[0])
        world.write()
        began = time.perf_counter()
        world.step()
        spent += time.perf_counter() - began
        world.read()
    return spent, world.body.copy()


def figures(*, quick: bool = False) -> list[Figure]:
    """Ratio of the loop to the bare step, and both [us per step]."""
    machine = mechanism("adaptive_grasp", {"run.duration": 0.2 if quick else 2.0})
    steps = round(machine.run.duration / machine.run.step)
    recording, (_, last) = simulate(machine), bare(machine)
    moving = [body.motion == "dynamic" for body in machine.bodies]
    angles = last[:sum(moving), 2]
    if not np.array_equal(recording.arrays["body_pose"][-1, moving, 2], angles):
        raise AssertionError("the two ways of stepping made different motions")
    loop, step = interleaved(
        [lambda: loop_seconds(simulate(machine)), lambda: bare(machine)[0]], 1 if quick else 9)
    return [
        Figure("step loop / bare space.step", loop / step, "", most=2.5),
        Figure("  whole loop, recording at 1 kHz", 1e6 * loop / steps, "us/step"),
        Figure("  bare space.step", 1e6 * step / steps, "us/step"),
    ]
