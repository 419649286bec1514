"""Drives that move nothing at the end of a run."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sandbox.engine.simulate import simulate
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
