"""Cords in recorded poses, against taut strings round polygons and against virtual work."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.samples.cords import lengths
from sandbox.samples.loads import Loads
from sandbox.scene.mechanism import Mechanism
from tests.audit.still import block, machine, still

SIDES = 2000
"""Of the polygon that stands for a wheel: an arc of it is short by (2 pi / n)^2 / 24 = 4e-7."""


def length_of(machine_: Mechanism, change=None, n: int = 4) -> np.ndarray:
    """Length of the first cord in every sample [m], [n]."""
    loads = Loads(still(machine_, change, n=n))
    return lengths(loads.frames, loads.cords)[0]


def hull(points: np.ndarray) -> np.ndarray:
    """Corners of the convex hull of points [k, 2], counter-clockwise (Andrew's chain)."""
    ordered = points[np.lexsort((points[:, 1], points[:, 0]))]
    halves = []
    for run in (ordered, ordered[::-1]):
        half: list[np.ndarray] = []
        for p in run:
            while len(half) > 1 and np.cross(
                    [*(half[-1] - half[-2]), 0], [*(p - half[-1]), 0])[2] <= 0:
                half.pop()
            half.append(p)
        halves += half[:-1]
    return np.array(halves)


def taut(p: np.ndarray, centre: np.ndarray, radius: float, q: np.ndarray) -> float:
    """A string from p round the far side of a wheel to q: its hull's rim without the side p q."""
    angles = np.arange(SIDES) * 2 * np.pi / SIDES
    rim = centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    corners = hull(np.vstack([[p, q], rim]))
    rim_length = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).sum()
    return float(rim_length - np.linalg.norm(p - q))


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("place", [(0.02, 0.05), (0.05, 0.35)])
def test_a_cord_over_a_wheel_is_a_taut_string(side, place):
    """From (0, 0) over a wheel above to (0.1, 0.01); to the left it turns the other way round.

    With the wheel to the right of the way the string goes over it: the hull's rim. To the left it
    goes under it first, round it and back: all of the rim but that arc, on the other tangents; it
    has to be told to.
    """
    p, q, centre, radius = np.zeros(2), np.array([0.1, 0.01]), np.array(place), 0.02
    cord = {"name": "cord", "guides": [
        {"body": "wall", "at": p},
        {"body": "wheel", "radius": radius, "side": side, "begins": "on"},
        {"body": "wall", "at": q}]}
    found = length_of(machine(block("wheel", at=place), tendons=[cord]))
    if side == "right":
        assert found == pytest.approx(taut(p, centre, radius, q), rel=1e-6)
        return
    # below the wheel: tangents to its other side, and the arc between them, by circles and Thales
    total, turned = 0.0, []
    for point, sign in ((p, 1.0), (q, -1.0)):
        away = centre - point
        total += math.sqrt(away @ away - radius**2)
        turned.append(math.atan2(away[1], away[0])
                      - sign * math.asin(radius / math.hypot(*away)))
    arc = (turned[1] + math.pi - turned[0]) % (2 * math.pi)
    assert found == pytest.approx(total + radius * arc, rel=1e-9)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("end", ["first", "last"])
def test_a_wheel_at_an_end_pays_out_what_it_turns(side, end):
    """r times the turn; the way of the cord at t = 0 counts as nothing wound.

    A cord leaves to the right on the wheel's top, where it lies left of the path: a turn
    counter-clockwise takes it in there, and pays it out on the other side.
    """
    guides = [{"body": "wheel", "radius": 0.02, "side": side}, {"body": "wall", "at": (0.3, 0.02)}]
    if end == "last":
        guides = guides[::-1]
    machine_ = machine(block("wheel", angle=0.4), tendons=[{"name": "cord", "guides": guides}])
    turn = np.array([0.0, 1.5, 4.0, 6.9, 9.0])  # more than once round, by less than half at a time

    def change(a):
        a["body_pose"][:, 1, 2] = 0.4 + turn
    found = length_of(machine_, change, n=5)
    # a wheel right of the path carries it on its left, so from above if the path goes right
    above = (side == "right") == (end == "first")
    assert found - found[0] == pytest.approx((1 if above else -1) * 0.02 * turn, abs=1e-15)
    ends = np.array([0.3, 0.02])
    straight = math.sqrt(ends @ ends - 0.02**2)
    assert found[0] == pytest.approx(straight, rel=1e-12)


# -- the pull on the guides --------------------------------------------------------------------


CORD = {"name": "cord", "guides": [
    {"body": "one", "at": (0.03, -0.01)}, {"body": "two", "at": (0.01, 0.02), "radius": 0.015,
                                           "side": "left"},
    {"body": "wall", "at": (0.2, 0.25), "radius": 0.03, "side": "right"}, {"body": "one"},
    {"body": "three", "at": (0.0, -0.02), "radius": 0.02, "side": "right"}]}
PLAIN = {"name": "plain", "guides": [{"body": "three", "at": (0.05, 0.0)},
                                     {"body": "one", "at": (-0.04, 0.02)}]}


def tangled():
    return machine(
        block("one", at=(0.05, -0.02), angle=0.3, centre=(0.02, 0.01)),
        block("two", at=(0.1, 0.12), angle=-0.8, centre=(-0.015, 0.02)),
        block("three", at=(0.4, -0.1), angle=2.0, centre=(0.01, -0.03)), tendons=[CORD, PLAIN])


def test_the_pull_of_a_cord_is_minus_its_tension_times_how_its_length_changes():
    """Virtual work: Q = -T dL/dq of every coordinate about the centres of mass, numerically."""
    tension = np.array([3.0, 5.0])
    machine_, by = tangled(), 1e-6

    def changed(body, k, by):
        def change(a):
            a["tendon_tension"][:] = tension
            if k < 2:
                a["body_pose"][:, body, k] += by
                return
            x, y = a["body_centre"][body]
            for sign, angle in ((1, a["body_pose"][0, body, 2]),
                                (-1, a["body_pose"][0, body, 2] + by)):
                a["body_pose"][:, body, 0] += sign * (np.cos(angle) * x - np.sin(angle) * y)
                a["body_pose"][:, body, 1] += sign * (np.sin(angle) * x + np.cos(angle) * y)
            a["body_pose"][:, body, 2] += by
        return change

    def both(change):
        loads = Loads(still(machine_, change, n=1))
        return lengths(loads.frames, loads.cords)[:, 0]
    totals = Loads(still(machine_, changed(1, 0, 0.0), n=1)).totals[:, :, 0]
    for body in (1, 2, 3):
        for k in range(3):
            slope = (both(changed(body, k, by)) - both(changed(body, k, -by))) / (2 * by)
            assert totals[k, body] == pytest.approx(-tension @ slope, abs=2e-9)
    assert np.abs(totals[:, 1:]).min() > 1e-3  # each of the nine is there
    assert (totals[:, 0] == 0).all()
