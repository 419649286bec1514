"""Planes: what may be written for them, who meets whom, and what parts make of them."""

from __future__ import annotations

from typing import Any

import pytest

import sandbox
from sandbox.model.compile import compile_mechanism
from sandbox.model.pairs import allowed_pairs
from sandbox.scene.expand import to_json
from sandbox.scene.values.planes import share

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


@pytest.mark.parametrize(("written", "message"), [
    ("=n / 4", "'=n / 4' is 0.5, which is no plane"), ("=501 * n", "1002 is no plane"),
    ("=m", "unknown name 'm' in an expression")])
def test_what_computes_to_no_plane_is_refused(written: str, message: str) -> None:
    with pytest.raises(sandbox.SceneError) as refused:
        sandbox.load_scene({"parameters": {"n": 2}, "bodies": [{**BALL, "plane": written}]})
    (problem,) = refused.value.problems
    assert (problem.path, problem.message) == ("$.bodies[0].plane", message)


@pytest.mark.parametrize(("written", "message", "hint"), [
    ("al", "'al' is no plane", "'all'"),
    (1.5, "the number 1.5 is no plane", ""), (True, "true is no plane", ""),
    ([0, [1]], "a list […] is no plane", ""),
    ([], "expected 1 to 64 planes, got 0", ""),
    (1001, "1001 is no plane", ""), (10**400, "so large a number is no plane", "")])
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
