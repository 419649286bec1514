"""Builders make what files hold: every shipped scene is built again, entry by entry."""

from __future__ import annotations

import inspect
import json
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

import sandbox
from sandbox import build
from sandbox.build.builders import EntryBuilder, Family, word_of
from sandbox.build.stub import stub
from sandbox.scene.library import shipped_scenes

EVERY: dict[str, EntryBuilder] = {
    (f"{name}.{each.__name__}" if isinstance(found, Family) else name): each
    for name, found in build.BUILDERS.items()
    for each in (found if isinstance(found, Family) else [found])}
BY_MODEL = {each.model: each for each in EVERY.values()}
STUB = Path(build.__file__).with_suffix(".pyi")
WRITTEN_OUT = {"like", "repeat", "include"}
"""Words of entries that no model sees; Python has functions and loops."""


def models_in(annotation: Any) -> list[Any]:
    """All models that a field may hold, however deep."""
    if annotation in BY_MODEL:
        return [annotation]
    return [model for inner in get_args(annotation) for model in models_in(inner)]


def built(value: Any, models: list[Any]) -> Any:
    """Data of a file made anew by the builders of what it holds."""
    if isinstance(value, list):
        return tuple(built(each, models) for each in value)
    if not isinstance(value, dict):
        return value
    fits = [model for model in models
            if value.keys() <= {field.alias or name for name, field in model.model_fields.items()}
            and ("type" not in value or ("type" in model.model_fields and get_args(
                model.model_fields["type"].annotation)[0] == value["type"]))]
    if WRITTEN_OUT & value.keys():
        return value
    if not fits:  # names to entries
        return {key: built(each, models) for key, each in value.items()}
    inner = {field.alias or name: models_in(field.annotation)
             for name, field in fits[0].model_fields.items()}
    words = {word_of(key): built(each, inner[key]) for key, each in value.items() if key != "type"}
    return BY_MODEL[fits[0]](**words)


@pytest.mark.parametrize("name", sorted(shipped_scenes()))
def test_every_scene_can_be_built(name: str) -> None:
    data = json.loads(shipped_scenes()[name].read_text(encoding="utf-8"))
    made = built(data, [build.scene.model])
    assert made == data
    assert list(made) == list(data)


def test_a_scene_that_is_built_is_the_one_of_the_file() -> None:
    b = build
    made = b.scene(
        "weight", run=b.run(duration="0.1 s"), gravity=(0, -9.81), parameters={"load": "200 g"},
        bodies=[b.body("frame", motion="fixed"),
                b.body("bob", at=np.array([0.1, 0.0]), mass="=load",
                       shapes=[b.shape.circle(radius="10 mm")])],
        joints=[b.joint.pin("axle", a="frame", b="bob", on_a=(0, 0))],
        drives=[b.drive.torque("push", joint="axle",
                               value=b.signal.ramp(from_=0, to="0.1 N m", over="50 ms"))],
        expect=[b.expect(max="axle.angle", below=10, because="it has little time")])
    data = {
        "name": "weight", "run": {"duration": "0.1 s"}, "gravity": [0, -9.81],
        "parameters": {"load": "200 g"},
        "bodies": [{"name": "frame", "motion": "fixed"},
                   {"name": "bob", "at": [0.1, 0.0], "mass": "=load",
                    "shapes": [{"type": "circle", "radius": "10 mm"}]}],
        "joints": [{"type": "pin", "name": "axle", "a": "frame", "b": "bob", "on_a": [0, 0]}],
        "drives": [{"type": "torque", "name": "push", "joint": "axle",
                    "value": {"from": 0, "to": "0.1 N m", "over": "50 ms"}}],
        "expect": [{"max": "axle.angle", "below": 10, "because": "it has little time"}]}
    assert json.loads(json.dumps(made)) == data
    assert sandbox.load_scene(made) == sandbox.load_scene(data)
    assert [verdict.ok for verdict in sandbox.simulate(made).verdicts] == [True]


@pytest.mark.parametrize(("work", "words"), [
    (lambda: build.body("a", mas=1), r"build.body: there is no 'mas'. Did you mean 'mass'\?"),
    (lambda: build.joint.pin("a", b="x"), r"build.joint.pin: 'a' must be given"),
    (lambda: build.body(at=[0, 0]), "'name' must be given"),
    (lambda: build.body("a", "b"), "only the name may stand alone"),
    (lambda: build.body("a", name="b"), "only the name may stand alone"),
    (lambda: build.shape.circle(3), "words for all, such as 'radius'"),
    (lambda: build.signal.ramp(**{"from": 1}), r"there is no 'from'. Did you mean 'from_'\?"),
])
def test_wrong_words_are_refused_where_they_stand(work: Any, words: str) -> None:
    with pytest.raises(sandbox.SceneError, match=words):
        work()


def test_a_builder_that_there_is_not() -> None:
    with pytest.raises(AttributeError, match=r"build.joint has no 'pinn'. Did you mean 'pin'\?"):
        build.joint.pinn  # noqa: B018
    with pytest.raises(AttributeError, match=r"build has no 'bodi'. Did you mean 'body'\?"):
        build.bodi  # noqa: B018
    assert "pin" in dir(build.joint)
    assert {"joint", "body"} <= set(dir(build))


def test_the_words_are_those_of_the_models() -> None:
    assert STUB.read_text(encoding="utf-8") == stub(), "run python docs/make_reference.py"
    said = inspect.getdoc(build.body)
    assert said is not None
    assert said.startswith("A rigid body:")
    assert "    mass: " in said
