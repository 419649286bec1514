"""Impossible numbers are refused with their name, what they must be, and what they are."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sandbox.mechanics import closure, grasp, grasp_state, springs, statics, tendon, transmission
from sandbox.mechanics.four_bar import FourBar
from sandbox.mechanics.grasp_stiffness import grasp_map
from sandbox.mechanics.grasp_stiffness import grasp_stiffness as stiffness
from tests.support.reference import SET_G

MAP = np.ones((3, 4))
STOPS = {"lower": (-1.5, 0.0), "upper": (1.5, 1.6)}


def fixed(tau_1: float, tau_2: float, **changes: object) -> grasp_state.TwoPhalanges:
    """A finger whose torques do not change."""
    return grasp_state.TwoPhalanges(
        (0.045, 0.030), lambda theta: np.broadcast_to([tau_1, tau_2], theta.shape).copy(),
        **(STOPS | changes))


@pytest.mark.parametrize(("call", "message"), [
    (lambda: tendon.route([[0.01, -0.01], [0.0, 0.0]], [0.04]), "guide distance .* got 0 m"),
    (lambda: tendon.route(SET_G.guides[:3], SET_G.lengths), "guides must have 4 points"),
    (lambda: tendon.route(SET_G.guides, SET_G.lengths).lengths([0.0, 2.6, 0.0]),
     "theta of joint 2 must lie between .* rad, .* got 2.6 rad"),
    (lambda: tendon.guide_tension(1.0, -0.1, 1.0), "friction must be 0 or more, got -0.1"),
    (lambda: springs.spring_set([(-0.01, 0.01)], [(0, 0)]), "after distance .* got 0 m"),
    (lambda: statics.joint_torques(-1.0, [0.01], [1.0], [0.0], [0.0]), "tension .* got -1 N"),
    (lambda: statics.contact_forces(np.ones((2, 3)), [1, 1, 1]), "as many contacts as joints"),
    (lambda: statics.contact_forces(np.zeros((2, 2)), [1, 1]), "must not be singular"),
    (lambda: statics.unilateral_forces(np.ones((1, 2)), [1, 1], inertia=-np.eye(2)),
     "positive definite"),
    (lambda: transmission.transmission_ratios([-0.01, 0.005]), "arms of joint 1 .* got -0.01 m"),
    (lambda: transmission.equilibrium_distance(0.3, 0.04, 1.25), "ratio must be below 1, got 1.25"),
    (lambda: closure.contact_wrenches([[1, 0]], [[1, 0]], -0.1, centre=(0, 0), length=1),
     "friction"),
    (lambda: closure.force_spread([0, 0]), "forces"),
    (lambda: grasp_map([1, 2], [0, 0]), "contacts"),
    (lambda: stiffness(MAP, np.ones((4, 2)), np.diag([1.0, -1.0])),
     "symmetric and positive definite"),
    (lambda: stiffness(MAP, np.ones((4, 2)), np.ones(2)),
     "2 joints for 4 directions"),
    (lambda: fixed(1, 1, lower=(2.0, 0.0)), "lower must not be above upper"),
    (lambda: grasp_state.grasp_states(fixed(1, 1), theta_1=0.1, theta_2=1.7, k_1=0.02, k_2=0.01),
     "theta_2 must lie between its stops, 0 and 1.6 rad, got 1.7 rad"),
    (lambda: grasp.disc_grasp((0.02, 0.0), 0.016, SET_G.lengths, SET_G.radii),
     r"more than 0.025 m from hinge 1, got 0.02 m"),
    (lambda: grasp.disc_grasp((0.06, -0.03), 0.016, SET_G.lengths, SET_G.radii),
     r"phalanx 1 touch within its length of 0.045 m"),
    (lambda: FourBar(0.05, 0.04, 0.015, 0.012).first_angle(0.0),
     r"must make a triangle, got 0.04 m, 0.062 m"),
    (lambda: FourBar(0.05, 0.04, 0.022, 0.012).ratio(0.0), r"one line, got 0 rad"),
])
def test_impossible_numbers_are_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
