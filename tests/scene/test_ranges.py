"""Ranges of numbers: those that stand in a scene, and those that follow from them."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sandbox.errors import SceneError
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits, check_limits
from sandbox.scene.read.load import load_scene
from sandbox.values.numbers import number_from
from sandbox.values.units import RANGES, size_fault
from sandbox.wording import WrongValueError


@pytest.mark.parametrize("dimension", ["length", "force"])
def test_a_number_at_the_end_of_its_range(dimension: str) -> None:
    most, least = RANGES[dimension].maximum, RANGES[dimension].minimum
    assert number_from(-most, dimension, {}) == -most
    assert size_fault(most, dimension) == size_fault(least, dimension) == ""
    with pytest.raises(WrongValueError, match="too large"):
        number_from(-most * 1.000001, dimension, {})
    assert size_fault(most * 1.000001, dimension)
    assert size_fault(least * 0.999999, dimension)
    assert size_fault(math.nan, dimension).startswith("no finite number")


# --- limits


def _scene(count: int = 1, **run: Any) -> dict[str, Any]:
    bodies = [{"name": f"b{i}", "mass": 1, "inertia": 1} for i in range(count)]
    return {"bodies": bodies, "run": {"duration": 1, "step": 0.25, "sample_rate": 8, **run},
            "view": {"fps": 20, "size": [100, 100]}}


@pytest.mark.parametrize(("name", "most"), [
    ("bodies", 3), ("elements", 3), ("steps", 4), ("samples", 8), ("frames", 20),
    ("pixels", 10_000), ("recorded_bytes", 8 * 8 * (2 + 9 * 3)),
])
def test_each_limit(name: str, most: int) -> None:
    mechanism = Mechanism.model_validate(_scene(3))
    assert check_limits(mechanism, Limits(**{name: most})) == []
    (problem,) = check_limits(mechanism, Limits(**{name: most - 1}))
    assert f"the limit '{name}', raised by --limit {name}=N" in problem.allowed
    with pytest.raises(SceneError, match=f"'{name}'"):
        load_scene(_scene(3), limits=Limits(**{name: most - 1}))


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
