"""What can be set of a scene, from where to where; when a parameter asks for a new beginning."""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.engine.live import Live
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene, read_scene
from sandbox.web.controls import changes, controls

from .test_session import PULLED


def shown(scene: Any) -> dict[str, dict[str, Any]]:
    loaded = read_scene(scene)
    return {each["name"]: each for each in controls(loaded, Live(loaded.mechanism), {})}


def test_parameters_have_the_units_of_the_file_and_those_that_follow_are_left_out() -> None:
    found = shown({**PULLED, "parameters": {"load": "200 g", "pull": "3 N", "half": "=pull / 2",
                                            "still": 0}})
    assert [(each["name"], each["value"], each["low"], each["high"], each["unit"])
            for each in found.values()] == [
        ("parameters.load", 200.0, 0.0, 400.0, "g"), ("parameters.pull", 3.0, 0.0, 6.0, "N"),
        ("parameters.still", 0.0, -1.0, 1.0, ""), ("winch", 3.0, 0.0, 6.0, "N")]


def test_what_a_controller_sets_has_no_slider_its_target_and_switch_have() -> None:
    found = shown("finger_dual_control")
    assert {"pull", "k_mcp"} & set(found) == set()
    assert found["mcp_loop.target"]["unit"] == "rad"
    assert found["mcp_loop.active"]["kind"] == "switch"
    kinds = [each["kind"] for each in found.values()]
    assert kinds == sorted(kinds, key=("parameter", "drive", "target", "switch").index)


def test_a_valve_goes_from_shut_to_open_and_a_pull_not_below_nothing() -> None:
    found = shown("hydraulic_lift")
    shares = [each for each in found.values() if each["kind"] == "drive" and not each["unit"]]
    assert shares
    assert {(each["low"], each["high"]) for each in shares} == {(0.0, 1.0)}


@pytest.mark.parametrize(("scene", "override", "time", "found"), [
    ("adaptive_grasp", {"parameters.pull": 20.0}, 0.6, {"actuator": 20.0}),
    ("adaptive_grasp", {"parameters.pull": 20.0}, 0.4, None),  # its ramp is not over
    ("adaptive_grasp", {"parameters.pitch": 0.1}, 0.6, None),
    ("adaptive_grasp", {"run.step": 1e-3}, 0.6, None),
    ("adaptive_grasp", {"run.duration": 3.0}, 0.6, {}),
    ("adaptive_grasp", {"gravity": [0, -9.81]}, 0.6, None),
    ("servo_arm", {"parameters.goal": 1.0}, 0.0, {"pd": 1.0, "stiff": 1.0}),
    ("finger_dual_control", {"controllers[mcp_loop].target": 0.1}, 0.0, {"mcp_loop.target": 0.1}),
    ("finger_dual_control", {"controllers[mcp_loop].kp": 1.0}, 0.0, None),
])
def test_what_a_parameter_changes(
    scene: str, override: dict[str, Any], time: float, found: dict[str, float] | None,
) -> None:
    old, new = (expand(load_scene(scene, overrides=each)) for each in ({}, override))
    assert changes(old, new, time) == found
