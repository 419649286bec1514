"""Tendon segments and springs where their ends lie in other quadrants."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.mechanics import springs, tendon


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


@pytest.mark.parametrize("before", [(-0.007, 0.008), (0.003, 0.008), (-0.007, -0.004)])
def test_spring_length_and_arm_in_any_quadrant(before: tuple[float, float]) -> None:
    """The distance of the ends by complex numbers, and hm = d(lm)/d(theta).

    A central difference of step e = 1e-5 is off by e^2 / 6 times less than 1 m, and by rounding,
    1e-17 / e: below 2e-11 m.
    """
    found, theta, e = springs.spring_set([before], [(0.007, 0.008)]), np.linspace(0, 2.2, 9), 1e-5
    theta = theta[:, None]
    turned = (0.007 + 0.008j) * np.exp(-1j * theta)
    np.testing.assert_allclose(
        found.lengths(theta), np.abs(turned - complex(*before)), rtol=0, atol=1e-15)
    slope = (found.lengths(theta + e) - found.lengths(theta - e)) / (2 * e)
    np.testing.assert_allclose(found.arms(theta), slope, rtol=0, atol=2e-11)
