"""The JSON Schema: valid itself, true to what loads, and the shipped copy is current."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from sandbox.scene.library import shipped_scenes
from sandbox.scene.reference import scene_schema
from tests.scene.hand import hand

COMPOSING = ("four_motor", "nine_discs")  # the others are left to the nightly tests
schema = cache(scene_schema)


def _complaints(data: Any) -> list[str]:
    return [f"{error.json_path}: {error.message}"
            for error in jsonschema.Draft202012Validator(schema()).iter_errors(data)]


def test_it_is_a_schema_and_the_good_scene_agrees_with_it() -> None:
    jsonschema.Draft202012Validator.check_schema(schema())
    assert _complaints({"$schema": "scene.schema.json", **hand()}) == []


@pytest.mark.parametrize("name", [
    pytest.param(name, marks=() if name in COMPOSING else pytest.mark.nightly)
    for name in sorted(shipped_scenes())])
def test_shipped_scenes_agree_with_it(name: str) -> None:
    assert _complaints(json.loads(shipped_scenes()[name].read_text(encoding="utf-8"))) == []


def test_the_shipped_copy_is_current() -> None:
    folder = next(iter(shipped_scenes().values())).parent
    copy: Path = folder / "scene.schema.json"
    assert json.loads(copy.read_text(encoding="utf-8")) == schema(), (
        "scenes/scene.schema.json is outdated: python docs/make_reference.py writes it")


@pytest.mark.parametrize("change", [
    lambda scene: scene["bodies"][0].update(mas=1),
    lambda scene: scene["bodies"][0].pop("name"),
    lambda scene: scene["bodies"][0].update(at=[1]),
    lambda scene: scene["joints"][0].update(type="pivot"),
    lambda scene: scene["parts"][0].pop("like"),
    lambda scene: scene["parameters"].update({"a b": 1}),
    lambda scene: scene.update(bodys=[]),
    lambda scene: scene["drives"][0]["value"].update(to=1),
])
def test_it_marks_mistakes(change: Callable[[dict[str, Any]], Any]) -> None:
    scene = hand()
    change(scene)
    assert _complaints(scene)
