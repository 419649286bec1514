"""Lengths of cords and springs: what each may be off by, and why."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.audit.still import H, block, figures, machine, still, turns

ROUNDING, CLOSED = 1e-12, 1.5e-10


def turned(angle, point):
    return np.array([math.cos(angle) * point[0] - math.sin(angle) * point[1],
                     math.sin(angle) * point[0] + math.cos(angle) * point[1]])


AT = {"one": (0.0, 0.0), "two": (0.1, 0.05)}
TURN = {"one": 0.2, "two": -0.4, "wall": 0.0}
HINGES = [("one", (0.004, -0.007)), ("two", (-0.006, 0.003))]
EYES = [("wall", (-0.04, 0.03)), ("one", (0.05, 0.02)), ("two", (0.01, 0.04)),
        ("two", (0.06, 0.01))]


def chain(**more):
    """Wall, one, two on hinges that count unlike; bodies turn about their centres of mass."""
    return machine(
        block("one", at=AT["one"], angle=TURN["one"], centre=(0.05, 0.0)),
        block("two", at=AT["two"], angle=TURN["two"], centre=(0.0, 0.05)), block("three"),
        joints=[{"type": "pin", "name": "first", "a": "wall", "b": "one", "on_b": HINGES[0][1],
                 "zero": 0.15},
                {"type": "pin", "name": "second", "a": "two", "b": "one", "on_a": HINGES[1][1],
                 "positive": "clockwise", "zero": -0.3}], **more)


def world(name, point):
    return np.array(AT.get(name, (0.0, 0.0))) + turned(TURN[name], point)


def apart(one, two):
    return float(np.linalg.norm(world(*one) - world(*two)))


SPIN = [[0, 0, 0], [0, 0, 30.0], [0, 0, -20.0], [0, 0, 0]]
FIRST = CLOSED + H**3 * 30.0**3 * apart(HINGES[0], ("one", (0.05, 0.0))) / 6
SECOND = CLOSED + H**3 * (30.0**3 * apart(HINGES[1], ("one", (0.05, 0.0)))
                          + 20.0**3 * apart(HINGES[1], ("two", (0.0, 0.05)))) / 6


def corded(eyes=EYES):
    return chain(tendons=[{"name": "cord", "guides": [
        {"body": body, "at": at} for body, at in eyes]}])


def changed(key, value):
    def change(a):
        a["body_velocity"][:] = SPIN
        a[key][:, 0] = value
    return change


LENGTH = sum(apart(*each) for each in pairwise(EYES))


def test_a_cords_length_is_that_of_its_path_to_rounding():
    for sign in (1.0, -1.0):
        turns("tendon.path", ROUNDING, lambda e, sign=sign: still(
            corded(), changed("tendon_length", LENGTH + sign * e)), by=1e-2)


def test_a_cord_by_its_hinge_angles_may_be_off_by_their_drift():
    """(16)-(19): two stretches cross hinges, each with the gap of its hinge."""
    allowed = ROUNDING + FIRST + SECOND
    turns("tendon.shortening", allowed, lambda e: still(
        corded(), changed("tendon_length", LENGTH + e)))


@pytest.mark.parametrize("by", [(0.0, 2e-4), (1e-4, -2e-4)])
def test_a_cord_by_its_hinge_angles_follows_the_angles_and_not_the_poses(by):
    """Angles off by 0.1 and 0.2 mrad: either stretch changes by its arm times that, and they add.

    What is beyond turns counter-clockwise at both: of one against two, counted clockwise, two does.
    """
    changes = 0.0
    for hinge, (one, two), turn in zip(HINGES, pairwise(EYES), by, strict=False):
        near, far = world(*one) - world(*hinge), world(*two) - world(*hinge)
        changes += np.linalg.norm(near - turned(turn, far)) - np.linalg.norm(near - far)
    assert abs(changes) > 1e-7

    def change(a):
        a["tendon_length"][:, 0] = LENGTH - 1e-5
        a["joint_angle"][:] += by
    value = figures(still(corded(), change))["tendon.shortening"].value
    assert value == pytest.approx(abs(changes + 1e-5), rel=1e-6)


@pytest.mark.parametrize("ends", [(EYES[0], EYES[1]), (EYES[1], EYES[0])])
def test_a_spring_over_a_hinge_may_be_off_by_its_drift(ends):
    """(28)-(30), and the gap of the hinge."""
    machine_ = sprung(*ends)
    turns("spring.length", ROUNDING + FIRST, lambda e: still(
        machine_, changed("spring_length", apart(*ends) - e)))


def sprung(one, two):
    return chain(springs=[{"type": "linear", "name": "band", "a": one[0], "b": two[0],
                           "on_a": one[1], "on_b": two[1], "stiffness": 1.0}])


def test_a_spring_over_a_hinge_follows_the_angle_and_not_the_pose():
    one, two = EYES[1], EYES[2]
    hinge, by = world(*HINGES[1]), 2e-4
    near, far = world(*one) - hinge, world(*two) - hinge
    expected = np.linalg.norm(near - turned(by, far)) - np.linalg.norm(near - far)

    def change(a):
        a["spring_length"][:, 0] = apart(one, two)
        a["joint_angle"][:, 1] += by
    value = figures(still(sprung(one, two), change))["spring.length"].value
    assert value == pytest.approx(abs(expected), rel=1e-6)
