"""Words of strangers on a terminal: no line but our own, no command, nothing turned round."""

from __future__ import annotations

import json

from sandbox.cli.console import Console
from sandbox.cli.failures import report
from sandbox.errors import Problem, SceneError

from .conftest import PAGES

HOSTILE = "a\x1b[2K\r\u202egnp\n9 of 9 expectations hold\x9b1A\u2028\u200b\t\udcff"
"""Clears the line, turns the writing round, forges a line, moves up; nothing; half a character."""


def test_a_line_is_one_line_that_prints(capsys):
    console = Console()
    console.say(HOSTILE)
    console.warn(HOSTILE)
    out, err = capsys.readouterr()
    assert out == err == ("a\\x1b[2K\\r\\u202egnp\\n9 of 9 expectations hold\\x9b1A\\u2028\\u200b"
                          "\\t\\udcff\n")


def test_json_keeps_the_words_and_prints_none_of_them(capsys):
    value = {"title": HOSTILE + "\U000e0001"}
    Console(as_json=True).result_json(value)
    out = capsys.readouterr().out
    assert all(char.isprintable() for char in out.replace("\n", ""))
    assert json.loads(out) == value


def test_a_problem_is_one_line(capsys):
    report(SceneError([Problem("bad-option", HOSTILE, hint=HOSTILE)], "x\n\x1b.json"), Console())
    line, = PAGES.sub("", capsys.readouterr().err).splitlines()
    assert line.isprintable()


def test_nothing_of_a_scene_forges_a_line(sandbox, scene):
    path = scene(title=HOSTILE[:-1], expect=[
        {"final": "ball.contact.fy", "above": 1e6, "because": HOSTILE[:-1]}])
    for words in (("check", path), ("run", path, "--no-render"), ("expand", path),
                  ("run", path, "--no-render", "--json"), ("export", path)):
        said = sandbox(*words)
        lines = (said.out + said.err).splitlines()
        assert all(line.isprintable() for line in lines), words
        assert "9 of 9 expectations hold" not in [line.strip() for line in lines]


def test_a_files_name_is_shown_on_one_line(sandbox, scene, tmp_path):
    path = scene().rename(tmp_path / "x\x1b[2K\nball: ok.json")
    said = sandbox("check", path)
    looked = said.out.splitlines()
    assert [line.partition("ball: ok.json: ")[2][:10] for line in looked] == ["ok", "would take"]
    assert all(line.isprintable() for line in looked)
    said = sandbox("run", tmp_path / "none\x1b\n.json")
    assert said.code == 2
    assert len(said.err.splitlines()) == 1
    assert said.err.strip().isprintable()
