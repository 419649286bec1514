"""Loading: all problems of a scene at once, each where it stands, in words that help."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.errors import Problem, SceneError
from sandbox.scene.document import Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene, read_scene
from sandbox.scene.settings import Run
from sandbox.values.paths import path_text
from tests.scene.hand import hand


def _problems(data: Any, **options: Any) -> list[Problem]:
    with pytest.raises(SceneError) as refused:
        load_scene(data, **options)
    return refused.value.problems


@pytest.mark.parametrize(("text", "hint"), [
    ("2 r", "'=2 * r'"), ("r * 2", "'=r * 2'"), ("2.5r", "'=2.5 * r'"), ("2 q", ""), ("r mm", ""),
])
def test_an_expression_without_its_sign(text: str, hint: str) -> None:
    (problem,) = _problems({"parameters": {"r": 0.1}, "bodies": [
        {"name": "disc", "mass": 1, "at": [text, 0], "inertia": 1}]})
    assert problem.path == "$.bodies[0].at[0]"
    assert problem.hint == hint or (not hint and "r" not in problem.hint)


def test_python_data_is_as_good_as_json() -> None:
    data = hand()
    data["bodies"][0]["at"] = (np.float32(0.5), np.int64(0))
    assert load_scene(data).bodies[0].at == (0.5, 0.0)
    assert "a key is text" in _problems({"parameters": {3: 1}})[0].message
    looped: dict[str, Any] = {}
    looped["run"] = looped
    assert "nested deeper" in _problems(looped)[0].message


def test_overrides() -> None:
    scene = load_scene(hand(), overrides={
        "run.step": "1 ms", "parameters.pull": "20 N", "bodies[disc].mass": "2 kg",
        "parts[finger1].springs.stiffness": 500, "parts[finger2].lengths[0]": "50 mm",
        "view.size": "[640, 480]", "$.bodies[1].at[0]": 3})
    assert scene.run.step == 0.001
    assert scene.parameters["each"] == 10.0
    assert scene.bodies[0].mass == 2.0
    assert scene.bodies[1].at == (3.0, 0.0)
    assert scene.view.size == (640, 480)
    one, two = scene.parts[:2]
    assert one.type == two.type == "finger"
    assert one.springs.stiffness == (500.0,)
    assert (one.lengths, two.lengths) == ((0.045, 0.026), (0.050, 0.026))


@pytest.mark.parametrize(("path", "value", "words", "hint"), [
    ("run.stp", 1, "unknown key 'stp' (set by an override)", "'step'"),
    ("parameters.pul", 1, "the scene has no parameter 'pul'", "'pull'"),
    ("bodies[disk].mass", 1, "nothing in 'bodies' is named 'disk'", "'disc'"),
    ("bodies[3].mass", 1, "'bodies' has no entry 3", ""),  # there are three
    ("bodies[0].mass.x", 1, "'mass' is the number 1 and has no 'x' in it", ""),
    ("run..step", 1, "'run..step' is not a path", ""),
    ("run", "[" * 10_000, "too many brackets", ""),
])
def test_overrides_that_lead_nowhere(path: str, value: Any, words: str, hint: str) -> None:
    (problem,) = _problems(hand(), overrides={path: value})
    assert words in problem.message
    assert (problem.hint, problem.line) == (hint, 0)


def test_mistakes_in_several_elements_are_reported_together() -> None:
    bodies = [{"name": "disc", "mass": "1 mm"}, {"name": "disc", "mass": 1, "inertia": 1},
              {"name": "wall", "motion": "fixed"}]
    joints = [{"type": "pin", "name": "p", "a": "wal", "b": "disc", "on_a": [0, 0]}]
    scene = {"bodies": bodies, "joints": joints, "expect": [
        {"max": "wall.x", "below": 1}, {"max": "wal.x", "below": 1},
        {"max": "wall.angel", "below": 1}, {"max": "solver.residual", "below": 1}]}
    assert {(each.code, each.path) for each in _problems(scene)} == {
        ("unknown-quantity", "$.expect[1].max"), ("unknown-quantity", "$.expect[2].max"),
        ("wrong-unit", "$.bodies[0].mass"), ("name-not-found", "$.joints[0].a")}


def test_very_many_problems_are_counted() -> None:
    data = hand()
    data["bodies"] += [{"name": f"b{i}", "mass": -1} for i in range(150)]
    problems = _problems(data)
    assert len(problems) == 101
    assert "more problems" in problems[-1].message


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
    | st.sampled_from(["=t", "=pull", "3 mm", "15 deg", "disc", "finger1", "=1/0", "circle", "*"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner,
                                                                max_size=3),
    max_leaves=6)


def _places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(
        value, list) else ()
    return [path, *(place for key, entry in inner for place in _places(entry, (*path, key)))]


def _scene_or_problems(data: Any, **options: Any) -> None:
    try:
        scene = load_scene(data, **options)
    except SceneError as error:
        refused = error
    else:
        assert isinstance(scene, Scene)
        return
    assert refused.problems
    assert str(refused).encode()  # no lone surrogates: it can be printed
    assert len(str(refused).splitlines()) == len(refused.problems)


@given(st.sampled_from([path_text(place) for place in _places(hand())])
       | st.text(max_size=30) | st.from_regex(r"[a-z]{1,6}(\[[a-z0-9]{1,8}\]|\.[a-z]{1,6}){0,3}"),
       json_values)
def test_any_override_sets_or_is_refused(path: str, value: Any) -> None:
    _scene_or_problems(hand(), overrides={path: value})


# --- a parameter of another unit, and settings that nothing reads any more


TWO = {"name": "two", "parameters": {"r": "20 mm", "k": 3, "twice": "=2 * r"},
         "bodies": [{"name": "disc", "mass": 1, "shapes": [{"type": "circle", "radius": "=r"}]}]}


@pytest.mark.parametrize("wrong", ["3 kg", "2 N/m", "10 deg"])
def test_a_parameter_of_another_dimension_is_refused(wrong):
    with pytest.raises(SceneError, match=r"unit of .*, and 'r' is in 'mm'.*Allowed: m, dm, cm"):
        load_scene(TWO, overrides={"parameters.r": wrong})


@pytest.mark.parametrize(("path", "value"), [
    ("parameters.r", "1 in"), ("parameters.r", 0.03), ("parameters.r", "=0.01 * k"),
    ("parameters.k", "4 N"), ("parameters.twice", "4 N")])
def test_without_a_unit_before_or_now_any_is_taken(path, value):
    assert load_scene(TWO, overrides={path: value})


def test_retired_settings_are_ignored_with_a_warning() -> None:
    loaded = read_scene({"run": {"step": "1 ms", "iterations": "many", "slop": None},
                         "bodies": [{"name": "still", "motion": "fixed"}]})
    assert loaded.scene.run.model_dump() == Run(step=1e-3).model_dump()
    assert [(each.path, each.severity) for each in loaded.ignored] == [
        ("$.run.iterations", "warning"), ("$.run.slop", "warning")]
    old = Mechanism().model_dump_json(by_alias=True).replace(
        '"sample_rate"', '"iterations":40,"slop":1e-06,"sample_rate"')
    assert Mechanism.model_validate_json(old).model_dump() == Mechanism().model_dump()
