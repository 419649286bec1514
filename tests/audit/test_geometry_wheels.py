"""What wheels may drift: teeth along the line of action, circles along themselves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.audit.still import Change, block, figures, machine, still, turns

GAP = 1.5e-10 + 1e-12
COS = math.cos(math.radians(20.0))


def wheels(*, inside: bool = False, **joint: Any):
    """A fixed wheel of 20 mm and one of 50 mm on a pin."""
    at = (0.03 if inside else 0.07, 0.0)
    return machine(block("one", at=at), joints=[
        {"name": "pin", "type": "pin", "a": "wall", "b": "one", "on_b": (0, 0)},
        {"name": "joint", "a": "wall", "b": "one", "radius_a": 0.02, "radius_b": 0.05,
         "inside": inside, **joint}])


def turned(angle: float) -> Change:
    def change(arrays: dict[str, np.ndarray]) -> None:
        arrays["body_pose"][:, 1, 2] += angle
        arrays["joint_angle"][:, 0] += angle
    return change


@pytest.mark.parametrize("inside", [False, True])
def test_teeth_without_play_are_held_along_the_line_of_action(inside: bool) -> None:
    turns("joint.drift", GAP, lambda e: still(
        wheels(inside=inside, type="gear"), turned(e / 0.05 / COS)), by=1e-2)


@pytest.mark.parametrize("inside", [False, True])
def test_circles_that_roll_are_held_along_themselves(inside: bool) -> None:
    turns("joint.drift", GAP, lambda e: still(
        wheels(inside=inside, type="roll"), turned(e / 0.05)), by=1e-2)


@pytest.mark.parametrize("side", [1, -1])
def test_teeth_with_play_may_go_through_it(side: int) -> None:
    """Half of it either way; beyond they would be in one another."""
    machine_ = wheels(type="gear", backlash=2e-4)
    inside = figures(still(machine_, turned(side * 0.9e-4 / 0.05)))["joint.drift"]
    assert (inside.value, inside.verdict) == (0.0, "pass")
    turns("joint.drift", GAP, lambda e: still(
        machine_, turned(side * (1e-4 + e / COS) / 0.05)), by=1e-2)


def test_teeth_may_yield_by_what_they_carry() -> None:
    """1 kN at 1 GN/m: a micrometre."""
    def make(error: float):
        def change(arrays: dict[str, np.ndarray]) -> None:
            turned(error / 0.05 / COS)(arrays)
            arrays["joint_reaction"][:, 1] = 1e3
        return still(wheels(type="gear"), change)

    turns("joint.drift", GAP + 1e-6, make, by=1e-4)


def test_a_rack_is_held_as_a_gear() -> None:
    """A rack off by e along its line is off by e cos 20 deg along the line of action."""
    def make(error: float):
        def change(arrays: dict[str, np.ndarray]) -> None:
            arrays["body_pose"][:, 1, 0] += error / COS
        return still(machine(block("one", at=(0.0, -0.02)), joints=[
            {"name": "rail", "type": "slot", "a": "wall", "b": "one", "start": (-1, -0.02),
             "end": (1, -0.02), "turns": False},
            {"name": "joint", "type": "rack", "a": "wall", "b": "one", "radius": 0.02}]), change)

    turns("joint.drift", GAP, make, by=1e-2)
