"""Controllers and events as scenes have them: what is read, and every mistake with its place."""

from __future__ import annotations

import json
from typing import Any

import pytest

import sandbox
from sandbox.scene.expand import expand, to_json

ARM: dict[str, Any] = {
    "format": 1,
    "run": {"duration": "1 s", "step": "0.5 ms"},
    "parameters": {"goal": "20 deg", "gain": 3},
    "bodies": [
        {"name": "base", "motion": "fixed"},
        {"name": "arm", "mass": 0.1, "inertia": 1e-4},
        {"name": "hand", "at": [0.1, 0], "mass": 0.1, "inertia": 1e-4},
    ],
    "joints": [
        {"type": "pin", "name": "elbow", "a": "base", "b": "arm", "on_a": [0, 0],
         "limits": ["-30 deg", "90 deg"]},
        {"type": "pin", "name": "wrist", "a": "arm", "b": "hand", "on_b": [0, 0]},
    ],
    "drives": [
        {"type": "torque", "name": "motor", "joint": "elbow", "value": 0},
        {"type": "torque", "name": "second", "joint": "wrist", "value": 0},
    ],
}
PID = {"type": "pid", "name": "loop", "reads": "elbow.angle", "target": "=goal", "writes": "motor",
       "kp": "=gain", "ki": 1.5, "limits": ["-1 N m", "1 N m"]}


def arm(*controllers: dict[str, Any], events: Any = (), **more: Any) -> dict[str, Any]:
    return {**ARM, "controllers": list(controllers), "events": list(events), **more}


def told(scene: dict[str, Any]) -> str:
    with pytest.raises(sandbox.SceneError) as caught:
        sandbox.simulate(sandbox.load_scene(scene))
    return str(caught.value)


def test_what_is_expanded_reads_the_same_again():
    damp = {"type": "feedback", "name": "damp", "value": "=-gain * wrist.rate",
            "writes": "second"}
    scene = arm(
        PID, damp,
        events=[{"name": "push", "when": "=elbow.angle > goal / 2", "set": {"loop.target": 0},
                 "lasts": "20 ms"}])
    mechanism = expand(sandbox.load_scene(scene))
    assert mechanism.controllers[1].readings == ("=-3.0 * wrist.rate",)
    again = expand(sandbox.load_scene(json.loads(to_json(mechanism))))
    assert again.controllers == mechanism.controllers
    assert again.events == mechanism.events


@pytest.mark.parametrize(("change", "path", "words"), [
    ({"writes": "moter"}, "$.controllers[0].writes", "Did you mean 'motor'"),
    ({"reads": "elbow.angel"}, "$.controllers[0].reads", "Did you mean 'elbow.angle'"),
    ({"reads": "elbow.damping"}, "$.controllers[0].reads", "cannot be read during it"),
    ({"reads": "elbow.lenght"}, "$.controllers[0].reads", "of this joint: 'angle', 'rate'"),
    ({"limits": [1, -1]}, "$.controllers[0].limits", "1 is not below -1"),
    ({"rate": "300 Hz"}, "$.controllers[0].rate", "333.333 Hz or 285.714 Hz"),
    ({"rate": "5 kHz"}, "$.controllers[0].rate", "at most 2000 Hz"),
    ({"kp": float("nan")}, "$.controllers[0].kp", "finite"),
    ({"slew": -1}, "$.controllers[0].slew", "greater than 0"),
    ({"target": "=1 / (t - t)"}, "$.controllers[0].target", "no finite value"),
    ({"type": "pidd"}, "$.controllers[0]", "'pid'"),
    ({"name": "motor"}, "$.controllers[0].name", "already that of a drive"),
])
def test_a_mistake_of_a_controller_is_told_with_its_place(change, path, words):
    text = told(arm({**PID, **change}))
    assert path in text
    assert words in text


@pytest.mark.parametrize(("event", "path", "words"), [
    ({"at": "2 s", "stop": "pass"}, "$.events[0].at", "the run ends at 1 s"),
    ({"at": "0.9998 s", "stop": "pass"}, "$.events[0].at", "due at 1 s, after the run's last step"),
    ({"when": "=t > 0", "after": "0.6 s", "rate": "2 Hz", "stop": "pass"}, "$.events[0].after",
     "due at 1 s"),
    ({"when": "=1 > 2", "stop": "pass"}, "$.events[0].when", "reads nothing"),
    ({"when": "=t > 5", "stop": "pass"}, "$.events[0].when", "true at no time of the run"),
    ({"at": 0.1, "after": 0.2, "stop": "pass"}, "$.events[0]", "'after' needs 'when'"),
    ({"at": 0.1, "rate": "1 kHz", "stop": "pass"}, "$.events[0]", "'rate' needs 'when'"),
    ({"when": "=elbow.angle > 1", "after": "1 s", "stop": "pass"}, "$.events[0].after", "never"),
    ({"when": "=elbow.angel > 1", "stop": "pass"}, "$.events[0].when", "elbow.angle"),
    ({"at": 0.1, "set": {"loop.tarket": 1}}, '$.events[0].set["loop.tarket"]', "'loop.target'"),
    ({"at": 0.1, "set": {"motor": 1}}, "$.events[0].set.motor", "would set it again"),
    ({"at": 0.1, "set": {"loop.active": 2}}, '$.events[0].set["loop.active"]', "0 or 1"),
    ({"stop": "pass"}, "$.events[0]", "give either 'at' or 'when'"),
    ({"at": 0.1, "stop": "fail", "lasts": 0.1}, "$.events[0].lasts", "'lasts' needs 'set'"),
])
def test_a_mistake_of_an_event_is_told_with_its_place(event, path, words):
    text = told(arm(PID, events=[{"name": "later", **event}]))
    assert path in text
    assert words in text


def test_a_target_without_a_value_at_the_first_act():
    text = told(arm({**PID, "target": "=1e-3 / t"}))
    assert "$.controllers[0].target" in text
    assert "at t = 0 s" in text


def test_two_controllers_of_one_drive():
    text = told(arm(PID, {**PID, "name": "other"}))
    assert "$.controllers[1].writes" in text
    assert "written already, by the controller 'loop'" in text


def test_an_algebraic_loop_is_named():
    a = {"type": "feedback", "name": "a", "value": "=second.value + 1", "writes": "motor"}
    b = {"type": "feedback", "name": "b", "value": "=2 * half", "writes": "second"}
    meters = [{"name": "half", "value": "=motor.value / 2"}]
    text = told(arm(a, b, meters=meters))
    assert "an algebraic loop: 'a' → 'b' → 'a'" in text
    assert "'c' → 'c'" in told(arm({**a, "name": "c", "value": "=motor.value"}))


@pytest.mark.parametrize("target", ["120 deg", {"to": "-50 deg", "over": 1}])
def test_a_target_beyond_a_stop_is_warned_of(target):
    from sandbox.engine.inspect import inspect

    found = inspect(expand(sandbox.load_scene(arm({**PID, "target": target}))))
    assert [(f.severity, f.element) for f in found] == [("warning", "loop")]
    assert "but its stops are at -0.5236 and 1.571 rad" in found[0].message
    assert not inspect(expand(sandbox.load_scene(arm(PID))))
