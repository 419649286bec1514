"""Fingers without mass on discs: against the Set G table, free rests, differences of gaps."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.mechanics.embrace import ClosingFinger, Pull, close_on_discs, near_disc
from sandbox.mechanics.grasp import disc_centre
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from sandbox.study.reference_fingers import SET_G, SET_G_TABLE

LIMITS = np.radians([[0.0, 85.0], [0.0, 88.0], [0.0, 75.0]])


@pytest.fixture(scope="module")
def finger() -> ClosingFinger:
    return ClosingFinger(route(SET_G.guides, SET_G.lengths), spring_set(SET_G.before, SET_G.after),
                   np.full(3, SET_G.stiffness), LIMITS, np.array(SET_G.lengths),
                   np.array(SET_G.radii), np.array([4e-3, 1.2e-3, 3e-4]))


def test_set_g_table(finger: ClosingFinger) -> None:
    """All rows at once, from the straight finger: the table's digits of angles and forces."""
    centres = np.array([disc_centre(np.radians(35.0), 0.031, row.disc_radius, SET_G.radii[0])
                        for row in SET_G_TABLE])
    discs = np.array([row.disc_radius for row in SET_G_TABLE])
    tension = np.array([row.tension for row in SET_G_TABLE])
    found = close_on_discs(finger, centres, discs, Pull(tension), 0.5)
    np.testing.assert_allclose(np.degrees(found.theta), [row.degrees for row in SET_G_TABLE],
                               rtol=0, atol=5.1e-4)
    np.testing.assert_allclose(found.forces, [row.forces for row in SET_G_TABLE], rtol=0,
                               atol=5.1e-5)
    assert found.residual.max() < 1e-9
    # the same rests where a cord is drawn by as much as they take up and it stretches
    stiff = 300.0
    drawn = finger.tendon.shortening(found.theta) + tension / stiff
    again = close_on_discs(finger, centres, discs, Pull(drawn, stiff), 0.5)
    np.testing.assert_allclose(again.tension, tension, rtol=1e-6)
    np.testing.assert_allclose(again.forces, found.forces, rtol=0, atol=1e-6)


def test_a_free_finger_rests_where_torques_balance(finger: ClosingFinger) -> None:
    """Its disc is out of reach, so each joint rests where T h = k s, or on its stop."""
    tension = np.array([1.0, 4.0])
    found = close_on_discs(finger, np.full((2, 2), -1.0), np.full(2, 0.01), Pull(tension), 0.5)
    tau = finger.torques(found.theta, tension)
    inside = (found.theta > 1e-6) & (found.theta < LIMITS[:, 1] - 1e-6)
    assert np.abs(tau[inside]).max() < 1e-9
    assert inside[0].any()
    assert (tau[found.theta >= LIMITS[:, 1] - 1e-6] > 0).all()
    np.testing.assert_array_equal(found.forces, 0.0)


def test_gaps_close_as_the_jacobian_says(finger: ClosingFinger) -> None:
    """By central differences, whose error is that of the gap's third derivative: 1e-9 m/rad."""
    rng = np.random.default_rng(5)
    theta = rng.uniform(0.0, 1.2, (20, 3))
    centres, discs = rng.uniform([-0.01, -0.07], [0.09, -0.03], (20, 2)), np.full(20, 0.005)

    def gaps(at: np.ndarray) -> np.ndarray:
        return near_disc(at, finger.lengths, finger.radii, centres, discs).gaps

    jacobian = near_disc(theta, finger.lengths, finger.radii, centres, discs).jacobian
    for j in range(3):
        turn = 1e-5 * np.eye(3)[j]
        slope = (gaps(theta + turn) - gaps(theta - turn)) / 2e-5
        np.testing.assert_allclose(jacobian[:, :, j], -slope, rtol=0, atol=1e-7)
