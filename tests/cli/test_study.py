"""``sandbox study``: which there are, and what comes of one."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
import pytest

from sandbox.cli.console import Console
from sandbox.cli.study import list_studies, run_studies
from sandbox.errors import OutputError
from sandbox.findings.registry import STUDIES, Study

MODULE = """
def run(directory, *, progress=None):
    progress(0.5)
    (directory / "deep").mkdir(exist_ok=True)
    (directory / "deep" / "table.csv").write_text("a,b")
    (directory / "picture.svg").write_text("<svg/>")
    progress(1.0)
    return "What came out: 42.\\n"
"""


@pytest.fixture
def studies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Study]:
    """Two studies by names of their own, in a module that writes two files."""
    (tmp_path / "small_study.py").write_text(MODULE)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.chdir(tmp_path)
    return {name: Study(name, f"about {name}", "small_study") for name in ("first", "second")}


def test_one_study(studies: dict[str, Study], capsys: Any) -> None:
    assert run_studies(studies, "first", None, Console()) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[:2] == ["first", "What came out: 42."]
    assert said[2].startswith("renders/studies/first: deep/table.csv, picture.svg  (")
    assert Path("renders/studies/first/picture.svg").is_file()


def test_all_studies(studies: dict[str, Study], capsys: Any) -> None:
    assert run_studies(studies, "all", Path("out"), Console(as_json=True)) == 0
    told = json.loads(capsys.readouterr().out)["studies"]
    assert [(s["name"], s["directory"]) for s in told] == [
        ("first", "out/first"), ("second", "out/second")]
    assert told[0]["text"] == "What came out: 42.\n"
    assert Path("out/second/deep/table.csv").is_file()


def test_only_what_was_written_is_told(studies: dict[str, Study], capsys: Any) -> None:
    Path("out").mkdir()
    Path("out/older.txt").write_text("left from before")
    assert run_studies(studies, "second", Path("out"), Console(as_json=True)) == 0
    assert json.loads(capsys.readouterr().out)["studies"][0]["files"] == [
        "deep/table.csv", "picture.svg"]


def test_wrong_names(studies: dict[str, Study]) -> None:
    with pytest.raises(click.BadParameter, match=r"Did you mean 'first'\? Studies: first, second"):
        run_studies(studies, "frist", None, Console())
    with pytest.raises(click.BadParameter, match=r"no study is named 'x'\. Studies"):
        run_studies(studies, "x", None, Console())


@pytest.mark.parametrize("many", [False, True])
def test_ctrl_c_says_what_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any, many: bool,
) -> None:
    (tmp_path / "stopped_study.py").write_text(
        "def run(directory, *, progress=None, **crew):\n    raise KeyboardInterrupt\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.chdir(tmp_path)
    studies = {"long": Study("long", "about", "stopped_study", many=many)}
    with pytest.raises(KeyboardInterrupt):
        run_studies(studies, "long", None, Console())
    said = capsys.readouterr().err
    assert ("all runs that were finished are in renders/studies/long, and the same command "
            "goes on" in said) is many


def test_nowhere_to_write(studies: dict[str, Study]) -> None:
    Path("taken").write_text("")
    with pytest.raises(OutputError, match="cannot write into taken"):
        run_studies(studies, "first", Path("taken"), Console())


def test_a_list(studies: dict[str, Study], capsys: Any) -> None:
    assert list_studies(studies, Console()) == 0
    rows = [line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines()]
    assert ["first", "about first"] in [[row[0], row[-1]] for row in rows]


def test_the_command(sandbox: Callable[..., Any]) -> None:
    said = sandbox("study", "--json")
    assert [s["name"] for s in json.loads(said.out)["studies"]] == list(STUDIES)
    said = sandbox("study", "proposal")
    assert said.code == 2
    assert "Did you mean 'proposals'?" in said.err
    assert list(Path().iterdir()) == []
