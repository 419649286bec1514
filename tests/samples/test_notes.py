"""Notes on a run: ends of slots, stalled drives."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.samples.samples import ended
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

FORCE, LENGTH, STEP = 2.0, 0.09, 1e-3
TAKES = np.sqrt(2 * LENGTH / FORCE)
"""Of 1 kg from rest to the groove's end: 0.3 s."""


def slider(*, turn: float = 0.0, force: float = FORCE, at: float = 0.0, length: float = LENGTH,
           duration: float = 0.4, count: int = 1) -> Recording:
    """Blocks of 1 kg on grooves of a fixed frame that is turned, each pushed along its own."""
    along = np.array([np.cos(turn), np.sin(turn)])
    across = np.array([-along[1], along[0]])
    bodies: list[dict[str, Any]] = [{"name": "frame", "motion": "fixed", "angle": turn}]
    joints, drives = [], []
    for k in range(count):
        bodies.append({"name": f"block{k}", "mass": 1, "inertia": 1e-4, "angle": turn,
                       "at": (at * along + 0.1 * k * across).tolist()})
        joints.append({"type": "slot", "name": f"rail{k}", "a": "frame", "b": f"block{k}",
                       "start": [0, 0.1 * k], "end": [length, 0.1 * k], "turns": False})
        drives.append({"type": "force", "name": f"push{k}", "body": f"block{k}",
                       "direction": along.tolist(), "value": force})
    return simulate(load_scene({"run": {"duration": duration, "step": STEP}, "bodies": bodies,
                                "joints": joints, "drives": drives}))


def test_the_way_and_the_time_of_free_motion() -> None:
    told, = slider(turn=2.0).notes
    found = re.fullmatch(r"rail0: block0 reached the end of its slot, 90 mm from its start, "
                         r"t = (\S+) s", told)
    assert found is not None
    # a step to see it stopped, half a step of the first order that the start is
    assert float(found.group(1)) == pytest.approx(TAKES, abs=2 * STEP)


@pytest.mark.parametrize("case", [
    {"length": 0.2}, {"at": LENGTH, "duration": 0.2}, {"duration": 0.2}],
    ids=["longer", "there", "earlier"])
def test_nothing_is_told_where_none_comes_to_an_end(case: dict[str, Any]) -> None:
    assert list(ended(slider(**case))) == []


@pytest.mark.parametrize(("drive", "since"), [
    # 1 rad/s with all of its torque from the start, 2 N m on 1/3 kg m^2; 60 deg of the stop
    ({"type": "motor", "value": 1.0, "torque": 2.0}, math.radians(60) + 1 / 12),
    ({"type": "servo", "value": 2.0, "torque": 2.0, "speed": 1.0}, math.radians(60) + 1 / 12),
    ({"type": "servo", "value": 0.5, "torque": 2.0}, None),
])
def test_a_motor_against_a_stop_has_stalled(drive: dict[str, Any], since: float | None) -> None:
    run = simulate(Mechanism.model_validate({
        "run": {"duration": 2.0}, "bodies": [
            {"name": "frame", "motion": "fixed"},
            {"name": "arm", "mass": 1.0, "inertia": 1 / 3}],
        "joints": [{"type": "pin", "name": "p", "a": "frame", "b": "arm", "on_b": [0, 0],
                    "limits": ["-10 deg", "60 deg"]}],
        "drives": [{"name": "m", "joint": "p", **drive}]}))
    if since is None:
        assert run.notes == []
        return
    note, = run.notes
    assert note.startswith("m has stalled: from t = ")
    assert note.endswith(" s on it gives all of its 2 N m, and nothing moves")
    assert float(note.split()[6]) == pytest.approx(since, abs=2e-3)
