"""A finger round a disc: distances measured from coordinates, and the Set G table."""

from __future__ import annotations

import pytest

from sandbox.mechanics import grasp
from tests.support.reference import SET_G


def test_impossible_grasps_are_refused() -> None:
    with pytest.raises(ValueError, match=r"more than 0.025 m from hinge 1, got 0.02 m"):
        grasp.disc_grasp((0.02, 0.0), 0.016, SET_G.lengths, SET_G.radii)
    with pytest.raises(ValueError, match=r"phalanx 1 touch within its length of 0.045 m"):
        grasp.disc_grasp((0.06, -0.03), 0.016, SET_G.lengths, SET_G.radii)
    with pytest.raises(ValueError, match=r"disc_radius must be greater than 0, got -0.01 m"):
        grasp.disc_grasp((0.02, -0.03), -0.01, SET_G.lengths, SET_G.radii)
