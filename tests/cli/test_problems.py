"""One way for a problem: read once, checked once, placed where it is written."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from sandbox.engine import inspect_control
from sandbox.engine.inspect import inspect
from sandbox.pages import ELEMENTS
from sandbox.scene.check import control, references
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.load import read_scene

from .conftest import BALL

ROPE = {"type": "rope", "name": "rope", "a": "floor", "b": "ball", "longest": 0.001}
CORD = {"name": "cord", "guides": [{"body": "floor"}, {"body": "floor"}, {"body": "ball"}]}
FINGER = {"type": "finger", "name": "finger", "lengths": ["45 mm"], "radii": ["9 mm"],
          "masses": ["12 g"], "guides": [["-22 mm", "-14 mm"], ["24 mm", "-8 mm"]],
          "springs": {"stiffness": "9e9 N/m", "from": ["-8 mm", "8 mm"], "to": ["8 mm", "8 mm"]}}
UNKNOWN = {"mean": "ball.contact.fz", "is": 0, "within": 1}


@pytest.fixture
def reads(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The scene's file, once for each time that it is opened to be read."""
    opened: list[str] = []
    plain = Path.open

    def counted(path: Path, mode: str = "r", *arguments: Any, **options: Any) -> Any:
        if path.name == "ball.json" and "r" in mode:
            opened.append(path.name)
        return plain(path, mode, *arguments, **options)

    monkeypatch.setattr(Path, "open", counted)
    return opened


@pytest.mark.parametrize("changes", [
    {}, {"expect": [UNKNOWN]}, {"tendons": [CORD]}],
    ids=["good", "unknown quantity", "no direction"])
@pytest.mark.parametrize("words", [
    ["check"], ["run", "--no-render", "--out", "out"], ["certify"], ["expand"], ["export"]],
    ids=lambda words: words[0])
def test_no_command_reads_a_file_twice(sandbox, scene, reads, words, changes):
    path = scene(**changes)
    sandbox(*words, path)
    assert reads == ["ball.json"]


def test_what_the_inspection_refuses_has_its_line(sandbox, scene):
    text = json.dumps(BALL | {"expect": [*BALL["expect"], UNKNOWN]}, indent=1)
    said = sandbox("check", scene(text), "--json")
    (problem,) = json.loads(said.out)["scenes"][0]["errors"]
    line = next(i for i, row in enumerate(text.splitlines(), 1) if "contact.fz" in row)
    assert (problem["path"], problem["line"]) == ("$.expect[1].mean", line)


def test_a_file_larger_than_usual_is_placed_in_too(sandbox, scene):
    """Its limit was raised for reading it, which is done once."""
    path = scene(about="x" * 6_000_000, expect=[UNKNOWN])
    said = sandbox("check", path, "--max-file-bytes", 10_000_000)
    assert "$.expect[0].mean: unknown quantity" in said.err


def test_what_blocks_and_has_a_name_is_told_by_both(sandbox, scene):
    text = json.dumps(BALL | {"tendons": [CORD]}, indent=1)
    path = scene(text)
    line = next(i for i, row in enumerate(text.splitlines(), 1) if "tendons" in row) + 1
    told = ("its guides 0 and 1 coincide; move one of them: the cord between has no direction")
    assert sandbox("check", path).err == f"{path}:{line}:3: $.tendons[0]: cord: {told}\n"
    (problem,) = json.loads(sandbox("check", path, "--json").out)["scenes"][0]["errors"]
    assert problem == {"message": told, "file": str(path), "path": "$.tendons[0]", "line": line,
                       "column": 3, "element": "cord",
                       "page": "docs/messages.md#guides-that-coincide",
                       "fields": f"{ELEMENTS}#tendon"}


def test_the_last_line_says_where_to_read_on(sandbox, scene):
    path = scene(tendons=[CORD], gravty=[0, 1])
    assert sandbox("check", path).pages == (
        "docs/messages.md#unknown-key explains it; "
        f"{ELEMENTS}#scene has the fields\n")
    assert sandbox("run", path, "--quiet").pages == ""
    said = sandbox("check", scene(joints=[ROPE]), "--json")
    (warning,) = json.loads(said.out)["scenes"][0]["findings"]
    assert warning["page"] == "docs/messages.md#not-assembled"
    assert sandbox("check", scene(joints=[ROPE])).pages == (
        "docs/messages.md#not-assembled explains it\n")


