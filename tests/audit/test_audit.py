"""Every figure of the audit can fail: spoil a recording, and the right one asks for a look."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sandbox.audit.audit import CHECKS, audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from tests.audit.still import H, block, figures, machine, still
from tests.audit.test_planted import MIDDLE, array, more, sound
from tests.engine.machines import fixed, mass, mechanism


@pytest.fixture(scope="module")
def held():
    """A Set G finger that closes on a disc, every step recorded."""
    return sound(2000.0)


@pytest.fixture(scope="module")
def gripped():
    """A weight on a cord that two eyes hold, pulled until it slides."""
    guides = [{"body": "load"}, {"body": "wall", "friction": 0.2},
              {"body": "wall", "at": (-0.1, 0.0), "friction": 0.1}, {"body": "wall", "at": (0, -1)}]
    return simulate(mechanism(
        duration=0.1, gravity=(0.0, -9.81), bodies=[fixed("wall"), mass("load", 0.1, (0.0, -0.5))],
        tendons=[{"name": "cord", "guides": guides, "pretension": 0.981}],
        drives=[{"type": "pull", "name": "pull", "tendon": "cord", "value": "=0.981 + 20 * t"}]))


def test_friction_of_a_guide_beyond_eulers_bound_asks_for_a_look(gripped):
    """By a share of the tension: the solve itself leaves 1e-10 of those on both sides."""
    share = 3e-9
    assert figures(gripped)["tendon.grip"].value < 2.1e-10
    tension, friction = gripped["cord.tension_1"][-1], gripped.arrays["guide_friction"][-1, 0]
    grown = array("guide_friction", (-1, 0), more)(gripped, share * tension / abs(friction))
    found = figures(grown)["tendon.grip"]
    # the tension before shrinks as the friction grows, and the bound by tanh(mu phi / 2) of that
    expected = share * (1 + math.tanh(0.1 * math.pi / 2))
    assert (found.verdict, found.value) == ("look", pytest.approx(expected, rel=0.02))


def test_numbers_that_are_none_are_never_a_pass(held):
    run = array("body_pose", (slice(100, None), MIDDLE, 0), more)(held, np.nan)
    found = figures(run)
    assert {"poses", "joint.drift", "momentum.moment"} <= {
        f.name for f in found.values() if f.verdict != "pass"}


def test_an_unfinished_run_and_an_empty_one_are_audited(held):
    cut = replace(held.info, complete=False)
    unfinished = Recording(held.mechanism, held.arrays, cut)
    assert "the run stopped early" in figures(unfinished)["rest.moments"].why
    assert {f.verdict for f in audit(held.part(0, 0))} == {"not computed"}


def test_one_check_may_fail_and_the_others_are_computed(monkeypatch):
    def broken(*_):
        raise ValueError("odd numbers")
    monkeypatch.setattr(CHECKS["poses"], "compare", broken)
    found = audit(still(machine(block("one"))))
    assert (found[0].name, found[0].verdict) == ("poses", "not computed")
    assert found[0].why == "the numbers cannot be used: odd numbers"
    assert [figure.name for figure in found] == list(CHECKS)


@pytest.fixture(scope="module")
def broken():
    """A rod that breaks at 1 N, 50 ms after a pull began to grow, and a spring let go at 60 ms."""
    return simulate(mechanism(
        duration=0.1, step=H, run={"sample_rate": 1 / H},
        bodies=[fixed("wall"), mass("load", 0.1, (0.0, -0.5)), mass("bob", 0.1, (1.0, -0.5))],
        joints=[{"type": "rod", "name": "rod", "a": "wall", "b": "load", "breaks_at": 1.0}],
        springs=[{"type": "linear", "name": "spring", "a": "wall", "b": "bob", "stiffness": 8,
                  "rest_length": 1.0, "on_a": (1.0, 1.0)}],
        drives=[{"type": "force", "name": "pull", "body": "load", "direction": (0, -1),
                 "value": "=20 * t"}],
        events=[{"name": "cut", "at": 0.06, "release": "spring"}]))


def test_what_is_released_carries_nothing(broken):
    figure = figures(broken)["release.force"]
    assert figure.verdict == "pass"
    assert "rod at 0.0505 s; spring at 0.0605 s" in figure.why
    gone = int(np.argmin(broken["rod.held"])) + 1
    for key, index in (("joint_reaction", (gone, 0)), ("spring_force", (70, 0))):
        figure = figures(array(key, index, lambda *_: 1e-6)(broken, 0.0))["release.force"]
        assert (figure.verdict, figure.value) == ("look", 1e-6)


def test_what_holds_may_carry_no_more_than_it_breaks_at(broken):
    assert figures(broken)["release.load"].verdict == "pass"
    for load, verdict in ((1 + 0.9e-9, "pass"), (1 + 1.1e-9, "look")):
        run = array("joint_reaction", (20, 0), lambda *_, load=load: load)(broken, 0.0)
        assert figures(run)["release.load"].verdict == verdict


def test_energy_of_closing_is_work_of_the_joint():
    """A pin that catches what falls takes energy, and is told to be known in every step only."""
    def caught(rate):
        return simulate(mechanism(
            duration=0.3, step=H, run={"sample_rate": rate}, gravity=(0.0, -9.81),
            bodies=[fixed("wall"), mass("load", 1.0, (0.0, 0.0))],
            joints=[{"type": "pin", "name": "hook", "a": "wall", "b": "load", "on_a": (0.0, 0.0),
                     "released": True}],
            events=[{"name": "catch", "at": 0.1, "take_up": "hook"}]))

    every, some = figures(caught(1 / H)), figures(caught(100))
    assert every["energy.created"].verdict == every["energy.lost"].verdict == "pass"
    assert some["energy.created"].verdict == some["energy.lost"].verdict == "not computed"
    assert "were engaged again" in some["energy.lost"].why
