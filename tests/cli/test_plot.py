"""``sandbox plot`` and ``sandbox compare`` as a user has them."""

from __future__ import annotations

import csv
import json
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sandbox.cli.runs import PICTURES
from sandbox.draw.figure.style import SUFFIXES
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Status
from tests.cli.conftest import BALL
from tests.samples.controlled import recording, scene

Sandbox = Callable[..., Any]


@pytest.fixture
def runs(sandbox: Sandbox) -> None:
    """Two runs with controllers and one without, in renders/ of an empty directory."""
    recording(reach=(1, 1, 0.5)).save("renders/controlled")
    recording(scene("other"), zeta=0.3, omega=9).save("renders/other")
    recording(scene("free", controllers=[]), zeta=0.9).save("elsewhere/free")


@pytest.mark.usefixtures("runs")
def test_several_files(sandbox: Sandbox) -> None:
    said = sandbox("plot", "renders/controlled", "finger.?ip.angle", "finger.mcp.angle", "--out",
                   "a.svg", "--out", "new/b.pdf", "--json")
    told = json.loads(said.out)
    assert told["files"] == ["a.svg", "new/b.pdf"]
    assert Path("a.svg").read_text().count("<svg") == 1
    assert Path("new/b.pdf").read_bytes().startswith(b"%PDF")
    assert told["responses"]["finger.mcp.angle"]["settling"] == pytest.approx(0.9905, abs=1e-4)
    assert told["responses"]["finger.dip.angle"]["settling"] is None
    assert PICTURES == SUFFIXES


@pytest.mark.usefixtures("runs")
def test_any_quantities(sandbox: Sandbox) -> None:
    said = sandbox("plot", "controlled.json", "finger.mcp.angle", "k?.value")
    assert said.code == 0
    assert Path("renders/controlled/plot.png").is_file()
    assert "finger.mcp.angle: settled" in said.out


@pytest.mark.parametrize(("words", "told"), [
    (["plot", "controled", "x"], "did you mean 'controlled'?; 'sandbox run' makes one"),
    (["plot", "controlled", "--figure", "finger-control"], "docs/studies/finger_control.py"),
    (["plot", "controlled", "--x", "k1.value"], "'sandbox plot RUN' lists them"),
    (["plot", "controlled", "k2.value", "--x", "k1.valeu"], "Did you mean 'k1.value'?"),
    (["plot", "controlled", "k1.value", "--from", "5 mm"], "this is a time"),
    (["plot", "controlled", "k1.value", "--from", "2", "--to", "1 s"], "1 s is not after"),
    (["plot", "controlled", "k1.value", "--from", "5"], "the last at 2.9995 s"),
    (["plot", "controlled", "k1.value", "--with", "othr"], "did you mean 'other'?"),
    (["plot", "controlled", "finger.mcp.angel"], "Did you mean 'finger.mcp.angle'?"),
    (["plot", "controlled", "finger.mcp.q"], "Allowed: 'finger.mcp.angle', "),
    (["plot", "controlled", "finger.*.angel"], "Did you mean 'finger.*.angle'?"),
    (["plot", "controlled", "k1.value", "--out", "x.bmp"], "does not end in one of .png"),
    (["plot", "controlled", "k1.value", "--target", "k1.value"], "QUANTITY=VALUE"),
    (["plot", "controlled", "k1.value", "--target", "finger.mcp.angle=5mm"], "unit of length"),
    (["plot", "controlled", "k1.value", "--target", "finger.mcp.angl=5"],
     "Did you mean 'finger.mcp.angle'?"),
    (["compare", "controlled", "nobody"], "there is no run in 'nobody'"),
    (["compare", "elsewhere/free"], "say what to compare with --quantity"),
    (["compare", "controlled", "--quantity", "k1.valeu"], "Did you mean 'k1.value'?"),
    (["compare", "controlled", "--out", "x.txt"], ".csv"),
    (["compare"], "RUN..."),
])
@pytest.mark.usefixtures("runs")
def test_wrong_words(sandbox: Sandbox, words: list[str], told: str) -> None:
    said = sandbox(*words)
    assert said.code == 2
    assert told in said.err
    assert said.out == ""
    assert len([line for line in said.err.splitlines() if line.startswith("error:")]) == 1


@pytest.mark.usefixtures("runs")
def test_asked_for_nothing_it_says_what_there_is_and_its_commands_work(sandbox: Sandbox) -> None:
    said = sandbox("plot", "controlled")
    assert said.code == 0
    heads = [line.partition(":")[0] for line in said.out.splitlines()
             if line and not line.startswith(" ")][2:]
    assert heads == ["drives", "tendons", "joints", "springs", "groups", "bodies", "to plot some"]
    assert "  .shortening  m " in said.out
    assert "work" in said.out
    assert not Path("renders/controlled/plot.png").exists()
    commands = [shlex.split(line) for line in said.out.splitlines() if "sandbox plot" in line]
    assert len(commands) == 3
    for command in commands:
        assert sandbox(*command[1:]).code == 0, command
    told = json.loads(sandbox("plot", "controlled", "--json").out)["quantities"]
    run = Recording.load("renders/controlled")
    assert {row["name"]: row["unit"] for row in told} == run.catalogue.units
    assert all(row["about"] for row in told)


