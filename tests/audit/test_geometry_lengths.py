"""Lengths of cords and springs: what each may be off by, and why."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.audit.still import H, block, figures, machine, still, turns

ROUNDING, SLOP, SHIFT = 1e-12, 1e-6, 4e-6
OVERLAP = [(i, 3, 0, (0.0, 0.0), (0.0, 1.0), (0.0, 0.0), -SLOP - SHIFT) for i in range(4)]
"""Body 3 lies in the wall by SHIFT more than slop, in every sample."""


def turned(angle, point):
    return np.array([math.cos(angle) * point[0] - math.sin(angle) * point[1],
                     math.sin(angle) * point[0] + math.cos(angle) * point[1]])


AT = {"one": (0.0, 0.0), "two": (0.1, 0.05)}
TURN = {"one": 0.2, "two": -0.4, "wall": 0.0}
EYES = [("wall", (-0.04, 0.03)), ("one", (0.05, 0.02)), ("two", (0.01, 0.04)),
        ("two", (0.06, 0.01))]


def chain(**more):
    """Wall, one, two on hinges that count unlike; bodies turn about their centres of mass."""
    return machine(
        block("one", at=AT["one"], angle=TURN["one"], centre=(0.05, 0.0)),
        block("two", at=AT["two"], angle=TURN["two"], centre=(0.0, 0.05)), block("three"),
        joints=[{"type": "pin", "name": "first", "a": "wall", "b": "one", "on_b": (0, 0),
                 "zero": 0.15},
                {"type": "pin", "name": "second", "a": "two", "b": "one", "on_a": (0, 0),
                 "positive": "clockwise", "zero": -0.3}], **more)


def world(name, point):
    return np.array(AT.get(name, (0.0, 0.0))) + turned(TURN[name], point)


def apart(one, two):
    return float(np.linalg.norm(world(*one) - world(*two)))


SPIN = [[0, 0, 0], [0, 0, 30.0], [0, 0, -20.0], [0, 0, 0]]
ARM = float(np.linalg.norm(world("two", (0, 0)) - world("one", (0.05, 0.0))))
FIRST = 1.1 * H**2 * 30.0**2 * 0.05 / 2 + SLOP
SECOND = 1.1 * H**2 * (30.0**2 * ARM + 20.0**2 * 0.05) / 2 + SLOP


def corded(eyes=EYES):
    return chain(tendons=[{"name": "cord", "guides": [
        {"body": body, "at": at} for body, at in eyes]}])


def changed(key, value):
    def change(a):
        a["body_velocity"][:] = SPIN
        a[key][:, 0] = value
    return change


LENGTH = sum(apart(*each) for each in pairwise(EYES))


def test_a_cords_length_is_that_of_its_path_to_rounding_and_the_shift_of_each_guide():
    turns("tendon.path", ROUNDING + 4 * SHIFT, lambda e: still(
        corded(), changed("tendon_length", LENGTH + e), touches=OVERLAP))
    turns("tendon.path", ROUNDING + 4 * SHIFT, lambda e: still(
        corded(), changed("tendon_length", LENGTH - e), touches=OVERLAP))
    turns("tendon.path", ROUNDING, lambda e: still(
        corded(), changed("tendon_length", LENGTH + e)), by=1e-2)


def test_a_cord_by_its_hinge_angles_may_be_off_by_their_drift():
    """(16)-(19): two stretches cross hinges, each with drift and shift; the record has one more."""
    allowed = ROUNDING + SHIFT + FIRST + SHIFT + SECOND + SHIFT
    turns("tendon.shortening", allowed, lambda e: still(
        corded(), changed("tendon_length", LENGTH + e), touches=OVERLAP))


def test_a_cord_by_its_hinge_angles_follows_the_angle_and_not_the_pose():
    """An angle off by 1e-4 rad: the stretch changes by arm times that, at either hinge."""
    for number, (one, two), sense in ((0, EYES[0:2], 1), (1, EYES[1:3], 1)):
        hinge = (np.zeros(2), world("two", (0, 0)))[number]
        by = 1e-4
        near, far = world(*one) - hinge, world(*two) - hinge
        after = np.linalg.norm(near - turned(sense * by, far))
        expected = abs(after - np.linalg.norm(near - far))

        def change(a, number=number, by=by):
            a["tendon_length"][:, 0] = LENGTH
            # counter-clockwise of what is beyond; of one against two, counted clockwise
            a["joint_angle"][:, number] += by
        value = figures(still(corded(), change))["tendon.shortening"].value
        assert value == pytest.approx(expected, rel=1e-6)
        assert expected > 1e-7


def test_cords_over_wheels_or_past_no_hinge_have_no_such_triangle():
    past = figures(still(corded(EYES[2:])))["tendon.shortening"]
    assert past.why == "no tendon crosses a hinge by plain eyes"
    for wheel in (0, 1):
        guides = [{"body": body, "at": at} for body, at in EYES[:2]]
        guides[wheel]["radius"] = 0.005
        over = chain(tendons=[{"name": "cord", "guides": guides}])
        assert figures(still(over))["tendon.shortening"].verdict == "not computed"


@pytest.mark.parametrize("ends", [(EYES[0], EYES[1]), (EYES[1], EYES[0])])
def test_a_spring_over_a_hinge_may_be_off_by_its_drift(ends):
    """(28)-(30), and the shift of both ends."""
    machine_ = sprung(*ends)
    turns("spring.length", ROUNDING + 2 * SHIFT + FIRST, lambda e: still(
        machine_, changed("spring_length", apart(*ends) - e), touches=OVERLAP))


def sprung(one, two):
    return chain(springs=[{"type": "linear", "name": "band", "a": one[0], "b": two[0],
                           "on_a": one[1], "on_b": two[1], "stiffness": 1.0}])


def test_a_spring_over_no_hinge_is_as_long_as_its_ends_are_apart():
    ends = EYES[0], EYES[2]
    turns("spring.length", ROUNDING + 2 * SHIFT, lambda e: still(
        sprung(*ends), changed("spring_length", apart(*ends) + e), touches=OVERLAP))


def test_a_spring_over_a_hinge_follows_the_angle_and_not_the_pose():
    one, two = EYES[1], EYES[2]
    hinge, by = world("two", (0, 0)), 2e-4
    near, far = world(*one) - hinge, world(*two) - hinge
    expected = np.linalg.norm(near - turned(by, far)) - np.linalg.norm(near - far)

    def change(a):
        a["spring_length"][:, 0] = apart(one, two)
        a["joint_angle"][:, 1] += by
    value = figures(still(sprung(one, two), change))["spring.length"].value
    assert value == pytest.approx(abs(expected), rel=1e-6)


@pytest.mark.parametrize(("far", "length"), [((-0.02, 0.0), 0.02), ((0.07, 0.0), 0.07)])
def test_ends_in_line_with_the_hinge_have_a_length_too(far, length):
    """At (50, 0) mm before the hinge, which lies at (50, 0): sides of 50 and of ``far`` in line."""
    machine_ = machine(
        block("one"), joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "one",
                               "on_b": (0, 0)}],
        springs=[{"type": "linear", "name": "band", "a": "wall", "b": "one", "on_a": (-0.05, 0.0),
                  "on_b": far, "stiffness": 1.0}])
    expected = abs(far[0] + 0.05)
    run = still(machine_, lambda a: a["spring_length"].__iadd__(expected + 3e-6))
    assert figures(run)["spring.length"].value == pytest.approx(3e-6, rel=1e-6)
    assert abs(far[0]) == length
