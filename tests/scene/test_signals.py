"""Named tables: what they are between and beyond their points, who may call them, what is wrong."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.errors import SceneError
from sandbox.values.tables import Function, NamedTable

PROFILE = {"points": [[0, 1], [1, 3], [3, 2]]}


def _function(**given: Any) -> Function:
    return Function(NamedTable.model_validate(given))


def _scene(**given: Any) -> dict[str, Any]:
    ball = {"name": "ball", "mass": 1, "shapes": [{"type": "circle", "radius": 0.1}]}
    return {"tables": {"profile": PROFILE}, "bodies": [ball], "run": {"duration": 0.1}} | given


def _force(value: str) -> dict[str, Any]:
    return {"drives": [{"type": "force", "name": "push", "body": "ball", "direction": [1, 0],
                        "value": value}]}


def test_a_cubic_of_many_points_comes_close_as_the_fourth_power() -> None:
    errors = []
    for n in (16, 32):
        x = np.linspace(0, math.tau, n + 1)
        table = _function(points=np.stack([x, np.sin(x)], axis=1).tolist(), between="cubic",
                          beyond="repeat")
        tried = np.linspace(-10, 10, 4001)
        errors.append(float(np.abs(table(tried) - np.sin(tried)).max()))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.3)


def test_tables_may_read_parameters_which_then_may_not_call_them() -> None:
    table = {"points": [[0, 0], [1, "=b"]]}
    scene = sandbox.load_scene(_scene(
        tables={"profile": table}, parameters={"b": 2}, **_force("=profile(0.5)")))
    assert scene.drives[0].value.constant == 1.0
    with pytest.raises(SceneError, match="reads parameters itself"):
        sandbox.load_scene(_scene(
            tables={"profile": table}, parameters={"b": 2, "a": "=profile(1)"}))


def test_meters_conditions_and_controllers_call_tables() -> None:
    scene = _scene(
        **_force("1 N"), meters=[{"name": "m", "value": "=profile(ball.x * 100)"}],
        controllers=[{"type": "feedback", "name": "f", "writes": "push", "value":
                      "=profile(ball.x * 100)"}],
        events=[{"name": "e", "when": "=profile(t * 100) > 2.9", "stop": "pass"}])
    run = sandbox.simulate(sandbox.load_scene(scene))
    assert run["m"] == pytest.approx(np.interp(100 * run["ball.x"], [0, 1, 3], [1, 3, 2]))
    assert run["push.value"][1:] == pytest.approx(run["m"][:-1], rel=0.01)
    assert run.time[-1] == pytest.approx(0.0095, abs=1.5e-3)


def test_an_included_scene_has_its_own_tables(tmp_path: Any) -> None:
    part = _scene(parameters={"high": 3}, tables={"profile": {"points": [[0, 0], [1, "=high"]]}},
                  **_force("=profile(t)"))
    (tmp_path / "part.json").write_text(json.dumps(part))
    (tmp_path / "main.json").write_text(json.dumps({
        "tables": {"profile": PROFILE, "other": PROFILE}, "run": {"duration": 0.1},
        "parts": [{"include": "part", "name": "one"}, {"include": "part", "name": "two",
                                                       "parameters": {"high": 5}},
                  {"include": "part", "name": "three", "at": [1, 0]}]}))
    mechanism = sandbox.expand(sandbox.load_scene(str(tmp_path / "main.json")))
    assert set(mechanism.tables) == {"profile", "other", "one_profile", "two_profile"}
    assert mechanism.tables["two_profile"].points == ((0.0, 0.0), (1.0, 5.0))
    assert [drive.value.expression for drive in mechanism.drives] == [
        "=one_profile(t)", "=two_profile(t)", "=one_profile(t)"]
    run = sandbox.simulate(mechanism)
    assert run["two.push.value"] == pytest.approx(5 * run.time)
    part["drives"][0]["value"] = "=other(t)"
    (tmp_path / "part.json").write_text(json.dumps(part))
    with pytest.raises(SceneError, match="unknown function 'other'"):
        sandbox.load_scene(str(tmp_path / "main.json"))
