"""Figures of what is let go, breaks and is taken up, and of surfaces that run: faults are found."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from tests.support.mechanisms import fixed, mass, mechanism

from .still import figures

H = 1e-3


def spoilt(run, key, index, value):
    arrays = {name: np.array(array) for name, array in run.arrays.items()}
    arrays[key][index] = value
    return Recording(run.mechanism, arrays, run.info)


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
        figure = figures(spoilt(broken, key, index, 1e-6))["release.force"]
        assert (figure.verdict, figure.value) == ("look", 1e-6)


def test_what_holds_may_carry_no_more_than_it_breaks_at(broken):
    assert figures(broken)["release.load"].verdict == "pass"
    for load, verdict in ((1 + 0.9e-9, "pass"), (1 + 1.1e-9, "look")):
        run = spoilt(broken, "joint_reaction", (20, 0), load)
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
