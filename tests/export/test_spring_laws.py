"""What MuJoCo gets of springs with laws: one-sided ones, or the reason why not."""

from __future__ import annotations

from typing import Any

import pytest

import sandbox
from sandbox.errors import SceneError
from sandbox.export import export_mechanism


def _exported(**spring: Any) -> str:
    ball = {"name": "m", "at": [1.1, 0], "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}
    scene = {"bodies": [{"name": "frame", "motion": "fixed"}, ball], "springs": [
        {"type": "linear", "name": "s", "a": "frame", "b": "m", "rest_length": 1, **spring}]}
    return export_mechanism(sandbox.expand(sandbox.load_scene(scene))).text


@pytest.mark.parametrize(("only", "free"), [("pull", "0 1"), ("push", "1 1000000")])
def test_a_one_sided_spring_has_lengths_at_which_it_gives_no_force(only: str, free: str) -> None:
    assert f'springlength="{free}"' in _exported(stiffness=300, only=only)


@pytest.mark.parametrize(("given", "what"), [
    ({"force": "=stretch ** 3"}, "a spring whose force is a law of its own"),
    ({"stiffness": 300, "only": "pull", "damping": 1}, "a damper that acts on one side only"),
])
def test_others_have_no_counterpart(given: dict[str, Any], what: str) -> None:
    with pytest.raises(SceneError, match=what):
        _exported(**given)
