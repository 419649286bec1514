"""Tables, and where words go."""

from __future__ import annotations

from sandbox.cli.console import Console


def test_quiet_keeps_results_and_errors(capsys):
    console = Console(quiet=True)
    console.say("a")
    console.warn("b")
    console.result("c")
    console.error("d")
    assert capsys.readouterr() == ("c\n", "d\n")


def test_json_keeps_stdout_for_the_object(capsys):
    console = Console(as_json=True)
    console.say("a")
    console.warn("b")
    console.result_json({"ü": 1})
    assert capsys.readouterr() == ('{\n  "ü": 1\n}\n', "a\nb\n")
