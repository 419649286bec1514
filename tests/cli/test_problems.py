"""One way for a problem: read once, checked once, placed where it is written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from sandbox.scene.read.models import ELEMENTS

from .conftest import BALL

ROPE = {"type": "rope", "name": "rope", "a": "floor", "b": "ball", "longest": 0.001}
CORD = {"name": "cord", "guides": [{"body": "floor"}, {"body": "floor"}, {"body": "ball"}]}
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


def test_what_blocks_and_has_a_name_is_told_by_both(sandbox, scene):
    text = json.dumps(BALL | {"tendons": [CORD]}, indent=1)
    path = scene(text)
    line = next(i for i, row in enumerate(text.splitlines(), 1) if "tendons" in row) + 1
    told = ("its guides 0 and 1 coincide; move one of them: the cord between has no direction")
    assert sandbox("check", path).err == f"{path}:{line}:3: $.tendons[0]: cord: {told}\n"
    (problem,) = json.loads(sandbox("check", path, "--json").out)["scenes"][0]["errors"]
    assert problem == {"message": told, "file": str(path), "path": "$.tendons[0]", "line": line,
                       "column": 3, "element": "cord",
                       "code": "coincident-points",
                       "fields": f"{ELEMENTS}#tendon"}


def test_the_last_line_says_where_to_read_on(sandbox, scene):
    path = scene(tendons=[CORD], gravty=[0, 1])
    assert sandbox("check", path).pages == (
        f"see docs/messages.md#unknown-key, {ELEMENTS}#scene\n")
    assert sandbox("run", path, "--quiet").pages == ""
    said = sandbox("check", scene(joints=[ROPE]), "--json")
    (warning,) = json.loads(said.out)["scenes"][0]["findings"]
    assert warning["code"] == "not-assembled"
    assert sandbox("check", scene(joints=[ROPE])).pages == "see docs/messages.md#not-assembled\n"


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
