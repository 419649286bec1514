"""Where to put the guides: the closed form against runs, the studies' files, the tables."""

import numpy as np
import pytest

import sandbox
from sandbox.findings.guide_statics import (
    GuideDesign,
    mean_spread,
    numbers_of,
    poses,
)
from sandbox.findings.guides import (
    DISCS,
    PATHS,
    SEARCHED,
    TRAINED,
    designs_of,
)
from sandbox.scene.library import shipped_studies
from sandbox.study.reference_fingers import SET_G, SET_G_TABLE
from sandbox.sweeps.plan import read_plan
from sandbox.sweeps.table import table_of

REFERENCE = GuideDesign(np.array(SET_G.guides), np.array(SET_G.stiffness))


def table(study):
    """The table of a shipped sweep of which nothing was run."""
    return table_of(read_plan(shipped_studies()[study]), [])


@pytest.fixture(scope="module")
def discs():
    return table(DISCS)


@pytest.mark.parametrize("row", SET_G_TABLE)
def test_forces_are_those_of_the_table(row):
    found = poses([row.disc_radius])
    assert np.degrees(found.theta[0]) == pytest.approx(row.degrees, abs=1e-3)
    assert found.forces(REFERENCE, row.tension)[0] == pytest.approx(row.forces, abs=1e-4)


def test_between_the_two_pulls_all_phalanges_press():
    found = poses([12e-3, 16e-3, 24e-3])
    least, most = found.pulls(REFERENCE)
    assert (least < most).all()
    for k in range(3):
        for pull, presses in ((0.99 * least[k], False), (1.01 * least[k], True),
                              (0.99 * min(most[k], 1e3), True), (1.01 * most[k], False)):
            if np.isfinite(pull):
                assert (found.forces(REFERENCE, pull)[k] >= 0).all() == presses


def test_nine_copies_keep_the_spread_of_the_closed_form():
    scene = sandbox.load_scene("nine_discs", overrides={"run.duration": 0.8, "run.step": 2e-3, **{
        path: number for path, number in zip(PATHS, numbers_of(designs_of(table(DISCS))[
            "three pulls"]).tolist(), strict=True)}})
    run = sandbox.simulate(scene)
    design = designs_of(table(DISCS))["three pulls"]
    found = poses(TRAINED)
    # all phalanges press, so the pose is the disc's, and what is left is how far it is from rest
    assert run["spread"][-1] == pytest.approx(
        mean_spread(design, found, SEARCHED["three pulls"][1]), rel=1e-4)
    assert run["spread_one"][-1] == pytest.approx(mean_spread(design, found, [3.75]), rel=1e-4)


def test_found_designs_press_more_alike_by_the_closed_form(discs):
    designs, found = designs_of(discs), poses(TRAINED)
    at = {name: [mean_spread(design, found, pulls) for pulls in ((3.75,), (2.5, 3.75, 7.5))]
          for name, design in designs.items()}
    assert at["one pull"][0] < 0.06 < at["Set G"][0] / 3
    assert at["three pulls"][1] < 0.07 < at["one pull"][1]
    assert at["three pulls"][1] < at["Set G"][1] / 6
    assert (poses(TRAINED).forces(designs["one height"], 3.75)[:, 1] < 0).all()
