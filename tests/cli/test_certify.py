"""``sandbox certify`` and ``sandbox verify`` as a user has them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import SimulationDiverged


def test_certified(sandbox: Callable[..., Any], scene: Callable[..., Path]) -> None:
    said = sandbox("certify", scene())
    assert said.code == 0
    assert "ball.contact.fy" in said.out
    assert said.out.rstrip().splitlines()[-1].startswith("Certified at h = 0.5 ms")
    assert list(Path().glob("*")) == [Path("ball.json")]


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

    monkeypatch.setattr("sandbox.convergence.runs.simulate", away)
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


def test_nothing_to_certify(sandbox: Callable[..., Any], scene: Callable[..., Path]) -> None:
    said = sandbox("certify", scene(expect=[]))
    assert said.code == 2
    assert "expects nothing" in said.err
