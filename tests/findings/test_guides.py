"""Where to put the guides: the closed form against runs, the studies' files, the tables."""

import numpy as np
import pytest

import sandbox
from sandbox.findings.guide_statics import (
    GuideDesign,
    best_design,
    design_of,
    mean_spread,
    numbers_of,
    poses,
    spread,
)
from sandbox.findings.guides import (
    DESIGNS,
    DISCS,
    PALM,
    PATHS,
    PLACES,
    SEARCHED,
    SQUARES,
    TRAINED,
    column,
    costs_of,
    designs_of,
    forces_of,
    summary,
)
from sandbox.scene.library import shipped_studies
from sandbox.search.written import read_search
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


def test_spread_is_std_over_mean_and_2_of_nothing():
    assert spread(np.array([1.0, 1.0, 1.0])) == 0.0
    assert spread(np.array([3.0, 0.0, -1.0])) == pytest.approx(2**0.5)
    assert spread(np.zeros(3)) == 2.0


def test_numbers_make_the_design_they_came_from():
    again = design_of(REFERENCE.guides[0], numbers_of(REFERENCE))
    assert (again.guides == REFERENCE.guides).all()
    assert (again.stiffness == REFERENCE.stiffness).all()


def test_a_few_rounds_of_the_closed_form_are_better_than_their_start():
    low, high = 0.8 * numbers_of(REFERENCE), 1.2 * numbers_of(REFERENCE)
    low, high = np.minimum(low, high), np.maximum(low, high)
    found = poses([16e-3])
    best, least = best_design(REFERENCE, low, high, found, [3.75], rounds=2)
    assert least == mean_spread(best, found, [3.75]) < mean_spread(REFERENCE, found, [3.75])
    assert ((numbers_of(best) >= low) & (numbers_of(best) <= high)).all()


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


@pytest.mark.parametrize("name", SEARCHED)
def test_searches_are_written_as_they_are_told(name):
    study, pulls = SEARCHED[name]
    search = read_search(shipped_studies()[study])
    assert search.kind == "best"
    assert set(search.question.space.paths) == set(PATHS)
    assert list(search.question.kept) == list(search.words["least"])
    parts = search.question.plan.loaded.mechanism.bodies
    assert sum(body.role == "object" for body in parts) == 9
    assert len(pulls) in (1, 3)


def test_sweeps_have_the_designs_in_their_order(discs):
    assert len(discs) == len(DESIGNS) * 12 * 4
    assert len(table(PLACES)) == len(DESIGNS) * 5 * 3 * 3
    assert len(table(SQUARES)) == len(DESIGNS) * 7
    designs = designs_of(discs)
    assert (designs["Set G"].guides == REFERENCE.guides).all()
    assert set(designs["one height"].guides[:, 1]) == {-5e-3}
    assert all((each.guides[0] == REFERENCE.guides[0]).all()
               for name, each in designs.items() if name != "one height")
    for each in (PLACES, SQUARES):
        assert {name: numbers_of(design).tolist() for name, design in
                designs_of(table(each)).items()} == {
            name: numbers_of(design).tolist() for name, design in designs.items()}


def test_found_designs_press_more_alike_by_the_closed_form(discs):
    designs, found = designs_of(discs), poses(TRAINED)
    at = {name: [mean_spread(design, found, pulls) for pulls in ((3.75,), (2.5, 3.75, 7.5))]
          for name, design in designs.items()}
    assert at["one pull"][0] < 0.06 < at["Set G"][0] / 3
    assert at["three pulls"][1] < 0.07 < at["one pull"][1]
    assert at["three pulls"][1] < at["Set G"][1] / 6
    assert (poses(TRAINED).forces(designs["one height"], 3.75)[:, 1] < 0).all()


def test_summary_and_costs_of_a_table_that_is_made_up(discs):
    radius, pull = column(discs, "parameters.radius"), column(discs, "parameters.pull")
    shape = (len(DESIGNS), len(radius))
    for k, name in enumerate(("proximal", "middle", "distal")):
        forces = np.broadcast_to(pull, shape).copy()
        forces[1] *= k
        discs.kept[name] = forces.ravel()
    assert forces_of(discs)[1, 0] == pytest.approx([0.0, 2.5, 5.0])
    other = {study: table(study) for study in (PLACES, SQUARES)}
    for each in other.values():
        for name in ("proximal", "middle", "distal"):
            each.kept[name] = np.ones(len(each))
    rows = summary({DISCS: discs, **other})
    assert len(rows) == len(DESIGNS) * 8
    set_g = next(row for row in rows if row["design"] == "Set G" and row["pull_N"] == 7.5)
    assert set_g["runs"] == 5
    assert set_g["spread"] == pytest.approx((2 / 3)**0.5)
    assert set_g["all_press"] == 0.0
    assert rows[0]["all_press"] == 1.0
    assert rows[0]["spread"] == 0.0
    assert {row["runs"] for row in rows if row["objects"] == "thicker discs"} == {5}
    assert {row["runs"] for row in rows if row["objects"] == "thinner discs"} == {2}
    costs = {row["design"]: row for row in costs_of(designs_of(discs))}
    assert costs["Set G"]["forces_per_pull"] == pytest.approx(0.572, abs=5e-4)
    assert costs["one height"]["largest_pull_N"] < 1.0
    assert np.isnan(costs["one height"]["forces_per_pull"])
    assert costs["Set G"]["least_pull_N"] < 3.75
    assert costs["Set G"]["largest_pull_N"] == np.inf


def test_paths_of_the_palm_are_the_scene_s():
    scene = sandbox.load_scene("guided_finger")
    assert [scene.parameters[path.removeprefix("parameters.")] for path in PALM] == \
        pytest.approx(REFERENCE.guides[0])
