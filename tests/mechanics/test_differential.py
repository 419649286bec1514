"""Equations (1)-(7) and rockers, each against coordinates or a balance of its own."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.mechanics import differential as d

arm = st.floats(0.005, 0.05)
shift = st.floats(-0.02, 0.02)


@given(shift, st.floats(-3, 3), arm)
def test_pulley_keeps_its_cord(x_axle: float, theta: float, radius: float) -> None:
    """(1)-(4): the cord over the wheel keeps its length, and (3), (4) undo (1), (2)."""
    x_1, x_2 = d.pulley_ends(x_axle, theta, radius)
    assert x_1 - x_axle == pytest.approx(-(x_2 - x_axle), abs=1e-15)
    assert d.pulley_rotation(x_1, x_2, radius) == pytest.approx(theta, abs=1e-12)
    assert d.pulley_axle(x_1, x_2) == pytest.approx(x_axle, abs=1e-15)
    assert d.pulley_turn(x_1, x_axle, radius) == pytest.approx(theta, abs=1e-12)


@given(arm, arm, st.floats(-0.6, 0.6), st.floats(0.1, 30))
def test_tilt_leaves_tensions_alone_in_line(a: float, b: float, tilt: float, pull: float) -> None:
    """Pins in line, strings parallel: the moment balance gives F b / (a + b) at any tilt."""
    line = np.array([np.cos(tilt), np.sin(tilt)])
    down = np.array([0.0, -1.0])
    t_1, t_2, up = d.rocker_tensions_at(pull, -a * line, b * line, down, down)
    assert (t_1, t_2) == (pytest.approx(float(d.rocker_tensions(pull, a, b)[0]), rel=1e-12),
                          pytest.approx(float(d.rocker_tensions(pull, a, b)[1]), rel=1e-12))
    np.testing.assert_allclose(up, [0, 1], rtol=0, atol=1e-12)


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_strings_not_parallel_balance(lean_1: float, lean_2: float) -> None:
    """Forces and moments of all three strings vanish, whatever the directions."""
    to_1, to_2 = np.array([-0.02, -0.003]), np.array([0.035, 0.002])
    d_1, d_2 = (np.array([np.sin(w), -np.cos(w)]) for w in (lean_1, lean_2))
    t_1, t_2, up = d.rocker_tensions_at(7.0, to_1, to_2, d_1, d_2)
    np.testing.assert_allclose(t_1 * d_1 + t_2 * d_2 + 7.0 * up, 0, atol=1e-13)
    moment = t_1 * np.linalg.det([to_1, d_1]) + t_2 * np.linalg.det([to_2, d_2])
    assert abs(moment) < 1e-14


@given(shift, shift, arm, arm)
def test_rocker_pose_from_coordinates(x_1: float, x_2: float, a: float, b: float) -> None:
    """Middle pin and tilt of a rigid rocker whose ends sit at heights x_1 and x_2."""
    if abs(x_1 - x_2) > 0.99 * (a + b):
        return
    tilt = d.rocker_tilt(x_1, x_2, a, b)
    end_2 = np.array([(a + b) * np.cos(tilt), x_2])
    end_1 = end_2 + (a + b) * np.array([-np.cos(tilt), np.sin(tilt)])
    assert end_1 == pytest.approx(np.array([0.0, x_1]), abs=1e-15)
    middle = end_1 + (end_2 - end_1) * a / (a + b)
    assert d.rocker_axle(x_1, x_2, a, b) == pytest.approx(middle[1], abs=1e-15)


@given(arm, arm, arm, arm)
def test_virtual_work_of_an_uneven_tree(a: float, b: float, c: float, e: float) -> None:
    """F X_P = sum T_i x_i, the shares made by walking down the rockers by hand."""
    tree = d.Split(first=d.Split(a=c, b=e), a=a, b=b)
    top_1, top_2 = d.rocker_tensions(1.0, a, b)
    low_1, low_2 = d.rocker_tensions(float(top_1), c, e)
    np.testing.assert_allclose(d.tree_shares(tree), [low_1, low_2, top_2], rtol=1e-12)
    x = np.array([3e-3, -1e-3, 4e-3])
    by_hand = d.rocker_axle(d.rocker_axle(x[0], x[1], c, e), x[2], a, b)
    assert d.tree_displacement(tree, x) == pytest.approx(float(by_hand), abs=1e-15)


def test_shaft_of_pulleys_works_virtually() -> None:
    """M dphi = sum T_j dx_j for pulleys of unequal radii on one shaft."""
    radii, tensions, turn = (0.01, 0.02, 0.015), np.array([2.0, 3.0, 1.0]), np.array([0.2, 0.5])
    moved = d.shaft_displacements(turn, radii)
    np.testing.assert_allclose(moved @ tensions, d.shaft_moment(tensions, radii) * turn, rtol=1e-14)


@pytest.mark.parametrize(("call", "message"), [
    (lambda: d.pulley_rotation(0.01, 0.0, -0.02),
     "radius must be greater than 0, got -0.02 m"),
    (lambda: d.pulley_axle([1.0, 2.0], [1.0, 2.0, 3.0]),
     r"x_1 and x_2 must be of equal length, got shapes \(2,\) and \(3,\)"),
    (lambda: d.rocker_tilt([0.0, 0.05], 0.0, 0.02, 0.02), "at most a .* 0.04 m, got 0.05 m"),
    (lambda: d.rocker_tensions_at(1, [-.02, 0], [.02, 0], [0, -1], [0, 1]),
     "opposite ways, got arms 0.02 m and 0.02 m"),
    (lambda: d.balanced_tree(6), "leaves must be a power of two, got 6"),
    (lambda: d.tree_displacement(d.balanced_tree(4), [1.0, 2.0]), "x must have 4 values in m"),
])
def test_impossible_differentials_are_refused(call: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
