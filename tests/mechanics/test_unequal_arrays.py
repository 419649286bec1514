"""Arrays that do not go together are refused by every closed form, by name and shape."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sandbox.mechanics import (
    differential,
    dynamics,
    grasp_state,
    motion,
    reactions,
    springs,
    statics,
    tendon,
    transmission,
)

TWO, THREE = np.full(2, 0.1), np.full(3, 0.1)
POINTS_2, POINTS_3 = np.full((2, 2), 0.1), np.full((3, 2), 0.1)
MATRICES_2, MATRICES_3 = np.zeros((2, 3, 3)), np.zeros((3, 3, 3))
FINGER = grasp_state.TwoPhalanges(
    (0.2, 0.2), np.ones_like, lower=(-1.0, 0.0), upper=(1.0, 1.0))


@pytest.mark.parametrize(("call", "names"), [
    (lambda: differential.pulley_ends(TWO, THREE, 0.1), "x_axle and theta and radius"),
    (lambda: differential.pulley_turn(TWO, THREE, 0.1), "x_1 and x_axle and radius"),
    (lambda: differential.pulley_rotation(TWO, THREE, 0.1), "x_1 and x_2 and radius"),
    (lambda: differential.rocker_axle(TWO, THREE, 0.1, 0.1), "x_1 and x_2 and a and b"),
    (lambda: differential.rocker_tilt(TWO, 0.1, THREE, 0.1), "x_1 and x_2 and a and b"),
    (lambda: differential.rocker_tensions_at(TWO, [-1, 0], [1, 0], -POINTS_3, [0, -1]),
     "pull and to_1 and to_2 and direction_1 and direction_2"),
    (lambda: dynamics.force_action(POINTS_2, POINTS_3), "force and point"),
    (lambda: dynamics.change_frame(MATRICES_2, MATRICES_3), "action and transform"),
    (lambda: dynamics.external_action(MATRICES_2, np.eye(3), applied=MATRICES_3),
     "acceleration and inertia and gravity and applied"),
    (lambda: dynamics.hinge_reactions(MATRICES_2, MATRICES_3), "actions and frames"),
    (lambda: grasp_state.grasp_states(FINGER, theta_1=TWO, theta_2=THREE, k_1=0.1, k_2=0.1),
     "theta_1 and theta_2"),
    (lambda: motion.origin_acceleration(POINTS_2, 0.1, THREE, [0.1, 0.1]),
     "acceleration and omega and alpha and centre"),
    (lambda: reactions.joint_reactions(
        POINTS_2, POINTS_2, POINTS_2, POINTS_3, [1, 1], [1, 1], POINTS_2, np.zeros((4, 2))),
     "joints and centres and accelerations and alphas and forces and moments"),
    (lambda: springs.end_forces(POINTS_2, [0.0, 0.0], THREE), "near and far and pull"),
    (lambda: statics.joint_torques(TWO, np.zeros((3, 2)), TWO, TWO, TWO),
     "tension and tendon_arms and stiffness and elongations and spring_arms"),
    (lambda: statics.contact_jacobian(np.zeros((2, 2)), TWO, np.zeros((3, 2))),
     "theta and distances"),
    (lambda: statics.contact_forces(np.ones((2, 4, 4)), np.ones((3, 4))),
     "jacobian and torques"),
    (lambda: tendon.guide_tension(TWO, 0.1, THREE), "tension and friction and wrap"),
    (lambda: tendon.guide_distance(POINTS_2, POINTS_3), "hinge and guide_before"),
    (lambda: transmission.force_transfer_ratio(POINTS_2, THREE), "forces and tension"),
    (lambda: transmission.equilibrium_distance(TWO, 0.1, THREE), "theta_2 and ratio"),
])
def test_arrays_of_unequal_length_are_named(call: Callable[[], object], names: str) -> None:
    with pytest.raises(ValueError, match=f"^{names} must be of equal length, got shapes"):
        call()
