"""``sandbox bounds`` as a user has it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

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
