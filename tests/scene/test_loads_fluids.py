"""Loads as scenes write them: numbers with units, patterns, assemblies."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import pytest

import sandbox
from sandbox.scene.elements.loads import BuoyancyLoad, DragLoad, LawLoad
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

BALLS: list[dict[str, Any]] = [
    {"name": name, "mass": 1, "at": [i, 0], "shapes": [{"type": "circle", "radius": 0.1}]}
    for i, name in enumerate(("ball1", "ball2", "box"))]
WALL = {"name": "ballast", "motion": "fixed"}


def _mechanism(*loads: dict[str, Any], **more: Any) -> Mechanism:
    return expand(load_scene({"gravity": [0, -9.81], "bodies": [*BALLS, WALL], "loads": list(loads),
                              **more}))


@pytest.mark.parametrize(("bodies", "found"), [
    (None, [0, 1, 2]), ("ball*", [0, 1]), (["box", "ball[2]"], [1, 2]),
    (["ball1", "ball*"], [0, 1])])
def test_patterns_find_what_moves_freely(bodies: Any, found: list[int]) -> None:
    load = {"type": "drag", "name": "d", "linear": 1} | ({"bodies": bodies} if bodies else {})
    assert [body for _, body in _mechanism(load).loaded] == found


def test_an_assembly_takes_its_loads_along() -> None:
    part = {"type": "assembly", "name": "a", "at": [1, 2], "angle": "90 deg", "scale": 2,
            "mirror": "left-right", "bodies": BALLS, "loads": [
                {"type": "law", "name": "f", "bodies": "*", "at": [0.1, 0.2],
                 "force": ["=-x", "=y"]},
                {"type": "drag", "name": "d", "bodies": ["ball1"], "linear": 1, "flow": [3, 0]},
                {"type": "buoyancy", "name": "w", "bodies": "ball?", "level": 0.5}]}
    other = {"name": "other", "mass": 1, "shapes": [{"type": "circle", "radius": 0.1}]}
    made = expand(load_scene({"gravity": [0, -9.81], "bodies": [other], "parts": [part]}))
    law, drag, water = made.loads
    assert isinstance(law, LawLoad)
    assert isinstance(drag, DragLoad)
    assert isinstance(water, BuoyancyLoad)
    assert [(load.name, load.bodies) for load in made.loads] == [
        ("a.f", ("a.*",)), ("a.d", ("a.ball1",)), ("a.w", ("a.ball?",))]
    assert law.at == (-0.2, 0.4)
    assert law.force == ("=-x", "=y")
    assert (drag.flow, water.level) == ((3.0, 0.0), 0.5)
    on = [(made.loads[i].name, made.bodies[body].name) for i, body in made.loaded]
    assert on == [("a.f", "a.ball1"), ("a.f", "a.ball2"), ("a.f", "a.box"), ("a.d", "a.ball1"),
                  ("a.w", "a.ball1"), ("a.w", "a.ball2")]


# --- fluids


FLUIDS: dict[str, Any] = {
    "bodies": [{"name": "ground", "motion": "fixed"},
               {"name": "ram", "mass": 1, "inertia": 1, "at": [0.1, 0]}],
    "joints": [{"type": "pin", "name": "hinge", "a": "ground", "b": "ram", "on_a": [0, 0]}],
    "lines": [{"name": "oil", "chambers": [
        {"type": "cylinder", "a": "ground", "b": "ram", "area": "10 cm^2"},
        {"type": "vane", "joint": "hinge", "displacement": "2 ml/rad"}]},
        {"name": "air", "gas": 1.4, "volume": "1 l"}],
    "valves": [{"name": "tap", "a": "oil", "b": "air", "resistance": "1 bar s/l"}],
    "drives": [{"type": "flow", "name": "pump", "line": "oil", "value": "1 l/min"},
               {"type": "pressure", "name": "source", "line": "air", "value": "1 bar"},
               {"type": "opening", "name": "lever", "valve": "tap", "value": "50 %"}],
}


def fluid_problems(**changes: Any) -> list[sandbox.errors.Problem]:
    """What is said of the scene with keys set: ``lines__0__volume=3``; None takes a key away."""
    scene = deepcopy(FLUIDS)
    for path, value in changes.items():
        *way, last = path.split("__")
        at: Any = scene
        for step in way:
            at = at[int(step) if step.isdigit() else step]
        if value is None:
            del at[last]
        else:
            at[int(last) if last.isdigit() else last] = value
    with pytest.raises(sandbox.SceneError) as caught:
        sandbox.load_scene(scene)
    return list(caught.value.problems)


def test_the_scene_itself_is_right() -> None:
    oil, air = sandbox.expand(sandbox.load_scene(FLUIDS)).lines
    assert (oil.chambers[0].area, oil.chambers[1].displacement, air.volume) == (1e-3, 2e-6, 1e-3)


@pytest.mark.parametrize(("change", "path", "message", "more"), [
    ({"lines__0__chambers__0__b": "rum"}, "$.lines[0].chambers[0].b", "no body named 'rum'", "ram"),
    ({"lines__0__chambers__1__joint": "hing"}, "$.lines[0].chambers[1].joint",
     "no pin joint named 'hing'", "hinge"),
    ({"lines__0__chambers__0__area": "10 cm"}, "$.lines[0].chambers[0].area",
     "'cm' is a unit of length", "cm^2"),
    ({"lines__0__chambers__1__displacement": 0}, "$.lines[0].chambers[1]", "2 ml/rad", ""),
    ({"lines__1__volume": None}, "$.lines[1].volume", "outside of", "0.1 l"),
    ({"lines__1__modulus": 1e9}, "$.lines[1]", "a gas has no modulus", ""),
    ({"lines__0__least": 1}, "$.lines[0]", "a vacuum, to 0", ""),
    ({"lines__0__relief": -1}, "$.lines[0]", "more than 0 Pa", ""),
    ({"lines__0__pressure": "-2 bar"}, "$.lines[0]", "between least and relief", ""),
    ({"valves__0__b": "oil"}, "$.valves[0]", "joins two lines", ""),
    ({"valves__0__resistance": None}, "$.valves[0]", "a resistance greater than 0", ""),
    ({"valves__0__b": "airs"}, "$.valves[0].b", "no line named 'airs'", "air"),
    ({"drives__2__valve": "tip"}, "$.drives[2].valve", "no valve named 'tip'", "tap"),
    ({"drives__0__value": "1 bar"}, "$.drives[0].value", "'bar' is a unit of pressure", "l/min"),
    ({"drives__0": {"type": "pressure", "name": "more", "line": "air", "value": 0}},
     "$.drives[1].line", "the pressure of 'air' is set already, by 'more'", "one drive for each"),
])
def test_what_cannot_be(change: dict[str, Any], path: str, message: str, more: str) -> None:
    problem, = fluid_problems(**change)
    assert problem.path.startswith(path)
    assert message in problem.message
    assert more in f"{problem.allowed} {problem.hint}"
