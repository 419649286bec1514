"""Advice of the inspection is right: a scene that follows it is told nothing of that any more."""

from __future__ import annotations

import math
from typing import Any

import pytest

import sandbox
from sandbox.engine.inspect import inspect
from sandbox.errors import Problem

GROUND = {"name": "ground", "motion": "fixed"}


def told(scene: dict[str, Any]) -> list[Problem]:
    return inspect(sandbox.expand(sandbox.load_scene({"run": {"duration": 0.1}, **scene})))


def of(element: str, scene: dict[str, Any]) -> list[Problem]:
    return [problem for problem in told(scene) if problem.element == element]


def wheels(distance: float, **joint: Any) -> dict[str, Any]:
    """Two wheels on pins of the ground, and what meshes between them."""
    return {
        "bodies": [GROUND, *({"name": name, "at": [x, 0], "mass": 1, "inertia": 1e-3}
                             for name, x in (("a", 0.0), ("b", distance)))],
        "joints": [*({"type": "pin", "name": f"on_{b}", "a": "ground", "b": b, "on_b": [0, 0]}
                     for b in "ab"),
                   {"type": "gear", "name": "mesh", "a": "a", "b": "b", **joint}]}


@pytest.mark.parametrize("kind", ["gear", "roll"])
@pytest.mark.parametrize(("radii", "inside", "advice"), [
    ((0.08, 0.02), False, 'or write "inside": true: then they fit as they are'),
    ((0.02, 0.08), True, "or leave 'inside' out: then they fit as they are"),
])
def test_gears_that_fit_the_other_way(
    kind: str, radii: tuple[float, float], inside: bool, advice: str,
) -> None:
    """|r_a - r_b| where r_a + r_b was asked for, and the other way round."""
    joint = {"type": kind, "radius_a": radii[0], "radius_b": radii[1]}
    distance = 0.1 if inside else 0.06
    (problem,) = of("mesh", wheels(distance, **joint, inside=inside))
    assert problem.advice.endswith(advice)
    assert of("mesh", wheels(distance, **joint, inside=not inside)) == []
    (problem,) = of("mesh", wheels(distance + 1e-4, **joint, inside=inside))
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
    (problem,) = told(rack(along, angle=angle, groove_on=groove_on))
    assert (problem.path, problem.element) == ("$.joints[2].along", "mesh")
    assert f"turned by {turn} from the groove of 'rail'" in problem.message
    x, y = (float(f"{v:.6g}") + 0.0 for v in right)
    assert problem.advice == (f"make 'along' [{x:g}, {y:.6g}], and move the rack or its 'on_b' by "
                              "10 mm")
    assert told(rack(right, angle=angle, groove_on=groove_on, y=-0.05)) == []
    (problem,) = told(rack(along, angle=angle, groove_on=groove_on, y=-0.05))
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
    (problem,) = told(scene)
    assert fault in problem.message
    assert problem.advice.endswith(f"make {field!r} {right}")
    scene["joints"][0][field] = right
    assert told(scene) == []


def cord(*guides: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"bodies": [GROUND, {"name": "a", "mass": 1, "inertia": 1e-3}],
            "tendons": [{"name": "cord", "guides": list(guides), **more}]}


def test_a_point_within_a_wheel() -> None:
    point, wheel = {"body": "a", "at": [0.03, 0.04]}, {"body": "ground", "radius": 0.08}
    for one, other, k in ((point, wheel, 0), (wheel, point, 1)):
        (problem,) = told(cord(one, other))
        assert problem.message == (f"its guide {k} is inside the wheel of its guide {1 - k}, 50 mm "
                                   "from its centre and 30 mm deep")
        assert problem.advice.startswith(f"move guide {k} out by this depth")
    assert told(cord({**point, "at": [0.048, 0.064]}, wheel)) == []


def test_a_wheel_within_a_wheel() -> None:
    (problem,) = told(cord({"body": "a", "at": [0.02, 0], "radius": 0.01},
                           {"body": "ground", "radius": 0.05}))
    assert problem.message == ("the wheel of its guide 0 is inside that of its guide 1: they are "
                               "20 mm apart, a tangent needs 40 mm")
    assert problem.advice.startswith("move one of them 20 mm further out")


def test_wheels_that_overlap_are_all_that_is_told_of_their_cord() -> None:
    """It has no length, of which nothing that is said could be right."""
    ends = {"radius": 0.05, "friction": 0.3}
    belt = {"closed": True, "pretension": "10 N"}
    (problem,) = told(cord({"body": "ground", **ends},
                           {"body": "a", "at": [0.08, 0], "side": "right", **ends}, **belt))
    assert problem.message == ("the wheels of its guides 0 and 1 are 80 mm apart, a crossed "
                               "tangent needs 100 mm")
    assert problem.advice.startswith("put them 20 mm further apart")
    assert "give both the same 'side'" in problem.advice
    assert told(cord({"body": "ground", **ends}, {"body": "a", "at": [0.08, 0], **ends},
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
    (problem,) = told(SERVO | {"drives": [drive]})
    assert (problem.path, problem.element) == ("$.drives[0].value", "s")
    assert words in problem.message
    assert problem.advice.endswith(advice)


@pytest.mark.parametrize(("limits", "value"), [
    (["-30 deg", "100 deg"], "90 deg"), (["-30 deg", "90 deg"], 1.570796), (None, 90)])
def test_a_servo_within_its_limits_or_without_any(limits: object, value: object) -> None:
    hinge = {**SERVO["joints"][0], "limits": limits}
    hinge = {key: each for key, each in hinge.items() if each is not None}
    drive = {"type": "servo", "name": "s", "joint": "hinge", "torque": 5, "value": value}
    assert told(SERVO | {"joints": [hinge], "drives": [drive]}) == []
