"""Tables, and where words go."""

from __future__ import annotations

from sandbox.cli.console import Console, table


def test_a_table_lines_up_its_columns():
    assert table(["name", "N"], [["a", "1.5"], ["long", "10"]], right="<>") == [
        "name    N", "a     1.5", "long   10"]


def test_a_table_without_rows_is_its_head():
    assert table(["scene", "title"], []) == ["scene  title"]


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
