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
@pytest.mark.parametrize(("along", "angle", "right", "turn"), [
    ([0, 1], 0.0, [1.0, 0.0], "90 deg"),
    ([1, 1], 0.0, [1.0, 0.0], "45 deg"),
    ([1, 0], math.pi / 6, [math.cos(math.pi / 6), -0.5], "30 deg"),
])
def test_a_rack_that_slides_across_its_pitch_line(
    groove_on: str, along: list[float], angle: float, right: list[float], turn: str,
) -> None:
    (problem,) = problems_of(rack(along, angle=angle, groove_on=groove_on))
    assert (problem.path, problem.element) == ("$.joints[2].along", "mesh")
    assert f"turned by {turn} from the groove of 'rail'" in problem.message
    x, y = (float(f"{v:.6g}") + 0.0 for v in right)
    assert problem.advice == (f"make 'along' [{x:g}, {y:.6g}], and move the rack or its 'on_b' by "
                              "10 mm")
    assert problems_of(rack(right, angle=angle, groove_on=groove_on, y=-0.05)) == []
    (problem,) = problems_of(rack(along, angle=angle, groove_on=groove_on, y=-0.05))
    assert problem.advice == f"make 'along' [{x:g}, {y:.6g}]"


@pytest.mark.parametrize(("joint", "fault", "field", "right"), [
    ({"type": "rope", "longest": 0.4}, "it allows 0 mm to 400 mm", "longest", "500.02 mm"),
    ({"type": "rope", "longest": 0.9, "shortest": 0.6}, "it allows 600 mm to 900 mm", "shortest",
     "500.02 mm"),
    ({"type": "rod", "length": 0.4}, "its length is 400 mm", "length", "500.02 mm"),
    ({"type": "actuator", "longest": 0.4}, "it allows 0 mm to 400 mm", "longest", "500.02 mm"),
])
def test_the_length_that_would_do(
    joint: dict[str, Any], fault: str, field: str, right: str,
) -> None:
    scene = {"bodies": [GROUND, {"name": "ball", "at": [0.50002, 0], "mass": 1, "inertia": 1e-3}],
             "joints": [{"name": "j", "a": "ground", "b": "ball", **joint}]}
    (problem,) = problems_of(scene)
    assert fault in problem.message
    assert problem.advice.endswith(f"make {field!r} {right}")
    scene["joints"][0][field] = right
    assert problems_of(scene) == []


def cable(*guides: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"bodies": [GROUND, {"name": "a", "mass": 1, "inertia": 1e-3}],
            "tendons": [{"name": "cord", "guides": list(guides), **more}]}


def test_a_point_within_a_wheel() -> None:
    point, wheel = {"body": "a", "at": [0.03, 0.04]}, {"body": "ground", "radius": 0.08}
    for one, other, k in ((point, wheel, 0), (wheel, point, 1)):
        (problem,) = problems_of(cable(one, other))
        assert problem.message == (f"its guide {k} is inside the wheel of its guide {1 - k}, 50 mm "
                                   "from its centre and 30 mm deep")
        assert problem.advice.startswith(f"move guide {k} out by this depth")
    assert problems_of(cable({**point, "at": [0.048, 0.064]}, wheel)) == []


def test_a_wheel_within_a_wheel() -> None:
    (problem,) = problems_of(cable({"body": "a", "at": [0.02, 0], "radius": 0.01},
                           {"body": "ground", "radius": 0.05}))
    assert problem.message == ("the wheel of its guide 0 is inside that of its guide 1: they are "
                               "20 mm apart, a tangent needs 40 mm")
    assert problem.advice.startswith("move one of them 20 mm further out")


def test_overlapping_pulleys_are_the_only_problem_reported_of_a_cable() -> None:
    """It has no length, of which nothing that is said could be right."""
    ends = {"radius": 0.05, "friction": 0.3}
    belt = {"closed": True, "pretension": "10 N"}
    (problem,) = problems_of(cable({"body": "ground", **ends},
                           {"body": "a", "at": [0.08, 0], "side": "right", **ends}, **belt))
    assert problem.message == ("the wheels of its guides 0 and 1 are 80 mm apart, a crossed "
                               "tangent needs 100 mm")
    assert problem.advice.startswith("put them 20 mm further apart")
    assert "give both the same 'side'" in problem.advice
    assert problems_of(cable({"body": "ground", **ends}, {"body": "a", "at": [0.08, 0], **ends},
                     **belt)) == []


SERVO = {
    "bodies": [GROUND, {"name": "arm", "mass": 1, "inertia": 1e-2}],
    "joints": [{"type": "pin", "name": "hinge", "a": "ground", "b": "arm", "on_b": [0, 0],
                "limits": ["-30 deg", "100 deg"]}]}


@pytest.mark.parametrize(("value", "words", "advice"), [
    (90, "sets hinge to 5157 deg, but its limits are [-30 deg, 100 deg]",
     'for degrees write "90 deg"'),
    ({"ramp": {"to": "120 deg", "over": 0.1}}, "sets hinge to 120 deg", "an angle within them"),
    ({"table": [[0, 0], [0.05, "-45 deg"], [0.1, 0]]}, "sets hinge to -45 deg",
     "an angle within them"),
])
def test_a_servo_beyond_the_limits_of_its_hinge(value: object, words: str, advice: str) -> None:
    drive = {"type": "servo", "name": "s", "joint": "hinge", "torque": 5, "value": value}
    (problem,) = problems_of(SERVO | {"drives": [drive]})
    assert (problem.path, problem.element) == ("$.drives[0].value", "s")
    assert words in problem.message
    assert problem.advice.endswith(advice)


@pytest.mark.parametrize(("limits", "value"), [
    (["-30 deg", "100 deg"], "90 deg"), (["-30 deg", "90 deg"], 1.570796), (None, 90)])
def test_a_servo_within_its_limits_or_without_any(limits: object, value: object) -> None:
    hinge = {**SERVO["joints"][0], "limits": limits}
    hinge = {key: each for key, each in hinge.items() if each is not None}
    drive = {"type": "servo", "name": "s", "joint": "hinge", "torque": 5, "value": value}
    assert problems_of(SERVO | {"joints": [hinge], "drives": [drive]}) == []


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


def test_centres_that_nothing_holds() -> None:
    problem, = findings(disc("a", 0), disc("b", 0.07), joints=[pin("ground", "a"), mesh()])
    assert (problem.path, problem.element) == ("$.joints[1]", "mesh")
    assert problem.message == "no joint holds its wheels together: teeth push 'a' and 'b' apart"
    assert "a pin on the ground or on a carrier" in problem.advice


def test_a_rack_that_nothing_holds() -> None:
    problem, = findings(disc("a", 0), disc("b", 0, -0.02), joints=[
        pin("ground", "a"), {"type": "rack", "name": "mesh", "a": "a", "b": "b", "radius": 0.02}])
    assert problem.message == ("no joint holds its rack at the gear: teeth push 'a' and 'b' apart")


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