@pytest.fixture
def checks(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The checks of control that are made, each time that they are."""
    made: list[str] = []

    def count(module: Any, name: str) -> None:
        check = getattr(module, name)

        def counted(*arguments: Any) -> Any:
            made.append(name)
            return check(*arguments)

        monkeypatch.setattr(module, name, counted)

    count(references, "check_control")
    count(inspect_control, "control_problems")
    monkeypatch.setattr("sandbox.engine.inspect.control_problems",
                        inspect_control.control_problems)
    return made


def test_control_is_checked_once_in_a_run(sandbox, scene, checks):
    assert references.check_control is not control.check_control  # what is counted is in use
    assert sandbox("run", scene(), "--no-render").code == 0
    assert checks == ["check_control", "control_problems"]


def test_python_callers_are_checked_when_they_simulate(scene, checks):
    import sandbox

    mechanism = sandbox.expand(sandbox.load_scene(scene()))
    checks.clear()
    sandbox.simulate(mechanism)
    assert checks == ["check_control", "control_problems"]


def questionable() -> dict[str, Any]:
    """A scene with something to be said of every list that the inspection looks at."""
    scene = copy.deepcopy(BALL)
    scene["run"] |= {"step": 3e-4}
    scene["view"] = {"start": 9}
    scene["bodies"] += [{"name": "plate", "motion": "scheduled", "path": {"x": 0.3}},
                        {"name": "twin", "at": [0, 0.005], "mass": 0.01,
                         "shapes": [{"type": "circle", "radius": 0.005}]}]
    scene["joints"] = [ROPE, {"type": "pin", "name": "axle", "a": "floor", "b": "twin",
                              "on_b": [0, 0], "limits": ["-10 deg", "10 deg"]}]
    scene["springs"] = [{"type": "linear", "name": "band", "a": "floor", "b": "ball",
                         "stiffness": 1e9}]
    scene["tendons"] = [CORD, {"name": "idle", "guides": [
        {"body": "floor"}, {"body": "plate", "at": [0, 0.1]}]}]
    scene["drives"] = [{"type": "force", "name": "push", "body": "floor", "direction": [1, 0],
                        "value": 0},
                       {"type": "torque", "name": "twist", "joint": "axle", "value": 0}]
    scene["controllers"] = [{"type": "pid", "name": "loop", "reads": "axle.angle",
                             "writes": "twist", "target": "30 deg"}]
    scene["events"] = [{"name": "late", "when": "=axle.angle > 1", "stop": "pass"}]
    scene["parts"] = [FINGER]
    scene["expect"] = [UNKNOWN]
    return scene


def at(value: Any, path: str) -> Any:
    """What stands at a path of a mechanism."""
    from sandbox.scene.read.paths import parse_path

    for step in parse_path(path):
        value = value[step] if isinstance(step, int) else getattr(value, step)
    return value


def test_every_problem_of_the_inspection_has_the_path_of_its_element():
    loaded = read_scene(questionable())
    found = inspect(loaded.mechanism)
    heads = {problem.path.partition("[")[0].removeprefix("$.") for problem in found}
    assert heads == {"run", "view", "bodies", "joints", "springs", "tendons", "drives",
                     "controllers", "events", "expect"}
    for problem in found:
        assert at(loaded.mechanism, problem.path) is not None
        head = problem.path.split(".")[1]
        named = getattr(at(loaded.mechanism, f"$.{head}"), "name", head)
        assert problem.element in ("", named)
        assert bool(problem.element) == (head != "expect[0]")


def test_problems_of_the_mechanism_are_placed_in_the_file(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(questionable(), indent=1))
    lines = path.read_text().splitlines()
    loaded = read_scene(path)
    for problem, found in zip(placed := loaded.placed(inspect(loaded.mechanism)),
                              inspect(loaded.mechanism), strict=True):
        assert problem.line > 0
        of_part = found.element.startswith("finger.")
        assert problem.path == ("$.parts[0]" if of_part else found.path)
        assert problem.message == found.message  # the element's name says which of the part's
    assert any(problem.path == "$.parts[0]" for problem in placed)
    late = next(problem for problem in placed if problem.element == "late")
    assert lines[late.line - 1][late.column - 1:].startswith('"=axle.angle > 1"')


def test_the_scanner_of_places_rests_where_nothing_is_wrong(sandbox, monkeypatch):
    def scanned(*arguments: Any) -> Any:
        raise AssertionError("a good file needs no places")

    monkeypatch.setattr("sandbox.scene.read.source.scan", scanned)
    assert sandbox("check", shipped_scenes()["single_finger"]).code == 0


def test_warnings_of_copies_and_of_included_scenes_are_placed_too(sandbox, scene, tmp_path):
    """Of copies the first one's place and index, of an included file its own name and line."""
    scene("")  # the folder
    disc = {"name": "disc", "mass": 0.01, "at": [0, 0.3], "inertia": 1e-6}
    inner = {"bodies": [disc], "joints": [
        {**ROPE, "name": "short", "a": "floor", "b": "disc", "on_a": [0, 0]}]}
    (tmp_path / "inner.json").write_text(json.dumps(inner, indent=1))
    outer = json.dumps(BALL | {
        "joints": [{**ROPE, "name": "rope{i}", "repeat": 3}],
        "parts": [{"name": "in", "include": "inner"}]}, indent=1)
    (tmp_path / "outer.json").write_text(outer)
    said = sandbox("check", tmp_path / "outer.json").err
    copies = next(line for line in said.splitlines() if "rope0" in line)
    line = next(i for i, row in enumerate(outer.splitlines(), 1) if '"joints"' in row) + 1
    assert copies.startswith(f"{tmp_path / 'outer.json'}:{line}:3: warning: $.joints[0]: rope0: ")
    assert "(for i = 0)" in copies
    assert copies.endswith("(and so for 2 more)")
    included = next(line for line in said.splitlines() if "in.short" in line)
    assert "inner.json:" in included.split(" ")[0]
    assert "warning: $.joints[0]: in.short: not assembled" in included
