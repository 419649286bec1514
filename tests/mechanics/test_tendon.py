"""Equations (8)-(19) and the arms, against guides placed by coordinates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import strategies as st

from sandbox.mechanics import springs, tendon
from tests.support.reference import SET_A, SET_G, FingerSet

from .coordinates import straight_lines

SETS = pytest.mark.parametrize("finger", [SET_A, SET_G], ids=["A", "G"])
joint = st.floats(0.0, 1.2)


@SETS
def test_arms_are_the_derivative(finger: FingerSet) -> None:
    """h = -d(lt)/d(theta). A central difference of step e errs by e^2/6 |lt'''| plus rounding
    1e-17/e: with |lt'''| < 1 m (lengths of 0.05 m, smooth over 1 rad) and e = 1e-5: < 2e-11 m.
    """
    route = tendon.route(finger.guides, finger.lengths)
    theta, e = np.linspace(0, np.array(finger.limits) - 0.01, 25), 1e-5
    slope = (route.lengths(theta - e) - route.lengths(theta + e)) / (2 * e)
    np.testing.assert_allclose(route.arms(theta), slope, rtol=0, atol=2e-11)


@pytest.mark.parametrize("side", [-1, 1], ids=["palm", "back"])
def test_guides_that_have_passed_each_other_over_the_hinge(side: int) -> None:
    """V_0 beyond the hinge, V_1 before it: pi - alpha_h - gamma_h is below 0, or above 2 pi.

    Their distance by complex numbers, and the arm as twice the triangle's area over it, whose sign
    says on which side the cord passes the hinge.
    """
    before, after = 0.01 + 0.01j * side, -0.01 + 0.02j * side
    route = tendon.route([(before.real, before.imag), (after.real, after.imag)], [0.05])
    assert 0 < route.beta_0[0] < 2 * np.pi
    for theta in (-0.5, 0.0, 0.7):
        turned = after * np.exp(-1j * theta)
        assert route.lengths([theta]) == pytest.approx(abs(turned - before), rel=1e-12)
        across = (before.conjugate() * turned).imag
        assert route.arms([theta]) == pytest.approx(across / abs(turned - before), rel=1e-12)


def test_rough_guide() -> None:
    """Euler's belt: half a turn at mu = 0.2 leaves exp(-0.2 pi)."""
    assert tendon.guide_tension(10.0, 0.2, np.pi) == pytest.approx(10 * np.exp(-0.2 * np.pi))


# --- springs


def _springs(finger: FingerSet) -> springs.SpringSet:
    return springs.spring_set(finger.before, finger.after)


@SETS
def test_spring_lengths_over_time_are_distances(finger: FingerSet) -> None:
    """(20)-(29), shape [time, 3], against the distance of the ends in the world."""
    theta = np.linspace([0, 0, 0], finger.limits, 40)
    by_hand = straight_lines(finger, theta, finger.before, finger.after, own_frame=False)
    np.testing.assert_allclose(_springs(finger).lengths(theta), by_hand, rtol=0, atol=1e-15)


@pytest.mark.parametrize("before", [(-0.007, 0.008), (0.003, 0.008), (-0.007, -0.004)])
def test_any_quadrant(before: tuple[float, float]) -> None:
    """(22) with the sign of x: right wherever M'' lies, where the printed atan2(y/x) is not."""
    finger = replace(SET_A, before=(before,), after=((0.007, 0.008),), lengths=(0.045,))
    theta = np.linspace(0, 1.2, 9)[:, None]
    by_hand = straight_lines(finger, theta, finger.before, finger.after, own_frame=False)
    np.testing.assert_allclose(_springs(finger).lengths(theta), by_hand, rtol=0, atol=1e-15)


@SETS
def test_spring_arms_are_the_derivative(finger: FingerSet) -> None:
    """hm = d(lm)/d(theta), on both sides of the over-centre angle. A central difference of
    step e errs by e^2/6 |lm'''| + 1e-17/e; |lm'''| < 1 m and e = 1e-5 give < 2e-11 m.
    """
    theta, e = np.linspace([0, 0, 0], [2.2, 2.2, 2.2], 30), 1e-5
    found = _springs(finger)
    slope = (found.lengths(theta + e) - found.lengths(theta - e)) / (2 * e)
    np.testing.assert_allclose(found.arms(theta), slope, rtol=0, atol=2e-11)
    assert (found.arms(theta)[0] > 0).all()
    assert (found.arms(theta)[-1] < 0).all()
