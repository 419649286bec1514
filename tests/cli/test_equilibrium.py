"""``sandbox equilibrium`` from the command line."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

BALL = {"name": "ball", "mass": 0.3, "at": [0, -0.2], "role": "object",
        "shapes": [{"type": "circle", "radius": 0.01}]}
WALL = {"name": "wall", "motion": "fixed"}
SPRING = {"type": "linear", "name": "spring", "a": "wall", "b": "ball", "on_a": [0, 0],
          "on_b": [0, 0], "stiffness": "=k"}
DOWN = 0.2 + 0.3 * 9.81 / 50


@pytest.fixture
def hung(tmp_path):
    """A ball on a spring."""
    (tmp_path / "hung.json").write_text(json.dumps({
        "bodies": [WALL, BALL], "springs": [SPRING], "gravity": [0, -9.81],
        "parameters": {"k": "50 N/m"}, "run": {"duration": 0.5}, "name": "hung"}))
    return "hung.json"


def test_a_table_and_its_files(sandbox, hung):
    said = sandbox("equilibrium", hung)
    assert said.code == 0
    lines = said.out.splitlines()
    assert lines[0] == "at rest: neutral: nothing answers a small motion of ball"
    assert lines[2].split() == ["quantity", "unit", "value"]
    told = dict(line.split()[::2] for line in lines[3:8])
    assert float(told["ball.y"]) == pytest.approx(-DOWN, abs=1e-6)
    assert float(told["spring.force"]) == pytest.approx(0.3 * 9.81, rel=1e-5)
    assert ("stiffness of ball: 11.369 N/m along x, 50 N/m along y, 0 N m/rad in rotation"
            in said.out)
    folder = Path("renders/rest/hung")
    assert lines[-3:] == [str(folder / name) for name in ("rest.json", "rest.csv", "rest.png")]
    head, *rows = csv.reader((folder / "rest.csv").read_text(encoding="utf-8").splitlines())
    assert head == ["quantity", "unit", "rest_1"]
    assert float(next(row for row in rows if row[0] == "ball.y")[2]) == pytest.approx(-DOWN)
    data = json.loads((folder / "rest.json").read_text(encoding="utf-8"))
    assert data["rests"][0]["stiffness"]["y"] == pytest.approx(50)
    assert (folder / "rest.png").stat().st_size > 3_000


@pytest.mark.parametrize(("words", "said"), [
    (["--along", "parameters.load=0:1"], "is not of the form PATH=FROM:TO:COUNT"),
    (["--along", "parameters.load=0 N:1 mN:3"], "'N' and 'mN' are two units"),
    (["--along", "parameters.load=0:0.5:2", "--plot", "nod.y"], "did you mean 'node.y'?"),
    (["--along", "parameters.load=0:0.5:2", "--from", "node.y=0"], "omit --from"),
    (["--from", "node.y=" + ",".join(["0"] * 201)], "more than 200 combinations"),
    (["--body", "nod"], "Did you mean 'node'"),
    (["--from", "node.y=0", "--from", "node.y=1 mm"], "'node.y' is given twice"),
])
def test_wrong_words(sandbox, words, said):
    found = sandbox("equilibrium", "snap_through", *words)
    assert found.code == 2
    assert said in found.err
