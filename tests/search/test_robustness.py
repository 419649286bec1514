"""Maps of what holds, against a block on an incline: it stays where mu > tan(angle)."""

import json
import math

import numpy as np
import pytest

import sandbox
from sandbox.cli.entry import invoke
from sandbox.errors import SandboxError
from tests.sweeps.scenes import PUCK

INCLINE = {
    "name": "incline", "gravity": [0, -9.81], "parameters": {"mu": 0.5, "angle": "20 deg"},
    "run": {"duration": "20 ms", "step": "1 ms"},
    "bodies": [
        {"name": "ramp", "motion": "fixed", "angle": "=angle", "shapes": [
            {"type": "box", "size": [1, 0.02], "at": [0, -0.01]}]},
        {"name": "block", "mass": 1, "angle": "=angle",
         "at": ["=-0.01 * sin(angle)", "=0.01 * cos(angle)"],
         "shapes": [{"type": "box", "size": ["60 mm", "20 mm"]}]}],
    "contacts": [{"between": ["ramp", "block"], "friction": "=mu"}],
}
OVER = {"parameters.angle": "0 deg:45 deg", "parameters.mu": "0.1:1.1"}
STAYS = {"keep": ["v=block.vx"], "holds": "v > -0.01 mm/s"}
WORDS = {"over": OVER, **STAYS, "coarse": 4, "within": 1 / 8, "probes": 2}


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A directory in which the map of the incline is kept, so that it is run once."""
    return tmp_path_factory.mktemp("incline")


def test_a_block_stays_where_friction_is_more_than_the_slope(done):
    found = sandbox.search.robustness(INCLINE, **WORDS, boundary="mu - tan(angle)", out=done)
    sheet, = found.sheets
    # of the map: (1.1 pi/4 - integral of tan, with mu > 0.1) / (1.0 pi/4), from atan(0.1) on
    low = math.atan(0.1)
    under = -math.log(math.cos(math.pi / 4)) + math.log(math.cos(low)) - 0.1 * (math.pi / 4 - low)
    assert sheet.low < 1 - under / (math.pi / 4) < sheet.high
    assert sheet.high - sheet.low < 3 / 8
    assert found.certified
    assert sheet.agreement.differs == 0
    assert sheet.agreement.passed == sheet.agreement.crossed > 8
    line, = sheet.boundary
    # half a cell along mu and half one along the angle, where tan' is 2 at most
    assert np.abs(line[:, 1] - np.tan(line[:, 0])).max() <= 1 / 16 + 2 * math.pi / 4 / 16
    assert found.runs < 9**2
    told = json.loads((done / "search.json").read_text())
    assert told["search"] == "robustness"
    assert set(found.table["met"]) == {True, False}
    assert {cell[-1] for cell in told["found"]["sheets"][0]["cells"]} == {
        "holds", "does not hold", "undecided"}
    assert (done / "table.csv").read_text().count("\n") == found.runs + 1
    assert (done / "search.png").stat().st_size > 10_000


def test_a_closed_form_that_is_wrong_is_told(done):
    found = sandbox.search.robustness(INCLINE, **WORDS, boundary="mu > tan(angle) + 0.4", out=done)
    agreement = found.sheets[0].agreement
    assert 0.15 < agreement.differs < 0.4  # a stripe 0.4 high, less undecided cells and corners
    assert agreement.passed < agreement.crossed / 2
    assert "mu > tan(angle) + 0.4 differs in" in found.lines[0]


def test_what_was_done_is_not_run_again(done, monkeypatch):
    first = sandbox.search.robustness(INCLINE, **WORDS, out=done)
    monkeypatch.setattr("sandbox.sweeps.evaluator.Pool", None)
    assert sandbox.search.robustness(INCLINE, **WORDS, out=done).lines == first.lines


def test_one_range_has_a_bracket_and_a_list_a_map_for_each():
    found = sandbox.search.robustness(
        INCLINE, over={"parameters.mu": "0.3, 0.6", "parameters.angle": "0 deg:45 deg"}, **STAYS,
        coarse=4, within=1 / 16, probes=0, boundary="mu - tan(angle)")
    assert [sheet.at for sheet in found.sheets] == ["0.3", "0.6"]
    for sheet, mu in zip(found.sheets, (0.3, 0.6), strict=True):
        bracket, = sheet.boundary
        assert bracket[0, 0] <= math.atan(mu) <= bracket[1, 0]
        assert sheet.low <= math.atan(mu) / (math.pi / 4) <= sheet.high
        assert sheet.agreement.differs == 0
    assert "0.3: holds in" in found.lines[1]
    assert "changes between 0.2" in found.lines[1]


def test_expectations_are_the_condition_and_everything_or_nothing_is_no_error(tmp_path):
    words = {"coarse": 2, "within": 1 / 8, "probes": 3, "out": tmp_path}
    found = sandbox.search.robustness(
        PUCK, over={"parameters.push": "3 N:6 N", "parameters.m": "0.5 kg:1 kg"}, **words)
    assert found.share == 1
    assert found.runs == 9 + 3
    assert "what the scene expects holds everywhere in the map" in found.lines[0]
    assert found.certificate == "9 of 9 points answer as before"
    none = sandbox.search.robustness(PUCK, over={"parameters.push": "1 N:2 N"}, **words)
    assert none.share == 0
    assert "holds nowhere in the map" in none.lines[0]


@pytest.mark.parametrize(("more", "said"), [
    ({"over": {"parameters.push": "1:2", "parameters.m": "uniform(1, 2)"}}, "1 distributions"),
    ({"over": {"parameters.m": "1, 2"}}, "over one or two ranges"),
    ({"holds": "vxx < 1"}, "no run keeps 'vxx'; did you mean 'vx'"),
    ({"boundary": "psh - 1"}, "the closed form: unknown name 'psh' in an expression; did you mean"),
    ({"boundary": "push -"}, "the closed form: "),
    ({"boundary": "twice - 1", "set": {"parameters": {"push": 1, "m": 1, "twice": "=2 * push"}}},
     "'twice' follows from what is varied; write it out in its place"),
    ({"coarse": 40, "runs": 30}, "the coarse grid alone has 41 runs, and 30 are allowed"),
    ({"coarse": 0}, "no narrower than 1/2048"),
    ({"within": 1e-9}, "no narrower than 1/2048"),
    ({"over": {"parameters.psh": "1:2"}}, "Did you mean 'push'"),
    ({"over": {"parameters.push": "1:2", "parameters.m": ", ".join(map(str, range(1, 12)))}},
     "a list has 11 values (allowed: at most 9"),
])
def test_what_cannot_be_mapped_is_told(more, said):
    words = {"over": {"parameters.push": "1:2"}, "keep": ["vx=puck.vx"], **more}
    with pytest.raises(SandboxError) as error:
        sandbox.search.robustness(PUCK, **words)
    assert said in str(error.value)


# -- the command ---------------------------------------------------------------------


@pytest.fixture
def puck(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "puck.json").write_text(json.dumps(PUCK))
    return "puck.json"


def test_the_command(puck, capsys, tmp_path):
    words = ["search", "robustness", puck, "--over",
             "parameters.push=1 N:6 N,parameters.m=0.5 kg:1.5 kg", "--coarse", "2", "--within",
             "0.125", "--boundary", "push * 0.0995 - 0.25 * m", "--probes", "2"]
    assert invoke(words) == 0
    said = capsys.readouterr().out
    assert "what the scene expects holds in" in said
    assert "differs in 0 %" in said
    assert "half the step: the same" in said
    assert "searches/robustness/puck: search.json, table.csv" in said
    assert invoke(["search", *words[1:], "--json"]) == 0  # the same command
    told = json.loads(capsys.readouterr().out)
    assert told["new"] == 0
    assert told["found"]["paths"] == ["parameters.push", "parameters.m"]
