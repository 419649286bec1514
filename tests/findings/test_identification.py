"""Identification: its study file, the surface that stands for runs, the counts of intervals."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sandbox.draw.figure.intervals import Intervals, save_intervals
from sandbox.findings import identification as study
from sandbox.findings.surface import points_of_surface, surface_of
from sandbox.scene.library import shipped_studies
from sandbox.search.asking import Where
from sandbox.search.question import asked


@pytest.fixture(scope="module")
def question():
    return asked(str(shipped_studies()[study.STUDY]))


def test_the_truth_lies_within_all_ranges(question):
    shares = study.shares_of(question, study.truth_of(question))
    assert (shares > 0.3).all()
    assert (shares < 0.7).all()
    assert question.space.numbers(shares[None])[0] == pytest.approx(study.truth_of(question))


def test_a_surface_is_exact_of_a_quadratic_model():
    rng = np.random.default_rng(1)
    value, slopes, bends = rng.normal(size=4), rng.normal(size=(4, 3)), rng.normal(size=(4, 3, 3))
    bends = bends + bends.transpose(0, 2, 1)
    centre, steps = np.array([0.5, 0.4, 0.6]), np.array([0.1, 0.02, 0.05])

    def model(shares):
        off = shares - centre
        return value + off @ slopes.T + np.einsum("ni,mij,nj->nm", off, bends, off) / 2

    points = points_of_surface(centre, steps)
    assert len(points) == 1 + 3 * 4
    found = surface_of(model(points), centre, steps)
    somewhere = rng.uniform(size=(5, 3))
    assert found(somewhere) == pytest.approx(model(somewhere))
    assert found.only(np.array([2, 0])).slopes == pytest.approx(slopes[[2, 0]])


def test_the_numbers_of_the_surface_are_those_measured():
    surface = surface_of(np.arange(43)[:, None] * np.ones((1, 5 * study.FINE)), np.full(6, 0.5),
                         study.STEPS)
    assert len(surface.only(study.measured_rows(study.EVERY)).value) == 3 * len(
        study.times(study.EVERY)) == 93
    seen = study.measurement(surface.only(study.measured_rows(study.EVERY)), 3)
    assert list(seen.columns) == list(study.ANGLES)
    assert all(len(values) == len(seen.time) for values in seen.columns.values())


def test_noise_has_the_size_and_the_memory_that_it_says():
    rng = np.random.default_rng(5)
    for noise, memory in ((study.independent, 0.0), (study.correlated, study.LASTING)):
        found = noise(rng, 20_000)
        # standard errors of 20 000 numbers are 0.5 to 1.2 %; four of them
        assert found.std() == pytest.approx(1, abs=0.05)
        assert np.corrcoef(found[1:], found[:-1])[0, 1] == pytest.approx(memory, abs=0.03)


def test_widths_are_those_of_the_slopes():
    slopes = np.zeros((5 * study.FINE, 6))
    rows = study.measured_rows(study.EVERY)
    slopes[rows[:6], range(6)] = 2.0  # J'J = 4
    surface = surface_of(np.zeros((43, len(slopes))), np.full(6, 0.5), study.STEPS)
    found = study.widths(replace(surface, slopes=slopes), 0.1, study.EVERY)
    assert found == pytest.approx(np.full(6, study.Z * 0.1 / 2))


def test_estimates_do_not_tell_how_many_runs_were_new():
    one = SimpleNamespace(value=1.0, low=0.5, high=1.5, halved=1.1)
    texts = [study.estimates_table(np.ones(6), [SimpleNamespace(parameters=[one] * 6, runs=runs)])
             for runs in (0, 150)]
    assert texts[0] == texts[1]


def test_intervals_that_hold_the_truth_are_counted():
    tries = study.Tries(np.array([[1.0, 2.0], [1.2, 5.0], [0.7, 2.1]]),
                        {0.95: np.full((3, 2), 0.25)}, np.zeros(3, dtype=bool))
    assert tries.covered(np.array([1.0, 2.0])).tolist() == [2, 2]


def test_runs_near_the_truth_are_those_of_the_surface(question, tmp_path):
    """The surface's own middle, and a point between its points, against runs."""
    surface = study.surface_about_truth(question, Where(out=tmp_path, workers=1))
    off = study.STEPS * np.array([0.5, -0.5, 0.5, -0.5, 0.5, 0.5])
    import sandbox

    values = question.space.numbers((surface.centre + off)[None])[0]
    run = sandbox.simulate(sandbox.load_scene(study.SCENE, overrides=dict(
        zip(question.space.paths, values.tolist(), strict=True))))
    found = surface((surface.centre + off)[None])[0].reshape(5, -1)
    for k, name in enumerate(study.ANGLES):
        # a hundredth of the noise
        assert found[k] == pytest.approx(np.interp(study.times(), run.time, run[name]),
                                         abs=0.02 * study.NOISE)


def test_a_picture_of_intervals_is_the_same_twice(tmp_path):
    values = np.random.default_rng(2).normal(1, 0.1, 30)
    panels = [Intervals(f"number {k}", "[N]", values, values - 0.1, values + 0.1, 1.0)
              for k in range(2)]
    paths = [tmp_path / f"{name}.png" for name in ("one", "two")]
    for path in paths:
        save_intervals(path, panels, count="measurements")
    assert paths[0].read_bytes() == paths[1].read_bytes()


@pytest.mark.parametrize("name", study.BLIND)
def test_a_blind_fit_asks_for_the_same_ranges(name, question, tmp_path, monkeypatch):
    monkeypatch.setattr(study, "find_fit", lambda asked_, data, place: (asked_, data))
    monkeypatch.setattr(study, "_slow", lambda other, at, place: surface_of(
        np.zeros((43, 3 * len(at))), np.full(6, 0.5), study.STEPS))
    surface = surface_of(np.zeros((43, 5 * study.FINE)), np.full(6, 0.5), study.STEPS)
    other, data = study.blind_fit(name, question, surface, tmp_path, Where(out=tmp_path))
    paths = question.space.paths
    assert other.space.paths[:len(paths)] == paths
    ends = np.array([np.zeros(len(paths)), np.ones(len(paths))])
    if name != "pull":  # which is one more
        assert other.space.numbers(ends) == pytest.approx(question.space.numbers(ends))
    assert data.read_text().startswith("time,")
