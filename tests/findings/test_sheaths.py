"""Friction in the sheaths: its study files, a few of their points, the closed forms."""


import numpy as np
import pytest

import sandbox
from sandbox.findings import sheaths
from sandbox.findings.sheath_forms import cycle, loop_area
from sandbox.scene.library import shipped_studies
from sandbox.sweeps.plan import read_plan
from sandbox.sweeps.runner import keep_of


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


def test_a_cycle_keeps_to_its_two_lines_and_its_area():
    pulls = np.concatenate([np.linspace(0, 8, 4001), np.linspace(8, 0, 4001)])
    tensions = cycle(pulls, 0.3)
    assert tensions[4000] == pytest.approx(8 * np.exp(-0.3))
    kept = pulls[4001:] > 8 * np.exp(-0.6)
    assert np.ptp(tensions[4001:][kept]) == 0
    assert tensions[-2] / pulls[-2] == pytest.approx(np.exp(0.3))
    # trapezoids of 2 mN miss the corners by less than their size times the height
    assert -np.trapezoid(tensions, pulls) == pytest.approx(loop_area(8.0, 0.3), abs=0.02)
