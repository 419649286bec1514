"""``sandbox certify`` and ``sandbox verify`` as a user has them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sandbox.audit.figures import Figure
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import SimulationDiverged

from .conftest import BALL


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
    assert quantity["allowed"] == pytest.approx(0.1 * 0.01 * 0.01 * 9.81)
    assert (found["looks"], found["diverged"], found["advice"]) == ([], [], [])
    assert said.err == ""


def test_what_it_rests_on_and_what_would_do(
    sandbox: Callable[..., Any], scene: Callable[..., Path],
) -> None:
    """A ball that falls on: m v / h in a step or two, whatever the bound."""
    path = scene(expect=[{"max": "ball.contact.normal", "below": "1000 N"}],
                 bodies=[{**BALL["bodies"][0], "at": [0, 0.01]}, BALL["bodies"][1]])
    said = sandbox("certify", path)
    assert said.code == 1
    assert "diverges max ball.contact.normal: halving the step changes it by " in said.out
    assert said.out.splitlines()[-1].startswith("The peak of a blow has no limit")
    data = json.loads(sandbox("certify", path, "--json").out)
    assert data["quantities"][0]["kind"] == "diverges"
    assert data["advice"] == said.out.splitlines()[-1:]


def audited(monkeypatch: pytest.MonkeyPatch) -> None:
    """The audit of every run finds twice the energy that it lets pass."""
    figure = Figure("energy.created", 2e-3, "", 1e-3, "look", "given back", "")
    monkeypatch.setattr("sandbox.study.repeats.audit", lambda run: [figure])


def test_what_the_audit_says(
    sandbox: Callable[..., Any], scene: Callable[..., Path], monkeypatch: pytest.MonkeyPatch,
) -> None:
    audited(monkeypatch)
    said = sandbox("certify", scene())
    assert said.code == 1
    assert ("look energy.created (h, h/2, h/4): 2.0e-03, at most 1.0e-03 "
            "passes: given back") in said.out
    assert "the audit at h asks for a look at energy.created" in said.out
    data = json.loads(sandbox("certify", scene(), "--json").out)
    assert data["certified"] is False
    assert data["looks"][0]["runs"] == ["h", "h/2", "h/4"]
    assert data["looks"][0]["value"] == 2e-3


def test_a_run_that_diverges_exits_3(
    sandbox: Callable[..., Any], scene: Callable[..., Path], monkeypatch: pytest.MonkeyPatch,
) -> None:
    def away(mechanism: Any, **more: Any) -> Any:
        if mechanism.run.step == 5e-4:
            simulation = Simulation(mechanism)
            simulation.run(20)
            gone = SimulationDiverged(0.01, "ball", "gone; a smaller run.step may help")
            gone.recording = simulation.finish(str(gone))
            raise gone
        return simulate(mechanism, **more)

    monkeypatch.setattr("sandbox.study.repeats.simulate", away)
    said = sandbox("certify", scene())
    assert said.code == 3
    assert said.err.splitlines()[0] == (
        "error: h: the simulation diverged at t = 0.01 s: ball: gone")
    assert "ball.contact.fy  mean           -  0.0981  0.0981" in said.out
    assert "try" not in said.err
    assert "certify from there, --set run.step=0.000125" in said.out
    said = sandbox("certify", scene(), "--json")
    data = json.loads(said.out)
    assert (said.code, data["exit_code"], data["status"]) == (3, 3, "diverged")
    assert [each["run"] for each in data["diverged"]] == ["h"]
    assert data["quantities"][0]["values"][0] is None


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


def test_verify_one_benchmark(sandbox: Callable[..., Any], tmp_path: Path) -> None:
    said = sandbox("verify", "--only", "car_axis", "--out", "report", "--json")
    assert said.code == 0
    found = json.loads(said.out)
    assert found["cases"] == []
    assert found["benchmarks"][0]["ok"] is True
    assert {path.name for path in Path("report").iterdir()} == {
        "benchmarks.md", "benchmarks.json", "benchmarks.png"}
    assert "1 of 1 benchmarks hold." in sandbox("verify", "--only", "car_axis").out


def test_verify_unknown_case(sandbox: Callable[..., Any]) -> None:
    said = sandbox("verify", "--only", "atwod")
    assert said.code == 2
    assert "Did you mean 'atwood'?" in said.err


def test_verify_into_a_file(sandbox: Callable[..., Any]) -> None:
    Path("taken").write_text("")
    said = sandbox("verify", "--only", "atwood", "--out", "taken")
    assert said.code == 2
