"""Loading: all problems of a scene at once, each where it stands, in words that help."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sandbox.engine.inspect import inspect
from sandbox.errors import Problem, SceneError
from sandbox.scene.document import Scene
from sandbox.scene.library import find_scene, wholes
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene, read_scene
from sandbox.scene.settings import Run
from sandbox.values.paths import path_text
from tests.scene.hand import hand

Change = Callable[[dict[str, Any]], Any]


def _problems(data: Any, **options: Any) -> list[Problem]:
    with pytest.raises(SceneError) as refused:
        load_scene(data, **options)
    return refused.value.problems


def _broken(change: Change, **options: Any) -> list[Problem]:
    data = hand()
    change(data)
    return _problems(data, **options)


def _set(*path: Any) -> Change:
    """Set the value (last of ``path``) at a place; ``...`` in its stead removes the key."""
    *steps, last, value = path

    def change(data: Any) -> None:
        for step in steps:
            data = data[step]
        if value is ...:
            del data[last]
        else:
            data[last] = value

    return change


def test_the_good_scene_loads() -> None:
    scene = load_scene(hand())
    assert isinstance(scene, Scene)
    assert scene.parameters == {"pull": 15.0, "each": 7.5, "r": 0.009}
    assert [part.name for part in scene.parts] == ["finger1", "finger2", "section1", "tree"]
    assert scene.expect[0].value == 7.5


MISTAKES: list[tuple[Change, str, str, str]] = [
    (_set("bodies", 0, "mas", 1), "$.bodies[0].mas", "unknown key 'mas'", "'mass'"),
    (_set("bodies", 0, "name", ...), "$.bodies[0]", "'name' is missing", ""),
    (_set("bodies", 0, "mass", 0), "$.bodies[0].mass", "must be greater than 0, got 0", ""),
    (_set("bodies", 0, "mass", "1 mm"), "$.bodies[0].mass", "'mm' is a unit of length", ""),
    (_set("bodies", 0, "mass", [1]), "$.bodies[0].mass", "expected a number or a string", ""),
    (_set("bodies", 0, "mass", math.inf), "$.bodies[0].mass", "must be finite", ""),
    (_set("bodies", 0, "mass", "=pul"), "$.bodies[0].mass", "unknown name 'pul'", "'pull'"),
    (_set("bodies", 0, "mass", "=1 / 0"), "$.bodies[0].mass", "no finite value", ""),
    (_set("bodies", 0, "mass", "=(1).__class__"), "$.bodies[0].mass", "no place in an express", ""),
    (_set("bodies", 0, "velocity", ["1 mm/s", "2 N"]), "$.bodies[0].velocity[1]", "of force", ""),
    (_set("bodies", 1, "at", [1]), "$.bodies[1].at", "entry 1 of the list is missing", ""),
    (_set("bodies", 1, "at", 1), "$.bodies[1].at", "expected a list […], got the number 1", ""),
    (_set("bodies", 1, "motion", "fix"), "$.bodies[1].motion", "'fix' is not allowed", "'fixed'"),
    (_set("bodies", 1, "shapes", 0, "type", "polygone"), "$.bodies[1].shapes[0].type",
     "unknown type 'polygone'", "'polygon'"),
    (_set("bodies", 1, "shapes", 0, 5), "$.bodies[1].shapes[0]", "expected an object {…}", ""),
    (_set("bodies", 2, "name", "disc"), "$.bodies[2].name", "is already that of another body", ""),
    (_set("bodies", 2, "name", "1 cam"), "$.bodies[2].name", "'1 cam' is not a name", ""),
    (_set("joints", 0, "a", "wal"), "$.joints[0].a", "there is no body named 'wal'", "'wall'"),
    (_set("joints", 0, "b", "wall"), "$.joints[0]", "must be two bodies", ""),
    (_set("springs", 0, "joint", "leash"), "$.springs[0].joint", "no pin joint named 'leash'", ""),
    (_set("tendons", 0, "guides", [{"body": "disc"}]), "$.tendons[0].guides", "at least 2", ""),
    (_set("drives", 0, "tendon", "tre"), "$.drives[0].tendon", "no tendon named 'tre'", "'tree'"),
    (_set("drives", 0, "value", "ramp", "to", "3 mm"), "$.drives[0].value.ramp.to",
     "'mm' is a unit of length, but this is a force", ""),
    (_set("drives", 0, "value", "ramp", "ovr", 1), "$.drives[0].value.ramp.ovr", "key 'ovr'",
     "'over'"),
    (_set("drives", 2, "direction", [0, 0]), "$.drives[2].direction", "[0, 0] is no direction", ""),
    (_set("drives", 1, "shape", 1), "$.drives[1].shape", "shape 1 of 'disc' is a box", ""),
    (_set("drives", 1, "value", "=0.01 - t"), "$.drives[1].value", "not greater than 0 at t", ""),
    (_set("parts", 2, "circl", 1), "$.parts[2].circl", "unknown key 'circl'", "'circle'"),
    (_set("parts", 0, "like", "digits"), "$.parts[0].like", "no template 'digits'", "'digit'"),
    (_set("parts", 3, "pulls", 1, "fingr2"), "$.parts[3].pulls[1]", "named 'fingr2'", "'finger2'"),
    (_set("parts", 2, "name", "finger1"), "$.parts[2].name", "is taken by $.parts[0]", ""),
    (_set("parts", 2, "material", "ruber"), "$.parts[2]", "no material named 'ruber'", "'rubber'"),
    (_set("templates", "digit", "rads", 1), "$.templates.digit.rads", "unknown key", "'radii'"),
    (_set("parts", 1, "springs", "stiffness", -1), "$.parts[1].springs.stiffness", "0 or more", ""),
    (_set("parameters", "pull", "=each"), "$.parameters.each", "each → pull → each", ""),
    (_set("parameters", "t", 1), "$.parameters.t", "already means the time", ""),
    (_set("parameters", "a.b", 1), '$.parameters["a.b"]', "is not a parameter's name", ""),
    (_set("parameters", "a" * 101, 1), f'$.parameters["{"a" * 100}..."]', "not a parameter's", ""),
    (_set("title", "a\ud800"), "$.title", "half a character", ""),
    (_set("parameters", "a\udfff", 1), '$.parameters["a\\udfff"]', "half a character", ""),
    (_set("parameters", 3), "$.parameters", "expected an object {…}, got the number 3", ""),
    (_set("run", "step", 0), "$.run.step", "must be greater than 0", ""),
    (_set("run", "duration", 3.15e7), "$.run.duration", "63 000 000 000 steps", ""),
    (_set("view", "fps", 30), "$.view.fps", "30 is not allowed here", ""),
    (_set("contacts", 0, "between", 0, "finger1"), "$.contacts[0].between[0]", "no body's name",
     "'finger1.*'"),
    (_set("contacts", 0, "collide", "no"), "$.contacts[0].collide",
     "expected true or false, got the text 'no'", ""),
    (_set("materials", "rubber", "static", 0.5), "$.materials.rubber.static", "at least 1", ""),
    (_set("materials", "rubber", {"friction": 0, "static": 2}), "$.materials.rubber",
     "'static' is a multiple of 'friction', which is 0", ""),
    (_set("contacts", 0, {"between": ["disc", "*"], "friction": 0, "static": 2}), "$.contacts[0]",
     "'static' is a multiple of 'friction', which is 0", ""),
    (_set("groups", 0, "bodies", 0, "disk"), "$.groups[0].bodies[0]", "no body named", "'disc'"),
    (_set("meters", 0, "value", "=a +"), "$.meters[0].value", "'a +' is not an expression", ""),
    (_set("expect", 0, "within", "5 parsec"), "$.expect[0].within", "unknown unit 'parsec'", ""),
    (_set("expect", 0, "over", "last 1 N"), "$.expect[0].over", "unit of force", ""),
    (_set("expect", 0, "at", "1 ms"), "$.expect[0]", "'quantity' and 'at' go together", ""),
    (_set("expect", 0, {"quantity": "body.x", "at": "1 ms", "over": [0, "1 ms"], "is": 1}),
     "$.expect[0]", "'at' is one instant and 'over' a window: give one of them", ""),
    (_set("expect", 0, {"quantity": "body.x", "at": "-1 ms", "is": 1}),
     "$.expect[0].at", "0 or more", ""),
    (_set("format", 2), "$.format", "this version of sandbox reads format 1", ""),
    (_set("bodys", []), "$.bodys", "unknown key 'bodys'", "'bodies'"),
]


@pytest.mark.parametrize(("change", "path", "words", "hint"), MISTAKES)
def test_mistakes(change: Change, path: str, words: str, hint: str) -> None:
    problems = _broken(change)
    assert [problem.path for problem in problems] == [path]
    assert words in problems[0].message
    assert problems[0].hint == hint


def test_all_problems_at_once() -> None:
    data = hand()
    data["bodies"][0]["mass"] = -1
    data["joints"][1]["b"] = "dics"
    data["parameters"]["r"] = "9 kg mm"
    data["view"]["fsp"] = 20
    data["templates"]["digit"]["lengths"][0] = "4 s"
    assert {problem.path for problem in _problems(data)} == {
        "$.bodies[0].mass", "$.joints[1].b", "$.parameters.r", "$.view.fsp",
        "$.templates.digit.lengths[0]"}


@pytest.mark.parametrize(("text", "hint"), [
    ("2 r", "'=2 * r'"), ("r", "'=r'"), ("r * 2", "'=r * 2'"), ("2.5r", "'=2.5 * r'"),
    ("2 q", ""), ("2 m m", ""), ("r mm", ""),
])
def test_an_expression_without_its_sign(text: str, hint: str) -> None:
    (problem,) = _problems({"parameters": {"r": 0.1}, "bodies": [
        {"name": "disc", "mass": 1, "at": [text, 0], "inertia": 1}]})
    assert problem.path == "$.bodies[0].at[0]"
    assert problem.hint == hint or (not hint and "r" not in problem.hint)


def test_places_in_the_file(tmp_path: Path) -> None:
    path = tmp_path / "claw.json"
    text = json.dumps(hand(), indent=2).replace('"mass": 1,', '"mas": 1,').replace(
        '"joint": "hinge"', '"joint": "hing"', 1)
    path.write_text(text)
    with pytest.raises(SceneError) as refused:
        load_scene(path)
    lines = text.splitlines()
    for problem, start in zip(refused.value.problems, ('"mas"', '"hing"'), strict=True):
        assert lines[problem.line - 1][problem.column - 1:].startswith(start)
    assert re.match(rf"{re.escape(str(path))}:\d+:\d+: \$\.bodies\[0\]\.mas: unknown key 'mas'\. "
                    r"Did you mean 'mass'\? Allowed: .*\.\n", str(refused.value))


@pytest.mark.parametrize("content", ["[]", "null"])
def test_a_scene_is_an_object(tmp_path: Path, content: str) -> None:
    path = tmp_path / "x.json"
    path.write_text(content)
    assert "a scene is an object" in _problems(path)[0].message


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
    ("parts[finger1].lenghts[0]", 1, "there is no list 'lenghts' there", ""),
    ("run..step", 1, "'run..step' is not a path", ""),
    ("run", "[" * 10_000, "too many brackets", ""),
    ("run.step", "NaN", "'NaN' is not a number with a unit", ""),
])
def test_overrides_that_lead_nowhere(path: str, value: Any, words: str, hint: str) -> None:
    (problem,) = _problems(hand(), overrides={path: value})
    assert words in problem.message
    assert (problem.hint, problem.line) == (hint, 0)


def test_a_parameter_has_a_hundred_letters_at_most_and_depends_a_hundred_deep() -> None:
    def chain(deep: int) -> dict[str, Any]:
        return {"parameters": {f"p{i}": f"=p{i + 1}" for i in range(deep)} | {f"p{deep}": 7}}
    assert load_scene(chain(100)).parameters["p0"] == 7.0
    assert load_scene({"parameters": {"a" * 100: 1}}).parameters["a" * 100] == 1.0
    for deep in (101, 150):
        (problem,) = _problems(chain(deep))
        assert problem.path == "$.parameters.p101"
        assert "more than 100 deep" in problem.message


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
keys = st.sampled_from([
    "name", "type", "at", "shapes", "like", "value", "ramp", "table", "to", "over", "limits",
    "path",
    "parts", "templates", "parameters", "bodies", "run", "within", "springs", "rod", "square"])


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


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_a_mutated_scene_loads_or_is_refused(data: st.DataObject) -> None:
    scene = hand()
    for _ in range(data.draw(st.integers(1, 3))):
        *path, last = data.draw(st.sampled_from(_places(scene)[1:]))
        holder = scene
        for step in path:
            holder = holder[step]
        what = data.draw(st.sampled_from(["drop", "replace", "insert", "swap"]))
        if what == "drop":
            del holder[last]
        elif what == "insert" and isinstance(holder, dict):
            holder[data.draw(keys)] = data.draw(json_values)
        elif what == "swap":
            other = data.draw(st.sampled_from(_places(scene)))
            value: Any = scene
            for step in other:
                value = value[step]
            holder[last] = json.loads(json.dumps(value))
        else:
            holder[last] = data.draw(json_values)
    _scene_or_problems(scene)


@pytest.mark.parametrize(("path", "value"), [
    ("title", "\udcff"), ("view", {"\ud800": 1})])
def test_half_a_character_cannot_be_set(path: str, value: Any) -> None:
    problem, = _problems(hand(), overrides={path: value})
    assert "half a character" in problem.message


@given(st.dictionaries(keys | st.text(max_size=5), json_values, max_size=5))
def test_any_object_loads_or_is_refused(data: dict[str, Any]) -> None:
    _scene_or_problems(data)


@given(st.sampled_from([path_text(place) for place in _places(hand())])
       | st.text(max_size=30) | st.from_regex(r"[a-z]{1,6}(\[[a-z0-9]{1,8}\]|\.[a-z]{1,6}){0,3}"),
       json_values)
def test_any_override_sets_or_is_refused(path: str, value: Any) -> None:
    _scene_or_problems(hand(), overrides={path: value})


# --- a parameter of another unit, and settings that nothing reads any more


TWO = {"name": "two", "parameters": {"r": "20 mm", "k": 3, "twice": "=2 * r"},
         "bodies": [{"name": "disc", "mass": 1, "shapes": [{"type": "circle", "radius": "=r"}]}]}


@pytest.mark.parametrize("wrong", ["3 kg", "2 N/m", "10 deg"])
def test_a_parameter_of_another_dimension_is_told(wrong):
    with pytest.raises(SceneError, match=r"unit of .*, and 'r' is in 'mm'.*Allowed: m, dm, cm"):
        load_scene(TWO, overrides={"parameters.r": wrong})


@pytest.mark.parametrize(("path", "value"), [
    ("parameters.r", "1 in"), ("parameters.r", 0.03), ("parameters.r", "=0.01 * k"),
    ("parameters.k", "4 N"), ("parameters.twice", "4 N")])
def test_without_a_unit_before_or_now_any_is_taken(path, value):
    assert load_scene(TWO, overrides={path: value})


def test_retired_settings_do_nothing_and_are_told() -> None:
    scene = {"run": {"step": "1 ms", "iterations": "many", "slop": None},
             "bodies": [{"name": "still", "motion": "fixed"}]}
    run = load_scene(scene).run
    assert run.model_dump() == Run(step=1e-3).model_dump()
    assert run.ignored == ("iterations", "slop")
    (found,) = inspect(read_scene(scene).mechanism)
    assert str(found).startswith("warning: run: 'iterations' and 'slop' do nothing now")
    old = Mechanism().model_dump_json(by_alias=True).replace(
        '"sample_rate"', '"iterations":40,"slop":1e-06,"sample_rate"')
    assert Mechanism.model_validate_json(old).model_dump() == Mechanism().model_dump()


# --- the library


def test_wholes_are_what_nothing_includes():
    hands = wholes("hands")
    assert {"four_finger_opposed", "prosthesis", "objects"} <= set(hands)
    assert not {"digit", "thumb", "shelf", "object_l", "object_bottle"} & set(hands)
    assert "slider_crank" in wholes("mechanisms")


def test_unknown_scene_gets_a_near_miss():
    with pytest.raises(SceneError) as caught:
        find_scene("adaptive_grsap")
    (problem,) = caught.value.problems
    assert problem.hint == "'adaptive_grasp'"
    assert "'approach'" in problem.allowed


@pytest.mark.parametrize("name", ["x" * 5000, "a\0b", "", "no/such/place.json"])
def test_names_that_no_file_can_have(name):
    with pytest.raises(SceneError):
        find_scene(name)
