"""Warnings about gears, racks, joint lengths and pulleys, and the advice they give."""

from __future__ import annotations

import math
from typing import Any

import pytest

import sandbox
from sandbox.engine.inspect import inspect
from sandbox.errors import Problem

GROUND = {"name": "ground", "motion": "fixed"}


def problems_of(scene: dict[str, Any]) -> list[Problem]:
    return inspect(sandbox.expand(sandbox.load_scene({"run": {"duration": 0.1}, **scene})))


def disc(name: str, x: float, y: float = 0.0) -> dict[str, Any]:
    return {"name": name, "at": [x, y], "mass": 1, "inertia": 1e-3}


def pin(a: str, b: str) -> dict[str, Any]:
    return {"type": "pin", "name": f"{a}_{b}", "a": a, "b": b, "on_b": [0, 0]}


def findings(*bodies: dict[str, Any], joints: list[dict[str, Any]], **more: Any) -> list[Problem]:
    return problems_of({"bodies": [GROUND, *bodies], "joints": joints, **more})


def meshing(distance: float, **joint: Any) -> list[Problem]:
    """What is wrong with how two wheels on pins of the ground mesh."""
    return [problem for problem in findings(
        disc("a", 0), disc("b", distance), joints=[pin("ground", "a"), pin("ground", "b"), {
            "type": "gear", "name": "mesh", "a": "a", "b": "b", **joint}])
            if problem.element == "mesh"]


@pytest.mark.parametrize("kind", ["gear", "roll"])
@pytest.mark.parametrize(("radii", "inside", "advice"), [
    ((0.08, 0.02), False, 'or write "inside": true: then they fit as they are'),
    ((0.02, 0.08), True, "or leave 'inside' out: then they fit as they are"),
])
def test_gears_that_fit_the_other_way(
    kind: str, radii: tuple[float, float], inside: bool, advice: str,
) -> None:
    """|r_a - r_b| where r_a + r_b is required, and vice versa."""
    joint = {"type": kind, "radius_a": radii[0], "radius_b": radii[1]}
    distance = 0.1 if inside else 0.06
    (problem,) = meshing(distance, **joint, inside=inside)
    assert problem.advice.endswith(advice)
    assert meshing(distance, **joint, inside=not inside) == []
    (problem,) = meshing(distance + 1e-4, **joint, inside=inside)
    assert "inside" not in problem.advice


