"""Loads as scenes write them: numbers with units, patterns, assemblies."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import pytest

import sandbox
from sandbox.model.compile import compile_mechanism
from sandbox.model.pairs import allowed_pairs
from sandbox.scene.expand import expand, to_json
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene
from sandbox.values.planes import share

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
    ({"lines__1__modulus": 1e9}, "$.lines[1]", "exclude each other", ""),
    ({"lines__0__least": 1}, "$.lines[0]", "a vacuum, to 0", ""),
    ({"lines__0__relief": -1}, "$.lines[0]", "more than 0 Pa", ""),
    ({"lines__0__pressure": "-2 bar"}, "$.lines[0]", "between least and relief", ""),
    ({"valves__0__b": "oil"}, "$.valves[0]", "a valve needs a line", ""),
    ({"valves__0__resistance": None}, "$.valves[0]", "a 'resistance' greater than 0", ""),
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


# --- planes


BALL: dict[str, Any] = {
    "name": "ball", "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}
FINGER: dict[str, Any] = {
    "type": "finger", "name": "f", "lengths": [0.03], "radii": [0.005], "masses": [0.01],
    "guides": [[-0.02, -0.005], [0.02, -0.005]]}


def loaded(plane: Any) -> sandbox.Scene:
    return sandbox.load_scene({"bodies": [{**BALL, "plane": plane}]})


@pytest.mark.parametrize(("written", "meant"), [
    (0, (0,)), (-3, (-3,)), ([2], (2,)), ([0, 1], (0, 1)), ("all", "all"), (1000, (1000,))])
def test_what_may_be_written(written: Any, meant: Any) -> None:
    scene = loaded(written)
    assert scene.bodies[0].plane == meant
    again = sandbox.load_scene(sandbox.expand(scene).model_dump(mode="json", by_alias=True))
    assert again.bodies == scene.bodies
    assert ('"plane"' in to_json(sandbox.expand(scene))) == (meant != (0,))


@pytest.mark.parametrize(("written", "message", "hint"), [
    ("al", "'al' is not a plane", "'all'"),
    (1.5, "the number 1.5 is not a plane", ""), (True, "true is not a plane", ""),
    ([0, [1]], "a list […] is not a plane", ""),
    ([], "expected 1 to 64 planes, got 0", ""),
    (1001, "1001 is not a plane", ""), (10**400, "so large a number is not a plane", "")])
def test_what_is_no_plane_is_refused_once(written: Any, message: str, hint: str) -> None:
    with pytest.raises(sandbox.SceneError) as refused:
        loaded(written)
    (problem,) = refused.value.problems
    assert (problem.path, problem.message, problem.hint) == ("$.bodies[0].plane", message, hint)


def test_the_table_of_all_pairs_is_that_of_each() -> None:
    planes: list[Any] = [(0,), (0, 1), "all", (-3, 7), (7,), (1,), "all"]
    scene = sandbox.load_scene({"bodies": [
        {**BALL, "name": f"b{i}", "at": [i, 0], "plane": plane if plane == "all" else list(plane)}
        for i, plane in enumerate(planes)]})
    allowed = allowed_pairs(compile_mechanism(sandbox.expand(scene)))
    for i, one in enumerate(planes):
        for j, other in enumerate(planes):
            assert allowed[i, j] == (i != j and share(one, other))


def test_a_part_lies_in_its_plane() -> None:
    made = sandbox.expand(sandbox.load_scene({"parts": [
        {**FINGER, "plane": 2},
        {"type": "section", "name": "s", "circle": 0.01, "square": 0.01, "rod": 0.03,
         "plane": [0, 2]}]}))
    planes = {body.name: body.plane for body in made.bodies if body.shapes}
    assert planes == {"f.palm": (2,), "f.proximal": (2,), "s.circle": (0, 2), "s.square": (0, 2)}
