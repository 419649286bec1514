"""What joints may drift in one step, term by term, and what the figures of geometry add to it."""

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


def test_a_slot_drifts_across_its_groove_however_it_lies():
    """A groove along (3, 4) / 5 of a carriage turned by 0.3; along it the pin is free."""
    along = np.array([0.6, 0.8])
    c, s = np.cos(0.3), np.sin(0.3)
    out = np.array([c * along[0] - s * along[1], s * along[0] + c * along[1]])
    aside = np.array([-out[1], out[0]])
    for slides, off in ((0.07, 0.0), (0.07, 3e-5), (-0.02, -3e-5)):
        machine_ = machine(
            block("one", at=(0.1, 0.1), angle=0.3), block("two", at=(0.4, 0.4)),
            joints=[{"type": "slot", "name": "slot", "a": "one", "b": "two", "start": (0.02, 0.01),
                     "end": (0.62, 0.81)}])
        start = np.array([0.1 + c * 0.02 - s * 0.01, 0.1 + s * 0.02 + c * 0.01])
        at = start + (0.2 + slides) * out + off * aside
        run = still(machine_, lambda a, at=at: a["body_pose"].__setitem__(
            (slice(None), 2, slice(0, 2)), at))
        figure = figures(run)["joint.drift"]
        assert figure.value == pytest.approx(abs(off), abs=1e-15)
        assert figure.threshold == pytest.approx(GAP)


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


# --- differentials


OPEN = 1.51e-10
"""What a step may leave of a joint's gap, and rounding."""


def rotated(angle, point):
    return np.array([math.cos(angle) * point[0] - math.sin(angle) * point[1],
                     math.sin(angle) * point[0] + math.cos(angle) * point[1]])


def rocker(arms=(0.03, -0.02), **more):
    """A rocker on a slot that points up, the way it is pulled, held by strings from below.

    It hangs at (0.2, 0.5); the eyes stand plumb below its ends, 0.3 m away.
    """
    strings = [{"name": f"string{i}", "guides": [
        {"body": "wall", "at": (0.2 + arm, 0.2)},
        {"body": "rocker", "at": (arm, 0.0)}]} for i, arm in enumerate(arms)]
    return machine(
        block("rocker", at=(0.2, 0.5)), block("two"), block("three"),
        joints=[{"type": "slot", "name": "slot", "a": "wall", "b": "rocker", "start": (0.2, 0.1),
                 "end": (0.2, 0.9)}],
        tendons=strings, groups=[{"name": "tree", "kind": "rocker_tree", "bodies": ["rocker"]}],
        **more)


def strings_at(a, machine_):
    """Lengths of the strings in the poses as they are."""
    pose = a["body_pose"][:, 1]
    for i, tendon in enumerate(machine_.tendons):
        eye, end = np.array(tendon.guides[0].at), np.array(tendon.guides[1].at)
        at = pose[:, :2] + np.array([rotated(angle, end) for angle in pose[:, 2]])
        a["tendon_length"][:, i] = np.linalg.norm(at - eye, axis=1)


def test_a_rocker_goes_the_mean_of_its_strings_weighted_by_the_other_arm():
    """Way of the pivot = (30 w_2 + 20 w_1) / 50 mm with w at the arms -30, 20: by the lever alone.

    A string that gives e more on its far side: its end's way is e more than the rocker shows.
    """
    for number, weight in ((0, 20 / 50), (1, 30 / 50)):
        def make(error, number=number, weight=weight):
            def change(a):
                a["body_pose"][:, 1, 1] += 0.004
                strings_at(a, rocker())
                a["tendon_length"][:, number] += error / weight
            return still(rocker(), change)
        turns("differential", 2 * OPEN, make, by=1e-3)
