"""Episodes steered from outside: steps and beginnings a second, beside MuJoCo on the same scene.

Both engines have the same mechanism at the same step, as ``sandbox export`` writes it for MuJoCo,
are given the same actions for 20 ms each and are asked for the same angles. What stands around
MuJoCo is the least that there can be: no checks, no spaces, no dictionary.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np

import sandbox.gym
from benchmarks.measure import Figure, interleaved, seconds
from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulation import Simulation
from sandbox.export import export_mechanism
from sandbox.gym.env import SceneEnv
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import read_scene

SCENES = (("single_finger", ["finger.mcp.angle", "finger.pip.angle", "finger.dip.angle"]),
          ("adaptive_grasp", ["finger1.mcp.angle", "finger2.mcp.angle", "finger3.mcp.angle"]))
PROCESSES = 2


def figures(*, quick: bool = False) -> list[Figure]:
    """Steps of environments, what a beginning costs, and what several processes gain."""
    repetitions, steps = (1, 10) if quick else (15, 60)
    found: list[Figure] = []
    for name, observe in SCENES[:1] if quick else SCENES:
        env = _env(name, observe)
        works: list[Callable[[], float]] = [
            partial(_episode, env, steps), partial(seconds, env.reset), partial(_anew, env),
            partial(_whole, _played(env, steps), steps * env.task.every)]
        if (other := _mujoco(name, observe, steps, env.task.every)) is not None:
            works.append(other)
        episode, reset, anew, whole, *mujoco = interleaved(works, repetitions)
        found += [
            Figure(f"{name}: steps of the environment", steps / episode, "1/s"),
            Figure("  in pieces / in one go", episode / whole, "", most=1.6),
            Figure("  reset", 1e3 * reset, "ms"),
            Figure("  reset / building anew", reset / anew, "", most=0.6)]
        if mujoco:
            found.append(Figure("  time / MuJoCo's", episode / mujoco[0], ""))
    return [*found, *_together(quick)]


def _env(name: str, observe: list[str]) -> SceneEnv:
    return sandbox.gym.make(name, observe=observe, act="actuator", reward=observe[0],
                            set={"expect": []})


def _actions(steps: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.random.default_rng(1).uniform(-1.0, 1.0, (steps, 1))


def _episode(env: SceneEnv, steps: int) -> float:
    """So many steps of an episode, its beginning left out [s]."""
    actions = _actions(steps)
    env.reset()
    began = time.perf_counter()
    for action in actions:
        env.step(action)
    return time.perf_counter() - began


def _played(env: SceneEnv, steps: int) -> Mechanism:
    """The scene with the actions of an episode as a table of its drive."""
    _episode(env, steps)
    return env.task.loaded(env.played())


def _whole(machine: Mechanism, steps: int) -> float:
    """The same motion in one go [s]."""
    simulation = Simulation(Checked(machine))
    return seconds(lambda: simulation.step(steps))


def _anew(env: SceneEnv) -> float:
    """Another simulation of the scene as it was read [s]."""
    return seconds(lambda: Simulation(Checked(env.task.mechanism)))


def _mujoco(name: str, observe: list[str], steps: int, every: int) -> Callable[[], float] | None:
    """The same episode in MuJoCo; None where it is not installed."""
    try:
        mujoco: Any = import_module("mujoco")
    except ImportError:
        return None
    model = mujoco.MjModel.from_xml_string(export_mechanism(
        read_scene(name, overrides={"expect": []}).mechanism).text)
    data = mujoco.MjData(model)
    most = float(model.key_ctrl[0, 0])
    sensors = [int(model.sensor(each).adr[0]) for each in observe]

    def episode() -> float:
        mujoco.mj_resetDataKeyframe(model, data, 0)
        began = time.perf_counter()
        for action in _actions(steps):
            data.ctrl[0] = most * (action[0] + 1) / 2
            mujoco.mj_step(model, data, nstep=every)
            data.sensordata[sensors]
        return time.perf_counter() - began

    return episode


def _together(quick: bool) -> list[Figure]:
    """What a process for each environment gains over one after the other."""
    from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv

    name, observe = SCENES[0] if quick else SCENES[1]
    makers = [partial(_env, name, observe)] * PROCESSES
    steps = 5 if quick else 90
    alone, several = SyncVectorEnv(makers), AsyncVectorEnv(makers)

    def work(envs: Any) -> float:
        envs.reset()
        actions = np.zeros((PROCESSES, 1))
        return seconds(lambda: [envs.step(actions) for _ in range(steps)])

    try:
        one, other = interleaved([partial(work, alone), partial(work, several)],
                                 1 if quick else 7)
    finally:
        several.close()
        alone.close()
    return [Figure(f"{PROCESSES} environments of {name}: steps in processes", PROCESSES * steps
                   / other, "1/s"),
            Figure("  one after the other / in processes", one / other, "")]
