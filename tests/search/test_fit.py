"""Fits to what is known: a mass on a spring, whose motion has a closed form, and a puck."""

import json

import numpy as np
import pytest

import sandbox
from sandbox.errors import SandboxError
from sandbox.search.fitting import estimate, read_columns
from tests.sweeps.scenes import PUCK

TIME = np.linspace(0.05, 1.0, 60)
LOW, HIGH = np.array([20.0, 0.0]), np.array([200.0, 2.0])
TRUTH = np.array([80.0, 0.6])
"""Stiffness [N/m] and damping [N s/m] of 1 kg."""
SCENE = {
    "name": "swing", "gravity": [0, 0], "parameters": {"k": "90 N/m", "c": "1 N*s/m", "m": "1 kg"},
    "run": {"duration": "1 s", "step": "1 ms"},
    "bodies": [
        {"name": "wall", "motion": "fixed", "at": [0, 0], "shapes": [
            {"type": "circle", "radius": "5 mm"}]},
        {"name": "mass", "mass": "=m", "at": [0.6, 0], "shapes": [
            {"type": "circle", "radius": "10 mm"}]}],
    "springs": [{"name": "spring", "type": "linear", "a": "wall", "b": "mass", "stiffness": "=k",
                 "damping": "=c", "rest_length": 0.5}],
}


def swing(values, time=TIME):
    """Closed form of x [m] of 1 kg released 0.1 m from rest, for k and c."""
    k, c = np.moveaxis(np.asarray(values), -1, 0)[..., None]
    decay = c / 2
    turn = np.sqrt(k - decay ** 2)
    return 0.5 + 0.1 * np.exp(-decay * time) * (
        np.cos(turn * time) + decay / turn * np.sin(turn * time))


def model(quantiles):
    return swing(LOW + quantiles * (HIGH - LOW))


COLUMN = np.zeros(len(TIME), dtype=np.int64)


def test_intervals_cover_the_truth_as_often_as_they_say():
    covered, files = np.zeros(2), 200
    for seed in range(files):
        data = swing(TRUTH) + np.random.default_rng(seed).normal(0, 2e-3, len(TIME))
        found = estimate(model, data, COLUMN, np.array([0.4, 0.4]))
        values = LOW + found.quantiles * (HIGH - LOW)
        covered += np.abs(values - TRUTH) <= found.halves * (HIGH - LOW)
    assert (covered >= 0.91 * files).all()
    assert (covered <= 0.985 * files).all()


def written(path, values, seed=0, noise=1e-3):
    noisy = values + np.random.default_rng(seed).normal(0, noise, len(values))
    path.write_text("time,x [mm]\n" + "".join(
        f"{t:.6f},{1e3 * x:.6f}\n" for t, x in zip(TIME, noisy, strict=True)))
    return path


def test_a_scene_is_fitted_to_a_file(tmp_path):
    found = sandbox.search.fit(
        SCENE, written(tmp_path / "x.csv", swing(TRUTH)), match={"x": "mass.x"},
        vary={"parameters.k": "20 N/m:200 N/m", "parameters.c": "0:2"}, out=tmp_path / "out")
    data = 1e-3 * np.loadtxt(tmp_path / "x.csv", delimiter=",", skiprows=1)[:, 1]
    closed = estimate(model, data, COLUMN, np.array([0.4, 0.4]))
    for path, value, half in zip(("parameters.k", "parameters.c"),
                                 LOW + closed.quantiles * (HIGH - LOW),
                                 closed.halves * (HIGH - LOW), strict=True):
        assert found[path].value == pytest.approx(value, abs=0.05 * half)
        assert (found[path].high - found[path].low) / 2 == pytest.approx(half, rel=0.02)
    assert found.noise["x"] == pytest.approx(1e-3, rel=0.3)
    assert found.certified
    assert found.blind == ()
    assert found.remarks == ()
    message = json.loads((tmp_path / "out" / "search.json").read_text())
    assert message["found"]["parameters"][0]["value"] == found["parameters.k"].value


def test_undetermined_parameters_are_reported(tmp_path):
    found = sandbox.search.fit(
        SCENE, written(tmp_path / "x.csv", swing([80.0, 0.0])), match={"x": "mass.x"},
        set={"parameters.c": 0},
        vary={"parameters.k": "20 N/m:200 N/m", "parameters.m": "0.25 kg:2.5 kg"})
    (half, parts), = found.blind
    assert half > 0.5
    assert parts["parameters.k"] * parts["parameters.m"] > 0
    assert any("do not determine" in line for line in found.lines)


@pytest.mark.parametrize(("text", "words"), [
    ("time,x\n0,1\n0.05,two\n", "row 3: 'two' is no number"),
    ("time,x\n0,1,2\n", "3 cells under 2 names"),
    ("time,z\n0,1\n0.05,1\n", "no column 'x'"),
    ("time,x\n0,1\n7,1\n", "times from 0 to 7 s, the run from 0 to 0.1 s"),
    ("time,x\n0,1\n", "1 measured numbers do not determine 1 parameters"),
])
def test_unusable_data_are_refused(tmp_path, text, words):
    (tmp_path / "x.csv").write_text(text)
    with pytest.raises(SandboxError) as error:
        sandbox.search.fit(PUCK, tmp_path / "x.csv", vary={"parameters.push": "1:5"},
                           match={"x": "puck.x"})
    assert words in str(error.value)


def test_numbers_of_other_units_are_read_as_si(tmp_path):
    (tmp_path / "x.csv").write_text("\ufefft [ms],x [mm], v\n100,5,\n\n200,7,3\n")
    time, columns = read_columns(tmp_path / "x.csv")
    assert time.tolist() == [0.1, 0.2]
    assert columns["x"].tolist() == [0.005, 0.007]
    assert np.isnan(columns["v"][0])
