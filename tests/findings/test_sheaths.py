"""Friction in the sheaths: its study files, a few of their points, the closed forms."""

import csv
import io
from dataclasses import replace

import numpy as np
import pytest

import sandbox
from sandbox.findings import sheaths
from sandbox.findings.sheath_forms import cycle, loop_area, over_pulleys
from sandbox.scene.library import shipped_studies
from sandbox.sweeps.plan import read_plan
from sandbox.sweeps.runner import keep_of
from sandbox.sweeps.table import SweepTable

GRIP = sheaths.SheathedGrip(
    guides=True, radius=0.016, bend=np.pi, friction=0.1, bend_in_all=4.0, share=0.7,
    share_closed=0.7, forces=(1.0, 1.2, 0.9), forces_closed=(1.0, 1.2, 0.9), touching=3)


@pytest.mark.parametrize(("name", "runs"), [
    (sheaths.SHARE, 210), (sheaths.HAND, 56), (sheaths.PULLEYS, 7)])
def test_the_study_files_resolve(name, runs):
    plan = read_plan(shipped_studies()[name])
    assert len(plan) == runs == len(set(plan.ids))
    assert not plan.spec.audit


@pytest.mark.parametrize(("guides", "radius", "bend", "friction"), [
    (0, 0.013, 2 * np.pi, 0.1), (1, 0.016, np.pi, 0.1), (1, 0.019, np.pi / 2, 0.05)])
def test_a_finger_has_what_the_closed_form_leaves_it(guides, radius, bend, friction):
    run = sandbox.simulate(sandbox.load_scene("sheathed_finger", overrides={
        "parameters.guides": guides, "parameters.radius": radius, "parameters.phi": bend,
        "parameters.mu": friction, "run.step": 1e-3, "run.duration": 2}))
    form = sheaths.finger(radius)
    pieces = form.pieces(8.0, bend, friction, guides * friction)
    # at rest up to the step's size times what the cord still creeps: some 1e-4 of the pull
    assert run["finger.tendon.tension_0"][-1] == pytest.approx(pieces[-1], rel=1e-3)
    assert [run[f"finger.{name}/disc.normal"][-1] for name in sheaths.PHALANGES] \
        == pytest.approx(form.forces(pieces), abs=2e-3)


def test_all_bends_of_a_grip_are_those_that_its_pull_falls_over():
    plan = read_plan(shipped_studies()[sheaths.SHARE])
    n = len(plan)
    table = SweepTable(plan, {name: np.ones(n) for name in plan.job.keep}, plan.ids, ["done"] * n,
                       np.ones(n))
    grips = sheaths.grips_of(table)
    assert {grip.guides for grip in grips} == {True, False}
    for grip in grips:
        assert grip.share_closed == pytest.approx(np.exp(-grip.friction * grip.bend_in_all))
        assert grip.bend_in_all - grip.bend == pytest.approx(
            grip.guides * sheaths.finger(grip.radius).wraps.sum())


@pytest.mark.parametrize("uneven", [0, 1])
def test_tensions_of_a_hand_are_those_that_its_picture_draws(uneven):
    friction, plan = 0.2, read_plan(shipped_studies()[sheaths.HAND])
    run = sandbox.simulate(sandbox.load_scene("sheathed_hand", overrides={
        "parameters.uneven": uneven, "parameters.phi": sheaths.BEND, "parameters.mu": friction,
        "run.step": 1e-3}))
    kept, lacking = keep_of(run, plan.job.keep, {})
    assert not lacking
    forms = {name: row[0] for name, row in sheaths.tensions_closed(np.array([friction])).items()}
    pull = run["actuator.value"][np.searchsorted(run.time, 1.15)] / 4

    def found(when):
        return [kept[f"{when}{finger}"] / pull for finger in range(1, 5)]

    assert found("closed") == pytest.approx(forms[sheaths.UNEVEN if uneven else sheaths.EVEN],
                                            rel=5e-3)
    if not uneven:
        assert found("swollen") == pytest.approx(forms[sheaths.PUSHED], rel=5e-3)


def test_tensions_of_pieces_fall_from_the_palm_to_the_tip():
    form = sheaths.finger(0.016)
    bare = form.pieces(8.0, np.pi, 0.1, 0.0)
    assert bare == pytest.approx(np.full(3, 8 * np.exp(-0.1 * np.pi)))
    rubbed = form.pieces(8.0, 0.0, 0.1, 0.2)
    assert -np.log(rubbed[-1] / 8) / 0.2 == pytest.approx(form.wraps.sum())
    assert (np.diff(rubbed) < 0).all()


def test_a_cycle_keeps_to_its_two_lines_and_its_area():
    pulls = np.concatenate([np.linspace(0, 8, 4001), np.linspace(8, 0, 4001)])
    tensions = cycle(pulls, 0.3)
    assert tensions[4000] == pytest.approx(8 * np.exp(-0.3))
    kept = pulls[4001:] > 8 * np.exp(-0.6)
    assert np.ptp(tensions[4001:][kept]) == 0
    assert tensions[-2] / pulls[-2] == pytest.approx(np.exp(0.3))
    # trapezoids of 2 mN miss the corners by less than their size times the height
    assert -np.trapezoid(tensions, pulls) == pytest.approx(loop_area(8.0, 0.3), abs=0.02)


def test_one_cord_over_pulleys_loses_a_whole_turn_from_finger_to_finger():
    tensions = over_pulleys(8.0, 0.1, 5)
    assert tensions[:-1] / tensions[1:] == pytest.approx(np.full(4, np.exp(-0.2 * np.pi)))
    assert tensions[-1] == pytest.approx(8 * (1 + np.exp(-0.1 * np.pi)))
    assert over_pulleys(8.0, 0.0, 5) == pytest.approx(np.full(5, 16.0))


def test_what_a_grip_is_called():
    assert GRIP.wraps
    assert not GRIP.held
    assert GRIP.could
    assert replace(GRIP, share=0.72).held
    assert not replace(GRIP, touching=2).wraps
    assert not replace(GRIP, forces_closed=(-0.1, 1.2, 0.9)).could


def test_the_table_has_a_row_a_grip_in_si():
    rows = list(csv.DictReader(io.StringIO(sheaths.table([GRIP, replace(GRIP, guides=False)]))))
    assert len(rows) == 2
    assert float(rows[0]["bend_rad"]) == pytest.approx(np.pi)
    assert float(rows[0]["middle_N"]) == 1.2
    assert rows[1]["guides"] == "False"
    assert rows[0]["touching"] == "3"
