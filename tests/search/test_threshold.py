"""Thresholds with known values: sliding friction, a final speed."""

import csv
import json

import pytest

import sandbox
from sandbox.errors import SandboxError
from tests.sweeps.scenes import PUCK

LAST = 0.1 - 0.5e-3
BLOCK = {
    "name": "block", "gravity": [0, -9.81], "parameters": {"push": "1 N", "mu": 0.5},
    "run": {"duration": "0.1 s", "step": "1 ms"},
    "bodies": [
        {"name": "floor", "motion": "fixed", "at": [0, -0.01], "shapes": [
            {"type": "box", "size": [2, 0.02]}]},
        {"name": "block", "mass": 1, "at": [0, 0.02], "shapes": [
            {"type": "box", "size": ["40 mm", "40 mm"]}]}],
    "contacts": [{"between": ["floor", "block"], "friction": "=mu"}],
    "drives": [{"name": "push", "type": "force", "body": "block", "direction": [1, 0],
                "value": "=push"}],
}


def test_a_push_moves_a_block_from_its_friction_on(tmp_path):
    found = sandbox.search.threshold(
        BLOCK, vary={"parameters.push": "1 N:9 N"}, keep=["v=max block.vx over last 0.05 s"],
        where="v < 1 mm/s", within=0.01, out=tmp_path)
    assert found.holds_below
    assert found.certified
    assert found.high - found.low <= 0.01
    assert 0.5 * 9.81 - 0.01 <= found.low <= found.high <= 0.5 * 9.81 + 0.03
    message = json.loads((tmp_path / "search.json").read_text())
    assert message["found"]["low"] == found.low
    with (tmp_path / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == found.runs
    assert [row["met"] for row in rows] == [
        "true" if float(row["v"]) < 1e-3 else "false" for row in rows]


def test_the_scenes_own_expectations_are_the_condition():
    found = sandbox.search.threshold(PUCK, vary={"parameters.push": "1 N:6 N"}, within=0.5e-3)
    assert not found.holds_below
    assert found.low < 0.25 / LAST < found.high
    assert not found.certified  # the last sample is half a step before the end
    assert "between 2.506" in found.certificate


def test_an_interrupted_search_resumes(tmp_path, monkeypatch):
    from sandbox.sweeps.job import Log

    words = {"vary": {"parameters.push": "1 N:6 N"}, "out": tmp_path}
    whole = sandbox.search.threshold(PUCK, **{**words, "out": tmp_path / "whole"})
    add, seen = Log.add, []

    def stopped(self, row):
        if len(seen) == 7:
            raise KeyboardInterrupt
        seen.append(row.id)
        add(self, row)

    monkeypatch.setattr(Log, "add", stopped)
    with pytest.raises(KeyboardInterrupt):
        sandbox.search.threshold(PUCK, **words)
    monkeypatch.setattr(Log, "add", lambda self, row: (seen.append(row.id), add(self, row)))
    assert sandbox.search.threshold(PUCK, **words) == whole
    assert len(seen) == len(set(seen))


@pytest.mark.parametrize(("more", "fragment"), [
    ({"vary": {"parameters.push": "1:2", "parameters.m": "1:2"}}, "one path with a range"),
    ({"vary": {"parameters.push": "1:2:7"}}, "has a count, 7, and a search chooses its points"),
    ({"vary": {"run.step": "1 ms:2 ms"}}, "does not vary run.step"),
    ({"vary": {"parameters.push": "3 N:6 N"}, "keep": None},
     "from 3 to 6 N has no threshold at its ends: the verdict on the expectations does not change"),
    ({"within": 1e-12}, "no narrower than 1e-09 of the range"),
    ({"where": "nothing > 0", "keep": ["vx=puck.vx", "nothing==vx / 0"]}, "does not decide"),
])
def test_wrong_threshold_requests_are_refused(more, fragment):
    words = {"vary": {"parameters.push": "1:2"}, "keep": ["vx=puck.vx"], **more}
    with pytest.raises(SandboxError) as error:
        sandbox.search.threshold(PUCK, **words)
    assert fragment in str(error.value)
