"""Ranges of numbers: those that stand in a scene, and those that follow from them."""

from __future__ import annotations

import math
from typing import Any

import pytest

import sandbox
from sandbox.errors import SceneError
from sandbox.scene.read.load import load_scene
from sandbox.scene.values.numbers import number_from
from sandbox.scene.values.ranges import ANY, RANGES, in_range, size_fault
from sandbox.scene.values.units import Measured
from sandbox.wording import WrongValueError


def refused(**scene: Any) -> str:
    with pytest.raises(SceneError) as found:
        load_scene(scene)
    return str(found.value)


def body(**keys: Any) -> list[dict[str, Any]]:
    return [{"name": "a", **keys}]


def box(*size: float) -> list[dict[str, Any]]:
    return [{"type": "box", "size": list(size)}]


FORCE = {"type": "force", "name": "push", "body": "a", "direction": [1, 0], "value": 1}
DISC = {"name": "a", "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}


@pytest.mark.parametrize("dimension", ["length", "force"])
def test_a_number_at_the_end_of_its_range(dimension: str) -> None:
    most, least = RANGES[dimension].most, RANGES[dimension].least
    assert number_from(-most, dimension, {}) == -most
    assert size_fault(most, dimension) == size_fault(least, dimension) == ""
    with pytest.raises(WrongValueError, match="too large"):
        number_from(-most * 1.000001, dimension, {})
    assert size_fault(most * 1.000001, dimension)
    assert size_fault(least * 0.999999, dimension)
    assert size_fault(math.nan, dimension).startswith("no finite number")


def test_a_number_of_any_dimension_has_the_range_of_its_unit() -> None:
    assert in_range(1e7, None) == 1e7
    with pytest.raises(WrongValueError) as found:
        in_range(Measured(1e7, "mm"), None)
    assert found.value.allowed == "a magnitude of at most 1e+06 m"
    with pytest.raises(WrongValueError):
        in_range(2 * ANY.most, None)


@pytest.mark.parametrize(("keys", "path", "what"), [
    ({"mass": 1, "shapes": box(1, 1e155)}, "$.bodies[0].shapes[0].size[1]", "1e+155"),
    ({"mass": 5e-324, "inertia": 1}, "$.bodies[0].mass", "at least 1e-12 kg"),
    ({"density": 1e12, "shapes": box(1e6, 1e6)}, "$.bodies[0]", "mass is 1e+22"),
    ({"mass": 1e-12, "shapes": [{"type": "circle", "radius": 1e-9}]}, "$.bodies[0]",
     "inertia is 5e-31"),
    ({"motion": "fixed", "shapes": [{"type": "polygon", "points": [
        [0, 0], [1e-12, 0], [0, 1]]}]}, "$.bodies[0].shapes[0].points", "shortest side"),
    ({"motion": "scheduled", "path": {"x": "=1e8 * t"}}, "$.bodies[0].path.x", "too large"),
    ({"motion": "scheduled", "path": {"x": {"table": [[0, 0], [0.5, 1e9], [1, 0]]}}},
     "$.bodies[0].path.x", "1e+09 is too large"),
])
def test_a_body(keys: dict[str, Any], path: str, what: str) -> None:
    told = refused(bodies=body(**keys))
    assert told.startswith(f"{path}: ")
    assert what in told
    assert told.count("\n") == 0


@pytest.mark.parametrize(("keys", "what"), [
    ({"direction": [5e-324, 5e-324]}, "$.drives[0].direction: as a direction its length is"),
    ({"value": "=1e20 * t"}, "$.drives[0].value: 9.98"),
    ({"value": {"to": 1e17, "over": 0.1}}, "$.drives[0].value: 1e+17 is too large"),
])
def test_a_drive(keys: dict[str, Any], what: str) -> None:
    assert refused(bodies=[DISC], drives=[{**FORCE, **keys}]).startswith(what)


def test_a_rate_so_small_that_no_step_can_be_counted() -> None:
    event = {"name": "e", "when": "=a.x > 0", "rate": 5e-324, "set": {"push": 1}}
    told = refused(bodies=[DISC], drives=[FORCE], events=[event])
    assert told == "$.events[0].rate: must be at least 1e-09 Hz, got 4.94066e-324"
    assert refused(bodies=[DISC], run={"sample_rate": 5e-324}).startswith("$.run.sample_rate")


@pytest.mark.parametrize("scene", [
    {"parameters": "=load", "bodies": [{**DISC, "mass": "=load"}],
     "expect": [{"final": "a.x", "above": "=load"}]},
    {"parameters": "body"}, {"parameters": "body", "bodies": [{**DISC, "mass": "=body"}]},
])
def test_nothing_is_left_out_in_silence(scene: dict[str, Any]) -> None:
    assert refused(**scene).startswith("$.parameters: expected an object {…}")


def test_what_an_event_sets() -> None:
    scene = {"bodies": [{"name": "a", "mass": 1}], "drives": [
        {"type": "force", "name": "f", "body": "a", "direction": [1, 0], "value": 0}],
        "events": [{"name": "push", "at": 0.1, "set": {"f": 1e17}}]}
    with pytest.raises(sandbox.SceneError, match=r"set.f: 1e\+17 is too large.*at most 1e\+12 N"):
        sandbox.load_scene(scene)


def test_a_moment_that_was_not_tried_makes_the_run_diverge() -> None:
    """Its instant is none of those at which signals are looked at beforehand."""
    scene = sandbox.load_scene({
        "bodies": [{"name": "a", "mass": 1, "inertia": 1}],
        "drives": [{"type": "force", "name": "f", "body": "a", "direction": [1, 0],
                    "value": "=1e15 if abs(t - 0.7305) < 0.0006 else 0"}],
        "run": {"duration": 1, "step": 1e-3}})
    with pytest.raises(sandbox.SimulationDiverged) as caught:
        sandbox.simulate(scene)
    assert caught.value.recording is not None
    assert len(caught.value.recording) > 700


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("dimension", [None, "length"])
def test_what_is_no_number_is_in_no_range(value: float, dimension: str | None) -> None:
    with pytest.raises(WrongValueError, match="too large"):
        in_range(value, dimension)
