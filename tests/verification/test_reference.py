"""The yardstick itself: energy, known frequencies, and the closed forms' arms."""

from __future__ import annotations

from dataclasses import replace

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


def test_tolerance_of_the_integration() -> None:
    """Tightening from 1e-9 to 1e-11 moves nothing by 1e-6 deg."""
    times = np.linspace(0.01, 0.06, 6)
    a, b = (reference.integrate(SET_G, times, pull=3.0, rtol=r).angle for r in (1e-9, 1e-11))
    assert np.degrees(np.abs(a - b).max()) < 1e-6


def test_double_pendulum_frequencies() -> None:
    """Two equal massless rods with points m at their ends: omega^2 = (2 -+ sqrt 2) g / l.

    The chain hangs (gravity along +x) from points at L; a small swing in the first mode,
    q_2 = (sqrt 2 - 1) q_1 relative, must stay cos(omega t). Amplitude 1e-4 rad: the cubic terms
    shift the phase by 1e-9.
    """
    length, g = 0.1, 9.81
    points = Points(guides=((0, -1e-3), (1e-3, -1e-3), (1e-3, -1e-3)), before=((-1e-3, 1e-3),) * 2,
                    after=((1e-3, 1e-3),) * 2, stiffness=(0.0, 0.0), damping=(0.0, 0.0),
                    lengths=(length, length), masses=(0.1, 0.1), radii=(1e-3, 1e-3), limits=(1, 1))
    times = np.linspace(0.05, 1.0, 20)
    for sign in (-1.0, 1.0):
        omega = np.sqrt((2 + sign * np.sqrt(2)) * g / length)
        start = 1e-4 * np.array([1.0, -sign * np.sqrt(2) - 1.0])
        chain = AtEnds(points, lambda _: 0.0, (g, 0.0))
        found = reference.solve_ivp(chain.derivative, (0, 1.0), [*start, 0, 0, 0, 0],
                                    method="DOP853", t_eval=times, rtol=1e-11, atol=1e-16)
        np.testing.assert_allclose(
            found.y[:2].T, np.cos(omega * times)[:, None] * start, atol=1e-4 * 1e-5)


class Points(FingerSet):
    """Masses without inertia of their own."""

    @property
    def inertias(self) -> tuple[float, ...]:
        return (0.0,) * len(self.lengths)


class AtEnds(reference.Chain):
    """A chain whose masses sit at the far ends of the links."""

    def __init__(self, *args: object) -> None:
        super().__init__(*args)
        self.s = self.L


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


def test_simple_solutions_are_consistent() -> None:
    """Each textbook formula against a limit or a balance of its own."""
    assert reference.pendulum_period(0.1, 0.0, 1.0, 1e-6, 9.81) == pytest.approx(
        2 * np.pi * np.sqrt(0.1 / 9.81))
    single = replace(SET_G, guides=SET_G.guides[:2], before=SET_G.before[:1],
                     after=SET_G.after[:1], stiffness=(0.0,), damping=(0.0,), lengths=(0.045,),
                     masses=(0.012,), radii=(0.009,), limits=(3.0,))
    period = reference.pendulum_period(0.0225, single.inertias[0], 0.012, 1.0, 9.81)
    swing = reference.integrate(single, np.array([period / 4, period / 2]), gravity=(9.81, 0.0),
                                start=(1.0,))
    np.testing.assert_allclose(swing.angle[:, 0], [0.0, -1.0], atol=1e-9)
    a, tension = reference.atwood(0.2, 0.12, 9.81)
    assert 0.2 * (9.81 - a) == pytest.approx(tension)
    assert 0.12 * (9.81 + a) == pytest.approx(tension)
    a, tension = reference.movable_pulley(0.15, 0.1, 9.81)
    assert 2 * tension - 0.15 * 9.81 == pytest.approx(0.15 * a / 2)
    t, dt = np.linspace(0, 0.3, 4001), 0.3 / 4000
    x = reference.damped_spring(t, 0.05, 200.0, 0.4, 0.01)
    v, second = np.gradient(x, dt), np.gradient(np.gradient(x, dt), dt)
    # central differences of x with omega = 63: errs by (omega dt)^2 / 3 of k x
    left = (0.05 * second + 0.4 * v + 200.0 * x)[5:-5]
    assert np.abs(left).max() < 200.0 * 0.01 * (63.3 * dt)**2
    assert reference.slide(0.1, 0.5, 9.81) == 0.0
    assert reference.stopping_distance(2.0, 0.5, 10.0) == pytest.approx(0.4)
