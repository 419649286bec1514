"""A finger round a disc: distances measured from coordinates, and the Set G table."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.mechanics import grasp, statics
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from tests.support.reference import SET_G, SET_G_TABLE, DiscRow


@pytest.mark.parametrize("row", SET_G_TABLE)
def test_set_g_table(row: DiscRow) -> None:
    """All digits of the table. Its centres are those of k_1 = 31 mm at 35 deg, rounded to 0.1 um;
    a digit of the angles needs the unrounded one (0.1 um moves theta_3 by up to 1e-4 deg).
    """
    at = grasp.disc_centre(np.radians(35.0), 0.031, row.disc_radius, SET_G.radii[0])
    np.testing.assert_allclose(at, row.centre, rtol=0, atol=5.1e-8)
    found = grasp.disc_grasp(at, row.disc_radius, SET_G.lengths, SET_G.radii)
    np.testing.assert_allclose(np.degrees(found.theta), row.degrees, rtol=0, atol=5.1e-4)
    springs, cord = spring_set(SET_G.before, SET_G.after), route(SET_G.guides, SET_G.lengths)
    tau = statics.joint_torques(row.tension, cord.arms(found.theta), SET_G.stiffness,
                                springs.elongations(found.theta), springs.arms(found.theta))
    J = statics.contact_jacobian(found.theta, SET_G.lengths, found.distances)
    np.testing.assert_allclose(statics.contact_forces(J, tau), row.forces, rtol=0, atol=5.1e-5)
    general = statics.point_jacobian(found.contacts, found.normals, found.hinges, [0, 1, 2])
    np.testing.assert_allclose(
        statics.contact_forces(general, tau), row.forces, rtol=0, atol=5.1e-5)


def test_impossible_grasps_are_refused() -> None:
    with pytest.raises(ValueError, match=r"more than 0.025 m from hinge 1, got 0.02 m"):
        grasp.disc_grasp((0.02, 0.0), 0.016, SET_G.lengths, SET_G.radii)
    with pytest.raises(ValueError, match=r"phalanx 1 touch within its length of 0.045 m"):
        grasp.disc_grasp((0.06, -0.03), 0.016, SET_G.lengths, SET_G.radii)
    with pytest.raises(ValueError, match=r"disc_radius must be greater than 0, got -0.01 m"):
        grasp.disc_grasp((0.02, -0.03), -0.01, SET_G.lengths, SET_G.radii)

