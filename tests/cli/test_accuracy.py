"""``sandbox converge`` and ``sandbox bounds``."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import SimulationDiverged
from sandbox.recording.recording import Recording

WEIGHT = 0.01 * 9.81


def test_convergence(sandbox, scene):
    output = sandbox("converge", scene())
    assert output.code == 0
    assert output.out.rstrip().splitlines()[-1].startswith("Certified at h = 0.5 ms")
    assert list(Path().glob("*")) == [Path("ball.json")]
    output = sandbox("converge", scene(), "--json")
    found = json.loads(output.out)
    assert (output.err, found["certified"], found["exit_code"]) == ("", True, 0)
    assert found["steps"] == [5e-4, 2.5e-4, 1.25e-4]
    quantity, = found["quantities"]
    assert len(quantity["values"]) == 3
    assert quantity["allowed"] == pytest.approx(0.1 * 0.01 * WEIGHT)
    assert (found["looks"], found["diverged"], found["advice"]) == ([], [], [])
    output = sandbox("converge", scene(expect=[]))
    assert output.code == 2
    assert "expects nothing" in output.err


def test_a_run_that_diverges_exits_3(sandbox, scene, monkeypatch):
    def away(mechanism, **more):
        if mechanism.run.step == 5e-4:
            simulation = Simulation(mechanism)
            simulation.run(20)
            gone = SimulationDiverged(0.01, "ball", "gone; a smaller run.step may help")
            gone.recording = simulation.finish(str(gone))
            raise gone
        return simulate(mechanism, **more)

    monkeypatch.setattr("sandbox.convergence.certificate.simulate", away)
    output = sandbox("converge", scene())
    assert output.code == 3
    assert output.err.splitlines()[0] == (
        "error: h: the simulation diverged at t = 0.01 s: ball: gone")
    assert "ball.contact.fy  mean           -  0.0981  0.0981" in output.out
    data = json.loads(sandbox("converge", scene(), "--json").out)
    assert (data["exit_code"], data["status"]) == (3, "diverged")
    assert data["quantities"][0]["values"][0] is None


@pytest.fixture
def resting(sandbox, scene):
    assert sandbox("run", scene(), "--out", "ball", "--no-render", "--quiet").code == 0
    return sandbox


def test_bounds_of_the_last_sample_and_of_chosen_ones(resting):
    output = resting("bounds", "ball")
    assert output.code == 0
    assert re.search(r"ball/floor.normal +0.0981 +0.0981 to 0.0981 +decided", output.out)
    assert output.out.splitlines()[-1] == str(Path("ball", "contact_bounds.csv"))
    head, row = Path("ball/contact_bounds.csv").read_text().splitlines()
    assert head == ("time_s,body,other,normal_N,normal_low_N,normal_high_N,"
                    "tangential_N,tangential_low_N,tangential_high_N")
    assert [float(n) for n in row.split(",")[3:6]] == pytest.approx([WEIGHT] * 3)
    output = resting("bounds", "ball", "--at", "0.02", "--at", "0.0302", "--json", "--out", "b.csv")
    found = json.loads(output.out)
    assert (output.code, found["exit_code"], found["files"]) == (0, 0, ["b.csv"])
    assert [one["time"] for one in found["bounds"]] == pytest.approx([0.01975, 0.02975], abs=6e-4)
    normal = found["bounds"][0]["normal"]
    assert (normal["decided"], normal["outside"]) == (True, False)


def test_the_largest_push_of_a_ball_on_a_floor(resting):
    """A ball rolls away at any push to the side, lifts at its weight, and never gives way below."""
    output = resting("bounds", "ball", "--push", "ball", "--json")
    push, = json.loads(output.out)["pushes"]
    found = dict(zip(push["direction_deg"], push["force"], strict=True))
    assert found[90] == pytest.approx(WEIGHT)
    assert (found[0], found[30], found[270]) == (0, 0, None)
    assert re.search(r"^ +270 +inf$", resting("bounds", "ball", "--push", "ball").out, re.MULTILINE)
    assert "does not move freely" in resting("bounds", "ball", "--push", "floor").err
    assert "did you mean 'ball'?" in resting("bounds", "ball", "--push", "bal").err


def test_a_force_outside_its_bounds_exits_1(resting):
    run = Recording.load("ball")
    arrays = {key: np.array(value) for key, value in run.arrays.items()}
    arrays["contact_force"] *= 1.001
    Recording(run.mechanism, arrays, run.info).save("ball")
    output = resting("bounds", "ball")
    assert output.err == "outside the range that mechanics allows: ball/floor.normal\n"
    assert output.code == 1
    assert "OUTSIDE" in output.out


@pytest.mark.parametrize(("words", "message"), [
    (["ball", "--at", "7"], "7 s is not within the run's 0.04975 s"),
    (["ball", "--out", "x.txt"], ".csv"),
    (["ball", "--near", "nan"], "is not a number with a unit"),
    (["ball", "--near", "-1um"], "must not be less than 0"),
])
def test_wrong_bounds(resting, words, message):
    output = resting("bounds", *words)
    assert output.code == 2
    assert message in output.err
