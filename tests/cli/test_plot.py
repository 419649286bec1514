"""``sandbox plot``: list, plot and compare quantities."""

from __future__ import annotations

import csv
import json
import shlex
from pathlib import Path

import pytest

from sandbox.recording.recording import Recording
from tests.samples.controlled import recording


def test_quantities_of_one_run(runs):
    output = runs("plot", "controlled.json", "finger.mcp.angle", "k?.value")
    assert output.code == 0
    assert Path("renders/controlled/plot.png").is_file()
    row = next(line.split() for line in output.out.splitlines() if "mcp.angle" in line)
    assert row == ["finger.mcp.angle", "controlled", "deg", "5", "5", "9.48", "0.9905", *row[7:]]
    output = runs("plot", "renders/controlled", "finger.*.angle", "--out", "a.svg", "--out",
                "new/b.pdf", "--json")
    message = json.loads(output.out)
    assert message["files"] == ["a.svg", "new/b.pdf"]
    assert Path("a.svg").read_text().count("<svg") == 1
    assert Path("new/b.pdf").read_bytes().startswith(b"%PDF")
    responses = {q["quantity"]: q["response"] for q in message["runs"][0]["quantities"]}
    assert responses["finger.mcp.angle"]["settling"] == pytest.approx(0.9905, abs=1e-4)
    assert responses["finger.dip.angle"]["settling"] is None


@pytest.mark.parametrize(("words", "message"), [
    (["controled", "x"], "did you mean 'controlled'?; 'sandbox run' makes one"),
    (["controlled", "--x", "k1.value"], "'sandbox plot RUN' lists them"),
    (["controlled", "k2.value", "--x", "k1.valeu"], "Did you mean 'k1.value'?"),
    (["controlled", "tension"], "Did you mean 'finger.tendon.tension'?"),
    (["controlled", "k1.value", "--from", "5 mm"], "this is a time"),
    (["controlled", "k1.value", "--from", "2", "--to", "1 s"], "1 s is not after"),
    (["controlled", "k1.value", "--with", "othr"], "did you mean 'other'?"),
    (["controlled", "finger.mcp.q"], "Allowed: 'finger.mcp.angle', "),
    (["controlled", "k1.value", "--out", "x.bmp"], "does not end in one of .png"),
    (["controlled", "k1.value", "--target", "finger.mcp.angle=5mm"], "unit of length"),
    (["elsewhere/free", "--with", "elsewhere/free"], "name the quantities to compare"),
])
def test_wrong_words(runs, words, message):
    output = runs("plot", *words)
    assert (output.code, output.out) == (2, "")
    assert message in output.err
    assert len([line for line in output.err.splitlines() if line.startswith("error:")]) == 1


def test_without_quantities_it_lists_them_and_commands_that_work(runs):
    output = runs("plot", "controlled")
    assert output.code == 0
    heads = [line.partition(":")[0] for line in output.out.splitlines()
             if line and not line.startswith(" ")][2:]
    assert heads == ["drives", "tendons", "joints", "springs", "groups", "bodies", "to plot some"]
    assert "  .shortening  m " in output.out
    assert not Path("renders/controlled/plot.png").exists()
    commands = [shlex.split(line) for line in output.out.splitlines() if "sandbox plot" in line]
    assert len(commands) == 2
    for command in commands:
        assert runs(*command[1:]).code == 0, command
    message = json.loads(runs("plot", "controlled", "--json").out)["quantities"]
    run = Recording.load("renders/controlled")
    assert {row["name"]: row["unit"] for row in message} == run.catalogue.units
    assert all(row["about"] for row in message)


def test_an_incomplete_run(sandbox):
    cut = {"complete": False, "reason": "it ran away"}
    recording(info=cut).save("renders/controlled")
    assert "diverged at 2.9995 s, before its end" in sandbox("plot", "controlled", "k1.value").err
    recording().part(0, 1).save("renders/controlled")
    output = sandbox("plot", "controlled", "k1.value")
    assert output.code == 2
    assert "holds 1 samples, at least 2 are needed" in output.err


def test_runs_are_compared_by_controlled_quantities_by_default(runs):
    output = runs("plot", "controlled", "--with", "other", "--with", "elsewhere/free",
                "--out", "c.svg", "--out", "c.csv")
    assert output.code == 0
    rows = {tuple(line.split()[:2]): line.split()[2:] for line in output.out.splitlines()
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
    assert table["other", "finger.pip.angle", "overshoot"][1] == "%"
    # from 15000 at rest it jumps to 45000 and comes back
    value, unit = table["controlled", "k1", "variation"]
    assert float(value) > 60000
    assert unit == "N/m"


def test_a_pattern_leaves_out_pairs_that_never_touched(sandbox):
    box = {"type": "box", "size": [0.1, 0.1]}
    content = {"run": {"duration": 0.01}, "gravity": [0, -9.81], "bodies": [
        {"name": "floor", "motion": "fixed", "shapes": [box]},
        {"name": "block", "at": [0, 0.1], "mass": 1, "shapes": [box]},
        {"name": "far", "motion": "fixed", "at": [5, 0], "shapes": [box]}]}
    Path("block.json").write_text(json.dumps(content))
    assert sandbox("run", "block.json", "--no-render", "--quiet").code == 0
    output = sandbox("plot", "block", "block/*.normal", "--json")
    shown = [each["quantity"] for each in json.loads(output.out)["runs"][0]["quantities"]]
    assert shown == ["block/floor.normal"]
