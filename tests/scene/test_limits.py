"""Limits: each holds at its bound, each can be raised, each says its name."""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.errors import SceneError
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits, check_limits
from sandbox.scene.read.load import load_scene


def _scene(count: int = 1, **run: Any) -> dict[str, Any]:
    bodies = [{"name": f"b{i}", "mass": 1, "inertia": 1} for i in range(count)]
    return {"bodies": bodies, "run": {"duration": 1, "step": 0.25, "sample_rate": 8, **run},
            "view": {"fps": 20, "size": [100, 100]}}


@pytest.mark.parametrize(("name", "most"), [
    ("bodies", 3), ("elements", 3), ("steps", 4), ("samples", 8), ("frames", 20),
    ("pixels", 10_000), ("recorded_bytes", 8 * 8 * (1 + 9 * 3)),
])
def test_each_limit(name: str, most: int) -> None:
    mechanism = Mechanism.model_validate(_scene(3))
    assert check_limits(mechanism, Limits().raised(**{name: most})) == []
    (problem,) = check_limits(mechanism, Limits().raised(**{name: most - 1}))
    assert f"the limit '{name}', raised by --max-{name.replace('_', '-')}" in problem.allowed
    with pytest.raises(SceneError, match=f"'{name}'"):
        load_scene(_scene(3), limits=Limits().raised(**{name: most - 1}))


def test_a_hundred_thousand_bodies() -> None:
    with pytest.raises(SceneError) as refused:
        load_scene({"bodies": [{}] * 100_000})
    (problem,) = refused.value.problems
    assert problem.message == "the scene has 100 000 bodies"
    assert problem.path == "$.bodies"


def test_corners_count_as_they_are_written() -> None:
    ring = [[0, 0], [9, 0], [9, 9], [0, 9]]
    hole = [[1, 1], [2, 1], [1, 2]]
    bodies = [{"name": "x", "motion": "fixed", "shapes": [
        {"type": "polygon", "points": ring, "holes": [hole]},
        {"type": "polyline", "points": [[0, 0], [1, 0]]}, {"type": "circle", "radius": 1}]}]
    assert load_scene({"bodies": bodies}, limits=Limits(corners=9))
    with pytest.raises(SceneError, match=r"outlines have 9 corners.*'corners'"):
        load_scene({"bodies": bodies}, limits=Limits(corners=8))
    with pytest.raises(SceneError, match="outlines have 42 000 corners"):
        load_scene({"bodies": [{"name": "x", "shapes": 21 * [{"type": "cam"}]}]})


def test_numbers_beyond_all_measure() -> None:
    with pytest.raises(SceneError, match=r"run\.duration: 1e\+300 is too large"):
        load_scene(_scene(duration=1e300))
    with pytest.raises(SceneError, match=r"steps of 1e-09 s is 1\.0e\+18 steps"):
        load_scene(_scene(duration=1e9, step=1e-9))


def test_unknown_limits() -> None:
    with pytest.raises(ValueError, match="unknown limit 'bodys'"):
        Limits().raised(bodys=1)