@pytest.mark.usefixtures("runs")
def test_one_against_another_in_a_window_of_several_runs(sandbox: Sandbox) -> None:
    said = sandbox("plot", "controlled", "finger.mcp.angle", "k1.value", "--x", "finger.dip.angle",
                   "--from", "0.5s", "--to", "2", "--with", "other", "--with", "elsewhere/free",
                   "--out", "all.svg")
    assert said.out == "all.svg\n"  # settling is of whole runs: 'compare' has it
    text = Path("all.svg").read_text()
    for word in ("controlled", "other", "free", "finger.dip.angle [deg]", "finger.mcp.angle"):
        assert f"<!-- {word} -->" in text, word


def test_a_run_that_was_cut_short(sandbox: Sandbox) -> None:
    recording(info={"status": Status.UNFINISHED}).save("renders/controlled")
    said = sandbox("plot", "controlled", "k1.value")
    assert said.code == 0
    assert "stopped at 2.9995 s, before its end" in said.err
    cut = {"status": Status.DIVERGED, "reason": "it ran away"}
    recording(info=cut).save("renders/controlled")
    assert "diverged at 2.9995 s, before its end" in sandbox("plot", "controlled", "k1.value").err
    recording().part(0, 1).save("renders/controlled")
    said = sandbox("plot", "controlled", "k1.value")
    assert said.code == 2
    assert "at least 2" in said.err


@pytest.mark.usefixtures("runs")
def test_compare(sandbox: Sandbox) -> None:
    said = sandbox("compare", "controlled", "other", "elsewhere/free", "--out", "c.svg",
                   "--out", "c.csv")
    assert said.code == 0
    rows = {tuple(line.split()[:2]): line.split()[2:] for line in said.out.splitlines()
            if line.strip()}
    # exp(-pi z / sqrt(1 - z^2)) for z = 0.6 and 0.3
    assert rows["finger.mcp.angle", "controlled"][:5] == ["deg", "5", "5", "9.48", "0.9905"]
    assert rows["finger.mcp.angle", "other"][3] == "37.2"
    assert rows["finger.dip.angle", "controlled"][4] == "-"
    assert rows["finger.mcp.angle", "free"][2:] == ["-"] * 5
    assert ("k1", "free") not in rows
    assert Path("c.svg").stat().st_size > 10_000
    with Path("c.csv").open() as file:
        table = {(r["run"], r["name"], r["measure"]): (r["value"], r["unit"])
                 for r in csv.DictReader(file)}
    assert table["controlled", "finger.dip.angle", "settling"] == ("", "s")
    assert float(table["other", "finger.pip.angle", "overshoot"][0]) == pytest.approx(
        37.23, abs=0.01)
    assert table["other", "finger.pip.angle", "overshoot"][1] == "%"
    # from 15000 at rest it jumps to 45000 and comes back
    value, unit = table["controlled", "k1", "variation"]
    assert float(value) > 60000
    assert unit == "N/m"
    assert table["controlled", "k1", "rate"][1] == "N/m/s"


def test_a_run_lists_its_meters_and_the_pairs_that_touched(
    sandbox: Sandbox, scene: Callable[..., Path],
) -> None:
    far = {"name": "far", "at": [5, 5], "shapes": [{"type": "circle", "radius": 0.01}]}
    bodies = [*BALL["bodies"], far | {"motion": "fixed"}]
    path = scene(bodies=bodies, meters=[{"name": "high", "value": "=2 * ball.y", "unit": "m"}])
    assert sandbox("run", path, "--no-render", "--quiet").code == 0
    said = sandbox("plot", "ball").out
    assert "  high  m  =2 * ball.y" in said
    assert "pairs of bodies that touched: ball/floor\n" in said
    assert "sandbox plot ball ball/floor.normal" in said


@pytest.mark.usefixtures("runs")
def test_compare_for_machines(sandbox: Sandbox) -> None:
    told = json.loads(sandbox("compare", "controlled", "elsewhere/free", "--json", "--quantity",
                              "finger.d*.angle", "--target", "finger.dip.angle=15deg").out)
    one, other = told["runs"]
    assert (one["run"], other["run"]) == ("controlled", "free")
    assert one["directory"] == "renders/controlled"
    answers = {q["quantity"]: q["response"] for q in one["quantities"]}
    assert answers["finger.distal.angle"] is None
    assert answers["finger.dip.angle"]["settling"] is None
    assert {q["quantity"]: q["response"] for q in other["quantities"]}[
        "finger.dip.angle"]["settling"] > 0
    assert [d["drive"] for d in one["drives"]] == ["k1", "k2", "k3"]
    assert other["drives"] == []
