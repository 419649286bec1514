"""Ways of rockers and wheels against those of their strings, and what a slant takes off."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.audit.still import block, figures, machine, still, turns

GAP = 1.51e-10
"""What a step may leave of a joint's gap, and rounding."""


def turned(angle, point):
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
        at = pose[:, :2] + np.array([turned(angle, end) for angle in pose[:, 2]])
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
        turns("differential", 2 * GAP, make, by=1e-3)


def test_wheels_of_a_pulley_tree_go_the_mean_of_their_two_sides():
    """A wheel of 20 mm hung in two strings that end on it, one on either side.

    It rises by w and turns by w / r: one side gives 2 w, the other nothing.
    """
    machine_ = machine(
        block("wheel", at=(0.2, 0.5)), block("two"), block("three"),
        joints=[{"type": "slot", "name": "slot", "a": "wall", "b": "wheel", "start": (0.2, 0.1),
                 "end": (0.2, 0.9)}],
        tendons=[{"name": f"string{side}", "guides": [
            {"body": "wall", "at": (0.2 + arm, 0.2)},
            {"body": "wheel", "radius": 0.02, "side": side}]}
            for side, arm in (("right", -0.02), ("left", 0.02))],
        groups=[{"name": "tree", "kind": "pulley_tree", "bodies": ["wheel"]}])

    def make(error):
        def change(a):
            a["body_pose"][:, 1, 1] += 0.004
            a["body_pose"][:, 1, 2] += 0.2  # 4 mm on a radius of 20 mm: its left comes down again
            a["tendon_length"][:] = [0.3 + 0.004 - 0.004, 0.3 + 0.004 + 0.004]
            a["tendon_length"][:, 0] += 2 * error
        return still(machine_, change)
    turns("differential", 2 * GAP, make, by=1e-2)


@pytest.mark.parametrize(("change", "words"), [
    ("no slot", "it does not slide on a slot"),
    ("one string", "it has 1 strings that are tendons, not 2"),
    ("one place", "its strings pull at one place")])
def test_what_of_a_tree_cannot_be_compared_says_why(change, words):
    machine_ = rocker(arms=(0.03, 0.03) if change == "one place" else (0.03, -0.02))
    content = machine_.model_dump(by_alias=True)
    if change == "no slot":
        content["joints"] = []
    if change == "one string":
        content["tendons"] = content["tendons"][:1]
    run = still(type(machine_).model_validate(content))
    assert figures(run)["differential"].why == f"rocker: {words}"
