"""The yardstick itself: energy, known frequencies, and the closed forms' arms."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from sandbox.study import independent as reference
from sandbox.study.reference_fingers import SET_A, SET_G, FingerSet


@pytest.mark.parametrize("gravity", [(0.0, 0.0), (2.0, -9.81)])
def test_energy_balance(gravity: tuple[float, float]) -> None:
    """Kinetic + elastic + weight = pulled - damped, to the integrator's tolerance of 1e-11 of the
    26 mJ that the tendon does: a wrong mass matrix or Coriolis term shows at once.
    """
    found = reference.integrate(SET_G, np.linspace(0.01, 0.06, 20), pull=3.0, gravity=gravity)
    left = found.kinetic + found.elastic + found.weight - found.pulled + found.damped
    np.testing.assert_allclose(left, 0, atol=1e-9 * 0.026)
    assert found.damped[-1] > 0.005  # and nothing of it is trivially zero


def test_free_closing_ends_as_published() -> None:
    """Set G under 3 N for 0.06 s ends near 20.6/29.3/21.8 deg (given to 0.1 deg)."""
    found = reference.free_closing()
    np.testing.assert_allclose(np.degrees(found.angle[-1]), [20.6, 29.3, 21.8], atol=0.1)


@pytest.mark.parametrize("numbers", [SET_A, SET_G], ids=["A", "G"])
def test_generalised_forces_are_the_closed_arms(numbers: FingerSet) -> None:
    """-dlt/dq and dl/dq of the reference against (17), (29): two programs, one geometry."""
    chain = reference.Chain(numbers, lambda _: 1.0)
    cord, springs = route(numbers.guides, numbers.lengths), spring_set(
        numbers.before, numbers.after)
    for theta in np.random.default_rng(5).uniform(0, 1.2, (10, 3)):
        length, slope = chain.tendon(theta)
        np.testing.assert_allclose(length, cord.lengths(theta), atol=1e-15)
        np.testing.assert_allclose(-slope, cord.arms(theta), atol=1e-15)
        length, slope = chain.spring(theta)
        np.testing.assert_allclose(length, springs.lengths(theta), atol=1e-15)
        np.testing.assert_allclose(slope, springs.arms(theta), atol=1e-15)
