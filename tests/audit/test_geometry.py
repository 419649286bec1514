"""How far joints may be off: hinges, stops, wheels and teeth."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.audit.still import Change, block, figures, machine, still, turns

ROUNDING = 1e-12
GAP = 1.5e-10 + ROUNDING
SIZE = np.array([0.3, -0.4])
"""An arm of 0.5 m."""


def hung(**joint: Any):
    """One body on the wall, its centre of mass 0.5 m from the anchor."""
    body = block("one", at=(0.1, 0.2), centre=(-SIZE).tolist())
    return machine(body, joints=[{"name": "joint", "a": "wall", "b": "one", "on_b": (0, 0),
                                  "type": "pin", **joint}])


def test_a_joint_at_rest_is_held_to_what_a_step_closes_it_to():
    turns("joint.drift", GAP, lambda e: still(
        hung(), lambda a: a["body_pose"].__setitem__((slice(None), 1, 0), 0.1 + e)), by=1e-3)


def test_stops_may_be_overrun_by_1e_8():
    for sign, limit in ((1.0, 0.7), (-1.0, -0.5)):
        turns("stop.overrun", 1e-8, lambda e, sign=sign, limit=limit: still(
            hung(limits=(-0.5, 0.7)), lambda a: a["body_pose"].__setitem__(
                (slice(None), 1, 2), limit + sign * e)), by=1e-5)


# -- wheels


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
@pytest.mark.parametrize(("kind", "share"), [("gear", COS), ("roll", 1.0)])
def test_teeth_are_held_along_the_line_of_action_and_circles_along_themselves(inside, kind, share):
    turns("joint.drift", GAP, lambda e: still(
        wheels(inside=inside, type=kind), turned(e / 0.05 / share)), by=1e-2)


@pytest.mark.parametrize("side", [1, -1])
def test_teeth_with_play_may_go_through_it(side: int) -> None:
    """Half of it either way; beyond they would be in one another."""
    machine_ = wheels(type="gear", backlash=2e-4)
    inside = figures(still(machine_, turned(side * 0.9e-4 / 0.05)))["joint.drift"]
    assert (inside.value, inside.verdict) == (0.0, "pass")
    turns("joint.drift", GAP, lambda e: still(
        machine_, turned(side * (1e-4 + e / COS) / 0.05)), by=1e-2)
