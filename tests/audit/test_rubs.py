"""Faults of dry friction and of a motor's line, planted one by one in a sound recording."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from tests.engine.machines import G, fixed, mechanism

HELD, SLIPS, GROOVE = 0, 1, 2


@cache
def sound() -> Recording:
    """An arm that is held, one that swings on its journal, a block on a groove of a turning rod.

    The rod is turned by a motor with a line.
    """
    return simulate(mechanism(
        duration=0.3, gravity=(0.0, -G), run={"sample_rate": 2000.0},
        bodies=[fixed("wall"), {"name": "one", "mass": 1.0, "inertia": 1e-3, "at": (0.1, 0.0)},
                {"name": "two", "mass": 1.0, "inertia": 1e-3, "at": (0.1, 0.5)},
                {"name": "rod", "mass": 1.0, "inertia": 0.01, "at": (0.0, 1.0)},
                {"name": "bead", "mass": 0.2, "inertia": 1e-4, "at": (0.1, 1.0)}],
        joints=[{"type": "pin", "name": "held", "a": "wall", "b": "one", "on_a": (0, 0),
                 "friction": 2.0},
                {"type": "pin", "name": "slips", "a": "wall", "b": "two", "on_a": (0, 0.5),
                 "friction_coefficient": 0.3, "pin_radius": 0.03},
                {"type": "slot", "name": "groove", "a": "rod", "b": "bead", "start": (0, 0),
                 "end": (3, 0), "friction_coefficient": 0.2},
                {"type": "pin", "name": "axle", "a": "wall", "b": "rod", "on_b": (0, 0)}],
        drives=[{"type": "motor", "name": "motor", "joint": "axle", "stall": 3.0,
                 "no_load": 8.0}]))


def planted(key: str, joint: int, change: Callable[[np.ndarray], np.ndarray]) -> Recording:
    run = sound()
    arrays = {name: np.array(values) for name, values in run.arrays.items()}
    arrays[key][:, joint] = change(arrays[key][:, joint])
    return Recording(run.mechanism, arrays, run.info)


def noticed(run: Recording) -> set[str]:
    return {figure.name for figure in audit(run) if figure.verdict == "look"}


def test_a_sound_run_is_sound() -> None:
    assert noticed(sound()) == set()
    holds = sound().arrays["joint_sticks"]
    assert (holds[:, HELD] == 1.0).all()
    assert (holds[:, SLIPS] == 0.0).all()
    assert np.abs(sound()["groove.friction"]).max() > 0.1
    assert {f.verdict for f in audit(sound()) if f.name in ("joint.friction", "drive.motor",
                                                            "work")} == {"pass"}


@pytest.mark.parametrize(("key", "joint", "change", "names"), [
    ("joint_friction", SLIPS, lambda x: x * 1.0001, {"joint.friction", "momentum.moment"}),
    ("joint_friction", SLIPS, lambda x: -x, {"joint.friction", "momentum.moment"}),
    ("joint_friction", HELD, lambda x: x * 3, {"joint.friction", "momentum.moment"}),
    ("joint_friction", GROOVE, lambda x: x * 1.0001, {"joint.friction", "momentum.force"}),
    ("joint_sticks", SLIPS, np.ones_like, {"joint.friction"}),
    ("joint_sticks", HELD, np.zeros_like, {"joint.friction"}),
    ("joint_friction_work", SLIPS, lambda x: x * 1.0001, {"work"}),
    ("joint_friction_work", GROOVE, lambda x: x * 1.0001, {"work"}),
    ("drive_torque", 0, lambda x: x * 1.0001, {"drive.motor", "momentum.moment"}),
])
def test_a_fault_is_noticed(
    key: str, joint: int, change: Callable[[np.ndarray], np.ndarray], names: set[str],
) -> None:
    assert names <= noticed(planted(key, joint, change))


@pytest.mark.parametrize(("kind", "number", "key", "figure"), [
    ("joints", SLIPS, "friction_coefficient", "joint.friction"),
    ("joints", SLIPS, "pin_radius", "joint.friction"),
    ("joints", GROOVE, "friction_coefficient", "joint.friction"),
    ("drives", 0, "stall", "drive.motor"), ("drives", 0, "no_load", "drive.signal")])
def test_a_scene_that_says_otherwise_is_noticed(
    kind: str, number: int, key: str, figure: str,
) -> None:
    content = json.loads(sound().mechanism.model_dump_json(by_alias=True))
    content[kind][number][key] *= 1.0001
    changed = type(sound().mechanism).model_validate(content)
    assert figure in noticed(Recording(changed, sound().arrays, sound().info))
