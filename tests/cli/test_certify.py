"""``sandbox certify`` and ``sandbox verify`` as a user has them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any


def test_certified(sandbox: Callable[..., Any], scene: Callable[..., Path]) -> None:
    said = sandbox("certify", scene())
    assert said.code == 0
    assert "ball.contact.fy" in said.out
    assert said.out.rstrip().splitlines()[-1].startswith("Certified at h = 0.5 ms")
    assert list(Path().glob("*")) == [Path("ball.json")]


def test_not_certified(sandbox: Callable[..., Any], scene: Callable[..., Path]) -> None:
    said = sandbox("certify", scene(expect=[{"mean": "ball.x", "above": "1 m"}]))
    assert said.code == 1
    assert "Not certified: 1 of 1" in said.out


def test_as_json(sandbox: Callable[..., Any], scene: Callable[..., Path]) -> None:
    said = sandbox("certify", scene(), "--json")
    found = json.loads(said.out)
    assert found["certified"] is True
    assert found["exit_code"] == 0
    assert found["steps"] == [5e-4, 2.5e-4, 1.25e-4]
    quantity, = found["quantities"]
    assert quantity["kind"] in ("exact to rounding", "converged")
    assert len(quantity["values"]) == 3


def test_nothing_to_certify(sandbox: Callable[..., Any], scene: Callable[..., Path]) -> None:
    said = sandbox("certify", scene(expect=[]))
    assert said.code == 2
    assert "expects nothing" in said.err


def test_too_large_when_refined(sandbox: Callable[..., Any], scene: Callable[..., Path]) -> None:
    said = sandbox("certify", scene(), "--max-steps", 150)
    assert said.code == 2
    assert "quarter of the step" in said.err


def test_unknown_scene(sandbox: Callable[..., Any]) -> None:
    assert sandbox("certify", "no_such_scene").code == 2


def test_verify_one_case(sandbox: Callable[..., Any], tmp_path: Path) -> None:
    said = sandbox("verify", "--only", "atwood")
    assert said.code == 0
    assert "1 of 1 cases hold." in said.out
    assert list(Path().glob("*")) == []
    said = sandbox("verify", "--only", "atwood", "--out", "report", "--json")
    assert said.code == 0
    assert json.loads(said.out)["cases"][0]["ok"] is True
    assert {path.name for path in Path("report").iterdir()} == {
        "index.md", "results.json", "atwood.png"}


def test_verify_unknown_case(sandbox: Callable[..., Any]) -> None:
    said = sandbox("verify", "--only", "atwod")
    assert said.code == 2
    assert "Did you mean 'atwood'?" in said.err


def test_verify_into_a_file(sandbox: Callable[..., Any]) -> None:
    Path("taken").write_text("")
    said = sandbox("verify", "--only", "atwood", "--out", "taken")
    assert said.code == 2
