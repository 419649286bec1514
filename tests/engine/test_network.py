"""Lengths of cords over guides, and how they change with the bodies."""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.engine.cord_state import CORD, GUIDE, GUIDE_RESULT, GUIDE_STATE
from sandbox.engine.network import measure as measured


class Path(NamedTuple):
    """One tendon's row, its guides, their memory and their rows of J."""

    cords: Any
    guides: Any
    memory: Any
    told: Any

    def gradient(self, bodies: int) -> np.ndarray:
        """What the guides were told of dL/dq, [nb, 3]."""
        found = np.zeros((bodies, 3))
        for guide, told in zip(self.guides, self.told, strict=True):
            found[guide["body"]] += told["jx"], told["jy"], told["jt"]
        return found


def path(*guides: tuple[int, float, float, float]) -> Path:
    """One tendon over guides (body, x, y, signed radius)."""
    rows = np.zeros(len(guides), dtype=GUIDE)
    for row, (body, x, y, radius) in zip(rows, guides, strict=True):
        row["body"], row["x"], row["y"], row["radius"] = body, x, y, radius
    cords = np.zeros(1, dtype=CORD)
    cords["last"] = len(guides)
    return Path(cords, rows, np.zeros(len(guides), GUIDE_STATE),
                np.zeros(len(guides), GUIDE_RESULT))


def measure(one: Path, pose: np.ndarray, start: bool) -> float:
    return measured(one.cords[0], one.guides, one.memory, one.told, pose, start)


@pytest.mark.parametrize(("side", "wrap"), [(1.0, math.pi / 2), (-1.0, 3 * math.pi / 2)],
                         ids=["right", "left"])
def test_wheel_between_two_eyes(side: float, wrap: float) -> None:
    """From (-L, 0) over a wheel at the origin to (0, -L), tangents of length sqrt(L^2 - r^2).

    The cord arrives along +x and leaves along -y, a turn of 90 deg clockwise. With the wheel on
    its right it takes, between the tangents, 90 deg + 2 asin(r / L) of the rim; on its left it
    goes round the other way and crosses itself: 270 deg + 2 asin(r / L).
    """
    far, radius = 0.1, 0.02
    one = path((0, -far, 0, 0), (0, 0, 0, side * radius), (0, 0, -far, 0))
    arc = radius * (wrap + 2 * math.asin(radius / far))
    expected = 2 * math.sqrt(far**2 - radius**2) + arc
    assert measure(one, np.zeros((1, 3)), True) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("sides", [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)])
def test_belt_between_two_wheels(sides: tuple[float, float]) -> None:
    """Open belt: sqrt(d^2 - (r1 - r2)^2); crossed: sqrt(d^2 - (r1 + r2)^2). Wound on at both ends,
    what is wound counts from the start, so the length is that of the free stretch.
    """
    r1, r2, d = 0.02, 0.03, 0.1
    one = path((0, 0, 0, sides[0] * r1), (0, 0, d, sides[1] * r2))
    between = r1 - r2 if sides[0] == sides[1] else r1 + r2
    assert measure(one, np.zeros((1, 3)), True) == pytest.approx(
        math.sqrt(d**2 - between**2), rel=1e-14)


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["right", "left"])
def test_a_cord_that_grazes_its_wheel_does_not_go_round_it(side: float) -> None:
    """Three points in line, the wheel touching from one side: the wrap is 0, not 2 pi, whichever
    way the rounding falls (here for 200 directions of the line).
    """
    radius = 0.01
    for angle in np.linspace(0, 2 * math.pi, 200):
        u = np.array([math.cos(angle), math.sin(angle)])
        centre = 0.05 * u + side * radius * np.array([u[1], -u[0]])
        one = path((0, 0, 0, 0), (0, *centre, side * radius), (0, *(0.1 * u), 0))
        assert measure(one, np.zeros((1, 3)), True) == pytest.approx(0.1, abs=1e-9)


def test_wrap_is_continuous_for_more_than_a_turn() -> None:
    """An eye circles a wheel twice, in steps of 3 deg: the length grows by r dphi each time."""
    radius, far = 0.02, 0.1
    one = path((0, -far, 0.0, 0), (0, 0, 0, radius), (1, 0.0, 0.0, 0))
    pose = np.zeros((2, 3))
    lengths = []
    for i in range(241):
        phi = -math.radians(3 * i)
        pose[1, :2] = far * math.cos(phi), far * math.sin(phi)
        lengths.append(measure(one, pose, i == 0))
    np.testing.assert_allclose(np.diff(lengths), radius * math.radians(3), rtol=1e-9)


def random_path(draw: Any) -> tuple[Path, np.ndarray]:
    """Guides on four bodies that stand far enough apart for every wheel to be passed."""
    count = draw(st.integers(2, 6))
    unit = st.floats(-1, 1)
    guides = []
    for i in range(count):
        radius = draw(st.sampled_from([0.0, 0.02, -0.02, 0.05, -0.05]))
        guides.append((i % 4, 0.05 * draw(unit), 0.05 * draw(unit), radius))
    pose = np.array([[0.5 * i + 0.05 * draw(unit), 0.3 * (i % 2) + 0.05 * draw(unit),
                      3 * draw(unit)] for i in range(4)])
    return path(*guides), pose


@settings(deadline=None, max_examples=60)
@given(st.data())
def test_gradient(data: Any) -> None:
    """J = dL/dq against central differences with e = 1e-5: e^2 / 6 times the third derivative.

    Guides are at least 0.2 m apart and arms at most 0.13 m, so third derivatives stay below some
    100 / m^2: 2e-9, and as much again for rounding 1e-16 * 3 m / 1e-5 = 3e-11.
    """
    one, pose = random_path(data.draw)
    measure(one, pose, True)
    exact = one.gradient(4)
    numeric = np.zeros((4, 3))
    for b, axis in itertools.product(range(4), range(3)):
        for sign in (1, -1):
            moved = pose.copy()
            moved[b, axis] += sign * 1e-5
            numeric[b, axis] += sign * measure(one, moved, False) / 2e-5
    np.testing.assert_allclose(exact, numeric, atol=2e-8)
    # a cord is inside the mechanism: its forces and moments about the origin add up to nothing
    np.testing.assert_allclose(exact[:, :2].sum(axis=0), 0, atol=1e-12)
    moments = exact[:, 2] + pose[:, 0] * exact[:, 1] - pose[:, 1] * exact[:, 0]
    assert abs(moments.sum()) < 1e-12
