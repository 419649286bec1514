"""Ways of rockers and wheels against those of their strings, and what a slant takes off."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.samples.cords import lengths
from sandbox.samples.loads import Loads
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


@pytest.mark.parametrize("ahead", [False, True])
def test_a_rocker_that_tilts_is_allowed_its_strings_slant(ahead):
    """Ends at arms of 30 and 20 mm, turned by 0.1 rad: strings lean by arm (1 - cos) over 0.3 m.

    As much if they come from where the slot leads to.
    """
    machine_, tilt = rocker(), 0.1
    content = machine_.model_dump(by_alias=True)
    if ahead:
        slot = content["joints"][0]
        slot["start"], slot["end"] = slot["end"], slot["start"]
    machine_ = type(machine_).model_validate(content)

    def change(a):
        a["body_pose"][:, 1, 2] = tilt
        strings_at(a, machine_)
    figure = figures(still(machine_, change))["differential"]
    slants, ways = [], []
    for arm in (0.03, -0.02):
        end = np.array([0.2, 0.5]) + turned(tilt, (arm, 0.0))
        along = end - np.array([0.2 + arm, 0.2])
        length = np.linalg.norm(along)
        slants.append(length * (1 - along[1] / length))
        ways.append(length - 0.3)
    # what each string got longer, weighted by the other's arm
    mean = (0.03 * ways[1] + 0.02 * ways[0]) / 0.05
    assert figure.value == pytest.approx(abs(mean), rel=1e-6)
    assert figure.threshold == pytest.approx(max(slants) + 2 * GAP, rel=1e-9)
    assert figure.verdict == "pass"


def test_a_rocker_on_a_frame_that_is_turned_goes_along_its_slot():
    """All of it turned by 0.6 rad, a slot that points up, and a carriage for its frame."""
    angle = 0.6
    machine_ = machine(
        block("carriage", at=(0.4, -0.1), angle=angle),
        block("rocker", at=(np.array([0.4, -0.1]) + turned(angle, (0.2, 0.5))).tolist(),
              angle=angle), block("three"),
        joints=[{"type": "slot", "name": "slot", "a": "carriage", "b": "rocker",
                 "start": (0.2, 0.1), "end": (0.2, 0.9)}],
        tendons=[{"name": f"string{i}", "guides": [
            {"body": "carriage", "at": (0.2 + arm, 0.2)}, {"body": "rocker", "at": (arm, 0.0)}]}
            for i, arm in enumerate((0.03, -0.02))],
        groups=[{"name": "tree", "kind": "rocker_tree", "bodies": ["rocker"]}])

    def make(error):
        def change(a):
            a["body_pose"][:, 2, :2] += turned(angle, (0.0, 0.01))
            a["tendon_length"][:] = 0.31
            a["tendon_length"][:, 0] += error / 0.4
        return still(machine_, change)
    turns("differential", 2 * GAP, make, by=1e-2)


ALONG, ASIDE = np.array([0.6, 0.8]), np.array([-0.8, 0.6])


def slanted(radius, ends):
    """A carriage turned by 0.6 rad with a slanted slot; strings come by way of two tips.

    Each runs from the carriage over a wheel on its tip to an end on the rocker: a point so far to
    the left and ahead of its middle, or, of a third number other than 0, a wheel about it. A
    radius is positive where the wheel lies right of its cord; tips stand so that no cord leans.
    """
    def world(point):
        return (np.array([0.4, -0.1]) + turned(0.6, point)).tolist()
    middle = np.array([0.2, 0.1]) + 0.3 * ALONG
    tips = [middle + (left + wheel - radius) * ASIDE + (ahead - back) * ALONG
            for (left, ahead, wheel), back in zip(ends, (0.3, 0.21), strict=True)]
    return machine(
        block("carriage", at=world((0, 0)), angle=0.6),
        block("rocker", at=world(middle), angle=0.6),
        *(block(f"tip{i}", at=world(tip), angle=0.3) for i, tip in enumerate(tips)),
        joints=[{"type": "slot", "name": "slot", "a": "carriage", "b": "rocker",
                 "start": (middle - 0.3 * ALONG).tolist(), "end": (middle + 0.3 * ALONG).tolist()}],
        tendons=[{"name": f"string{i}", "guides": [
            {"body": "carriage", "at": (tip - 0.05 * ALONG + 0.2 * ASIDE).tolist()},
            {"body": f"tip{i}", "radius": radius, "side": "right",
             **({"begins": "on"} if radius else {})},
            {"body": "rocker", "at": (left * ASIDE + ahead * ALONG).tolist(),
             "radius": abs(wheel), "side": "right" if wheel > 0 else "left"}]}
            for i, (tip, (left, ahead, wheel)) in enumerate(zip(tips, ends, strict=True))],
        groups=[{"name": "tree", "kind": "rocker_tree", "bodies": ["rocker"]}])


POINTS = [(0.02, 0.013, 0.0), (-0.01, 0.0, 0.0)]
WHEELS = [(0.0, 0.0, 0.02), (0.0, 0.0, -0.01)]


@pytest.mark.parametrize(("radius", "ends", "turn"), [
    (0.0, POINTS, 0.0), (0.004, POINTS, 0.0), (0.0, [POINTS[0], WHEELS[1]], 0.0),
    (0.004, WHEELS, 0.3), (0.0, WHEELS, -0.3)])
def test_strings_over_wheels_that_move_give_what_the_path_before_gets_shorter(radius, ends, turn):
    """The rocker goes 10 mm, one tip 4 mm along with it and the other 7 mm back; nothing leans.

    What the record has more than the path is what the string gives; a third of it and two thirds
    by arms of 10 and 20 mm, of the ends or of wheels, which may turn as well: their pivot does
    not move by that, since what one string gives the other takes, in these shares.
    """
    machine_, along = slanted(radius, ends), turned(0.6, ALONG)

    def moved(a):
        for body, way in ((2, 0.010), (3, 0.004), (4, -0.007)):
            a["body_pose"][:, body, :2] += way * along
        a["body_pose"][:, 2, 2] += turn
    loads = Loads(still(machine_, moved))
    path = lengths(loads.frames, loads.cords)
    if radius == 0.0 and ends == POINTS:  # how far the last stretch and the one before have changed
        assert path[0, 0] - lengths(*_first(machine_))[0, 0] == pytest.approx(
            0.006 + np.hypot(0.2, 0.05 + 0.004) - np.hypot(0.2, 0.05))
    for number, weight in ((0, 1 / 3), (1, 2 / 3)):
        def make(error, number=number, weight=weight):
            def change(a):
                moved(a)
                a["tendon_length"][:] = path.T
                a["tendon_length"][:, number] += error / weight
            return still(machine_, change)
        turns("differential", 2 * GAP, make, by=1e-2)


def _first(machine_):
    loads = Loads(still(machine_))
    return loads.frames, loads.cords


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


def test_the_first_two_of_what_cannot_be_compared_are_named():
    machine_ = rocker()
    content = machine_.model_dump(by_alias=True)
    content["groups"] = [{"name": "tree", "kind": "rocker_tree",
                          "bodies": ["rocker", "two", "three", "wall"]}]
    mixed = figures(still(type(machine_).model_validate(content)))["differential"]
    assert mixed.why.endswith("; left out: two: it does not slide on a slot; "
                              "three: it does not slide on a slot")
    content["joints"] = []
    none = figures(still(type(machine_).model_validate(content)))["differential"]
    assert none.why == ("rocker: it does not slide on a slot; two: it does not slide on a slot")
    assert "left out" not in figures(still(machine_))["differential"].why
