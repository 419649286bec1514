"""What ``check`` says of gears, racks and rolling circles: the element, and what would be right."""

from __future__ import annotations

from typing import Any

import pytest

import sandbox
from sandbox.engine.inspect import inspect
from sandbox.errors import Problem


def wheel(name: str, x: float, y: float = 0.0) -> dict[str, Any]:
    return {"name": name, "at": [x, y], "mass": 1, "inertia": 1e-3}


def pin(a: str, b: str) -> dict[str, Any]:
    return {"type": "pin", "name": f"{a}_{b}", "a": a, "b": b, "on_b": [0, 0]}


def told(*bodies: dict[str, Any], joints: list[dict[str, Any]], **more: Any) -> list[Problem]:
    return inspect(sandbox.expand(sandbox.load_scene({
        "name": "x", "bodies": [{"name": "ground", "motion": "fixed"}, *bodies],
        "joints": joints, **more})))


def mesh(**joint: Any) -> dict[str, Any]:
    return {"type": "gear", "name": "mesh", "a": "a", "b": "b", "radius_a": 0.02,
            "radius_b": 0.05, **joint}


@pytest.mark.parametrize(("joint", "distance", "severity", "words", "advice"), [
    (mesh(), 0.072, "warning",
     "does not mesh as it should at t = 0: its centres are 72 mm apart, its pitch circles touch at "
     "70 mm; teeth would push at 23.99 deg instead of 20 deg",
     "put them 70 mm apart, or make 'radius_b' 52 mm"),
    (mesh(), 0.065, "error",
     "its teeth overlap at t = 0: its centres are 65 mm apart, its pitch circles touch "
     "at 70 mm", "put them 70 mm apart, or make 'radius_b' 45 mm"),
    (mesh(inside=True), 0.032, "warning", "its pitch circles touch at 30 mm",
     "put them 30 mm apart, or make 'radius_b' 52 mm"),
    (mesh(inside=True, radius_a=0.05, radius_b=0.02), 0.032, "warning",
     "its pitch circles touch at 30 mm", "put them 30 mm apart, or make 'radius_b' 18 mm"),
    (mesh(inside=True), 0.0, "error", "its centres are 0 mm apart", "put them 30 mm apart"),
    (mesh(type="roll"), 0.075, "warning",
     "not assembled at t = 0: its centres are 75 mm apart, its circles touch at 70 mm",
     "put them 70 mm apart, or make 'radius_b' 55 mm"),
    (mesh(type="roll", inside=True), 0.0, "error", "its circles touch at 30 mm",
     "put them 30 mm apart"),
    ({"type": "rack", "name": "mesh", "a": "a", "b": "b", "radius": 0.02, "along": [0, 1]}, 0.025,
     "warning", "its pitch line is 25 mm from the gear's centre, the pitch circle has a radius of "
     "20 mm", "move the rack or its 'on_b' by 5 mm, or make 'radius' 25 mm"),
])
def test_what_does_not_meet(
    joint: dict[str, Any], distance: float, severity: str, words: str, advice: str,
) -> None:
    found = told(wheel("a", 0), wheel("b", distance),
                 joints=[pin("ground", "a"), pin("ground", "b"), joint])
    problem, = (one for one in found if one.element == "mesh")
    assert (problem.path, problem.severity) == ("$.joints[2]", severity)
    assert words in problem.message
    assert problem.advice.startswith(advice)


def test_what_fits_is_not_told() -> None:
    for joint, distance in ((mesh(), 0.07), (mesh(inside=True), 0.03)):
        assert told(wheel("a", 0), wheel("b", distance),
                    joints=[pin("ground", "a"), pin("ground", "b"), joint]) == []
    assert told(wheel("a", 0), wheel("b", 0.07),
                joints=[pin("ground", "a"), mesh(type="roll")]) == []


def test_centres_that_nothing_holds() -> None:
    problem, = told(wheel("a", 0), wheel("b", 0.07), joints=[pin("ground", "a"), mesh()])
    assert (problem.path, problem.element) == ("$.joints[1]", "mesh")
    assert problem.message == "no joint holds its wheels together: teeth push 'a' and 'b' apart"
    assert "a pin on the ground or on a carrier" in problem.advice


def test_a_rack_that_nothing_holds() -> None:
    problem, = told(wheel("a", 0), wheel("b", 0, -0.02), joints=[
        pin("ground", "a"), {"type": "rack", "name": "mesh", "a": "a", "b": "b", "radius": 0.02}])
    assert problem.message == ("no joint holds its rack at the gear: teeth push 'a' and 'b' apart")


def test_held_by_a_spring_a_carrier_or_planets() -> None:
    """A spring may press wheels together; a sun without a bearing floats between its planets."""
    spring = {"type": "linear", "name": "press", "a": "ground", "b": "b", "stiffness": 100}
    pressed = {"joints": [pin("ground", "a"), mesh(backlash=1e-5)], "springs": [spring]}
    assert told(wheel("a", 0), wheel("b", 0.07), **pressed) == []
    problem, = told(wheel("a", 0), wheel("b", 0.07), **pressed | {
        "joints": [pin("ground", "a"), mesh()]})
    assert problem.message.startswith("only springs or tendons hold its wheels together")
    assert problem.advice == "give it a 'backlash', for example 0.01 mm"
    assert told(wheel("a", 0), wheel("b", 0.07), wheel("arm", 0),
                joints=[pin("ground", "arm"), pin("arm", "a"), pin("arm", "b"), mesh()]) == []
    ring = {"type": "gear", "name": "outer{i}", "repeat": 3, "a": "ground", "b": "p{i}",
            "radius_a": 0.05, "radius_b": 0.015, "inside": True}
    floating = told(
        wheel("sun", 0), wheel("arm", 0),
        {**wheel("p{i}", 0.035), "repeat": {"count": 3, "circle": [0, 0]}},
        joints=[pin("ground", "arm"), {**pin("arm", "p{i}"), "repeat": 3, "name": "pin{i}"}, ring,
                {"type": "gear", "name": "inner{i}", "repeat": 3, "a": "sun", "b": "p{i}",
                 "radius_a": 0.02, "radius_b": 0.015}])
    assert floating == []


@pytest.mark.parametrize(("joint", "path", "words"), [
    (mesh(stiffness=0), "$.joints[0].stiffness", "greater than 0"),
    (mesh(pressure_angle="50 deg"), "$.joints[0].pressure_angle", "must be at most 0.785398"),
    (mesh(inside=True, radius_b=0.02), "$.joints[0]", "must differ"),
    (mesh(type="roll", inside=True, radius_b=0.02), "$.joints[0]", "must differ"),
    (mesh(backlash=-1e-3), "$.joints[0].backlash", "must be 0 or more"),
    ({"type": "rack", "name": "mesh", "a": "a", "b": "b", "radius": 0.02, "along": [0, 0]},
     "$.joints[0].along", "[0, 0] is no direction"),
    ({"type": "rack", "name": "mesh", "a": "a", "b": "b", "radius": 0.02, "along": [1e-30, 0]},
     "$.joints[0].along", "as a direction its length is 1e-30"),
])
def test_values_that_no_wheel_can_have(joint: dict[str, Any], path: str, words: str) -> None:
    with pytest.raises(sandbox.SceneError) as caught:
        told(wheel("a", 0), wheel("b", 0.07), joints=[joint])
    problem, = caught.value.problems
    assert problem.path == path
    assert words in problem.message
