"""Identification: its study file, the surface that stands for runs, the counts of intervals."""


import numpy as np
import pytest

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
