"""``sandbox bounds`` as a user has it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from sandbox.audit.bounds import Interval
from sandbox.recording.recording import Recording

WEIGHT = 0.01 * 9.81


@pytest.fixture
def resting(sandbox, scene):
    assert sandbox("run", scene(), "--out", "ball", "--no-render", "--quiet").code == 0
    return sandbox


def test_the_last_sample_by_default_with_a_file_beside_the_others(resting):
    said = resting("bounds", "ball")
    assert said.code == 0
    assert re.search(r"ball/floor.normal +0.0981 +0.0981 to 0.0981 +decided", said.out)
    assert said.out.splitlines()[-1] == str(Path("ball", "contact_bounds.csv"))
    head, row = Path("ball/contact_bounds.csv").read_text().splitlines()
    assert head == ("time_s,body,other,normal_N,normal_low_N,normal_high_N,"
                    "tangential_N,tangential_low_N,tangential_high_N")
    time, body, other, *numbers = row.split(",")
    assert (float(time), body, other) == (pytest.approx(0.04975), "ball", "floor")
    assert [float(n) for n in numbers[:3]] == pytest.approx([WEIGHT] * 3)


def test_chosen_instants_as_json(resting):
    said = resting("bounds", "ball", "--at", "0.02", "--at", "0.0302", "--json", "--out", "b.csv")
    found = json.loads(said.out)
    assert (said.code, found["exit_code"], found["files"]) == (0, 0, ["b.csv"])
    assert [one["time"] for one in found["bounds"]] == pytest.approx([0.01975, 0.02975], abs=6e-4)
    normal = found["bounds"][0]["normal"]
    assert normal["low"] == pytest.approx(WEIGHT)
    assert (normal["decided"], normal["outside"]) == (True, False)
    assert len(Path("b.csv").read_text().splitlines()) == 3


def test_a_force_outside_fails(resting):
    run = Recording.load("ball")
    arrays = {key: np.array(value) for key, value in run.arrays.items()}
    arrays["contact_force"] *= 1.001
    Recording(run.mechanism, arrays, run.info).save("ball")
    said = resting("bounds", "ball")
    assert said.code == 1
    assert "OUTSIDE" in said.out
    assert said.err == "outside of what mechanics allows: ball/floor.normal\n"


@pytest.mark.parametrize("noise", [1.25e-10, -3e-13])
def test_what_is_less_than_balance_is_known_to_reads_as_0(resting, noise):
    """The balance of 0.0981 N is known to some 1e-9 of it: 1.25e-10 N in 0 to 0 says nothing."""
    run = Recording.load("ball")
    arrays = {key: np.array(value) for key, value in run.arrays.items()}
    arrays["contact_force"][-1] += (noise, 0.0)
    Recording(run.mechanism, arrays, run.info).save("ball")
    said = resting("bounds", "ball", "--json")
    rubs = json.loads(said.out)["bounds"][0]["tangential"]
    assert abs(rubs["force"]) == pytest.approx(abs(noise))
    assert abs(noise) < rubs["tolerance"] < 1e-9
    said = resting("bounds", "ball")
    assert said.code == 0
    assert re.search(r"ball/floor.tangential +0 +0 to 0 +decided", said.out)


@pytest.mark.parametrize(("part", "shown"), [
    # inside by rounding: the interval as wide as that
    (Interval(3e-6, 2.3e-6, 2.3e-6, (1e-6, 1e-6)), ("3e-06", "2.3e-06 to 3e-06")),
    (Interval(1.9e-6, 2.3e-6, 5e-6, (1e-6, 1e-6)), ("1.9e-06", "1.9e-06 to 5e-06")),
    (Interval(9e-7, -9e-7, 2.0, (1e-6, 1e-6)), ("0", "0 to 2")),
    (Interval(3.4e-6, 2.3e-6, 2.3e-6, (1e-6, 1e-6)), ("3.4e-06", "2.3e-06 to 2.3e-06")),
    (Interval(0.5, 0.25, np.inf, (1e-9, 0.0)), ("0.5", "0.25 to inf")),
    (Interval(0.5, np.nan, np.nan, (0.0, 0.0)), ("0.5", "nan to nan")),
])
def test_rounding_reads_as_no_contradiction(part, shown):
    from sandbox.cli.bounds import shown_numbers

    assert shown_numbers(part) == shown


def test_a_run_that_is_made_anew_has_no_bounds_of_the_old_one(resting, scene):
    resting("bounds", "ball")
    resting("run", scene(), "--out", "ball", "--no-render", "--quiet")
    assert not Path("ball/contact_bounds.csv").exists()


def test_where_nothing_touches_that_is_said(sandbox, scene):
    """In weightlessness, a millimetre above the floor: touching is what one calls near."""
    ball = {"name": "ball", "at": [0, 0.006], "mass": 0.01,
            "shapes": [{"type": "circle", "radius": 0.005}]}
    floor = {"name": "floor", "motion": "fixed", "shapes": [
        {"type": "box", "size": [0.2, 0.02], "at": [0, -0.01]}]}
    sandbox("run", scene(gravity=[0, 0], expect=[], bodies=[ball, floor]), "--out", "ball",
            "--no-render", "--quiet")
    said = sandbox("bounds", "ball")
    assert said.code == 0
    assert "nothing touches" in said.out
    said = sandbox("bounds", "ball", "--near", "1.1mm")
    assert re.search(r"ball/floor.normal +0 +0 to 0 +decided", said.out)


@pytest.mark.parametrize(("words", "told"), [
    (["nobody"], "there is no run in 'nobody'"),
    (["ball", "--at", "7"], "7 s is not within the run's 0.04975 s"),
    (["ball", "--out", "x.txt"], ".csv"),
    (["ball", "--near", "nan"], "is not a number with a unit"),
    (["ball", "--near", "inf"], "is not a number with a unit"),
    (["ball", "--near", "-1um"], "must not be less than 0"),
    (["ball", "--near", "1 N"], "a unit of force"),
])
def test_wrong_words(resting, words, told):
    said = resting("bounds", *words)
    assert said.code == 2
    assert told in said.err
