"""Where points of bodies are, from their recorded poses."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.samples.frames import Frames
from tests.audit.still import block, machine, still

C, S = np.cos(0.7), np.sin(0.7)


def chain():
    return machine(
        block("one", at=(0.1, -0.2), angle=0.7, centre=(0.05, 0.02)),
        block("two", at=(0.3, 0.1), angle=-1.2),
        joints=[{"type": "pin", "name": "pin", "a": "one", "b": "two", "on_b": (0.02, 0.03),
                 "positive": "clockwise"},
                {"type": "pin", "name": "back", "a": "two", "b": "wall", "on_b": (0, 0)},
                {"type": "rod", "name": "rod", "a": "wall", "b": "two"}])


def test_points_and_their_arms_from_the_centre_of_mass():
    frames = Frames(still(chain()))
    places = frames.places([1], np.array([[0.09, 0.05]]))
    arm = np.array([C * 0.04 - S * 0.03, S * 0.04 + C * 0.03])
    centre = np.array([0.1 + C * 0.05 - S * 0.02, -0.2 + S * 0.05 + C * 0.02])
    assert (frames.centre_x[1, 0], frames.centre_y[1, 0]) == pytest.approx(tuple(centre))
    assert (places.arm_x[0, 0], places.arm_y[0, 0]) == pytest.approx(tuple(arm))
    assert (places.x[0, 0], places.y[0, 0]) == pytest.approx(tuple(centre + arm))


def test_gaps_are_between_the_two_anchors_of_each_joint():
    def change(a):
        a["body_pose"][1, 2, :2] += [0.3, -0.4]
    gaps = Frames(still(chain(), change)).gaps
    assert gaps[0] == pytest.approx([0.0, 0.5, 0.0, 0.0], abs=1e-15)
    assert gaps[2] == pytest.approx([np.hypot(0.3, 0.1), np.hypot(0.6, 0.3),
                                     *[np.hypot(0.3, 0.1)] * 2])


def test_velocities_and_accelerations_by_component_and_body():
    def change(a):
        a["body_velocity"][3, 2], a["body_acceleration"][3, 2] = [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]
    frames = Frames(still(chain(), change))
    assert frames.velocity[:, 2, 3].tolist() == [1.0, 2.0, 3.0]
    assert frames.acceleration[:, 2, 3].tolist() == [4.0, 5.0, 6.0]
