"""Drives that move nothing at the end of a run."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism


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


@pytest.mark.parametrize(("angle", "way", "dead"), [
    (0.0, (-1, 0), True), (0.0, (1, 0), False), (0.0, (0, 1), False), (0.3, (-1, 0), False)])
def test_a_push_in_line_with_crank_and_rod_acts_on_a_dead_centre(
    angle: float, way: tuple[int, int], dead: bool,
) -> None:
    """It holds whoever pulls at it, too, but of that any motion would be taken back."""
    x, y = 0.1 * math.cos(angle), 0.1 * math.sin(angle)
    rod = math.asin(y / 0.3)
    run = simulate(Mechanism.model_validate({
        "run": {"duration": 0.02}, "bodies": [
            {"name": "frame", "motion": "fixed"},
            {"name": "crank", "mass": 0.3, "inertia": 1e-3, "angle": angle},
            {"name": "rod", "mass": 0.2, "inertia": 1e-3, "at": [x, y], "angle": -rod},
            {"name": "piston", "mass": 0.2, "inertia": 1e-3, "at": [x + 0.3 * math.cos(rod), 0]}],
        "joints": [{"type": "pin", "name": "o", "a": "frame", "b": "crank", "on_b": [0, 0]},
                   {"type": "pin", "name": "p", "a": "crank", "b": "rod", "on_b": [0, 0]},
                   {"type": "pin", "name": "q", "a": "rod", "b": "piston", "on_b": [0, 0]},
                   {"type": "slot", "name": "s", "a": "frame", "b": "piston", "start": [-1, 0],
                    "end": [1, 0], "turns": False}],
        "drives": [{"type": "force", "name": "push", "body": "piston", "direction": way,
                    "value": 10}]}))
    assert [note.startswith("push acts at a dead centre") for note in run.notes] == [True] * dead
    pose = np.full_like(run.arrays["body_pose"], np.nan)
    assert not Recording(run.mechanism, {**run.arrays, "body_pose": pose}, run.info).notes
