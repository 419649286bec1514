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
"parameters": {"pull": 2},
"tables": {"law": {"points": [[0, 0], [1, 1]]}},
"materials": {"steel": {"friction": 0.2}},
"bodies": [
{"name": "frame", "motion": "fixed"},
{"name": "disc", "mass": 1, "at": [0.1, 0], "shapes": [{"type": "circle", "radius": 0.01}]},
{"name": "ball", "mass": 1, "at": [0.3, 0], "shapes": [{"type": "circle", "radius": 0.01}]}
],
"joints": [{"type": "pin", "name": "hinge", "a": "frame", "b": "disc", "on_b": [-0.1, 0]}],
"springs": [{"type": "linear", "name": "back", "a": "disc", "b": "ball", "stiffness": 10}],
"tendons": [{"name": "cord", "stiffness": 1e3, "guides": [{"body": "frame"}, {"body": "disc"}]}],
"drives": [{"type": "pull", "name": "winch", "tendon": "cord", "value": 0}],
"controllers": [{"type": "pid", "name": "law_1", "reads": "hinge.angle", "target": 0,
"writes": "winch", "kp": 1}],
"events": [{"name": "late", "at": "0.5 s", "set": {"law_1.target": 0.1}}],
"meters": [{"name": "far", "value": "=2 * disc.x"}],
"expect": [{"max": "disc.x", "below": 1}]
}"""

WRONG = r"""
"below": 1}]|"below": 1,}]|invalid-json|$.expect[0]
"step"|"stp"|unknown-key|$.run.stp
"expect"|"parts": [{"name": "jaw", "include": "jaw"}], "expect"|bad-include|$.parts[0].include
"circle", "radius": 0.01|"polyline", "points": [[0, 0], [1, 0]]|bad-outline|$.bodies[1]
"circle", "radius": 0.01|"drawing", "file": "no.svg"|bad-drawing|$.bodies[1].shapes[0]
"set": {"law_1.target": 0.1}|"release": ["winch"]|not-releasable|$.events[0].release[0]
"max": "disc.x"|"quantity": "disc.x", "at": 3|bad-time|$.expect[0].at
{"body": "frame"}|{"body": "disc"}|coincident-points|$.tendons[0]
"on_b": [-0.1, 0]|"on_a": [0, 0], "on_b": [-0.2, 0]|not-assembled|$.joints[0]
"at": [0.1, 0]|"at": [0.29, 0]|overlap|$.bodies[1]
"stiffness": 10|"stiffness": 1e9|stiff-step|$.springs[0]
"mass": 1, "at": [0.3|"mass": 1e-9, "at": [0.3|mass-ratio|$.bodies[2]
"""
"""Text of the scene, its replacement, and code and JSON path of the diagnostic."""


def test_the_scene_itself_is_sound(tmp_path: Path, capsys: Any) -> None:
    assert diagnostics(SCENE, tmp_path, capsys) == []


@pytest.mark.parametrize("row", WRONG.strip("\n").split("\n"))
def test_wrong_input_has_a_code_and_a_place(row: str, tmp_path: Path, capsys: Any) -> None:
    old, new, code, path = row.split("|")
    line = SCENE[:SCENE.index(old)].count("\n") + 1
    found = diagnostics(SCENE.replace(old, new, 1), tmp_path, capsys)
    assert (code, path, line) in found


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
