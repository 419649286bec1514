"""Diagnostics have a code of the table, a place and a line; scene/test_diagnostics.py has all."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import sandbox
from sandbox.cli.commands import invoke
from sandbox.errors import Problem

SCENE = """{
"run": {"duration": 1, "step": 0.001},
"bodies": [
{"name": "frame", "motion": "fixed"},
{"name": "disc", "mass": 1, "at": [0.1, 0], "shapes": [{"type": "circle", "radius": 0.01}]}
],
"springs": [{"type": "linear", "name": "back", "a": "disc", "b": "frame", "stiffness": 10}],
"expect": [{"max": "disc.x", "below": 1}]
}"""


@pytest.mark.parametrize(("old", "new", "code", "path"), [
    ('"expect"', '"parts": [{"name": "jaw", "include": "jaw"}], "expect"', "bad-include",
     "$.parts[0].include"),
    ('"circle", "radius": 0.01', '"drawing", "file": "no.svg"', "bad-drawing",
     "$.bodies[1].shapes[0]"),
    ('"max": "disc.x"', '"quantity": "disc.x", "at": 3', "bad-time", "$.expect[0].at"),
    ('"stiffness": 10', '"stiffness": 1e9', "stiff-step", "$.springs[0]"),
])
def test_wrong_input_has_a_code_and_a_place(
    old: str, new: str, code: str, path: str, tmp_path: Path, capsys: Any,
) -> None:
    assert diagnostics(SCENE, tmp_path, capsys) == []
    line = SCENE[:SCENE.index(old)].count("\n") + 1
    assert (code, path, line) in diagnostics(SCENE.replace(old, new, 1), tmp_path, capsys)


def diagnostics(text: str, folder: Path, capsys: Any) -> list[tuple[str, str, int]]:
    """Code, path and line of all errors and warnings of a scene."""
    (folder / "scene.json").write_text(text, encoding="utf-8")
    invoke(["check", str(folder / "scene.json"), "--json"])
    (scene,) = json.loads(capsys.readouterr().out)["scenes"]
    return [(each["code"], each["path"], each.get("line", 0))
            for each in (*scene["errors"], *scene["findings"])]


def test_a_diagnostic_without_a_known_code_cannot_be_made() -> None:
    with pytest.raises(KeyError, match="no diagnostic has the code 'my words'"):
        Problem("my words", "$")
    with pytest.raises(KeyError, match="no diagnostic has the code 'none'"):
        sandbox.SandboxError("my words", code="none")