def rack(along: list[float], *, angle: float = 0.0, y: float = -0.06, groove_on: str = "ground",
         slot: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
    """A gear of 50 mm at the origin over a rack that slides along x, in a slot that is given."""
    ends = {"a": "ground", "b": "rack", "start": [-1, y], "end": [1, y]}
    if groove_on == "rack":
        turned = [math.cos(angle), -math.sin(angle)]
        ends = {"a": "rack", "b": "ground", "on_b": [0, y],
                "start": [-turned[0], -turned[1]], "end": turned}
    return {
        "bodies": [GROUND, {"name": "gear", "mass": 1, "inertia": 1e-3},
                   {"name": "rack", "at": [0, y], "angle": angle, "mass": 1, "inertia": 1e-3}],
        "joints": [{"type": "pin", "name": "axle", "a": "ground", "b": "gear", "on_b": [0, 0]},
                   {"type": "slot", "name": "rail", "turns": False, **ends, **(slot or {})},
                   {"type": "rack", "name": "mesh", "a": "gear", "b": "rack", "radius": 0.05,
                    "along": along, **more}]}


@pytest.mark.parametrize("groove_on", ["ground", "rack"])
@pytest.mark.parametrize(("along", "angle", "right"), [
    ([1, 1], 0.0, [1.0, 0.0]),
    ([1, 0], math.pi / 6, [math.cos(math.pi / 6), -0.5]),
])
def test_a_rack_that_slides_across_its_pitch_line(
    groove_on: str, along: list[float], angle: float, right: list[float],
) -> None:
    found = problems_of(rack(along, angle=angle, groove_on=groove_on))
    assert {problem.path for problem in found} == {"$.joints[2]"}
    assert "no joint holds its rack at the gear" in found[-1].message
    assert problems_of(rack(right, angle=angle, groove_on=groove_on, y=-0.05)) == []


@pytest.mark.parametrize(("joint", "fault", "field"), [
    ({"type": "rope", "longest": 0.4}, "it allows 0 mm to 400 mm", "longest"),
    ({"type": "rope", "longest": 0.9, "shortest": 0.6}, "it allows 600 mm to 900 mm", "shortest"),
    ({"type": "rod", "length": 0.4}, "its length is 400 mm", "length"),
])
def test_the_length_that_would_do(joint: dict[str, Any], fault: str, field: str) -> None:
    joints = [{"name": "j", "a": "ground", "b": "ball", **joint}]
    (problem,) = findings(disc("ball", 0.50002), joints=joints)
    assert fault in problem.message
    assert problem.advice.endswith(f"make {field!r} 500.02 mm")
    joints[0][field] = "500.02 mm"
    assert findings(disc("ball", 0.50002), joints=joints) == []


def cable(*guides: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"bodies": [GROUND, {"name": "a", "mass": 1, "inertia": 1e-3}],
            "tendons": [{"name": "cord", "guides": list(guides), **more}]}


POINT, WHEEL = {"body": "a", "at": [0.03, 0.04]}, {"body": "ground", "radius": 0.08}
PULLEYS = [{"body": body, "at": at, "radius": 0.05, "friction": 0.3}
           for body, at in (("ground", [0, 0]), ("a", [0.08, 0]))]
BELT = {"closed": True, "pretension": "10 N"}


@pytest.mark.parametrize(("guides", "more", "message", "advice"), [
    ([POINT, WHEEL], {}, "its guides 0 and 1 are 50 mm apart, a tangent needs 80 mm, as one is "
     "inside the wheel of the other", "put them 30 mm further apart"),
    ([{"body": "a", "at": [0.02, 0], "radius": 0.01}, WHEEL], {},
     "as one is inside the wheel of the other", "put them 50 mm further apart"),
    ([PULLEYS[0], {**PULLEYS[1], "side": "right"}], BELT, "a crossed tangent needs 100 mm",
     "put them 20 mm further apart, or make a wheel smaller, or give both the same 'side'"),
])
def test_overlapping_guides_are_the_only_problem_reported_of_a_tendon(
    guides: list[dict[str, Any]], more: dict[str, Any], message: str, advice: str,
) -> None:
    """It has no length, so that nothing else can be computed."""
    (problem,) = problems_of(cable(*guides, **more))
    assert message in problem.message
    assert problem.advice.startswith(advice)


def test_guides_clear_of_each_other_are_not_reported() -> None:
    assert problems_of(cable({**POINT, "at": [0.048, 0.064]}, WHEEL)) == []
    assert problems_of(cable(*PULLEYS, **BELT)) == []


@pytest.mark.parametrize(("value", "limits", "words", "advice"), [
    (90, ["-30 deg", "100 deg"], "sets hinge to 5157 deg", 'for degrees write "90 deg"'),
    ({"table": [[0, 0], [0.05, "-45 deg"], [0.1, 0]]}, ["-30 deg", "100 deg"],
     "sets hinge to -45 deg", "an angle within them"),
    (1.570796, ["-30 deg", "90 deg"], "", ""), (90, None, "", ""),
])
def test_a_servo_beyond_the_limits_of_its_hinge(
    value: object, limits: object, words: str, advice: str,
) -> None:
    hinge = {**pin("ground", "arm"), "name": "hinge", **({"limits": limits} if limits else {})}
    drive = {"type": "servo", "name": "s", "joint": "hinge", "torque": 5, "value": value}
    found = findings(disc("arm", 0), joints=[hinge], drives=[drive])
    assert [problem.path for problem in found] == ["$.drives[0].value"] * bool(words)
    assert all(words in problem.message and problem.advice.endswith(advice) for problem in found)


def mesh(**joint: Any) -> dict[str, Any]:
    return {"type": "gear", "name": "mesh", "a": "a", "b": "b", "radius_a": 0.02,
            "radius_b": 0.05, **joint}


@pytest.mark.parametrize(("joint", "distance", "severity", "words", "advice"), [
    (mesh(), 0.072, "warning", "teeth would push at 23.99 deg instead of 20 deg",
     "put them 70 mm apart, or make 'radius_b' 52 mm"),
    (mesh(), 0.065, "error", "its teeth overlap at t = 0",
     "put them 70 mm apart, or make 'radius_b' 45 mm"),
    (mesh(inside=True, radius_a=0.05, radius_b=0.02), 0.032, "warning",
     "its pitch circles touch at 30 mm", "put them 30 mm apart, or make 'radius_b' 18 mm"),
    (mesh(inside=True), 0.0, "error", "its centres are 0 mm apart", "put them 30 mm apart"),
    (mesh(type="roll"), 0.075, "warning", "its circles touch at 70 mm",
     "put them 70 mm apart, or make 'radius_b' 55 mm"),
    ({"type": "rack", "name": "mesh", "a": "a", "b": "b", "radius": 0.02, "along": [0, 1]}, 0.025,
     "warning", "its pitch line is 25 mm from the gear's centre",
     "move the rack or its 'on_b' by 5 mm, or make 'radius' 25 mm"),
])
def test_wrong_distances_of_gears_are_reported(
    joint: dict[str, Any], distance: float, severity: str, words: str, advice: str,
) -> None:
    problem, = meshing(distance, **joint)
    assert (problem.path, problem.severity) == ("$.joints[2]", severity)
    assert words in problem.message
    assert problem.advice.startswith(advice)


def test_correct_gears_are_not_reported() -> None:
    for joint, distance in ((mesh(), 0.07), (mesh(inside=True), 0.03)):
        assert meshing(distance, **joint) == []
    assert findings(disc("a", 0), disc("b", 0.07),
                    joints=[pin("ground", "a"), mesh(type="roll")]) == []


@pytest.mark.parametrize(("joint", "at", "words"), [
    (mesh(), (0.07, 0.0), "no joint holds its wheels together"),
    ({"type": "rack", "name": "mesh", "a": "a", "b": "b", "radius": 0.02}, (0.0, -0.02),
     "no joint holds its rack at the gear")])
def test_gears_that_nothing_holds(
    joint: dict[str, Any], at: tuple[float, float], words: str,
) -> None:
    problem, = findings(disc("a", 0), disc("b", *at), joints=[pin("ground", "a"), joint])
    assert problem.path == "$.joints[1]"
    assert words in problem.message


def test_held_by_a_spring_a_carrier_or_planets() -> None:
    """A spring may press wheels together; a sun without a bearing floats between its planets."""
    spring = {"type": "linear", "name": "press", "a": "ground", "b": "b", "stiffness": 100}
    pressed = {"joints": [pin("ground", "a"), mesh(backlash=1e-5)], "springs": [spring]}
    assert findings(disc("a", 0), disc("b", 0.07), **pressed) == []
    problem, = findings(disc("a", 0), disc("b", 0.07), **pressed | {
        "joints": [pin("ground", "a"), mesh()]})
    assert problem.message.startswith("only springs or tendons hold its wheels together")
    assert problem.advice == "give it a 'backlash', for example 0.01 mm"
    assert findings(disc("a", 0), disc("b", 0.07), disc("arm", 0),
                    joints=[pin("ground", "arm"), pin("arm", "a"), pin("arm", "b"), mesh()]) == []
    ring = {"type": "gear", "name": "outer{i}", "repeat": 3, "a": "ground", "b": "p{i}",
            "radius_a": 0.05, "radius_b": 0.015, "inside": True}
    floating = findings(
        disc("sun", 0), disc("arm", 0),
        {**disc("p{i}", 0.035), "repeat": {"count": 3, "circle": [0, 0]}},
        joints=[pin("ground", "arm"), {**pin("arm", "p{i}"), "repeat": 3, "name": "pin{i}"}, ring,
                {"type": "gear", "name": "inner{i}", "repeat": 3, "a": "sun", "b": "p{i}",
                 "radius_a": 0.02, "radius_b": 0.015}])
    assert floating == []
