"""``sandbox study``: which there are, and what comes of one."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
import pytest

from sandbox.cli.console import Console
from sandbox.cli.study import run_studies
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


def test_wrong_names(studies: dict[str, Study]) -> None:
    with pytest.raises(click.BadParameter, match=r"Did you mean 'first'\? Studies: first, second"):
        run_studies(studies, "frist", None, Console())
    with pytest.raises(click.BadParameter, match=r"no study is named 'x'\. Studies"):
        run_studies(studies, "x", None, Console())


def test_the_command(sandbox: Callable[..., Any]) -> None:
    said = sandbox("study", "--json")
    assert [s["name"] for s in json.loads(said.out)["studies"]] == list(STUDIES)
    said = sandbox("study", "proposal")
    assert said.code == 2
    assert "Did you mean 'proposals'?" in said.err
    assert list(Path().iterdir()) == []
