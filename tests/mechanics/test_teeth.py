"""Lines of action and gaps of teeth, against the geometry of involutes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.mechanics.teeth import Flank, gear_flank, nearest, rack_flank, rolled

PRESSURE = math.radians(20.0)


def flank(side: int, inside: bool, distance: float, bearing: float, **angles: float) -> Flank:
    return gear_flank((0.02, 0.05), inside, PRESSURE, side, dx=distance * math.cos(bearing),
                      dy=distance * math.sin(bearing),
                      angle_a=angles.get("a", 0.0), angle_b=angles.get("b", 0.0))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("inside", "distance"), [(False, 0.07), (True, 0.03)])
def test_the_line_of_action(side: int, inside: bool, distance: float) -> None:
    """A tangent of both base circles, at the pressure angle, that pushes the two apart."""
    found = flank(side, inside, distance, 0.4)
    push, line = np.array([found.x, found.y]), np.array([math.cos(0.4), math.sin(0.4)])
    assert np.hypot(*push) == pytest.approx(1)
    on_a, to_b = np.array(found.from_a), distance * line
    assert np.hypot(*on_a) == pytest.approx(0.02 * math.cos(PRESSURE))
    assert on_a @ push == pytest.approx(0, abs=1e-15)
    assert abs(push[0] * to_b[1] - push[1] * to_b[0] + (
        on_a[0] * push[1] - on_a[1] * push[0])) == pytest.approx(0.05 * math.cos(PRESSURE))
    apart = push @ line * (-1 if inside else 1)  # of a gear in a ring, towards its teeth
    assert apart == pytest.approx(math.sin(PRESSURE))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("inside", "distance"), [(False, 0.07), (True, 0.03), (False, 0.074)])
def test_the_gap_opens_as_the_push_does_work(side: int, inside: bool, distance: float) -> None:
    """Its derivatives are the push and its moments: 1 N, base radius times 1 N."""
    e = 1e-6
    found = flank(side, inside, distance, 0.4)
    along = {"a": -side * 0.02, "b": -side * 0.05 * (-1 if inside else 1)}
    for name, radius in along.items():
        more, less = (flank(side, inside, distance, 0.4, **{name: s * e}) for s in (1, -1))
        moment = (more.gap - less.gap) / (2 * e)
        assert abs(moment) == pytest.approx(abs(radius) * math.cos(PRESSURE), rel=1e-7)
    far, near = (flank(side, inside, distance + s * e, 0.4) for s in (1, -1))
    line = math.cos(0.4) * found.x + math.sin(0.4) * found.y
    assert (far.gap - near.gap) / (2 * e) == pytest.approx(line, rel=1e-6)


def test_both_gears_turned_by_their_ratio_stay_in_mesh() -> None:
    for side in (1, -1):
        start = flank(side, False, 0.07, 0.4).gap
        assert flank(side, False, 0.07, 0.4, a=1.5, b=-0.6).gap == pytest.approx(start, abs=1e-15)
        start = flank(side, True, 0.03, 0.4).gap
        assert flank(side, True, 0.03, 0.4, a=1.5, b=0.6).gap == pytest.approx(start, abs=1e-15)


@pytest.mark.parametrize("side", [1, -1])
def test_a_rack_pushes_down_and_along(side: int) -> None:
    found = rack_flank(0.02, PRESSURE, side, along=(1.0, 0.0), dx=0.1, dy=-0.02, turned=0.0)
    assert (found.x, found.y) == pytest.approx((side * math.cos(PRESSURE), -math.sin(PRESSURE)))
    moved = rack_flank(0.02, PRESSURE, side, along=(1.0, 0.0), dx=0.1 + 0.02 * 0.3, dy=-0.02,
                       turned=0.3)
    assert moved.gap == pytest.approx(found.gap, abs=1e-15)


def test_a_turn_of_the_line_of_centres_is_taken_off() -> None:
    way, period = rolled((0.02, 0.05), False, dx=-0.07, dy=1e-12, angle_a=0.0, angle_b=0.0)
    other, _ = rolled((0.02, 0.05), False, dx=-0.07, dy=-1e-12, angle_a=0.0, angle_b=0.0)
    assert nearest(way - other, period) == pytest.approx(0, abs=1e-10)
    assert nearest(3.0, math.inf) == 3.0
