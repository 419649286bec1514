"""Controllers and events as scenes have them: what is read, and every mistake with its place."""

from __future__ import annotations

import json
from typing import Any

import pytest

import sandbox
from sandbox.scene.elements.controllers import readings_of
from sandbox.scene.expand import expand, to_json
from tests.scene.hand import ARM, PID


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
    assert readings_of(mechanism.controllers[1]) == ("=-3.0 * wrist.rate",)
    again = expand(sandbox.load_scene(json.loads(to_json(mechanism))))
    assert again.controllers == mechanism.controllers
    assert again.events == mechanism.events


def test_a_target_without_a_value_at_the_first_act():
    text = told(arm({**PID, "target": "=1e-3 / t"}))
    assert "$.controllers[0].target" in text
    assert "at t = 0 s" in text


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
