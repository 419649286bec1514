"""Where lines go, what a terminal may show, the progress bar."""

from __future__ import annotations

import json

from sandbox.cli.console import Console, report
from sandbox.errors import Problem, SceneError

from .conftest import PAGES

HOSTILE = "a\x1b[2K\r\u202egnp\n9 of 9 expectations passed\x9b1A\u2028\u200b\t\udcff"
"""Clears the line, turns the writing round, forges a line, moves up; nothing; half a character."""


def test_quiet_keeps_results_and_errors_and_json_keeps_stdout(capsys):
    for console in (Console(quiet=True), Console(as_json=True)):
        console.say("a")
        console.warn("b")
        console.document("c")
        console.error("d")
    assert capsys.readouterr() == ("c\nc\n", "d\na\nb\nd\n")


def test_a_line_is_one_printable_line(capsys):
    Console().say(HOSTILE)
    assert capsys.readouterr().out == (
        "a\\x1b[2K\\r\\u202egnp\\n9 of 9 expectations passed\\x9b1A\\u2028\\u200b\\t\\udcff\n")
    report(SceneError([Problem("bad-option", HOSTILE, hint=HOSTILE)], "x\n\x1b.json"), Console())
    line, = PAGES.sub("", capsys.readouterr().err).splitlines()
    assert line.isprintable()
    value = {"title": HOSTILE + "\U000e0001"}
    Console(as_json=True).finish(value)
    out = capsys.readouterr().out
    assert all(char.isprintable() for char in out.replace("\n", ""))
    assert json.loads(out)["title"] == value["title"]


def test_no_scene_can_forge_a_line(sandbox, scene, tmp_path):
    path = scene(title=HOSTILE[:-1], expect=[
        {"final": "ball.contact.fy", "above": 1e6, "because": HOSTILE[:-1]}])
    path = path.rename(tmp_path / "x\x1b[2K\nball: ok.json")
    for words in (("check", path), ("run", path, "--no-render"), ("check", path, "--expand"),
                  ("run", path, "--no-render", "--json"), ("export", path),
                  ("run", tmp_path / "none\x1b\n.json")):
        output = sandbox(*words)
        lines = (output.out + output.err).splitlines()
        assert all(line.isprintable() for line in lines), words
        assert not {"9 of 9 expectations passed", "ball: ok"} & {line.strip() for line in lines}
