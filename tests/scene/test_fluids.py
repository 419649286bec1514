"""Lines and valves that cannot be: one clear message each, with place and what is allowed."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import pytest

import sandbox

SCENE: dict[str, Any] = {
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


def wrong(**changes: Any) -> list[sandbox.errors.Problem]:
    """What is said of the scene with keys set: ``lines__0__volume=3``; None takes a key away."""
    scene = deepcopy(SCENE)
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
    oil, air = sandbox.expand(sandbox.load_scene(SCENE)).lines
    assert (oil.chambers[0].area, oil.chambers[1].displacement, air.volume) == (1e-3, 2e-6, 1e-3)


@pytest.mark.parametrize(("change", "path", "message", "more"), [
    ({"lines__0__chambers__0__b": "rum"}, "$.lines[0].chambers[0].b", "no body named 'rum'", "ram"),
    ({"lines__0__chambers__1__joint": "hing"}, "$.lines[0].chambers[1].joint",
     "no pin joint named 'hing'", "hinge"),
    ({"lines__0__chambers__0__area": "10 cm"}, "$.lines[0].chambers[0].area",
     "'cm' is a unit of length", "cm^2"),
    ({"lines__0__chambers__0__area": 0}, "$.lines[0].chambers[0].area", "greater than 0", ""),
    ({"lines__0__chambers__1__displacement": 0}, "$.lines[0].chambers[1]", "2 ml/rad", ""),
    ({"lines__1__volume": None}, "$.lines[1].volume", "outside of", "0.1 l"),
    ({"lines__1__gas": 3}, "$.lines[1].gas", "at most 2", ""),
    ({"lines__1__modulus": 1e9}, "$.lines[1]", "a gas has no modulus", ""),
    ({"lines__0__least": 1}, "$.lines[0]", "a vacuum, to 0", ""),
    ({"lines__0__relief": -1}, "$.lines[0]", "more than 0 Pa", ""),
    ({"lines__0__pressure": "-2 bar"}, "$.lines[0]", "between least and relief", ""),
    ({"valves__0__b": None, "valves__0__a": None}, "$.valves[0]", "joins two lines", ""),
    ({"valves__0__b": "oil"}, "$.valves[0]", "joins two lines", ""),
    ({"valves__0__resistance": None}, "$.valves[0]", "a resistance greater than 0", ""),
    ({"valves__0__b": "airs"}, "$.valves[0].b", "no line named 'airs'", "air"),
    ({"drives__0__line": "ram"}, "$.drives[0].line", "no line named 'ram'", ""),
    ({"drives__2__valve": "tip"}, "$.drives[2].valve", "no valve named 'tip'", "tap"),
    ({"drives__0__value": "1 bar"}, "$.drives[0].value", "'bar' is a unit of pressure", "l/min"),
    ({"drives__0": {"type": "pressure", "name": "more", "line": "air", "value": 0}},
     "$.drives[1].line", "the pressure of 'air' is set already, by 'more'", "one drive for each"),
])
def test_what_cannot_be(change: dict[str, Any], path: str, message: str, more: str) -> None:
    problem, = wrong(**change)
    assert problem.path.startswith(path)
    assert message in problem.message
    assert more in f"{problem.allowed} {problem.hint}"


def test_an_assembly_takes_its_lines_along() -> None:
    """Points are placed as those of springs; areas and volumes stay; the twin has its own names."""
    part = {"type": "assembly", "name": "left", "at": [1, 0], "mirror": "left-right", "scale": 2,
            **{key: SCENE[key] for key in ("bodies", "joints", "lines", "valves", "drives")}}
    made = sandbox.expand(sandbox.load_scene({"parts": [part]}))
    oil = made.lines[0]
    assert (oil.name, oil.chambers[0].a, oil.chambers[1].joint) == (
        "left.oil", "left.ground", "left.hinge")
    assert oil.chambers[0].area == 1e-3
    assert (made.valves[0].a, made.drives[2].valve) == ("left.oil", "left.tap")
