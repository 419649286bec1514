"""Scenes written in Python with the schema models."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox import build
from sandbox.scene.library import shipped_scenes
from sandbox.values.spec import Spec


def rebuilt(value: Any) -> Any:
    """A value whose models are built again by their constructors."""
    if isinstance(value, Spec):
        return getattr(build, type(value).__name__)(
            **{name: rebuilt(getattr(value, name)) for name in value.model_fields_set - {"type"}})
    if isinstance(value, dict):
        return {key: rebuilt(entry) for key, entry in value.items()}
    return [rebuilt(entry) for entry in value] if isinstance(value, tuple) else value


@pytest.mark.parametrize("name", sorted(shipped_scenes()))
def test_every_scene_can_be_built_in_python(name: str) -> None:
    scene = sandbox.load_scene(name)
    assert rebuilt(scene) == scene


def test_a_scene_of_models_is_that_of_a_file() -> None:
    bodies = [build.Body(name="frame", motion="fixed"),
              build.Body(name="bob", at=np.array([0.1, 0.0]), mass="200 g",
                         shapes=(build.Circle(radius="10 mm"),))]
    drive = build.TorqueDrive(name="push", joint="axle",
                              value=build.Ramp(to="0.1 N m", over="50 ms"))
    scene = build.Scene(
        name="weight", run=build.Run(duration="0.1 s"), gravity=(0, -9.81), bodies=bodies,
        joints=[build.Pin(name="axle", a="frame", b="bob", on_a=(0, 0))], drives=[drive],
        expect=[build.Expect(max="axle.angle", below=10)])
    data = {
        "name": "weight", "run": {"duration": "0.1 s"}, "gravity": [0, -9.81],
        "parameters": {"load": "0.2 kg"},
        "bodies": [bodies[0], {"name": "bob", "at": [0.1, 0.0], "mass": "=load",
                               "shapes": [{"type": "circle", "radius": "10 mm"}]}],
        "joints": [{"type": "pin", "name": "axle", "a": "frame", "b": "bob", "on_a": [0, 0]}],
        "drives": [drive], "expect": [{"max": "axle.angle", "below": 10}]}
    assert scene == sandbox.load_scene(data).model_copy(update={"parameters": {}})
    assert sandbox.load_scene(data, overrides={"parameters.load": 3}).bodies[1].mass == 3.0
    assert [verdict.ok for verdict in sandbox.simulate(scene).verdicts] == [True]


@pytest.mark.parametrize(("model", "fields", "message"), [
    ("Body", {"name": "a", "mas": 1}, "Body:.*unknown key 'mas'. Did you mean 'mass'?"),
    ("Pin", {"name": "a", "b": "x"}, "'a' is missing"),
    ("Circle", {"radius": "3 kg"}, "'kg' is a unit of mass"),
    ("Body", {"name": "a", "mass": "=load"}, "unknown name 'load'"),
    ("DiscCam", {"base": -1, "lift": [[0, 0], [1, 1], [2, 0]]}, "greater than 0"),
])
def test_wrong_arguments_are_refused(model: str, fields: dict[str, Any], message: str) -> None:
    with pytest.raises(sandbox.SceneError, match=message):
        getattr(build, model)(**fields)
