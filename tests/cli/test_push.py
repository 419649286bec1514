"""``sandbox push`` as a user has it."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

BOX = {"name": "box", "mass": 0.2, "at": [0, 0.02], "role": "object",
       "shapes": [{"type": "box", "size": [0.06, 0.04]}]}
FLOOR = {"name": "floor", "motion": "fixed",
         "shapes": [{"type": "box", "size": [1, 0.1], "at": [0, -0.05]}]}
WEIGHT = 0.2 * 9.81


@pytest.fixture
def standing(scene):
    """A box on a floor, at rest for 50 ms."""
    return scene(bodies=[FLOOR, BOX], gravity=[0, -9.81], run={"duration": 0.05}, expect=[],
                 name="standing")


def test_a_table_and_its_files(sandbox, standing):
    said = sandbox("push", standing, "--directions", 4, "--over", 0.3)
    assert said.code == 0
    lines = said.out.splitlines()
    assert lines[0].split() == [
        "push", "along", "[deg]", "bound", "[N]", "moved", "by", "0.3606", "mm", "at", "[N]"]
    assert lines[1].split()[:2] == ["0", "0.981"]
    assert lines[4].split()[:2] == ["270", "none"]
    assert "not up to 3.924" in lines[4]
    assert "box has moved by 0.3606 mm first at" in said.out
    assert "no hand holds box at t = 0.05 s" in said.out
    assert "'not up to' is where the search ended; --beyond looks further" in said.out
    assert "box gives first at 0.981 N, along 0 deg (bound)" in said.out
    folder = Path("renders/studies/push/standing")
    assert lines[-2:] == [str(folder / "push.csv"), str(folder / "push.png")]
    head, first, *_, last = csv.reader(
        (folder / "push.csv").read_text(encoding="utf-8").splitlines())
    assert head == ["direction_deg", "bound_N", "moved_at_N", "pushed_to_N"]
    assert float(first[1]) == pytest.approx(WEIGHT / 2, rel=1e-6)
    assert last[1:3] == ["inf", "inf"]
    assert (folder / "push.png").stat().st_size > 10_000


def test_as_json(sandbox, standing):
    said = sandbox("push", standing, "--directions", 4, "--over", 0.3, "--limit", 0.002,
                   "--at", 0.02, "--out", "there", "--beyond", 2.5, "--json")
    found = json.loads(said.out)
    assert (said.code, found["body"], found["at"], found["limit"]) == (0, "box", 0.02, 0.002)
    assert found["files"] == ["there/push.csv", "there/push.png"]
    assert found["pushes"][0]["bound"] == pytest.approx(WEIGHT / 2, rel=1e-6)
    assert found["held"] is False
    assert found["pushes"][0]["pushed_to"] == pytest.approx(2.5 * WEIGHT / 2, rel=1e-6)
    assert found["pushes"][3]["pushed_to"] == pytest.approx(2 * WEIGHT * 2.5 / 8, rel=1e-6)
    assert found["own"]["stayed"] == []
    assert found["pushes"][3]["settled"] is True
    assert found["pushes"][3]["bound"] is None
    assert found["pushes"][3]["moved_at"] is None


@pytest.mark.parametrize(("bodies", "words", "told"), [
    ([FLOOR, {**BOX, "role": "link"}], [], "no bodies with the role 'object'"),
    ([FLOOR, BOX, {**BOX, "name": "other", "at": [0.3, 0.02]}], [], "name one of box, other"),
    ([FLOOR, BOX], ["--body", "boks"], "'boks' is no body"),
    ([FLOOR, {**BOX, "at": [0, 0.2]}], [], "nothing touches 'box' at t = 0.0"),
    ([FLOOR, BOX], ["--at", -1], "-1 s is not within the run"),
    ([FLOOR, BOX], ["--over", 0], "--over"),
])
def test_what_cannot_be_pushed(sandbox, scene, bodies, words, told):
    path = scene(bodies=bodies, gravity=[0, -9.81], run={"duration": 0.05}, expect=[])
    said = sandbox("push", path, *words)
    assert said.code == 2
    assert told in said.err


@pytest.mark.parametrize(("limit", "problem"), [
    ("0", "must be greater than 0"), ("2", "has no unit, as 2mm has"), ("2 N", "length")])
def test_how_far_it_may_come_is_a_length(sandbox, standing, limit, problem):
    said = sandbox("push", standing, "--limit", limit)
    assert said.code == 2
    assert problem in said.err
