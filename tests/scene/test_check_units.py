"""Units around control: each field takes the unit of its drive or reading, and refuses others."""

from __future__ import annotations

from typing import Any

import pytest

import sandbox
from tests.scene.hand import FINGER

SCENE: dict[str, Any] = {
    "run": {"duration": "1 s", "step": "0.5 ms"},
    "bodies": [{"name": "base", "motion": "fixed"},
               {"name": "arm", "mass": 0.1, "shapes": [{"type": "circle", "radius": 0.01}]}],
    "joints": [{"type": "pin", "name": "axle", "a": "base", "b": "arm", "on_a": [0, 0]},
               {"type": "actuator", "name": "screw", "a": "base", "b": "arm", "on_b": [0.1, 0]}],
    "springs": [{"type": "rotary", "name": "coil", "joint": "axle", "stiffness": 0.3},
                {"type": "linear", "name": "band", "a": "base", "b": "arm", "stiffness": 300,
                 "rest_length": 0}],
    "parts": [FINGER],
    "drives": [
        {"type": "force", "name": "push", "body": "arm", "direction": [1, 0], "value": 0},
        {"type": "torque", "name": "twist", "joint": "axle", "value": 0},
        {"type": "motor", "name": "spin", "joint": "finger.dip", "value": 0, "torque": 1},
        {"type": "servo", "name": "turn", "joint": "finger.pip", "value": 0, "torque": 1},
        {"type": "length", "name": "reach", "joint": "screw", "value": 0.1, "force": 1},
        {"type": "stiffness", "name": "k_coil", "spring": "coil"},
        {"type": "stiffness", "name": "k_mcp", "spring": "finger.mcp_spring"},
        {"type": "stiffness", "name": "k_pip", "spring": "finger.pip_spring"},
    ],
}
PID = {"type": "pid", "name": "law", "reads": "axle.angle", "writes": "push", "target": 0}
RELAY = {"type": "relay", "name": "law", "reads": "axle.angle", "writes": "push", "target": 0,
         "amplitude": 1}
SWITCH = {"type": "switch", "name": "law", "reads": "axle.angle", "writes": "push", "below": 0,
          "above": 1, "value_below": 1, "value_above": 0}
SCHEDULE = {"type": "schedule", "name": "law", "writes": "push", "value": 0}
FEEDBACK = {"type": "feedback", "name": "law", "writes": "push", "value": "=t"}
STATE = {"type": "state_feedback", "name": "law", "reads": ["axle.angle", "axle.rate"],
         "writes": ["twist", "push"], "targets": [0, 0], "gains": [[1, 0], [0, 1]]}
EQUILIBRIUM = {"type": "equilibrium", "name": "law", "tendon": "finger.tendon",
               "joints": ["finger.mcp", "finger.pip"], "writes": ["k_mcp", "k_pip"],
               "targets": ["10 deg", "10 deg"], "kp": [0, 0]}


def problems(scene: dict[str, Any]) -> list[tuple[str, str]]:
    """Path and message of everything that is wrong with a scene."""
    try:
        sandbox.load_scene(scene)
    except sandbox.SceneError as error:
        return [(problem.path, problem.message) for problem in error.problems]
    return []


def law(controller: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {**SCENE, "controllers": [{**controller, **more}]}


def setting(name: str, value: Any, *controllers: dict[str, Any]) -> dict[str, Any]:
    return {**SCENE, "controllers": list(controllers),
            "events": [{"name": "event", "at": 0, "set": {name: value}}]}


@pytest.mark.parametrize(("drive", "right", "wrong"), [
    ("push", "1 N", "1 N m"), ("twist", "1 N mm", "1 N"), ("spin", "1 deg/s", "1 deg"),
    ("turn", "1 deg", "1 deg/s"), ("reach", "1 mm", "1 deg"), ("k_coil", "1 N m/rad", "1 N/m"),
    ("k_mcp", "1 N/mm", "1 N m/rad")])
def test_a_drive_takes_its_own_unit_from_an_event_and_a_schedule(
    drive: str, right: str, wrong: str,
) -> None:
    for value, places in ((right, []), (wrong, [
            f"$.events[0].set.{drive}", "$.controllers[0].value"])):
        assert [path for scene in (
            setting(drive, value), law(SCHEDULE, writes=drive, value=value))
            for path, _ in problems(scene)] == places


@pytest.mark.parametrize(("controller", "key", "right", "wrong", "places"), [
    (PID, "limits", ["-1 N", "1 kN"], ["-1 mm", "1 mm"], ["[0]", "[1]"]),
    (PID, "bias", "1 N", "1 N m", [""]),
    (PID, "target", "30 deg", "30 N", [""]),
    (PID, "target", {"to": "30 deg", "over": 1}, {"to": "30 mm", "over": 1}, [".to"]),
    (SCHEDULE, "limits", ["-1 N", "1 N"], [-1, "1 s"], ["[1]"]),
    (FEEDBACK, "limits", ["-1 N", "1 N"], ["-1 rad", 1], ["[0]"]),
    (SWITCH, "value_below", "1 N", "1 m", [""]),
    (SWITCH, "below", "-1 deg", "-1 N", [""]),
    (SWITCH, "above", "90 deg", "90 N", [""]),
    (RELAY, "amplitude", "1 N", "1 rad", [""]),
    (RELAY, "hysteresis", "1 deg", "1 N", [""]),
    (STATE, "limits", [["-1 N m", "1 N m"], ["-1 N", "1 N"]],
     [["-1 N m", "1 N"], ["-1 N m", "1 N"]], ["[0][1]", "[1][0]"]),
    (STATE, "bias", ["1 N m", "1 N"], ["1 N", "1 N m"], ["[0]", "[1]"]),
    (STATE, "targets", ["1 deg", "1 deg/s"], ["1 deg/s", {"constant": "1 deg"}],
     ["[0]", "[1].constant"]),
    (EQUILIBRIUM, "limits", [["1 N/m", "1 N/mm"]] * 2,
     [[1, "1 N/mm"], ["1 N", "2 N m/rad"]], ["[1][0]", "[1][1]"]),
    (EQUILIBRIUM, "pull", "1 N", "1 N m", [""]),
])
def test_every_field(
    controller: dict[str, Any], key: str, right: Any, wrong: Any, places: list[str]
) -> None:
    assert problems(law(controller, **{key: right})) == []
    found = problems(law(controller, **{key: wrong}))
    assert [path for path, _ in found] == [f"$.controllers[0].{key}{place}" for place in places]
    assert all(" is a unit of " in message for _, message in found)


@pytest.mark.parametrize(("reads", "unit"), [
    ("axle.rate", "rad/s"), ("band.length", "mm")])
def test_a_target_is_of_the_kind_of_the_reading(reads: str, unit: str) -> None:
    assert problems(law(PID, reads=reads, target=f"1 {unit}")) == []
    for scene, place in ((law(PID, reads=reads, target="1 kg"), "$.controllers[0].target"),
                         (setting("law.target", "1 kg", {**PID, "reads": reads}),
                          '$.events[0].set["law.target"]')):
        (found,) = problems(scene)
        assert found[0] == place
        assert found[1].startswith("'kg' is a unit of mass, but this is a")
