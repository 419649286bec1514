"""``sandbox push`` as a user has it."""

from __future__ import annotations

import csv
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
