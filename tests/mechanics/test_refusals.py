"""Impossible numbers are refused with their name, what they must be, and what they are."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sandbox.mechanics import (
    closure,
    grasp,
    grasp_state,
    springs,
    statics,
    tendon,
    transmission,
)
from sandbox.mechanics.four_bar import FourBar, crank_torques
from sandbox.mechanics.grasp_stiffness import grasp_map, tip_jacobian
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
    (lambda: tendon.segment_length(0.02, 0.02, 0.0), "beta must lie between 0 .* got 0 rad"),
    (lambda: tendon.segment_length(0.02, 0.01, np.pi), "through the hinge, got 3.14159 rad"),
    (lambda: tendon.route(SET_G.guides[:3], SET_G.lengths), "guides must have 4 points"),
    (lambda: tendon.route(SET_G.guides, SET_G.lengths).lengths([0.0, 2.6, 0.0]),
     "theta of joint 2 must lie between .* rad, .* got 2.6 rad"),
    (lambda: tendon.guide_tension(1.0, -0.1, 1.0), "friction must be 0 or more, got -0.1"),
    (lambda: springs.spring_set([(-0.01, 0.01)], [(0, 0)]), "after distance .* got 0 m"),
    (lambda: springs.spring_set(SET_G.before, SET_G.after[:2]), "after must have 3 points"),
    (lambda: springs.spring_length(0.01, -0.02, 1.0), "rm must be greater than 0, got -0.02 m"),
    (lambda: springs.spring_length([0.01] * 2, [0.02] * 3, 1.0),
     "dm and rm and delta must be of equal length"),
    (lambda: statics.joint_torques(-1.0, [0.01], [1.0], [0.0], [0.0]), "tension .* got -1 N"),
    (lambda: statics.contact_forces(np.ones((2, 3)), [1, 1, 1]), "as many contacts as joints"),
    (lambda: statics.contact_forces(np.zeros((2, 2)), [1, 1]), "must not be singular"),
    (lambda: statics.point_jacobian([[0, 0]], [[0, 1]], [[0, 0]], [1]), r"phalanx .* got \[1\]"),
    (lambda: statics.unilateral_forces(np.ones((1, 2)), [1, 1], inertia=-np.eye(2)),
     "positive definite"),
    (lambda: transmission.transmission_ratios([-0.01, 0.005]), "arms of joint 1 .* got -0.01 m"),
    (lambda: transmission.force_transfer_ratio([1.0], 0.0), "tension .* got 0 N"),
    (lambda: transmission.equilibrium_distance(0.3, 0.04, 1.25), "ratio must be below 1, got 1.25"),
    (lambda: transmission.two_phalanx_forces(0.3, 0.02, 0.0, 0.04, 1, 1), "k_2 .* got 0 m"),
    (lambda: transmission.force_isotropy([0.0, 0.0]), "largest of forces .* got 0 N"),
    (lambda: closure.contact_wrenches([[1, 0]], [[1, 0]], -0.1, centre=(0, 0), length=1),
     "friction"),
    (lambda: closure.contact_wrenches([[1, 0]], [[1, 0]], 0.1, centre=(0, 0), length=0), "length"),
    (lambda: closure.contact_wrenches([[1, 0]], [[1, 0], [0, 1]], 0, centre=(0, 0), length=1),
     "normals"),
    (lambda: closure.largest_ball([[1, 2]]), "wrenches"),
    (lambda: closure.force_spread([0, 0]), "forces"),
    (lambda: grasp_map([1, 2], [0, 0]), "contacts"),
    (lambda: tip_jacobian([[0, 0]], [[0, 0]], [[True, False]]), "moves"),
    (lambda: stiffness(MAP, np.ones((4, 4)), np.ones(4), contact_stiffness=0.0),
     "contact_stiffness"),
    (lambda: stiffness(MAP, np.ones((2, 4)), np.ones(4)), "jacobian"),
    (lambda: stiffness(MAP, np.ones((4, 4)), np.ones(3)), "joint_stiffness"),
    (lambda: stiffness(MAP, np.ones((4, 2)), -np.eye(2)), "joint_stiffness"),
    (lambda: stiffness(MAP, np.ones((4, 2)), np.diag([1.0, -1.0])),
     "symmetric and positive definite"),
    (lambda: stiffness(MAP, np.ones((4, 2)), [[2.0, 1.0], [0.0, 2.0]]),
     "symmetric and positive definite"),
    (lambda: stiffness(MAP, np.ones((4, 2)), np.ones(2)),
     "2 joints for 4 directions"),
    (lambda: grasp_state.TwoPhalanges((0.045, 0.0), np.ones_like, **STOPS),
     "lengths must be greater than 0, got 0 m"),
    (lambda: fixed(1, 1, lower=(2.0, 0.0)), "lower must not be above upper"),
    (lambda: grasp_state.grasp_states(fixed(1, 1), theta_1=0.1, theta_2=1.7, k_1=0.02, k_2=0.01),
     "theta_2 must lie between its stops, 0 and 1.6 rad, got 1.7 rad"),
    (lambda: grasp_state.grasp_states(fixed(1, 1), theta_1=0.1, theta_2=0.7, k_1=0.02, k_2=0.04),
     "k_2 must lie on its phalanx of 0.03 m, got 0.04 m"),
    (lambda: grasp.disc_grasp((0.02, 0.0), 0.016, SET_G.lengths, SET_G.radii),
     r"more than 0.025 m from hinge 1, got 0.02 m"),
    (lambda: grasp.disc_grasp((0.06, -0.03), 0.016, SET_G.lengths, SET_G.radii),
     r"phalanx 1 touch within its length of 0.045 m"),
    (lambda: grasp.disc_grasp((0.02, -0.03), -0.01, SET_G.lengths, SET_G.radii),
     r"disc_radius must be greater than 0, got -0.01 m"),
    (lambda: FourBar(0.05, 0.04, 0.0, 0.01), r"coupler must be greater than 0, got 0 m"),
    (lambda: FourBar(0.05, 0.04, 0.015, 0.012).first_angle(0.0),
     r"must make a triangle, got 0.04 m, 0.062 m"),
    (lambda: FourBar(0.05, 0.04, 0.022, 0.012).ratio(0.0), r"one line, got 0 rad"),
    (lambda: crank_torques(1.0, FourBar(0.05, 0.04, 0.048, 0.012), 1.5, stiffness=-1),
     r"stiffness must be 0 or more, got -1 N m/rad"),
])
def test_impossible_numbers_are_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
