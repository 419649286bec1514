"""Controllers, loads, fluid lines, planes and joints as scenes have them."""

from __future__ import annotations

from typing import Any

import pytest

import sandbox
from sandbox.engine.inspect import inspect
from sandbox.scene.expand import expand, to_json
from sandbox.scene.read.load import load_scene
from tests.scene.hand import ARM, PID


def arm(*controllers: dict[str, Any], events: Any = (), **more: Any) -> dict[str, Any]:
    return {**ARM, "controllers": list(controllers), "events": list(events), **more}


def error_of(scene: dict[str, Any]) -> str:
    with pytest.raises(sandbox.SceneError) as caught:
        sandbox.simulate(sandbox.load_scene(scene))
    return str(caught.value)


def test_an_algebraic_loop_is_named():
    a = {"type": "feedback", "name": "a", "value": "=second.value + 1", "writes": "motor"}
    b = {"type": "feedback", "name": "b", "value": "=2 * half", "writes": "second"}
    meters = [{"name": "half", "value": "=motor.value / 2"}]
    text = error_of(arm(a, b, meters=meters))
    assert "an algebraic loop: 'a' → 'b' → 'a'" in text
    assert "'c' → 'c'" in error_of(arm({**a, "name": "c", "value": "=motor.value"}))


@pytest.mark.parametrize("target", ["120 deg", {"to": "-50 deg", "over": 1}])
def test_a_target_beyond_a_stop_is_warned_of(target):
    found = inspect(expand(sandbox.load_scene(arm({**PID, "target": target}))))
    assert [(f.severity, f.element) for f in found] == [("warning", "loop")]
    assert "but its stops are at -0.5236 and 1.571 rad" in found[0].message
    assert not inspect(expand(sandbox.load_scene(arm(PID))))


# --- planes


BALL: dict[str, Any] = {"name": "ball", "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}


def loaded(plane: Any) -> sandbox.Scene:
    return sandbox.load_scene({"bodies": [{**BALL, "plane": plane}]})


@pytest.mark.parametrize(("written", "meant"), [
    (0, (0,)), (-3, (-3,)), ([2], (2,)), ([0, 1], (0, 1)), ("all", "all"), (1000, (1000,))])
def test_allowed_planes(written: Any, meant: Any) -> None:
    scene = loaded(written)
    assert scene.bodies[0].plane == meant
    again = sandbox.load_scene(sandbox.expand(scene).model_dump(mode="json", by_alias=True))
    assert again.bodies == scene.bodies
    assert ('"plane"' in to_json(sandbox.expand(scene))) == (meant != (0,))


def test_a_joint_needs_a_body_that_moves() -> None:
    with pytest.raises(sandbox.SceneError, match="neither 'floor' nor 'wall' can move freely"):
        load_scene({
            "bodies": [{"name": "floor", "motion": "fixed"},
                       {"name": "wall", "motion": "scheduled", "path": {"x": 0}}],
            "joints": [{"type": "pin", "name": "p", "a": "floor", "b": "wall", "on_a": [0, 0]}]})
