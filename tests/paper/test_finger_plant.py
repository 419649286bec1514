"""What holds a pose, and how the finger moves near it."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.paper.finger_plant import TARGET, Plant
from sandbox.paper.reach_runs import finger_scene, settle
from sandbox.study.independent import Chain

LEVEL = (0.0, -9.81)


def moments(plant: Plant, pull: float, stiffness: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """T h - k dlm hm + weight, from coordinates and not from the paper's triangles."""
    chain = Chain(plant.finger, lambda _: pull, plant.gravity)
    length, arm = chain.spring(theta)
    _, jacobian, _, _ = chain.kinematics(theta, 0 * theta)
    weight = np.einsum("i,ixj,x->j", chain.m, jacobian, chain.gravity)
    return -pull * chain.tendon(theta)[1] - stiffness * (length - chain.rest) * arm + weight


@pytest.mark.parametrize("gravity", [(0.0, 0.0), LEVEL])
@pytest.mark.parametrize("pull", [7.0, 15.0, 22.0])
def test_the_stiffness_balances_the_pull(gravity, pull):
    """(T h + w) / (dlm hm) leaves no moment: equality to rounding of moments of 0.1 N m."""
    plant = Plant(gravity=gravity)
    assert np.abs(moments(plant, pull, plant.stiffness(pull, TARGET), TARGET)).max() < 1e-15


def test_set_a_has_the_stiffnesses_of_the_reference():
    """The table of independent programs gives five digits from its runs' ends: 0.05 %."""
    for pull, wanted in ((15.0, (16475, 9745, 4330)), (10.0, (10983, 6497, 2887))):
        assert Plant().stiffness(pull, TARGET) == pytest.approx(wanted, rel=5e-4)


def test_the_range_of_pulls_has_a_spring_at_its_limit_at_either_end():
    plant = Plant()
    least, most = plant.pull_range(TARGET)
    low, high = plant.stiffness(least, TARGET), plant.stiffness(most, TARGET)
    assert low[0] == pytest.approx(plant.softest[0], rel=1e-12)
    assert high[2] == pytest.approx(plant.stiffest[2], rel=1e-12)
    for k in (low, high):
        assert (k > 0.999999 * plant.softest).all()
        assert (k < 1.000001 * plant.stiffest).all()


@pytest.mark.parametrize("gravity", [(0.0, 0.0), LEVEL])
def test_linearised_stiffness_is_the_slope_of_the_moments(gravity):
    """K = -d(moments)/dtheta by central differences: error (1e-5)^2 / 6 of the third derivative."""
    plant = Plant(gravity=gravity)
    k = plant.stiffness(14.0, TARGET)
    step = 1e-5
    slopes = np.stack([
        (moments(plant, 14.0, k, TARGET + one) - moments(plant, 14.0, k, TARGET - one)) / (2 * step)
        for one in step * np.eye(3)], axis=1)
    assert plant.linear(14.0, k, TARGET).stiffness == pytest.approx(-slopes, abs=1e-8)


@pytest.mark.parametrize("pull", [5.0, 14.0])
def test_rest_is_where_the_engine_comes_to_rest(pull):
    """At 5 N the knuckle's softest spring holds it at 3.44 deg: the failing experiment."""
    plant = Plant()
    k = np.clip(plant.stiffness(pull, TARGET), plant.softest, plant.stiffest)
    found = plant.rest(pull, k)
    assert np.abs(moments(plant, pull, k, found)).max() < 1e-12
    assert settle(finger_scene(pull, stiffness=k)) == pytest.approx(found, abs=1e-6)
    if pull == 5.0:
        assert np.degrees(found[0]) == pytest.approx(3.44, abs=0.005)
