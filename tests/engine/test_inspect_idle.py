"""Drives and events that do nothing are told, those that do something are not."""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.engine.inspect import inspect
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene

SCENE: dict[str, Any] = {
    "run": {"duration": 0.1},
    "bodies": [{"name": "frame", "motion": "fixed"},
               {"name": "arm", "at": [0.3, 0.0], "mass": 1.0, "inertia": 1e-2}],
    "joints": [{"type": "pin", "name": "axle", "a": "frame", "b": "arm", "on_b": [-0.3, 0]},
               {"type": "actuator", "name": "cylinder", "a": "frame", "b": "arm",
                "on_a": [0.3, -0.5], "shortest": 0.4, "longest": 0.6}],
}
LIFT = {"type": "length", "name": "lift", "joint": "cylinder", "force": 10}


def told(**parts: Any) -> list[tuple[str, str]]:
    """What is found of an element: its path and the words."""
    scene = {**SCENE, **parts}
    return [(problem.path, problem.message) for problem in inspect(expand(load_scene(scene)))]


def released(*joints: str) -> list[dict[str, Any]]:
    return [{**joint, "released": joint["name"] in joints} for joint in SCENE["joints"]]


@pytest.mark.parametrize(("parts", "path", "words"), [
    ({"events": [{"name": "catch", "at": 0.05, "take_up": "axle"}]}, "$.events[0].take_up[0]",
     "takes up axle, which no event releases"),
    ({"joints": released("axle"), "drives": [
        {"type": "motor", "name": "spin", "joint": "axle", "value": 1, "torque": 1}]},
     "$.drives[0]", "acts on axle, which is released from the start and never taken up"),
    ({"drives": [{"type": "surface", "name": "belt", "body": "frame", "value": 1}]},
     "$.drives[0].body", "frame has no shapes"),
    ({"drives": [{**LIFT, "value": {"ramp": {"from": 0.5, "to": 0.7, "over": 0.1}}}]},
     "$.drives[0].value", "sets cylinder to 700 mm, but it is 600 mm long at most"),
    ({"drives": [{**LIFT, "value": 0.3}]}, "$.drives[0].value",
     "sets cylinder to 300 mm, but it is 400 mm long at least"),
])
def test_what_does_nothing_is_told(parts: dict[str, Any], path: str, words: str) -> None:
    [found] = told(**parts)
    assert found[0] == path
    assert words in found[1]


@pytest.mark.parametrize("parts", [
    {"events": [{"name": "catch", "at": 0.05, "take_up": "axle"}], "joints": released("axle"),
     "drives": [{"type": "motor", "name": "spin", "joint": "axle", "value": 1, "torque": 1}]},
    {"events": [{"name": "drop", "at": 0.05, "release": "axle"},
                {"name": "catch", "at": 0.07, "take_up": "axle"}]},
    {"drives": [{**LIFT, "value": 0.6}]},
])
def test_what_does_something_is_not(parts: dict[str, Any]) -> None:
    assert told(**parts) == []
