"""Every figure of the audit can fail: spoil a recording, and the right one asks for a look."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from sandbox.audit.audit import audit, figure_data
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.recording.store import summary
from tests.engine.machines import G, disc, fixed, mass, mechanism
from tests.support.mechanisms import finger
from tests.support.reference import SET_G, SET_G_TABLE

MIDDLE = 2


@pytest.fixture(scope="module")
def held():
    """A Set G finger that closes on a disc and comes to rest, every step recorded."""
    return simulate(finger(
        SET_G, pull={"ramp": {"to": 3.75, "over": 0.3}}, duration=1.0, step=5e-4,
        disc=SET_G_TABLE[0], groups=[{"name": "finger", "kind": "finger", "bodies": [
            "finger.proximal", "finger.middle", "finger.distal"]}],
        run={"sample_rate": 2000.0}))


def figures(run):
    return {figure.name: figure for figure in audit(run)}


def spoilt(run, key, change):
    """The recording with one array changed in place."""
    arrays = {name: np.array(array) for name, array in run.arrays.items()}
    change(arrays[key])
    return Recording(run.mechanism, arrays, run.info)


@pytest.fixture(scope="module")
def gripped():
    """A weight on a cord that two eyes hold, pulled until it slides."""
    guides = [{"body": "load"}, {"body": "wall", "friction": 0.2},
              {"body": "wall", "at": (-0.1, 0.0), "friction": 0.1}, {"body": "wall", "at": (0, -1)}]
    return simulate(mechanism(
        duration=0.1, gravity=(0.0, -9.81), bodies=[fixed("wall"), mass("load", 0.1, (0.0, -0.5))],
        tendons=[{"name": "cord", "guides": guides, "pretension": 0.981}],
        drives=[{"type": "pull", "name": "pull", "tendon": "cord", "value": "=0.981 + 20 * t"}]))


def scale(index, factor):
    def change(array):
        array[index] *= factor
    return change


def shift(index, by):
    def change(array):
        array[index] += by
    return change


def test_friction_of_a_guide_beyond_eulers_bound_asks_for_a_look(gripped):
    """By a share of the tension: the solve itself leaves 1e-10 of those on both sides."""
    share = 3e-9
    assert figures(gripped)["tendon.grip"].value < 2.1e-10
    tension, friction = gripped["cord.tension_1"][-1], gripped.arrays["guide_friction"][-1, 0]
    grown = 1 + share * tension / abs(friction)
    found = figures(spoilt(gripped, "guide_friction", scale((-1, 0), grown)))["tendon.grip"]
    # the tension before shrinks as the friction grows, and the bound by tanh(mu phi / 2) of that
    expected = share * (1 + math.tanh(0.1 * math.pi / 2))
    assert (found.verdict, found.value) == ("look", pytest.approx(expected, rel=0.02))


def test_numbers_that_are_none_are_never_a_pass(held):
    run = spoilt(held, "body_pose", shift((slice(100, None), MIDDLE, 0), np.nan))
    found = figures(run)
    assert {"poses", "joint.drift", "momentum.moment"} <= {
        f.name for f in found.values() if f.verdict != "pass"}
    json.dumps([figure_data(f) for f in found.values()], allow_nan=False)


REASONS = {
    "differential": "no tree", "poses": "no chain of hinges starts", "tendon.path": "no tendon",
    "spring.length": "no straight spring", "stop.overrun": "no hinge has stops",
    "rest.moments": "not at rest", "rest.contacts": "not at rest", "contact.shared": "no finger",
    "contact.friction": "nothing touches", "tendon.slack": "no tendon", "joint.drift": "no joint",
    "reaction.size": "no joint"}


def test_what_cannot_be_computed_says_why():
    run = simulate(mechanism(gravity=(0.0, -G), bodies=[mass("stone", 1.0, (0.0, 0.0))]))
    found = figures(run)
    for name, reason in REASONS.items():
        assert found[name].verdict == "not computed"
        assert reason in found[name].why
        assert math.isnan(found[name].value)


@pytest.mark.parametrize(("more", "reason"), [
    ({"bodies": [fixed("wall"), {"name": "plate", "motion": "scheduled", "path": {"x": "=t"}}]},
     "schedule"),
    ({"bodies": [disc("ball", 0.1, (0, 0))], "drives": [
        {"type": "radius", "name": "swell", "body": "ball", "value": "=0.1 + 0.01 * t"}]},
     "radius"),
])
def test_work_that_is_not_recorded_is_told(more, reason):
    for name in ("energy.created", "energy.lost"):
        figure = figures(simulate(mechanism(**more)))[name]
        assert figure.verdict == "not computed"
        assert reason in figure.why


def test_an_unfinished_run_and_an_empty_one_are_audited(held):
    cut = replace(held.info, complete=False)
    unfinished = Recording(held.mechanism, held.arrays, cut)
    assert "the run stopped early" in figures(unfinished)["rest.moments"].why
    assert {f.verdict for f in audit(held.part(0, 0))} == {"not computed"}


def test_run_json_holds_the_figures(held, tmp_path):
    held.save(tmp_path)
    kept = json.loads((tmp_path / "run.json").read_text())["audit"]
    assert [f["name"] for f in kept] == [f.name for f in audit(held)]
    assert {f["verdict"] for f in kept} == {"pass", "not computed"}
    assert next(f for f in kept if f["name"] == "differential")["value"] is None
    assert summary(held, verdicts=[], figures=[])["audit"] == []
