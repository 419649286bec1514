"""Every kind of load as a force and a moment on its bodies, with numbers worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.samples.cords import lengths
from sandbox.samples.loads import Loads
from sandbox.samples.nearby import PlacedPiece, apart
from sandbox.scene.mechanism import Mechanism
from tests.audit.still import block, machine, still


def turned(angle, point):
    return np.array([math.cos(angle) * point[0] - math.sin(angle) * point[1],
                     math.sin(angle) * point[0] + math.cos(angle) * point[1]])


def moment(lever, force):
    return lever[0] * force[1] - lever[1] * force[0]


def totals(machine_, change=None, **more):
    return Loads(still(machine_, change, n=3, **more)).totals


# --- cords


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


# --- distances of convex shapes


S = np.sqrt(0.5)


def piece(*corners, grown=0.0):
    return PlacedPiece(np.array(corners, dtype=float), grown, None)


BOX = piece((-1, -1), (1, -1), (1, 1), (-1, 1))


@pytest.mark.parametrize(("one", "two", "gap", "normal", "at"), [
    (piece((0, 0), grown=1), piece((3, 4), grown=2), 2.0, (0.6, 0.8), (1.2, 1.6)),
    (piece((0, 0), grown=1), piece((0, 1.5), grown=1), -0.5, (0, 1), (0, 0.75)),
    # capsules: side to side, end to end in line, side to end
    (piece((0, 0), (4, 0), grown=1), piece((2, 3), (9, 3), grown=1), 1.0, (0, 1), (None, 1.5)),
    (piece((0, 0), (0.3, 0.1), grown=0.01), piece((0.6, 0.2), (0.9, 0.3), grown=0.01),
     np.hypot(0.3, 0.1) - 0.02, np.array([3, 1]) / np.sqrt(10), (0.45, 0.15)),
    (piece((0, 0), (4, 0), grown=1), piece((2, -3), (2, -9), grown=0.5), 1.5, (0, -1), (2, -1.75)),
    # a polygon: a circle at a side, at a corner; a side, a corner; what is in it a little
    (BOX, piece((0.3, 3), grown=1), 1.0, (0, 1), (0.3, 1.5)),
    (BOX, piece((2, 2), grown=1), np.sqrt(2) - 1, (S, S), None),
    (BOX, piece((1, 0.5), (4, 0.5), (4, 3), (1, 3)), 0.0, (1, 0), (1, None)),
    (BOX, piece((1 + 1e-9, -3), (5, -3), (5, 3), (1 + 1e-9, 3)), 1e-9, (1, 0), (1, None)),
    (BOX, piece((1 - 1e-9, -3), (5, -3), (5, 3), (1 - 1e-9, 3)), -1e-9, (1, 0), (1, None)),
    (BOX, piece((1.5, 0), (3, -1), (3, 1)), 0.5, (1, 0), (1.25, 0)),
    (BOX, piece((2, 2), (3, 2), (3, 3), (2, 3)), np.sqrt(2), (S, S), (1.5, 1.5)),
])
def test_gap_normal_and_place(one, two, gap, normal, at):
    found = apart(one, two)
    assert found.gap == pytest.approx(gap, abs=1e-15)
    assert found.normal == pytest.approx(normal)
    other = apart(two, one)
    assert other.gap == pytest.approx(gap, abs=1e-15)
    assert other.normal == pytest.approx(-np.asarray(normal))
    for i, wanted in enumerate(at or ()):
        if wanted is not None:
            assert found.at[i] == pytest.approx(wanted, abs=2e-9)
