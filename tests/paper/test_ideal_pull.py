"""The slow motion of the stiffness loops in closed form, against runs of the engine."""

from __future__ import annotations

import numpy as np
import pytest

import sandbox
from sandbox.paper.finger_plant import HINGES, TARGET, Plant
from sandbox.paper.ideal_pull import _scene, laws, needed, predicted, simulated
from sandbox.study.reference_fingers import SET_A

FAST = 0.1
"""The first swings are over by then [s]; the slow motion cannot be further off than they last."""


@pytest.mark.parametrize("pull", [7.5, 10.0, 15.0, 22.0])
def test_the_quadrature_tells_when_the_slowest_joint_is_settled(pull):
    assert simulated(pull).max() == pytest.approx(predicted(pull).max(), abs=FAST)


def test_late_errors_fall_at_the_rate_of_the_closed_form():
    """e' = - KI e / (Kp - T g'): to the share by which g' changes over what is left of e.

    The damper, left out of the slow motion, is counted here: T h - k s = C theta' makes
    rate (Kp - T g' - rate C / s) = KI.
    """
    pull, plant = 15.0, Plant()
    run = sandbox.simulate(_scene(pull))
    for joint, hinge in enumerate(HINGES):
        law, target = laws()[joint], TARGET[joint]
        error = np.interp([2.5, 3.5], run.time, run[f"finger.{hinge}.angle"]) - target
        near = np.array([target - 1e-4, target, target + 1e-4])
        slope = np.gradient(needed(joint, near, plant), near)[1]
        stiff = law.kp - pull * slope
        drag = SET_A.damping[joint] / plant.spring_moments(TARGET)[joint]
        rate = (stiff - np.sqrt(stiff**2 - 4 * drag * law.ki)) / (2 * drag)
        # d ln|g'| / d ln theta is some -3 for g = h / s with s about theta^2
        left = 3 * abs(error[0]) / target
        assert left < 0.03
        assert np.log(error[0] / error[1]) == pytest.approx(rate, rel=left)


def test_the_pull_that_settles_soonest_lies_where_two_joints_are_as_slow():
    """The knuckle gets faster with the pull, the end joint slower; the slower one counts."""
    pulls = np.linspace(7.0, 22.0, 61)
    times = np.array([predicted(float(pull)) for pull in pulls])
    best = np.argmin(times.max(axis=1))
    assert 7.5 < pulls[best] < 8.5
    assert times[best, 0] == pytest.approx(times[best, 2], abs=0.05)
    assert times.max(axis=1)[[0, -1]] == pytest.approx([1.27, 2.40], abs=0.01)
