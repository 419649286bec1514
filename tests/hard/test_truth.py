"""The yardsticks themselves: published digits, what is conserved, and limits known otherwise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from sandbox.study.reference_fingers import SET_G
from sandbox.verification.benchmarks import (
    four_bars,
    pendulum,
    slider_crank,
    slider_with_play,
    squeezer,
)
from tests.hard.trials.clearance import TRUTH
from tests.hard.trials.linkages import BARS, BASE, SLIDER_CRANK, grashof
from tests.hard.truth import andrews
from tests.hard.truth.chains import G, Rods
from tests.hard.truth.contacts import centre_of_pressure, struck_in_sequence
from tests.hard.truth.fingers import across, rest
from tests.hard.truth.integrate import motion
from tests.hard.truth.linkages import Linkage
from tests.hard.truth.loops import parallelogram
from tests.hard.truth.rods import Rod
from tests.hard.truth.truss import bar_forces


@pytest.mark.parametrize("loops", four_bars.TIPS)
def test_parallelogram(loops: int) -> None:
    """Tips of A02's cranks; those of two loops are published by an independent program."""
    angle, rate = parallelogram(np.array(four_bars.INSTANTS), loops)
    np.testing.assert_allclose(np.stack([np.cos(angle), np.sin(angle)], axis=1),
                               four_bars.TIPS[loops], atol=2e-11)
    if loops == 2:
        assert rate[-1] == pytest.approx(four_bars.LAST_RATE, abs=2e-11)


def test_pendulum() -> None:
    """A01: the elliptic function's digits are the integration's."""
    times = np.array(list(pendulum.TIPS))
    swing = motion(times, lambda q, _: -G / pendulum.LENGTH * np.sin(q), np.array([np.pi / 2]),
                   np.zeros(1))[0, :, 0]
    np.testing.assert_allclose(np.stack([-np.sin(swing), -np.cos(swing)], axis=1),
                               list(pendulum.TIPS.values()), atol=2e-11)


def test_one_rod_is_a_pendulum() -> None:
    """(1/3) l a'' = -(g/2) cos a, whatever the mass."""
    times = np.linspace(0.05, 1.0, 20)
    found = Rods((0.3,), 0.2, (-0.3,)).angles(times)[:, 0]
    truth = motion(times, lambda q, _: -1.5 * G / 0.2 * np.cos(q), np.array([-0.3]), np.zeros(1))
    np.testing.assert_allclose(found, truth[0, :, 0], atol=1e-10)


@pytest.mark.parametrize(("masses", "duration"), [((1e-4, 0.1), 1.0), ((0.01,) * 20, 0.1)])
def test_rods_keep_their_energy(masses: tuple[float, ...], duration: float) -> None:
    """A wrong inertia or Coriolis term would show; so would an error in the tip."""
    rods = Rods(masses, 0.1, tuple(np.linspace(-0.3, 0.2, len(masses)).tolist()))
    times = np.linspace(0.01, duration, 50)
    start = np.array(rods.start)
    angle, rate = motion(times, rods.acceleration, start, 0 * start)
    first = rods.energy(start[None], 0 * start[None])[0]
    np.testing.assert_allclose(rods.energy(angle, rate), first, atol=1e-10 * abs(first))
    assert rate.any()


def test_rods_begin_as_newton_says() -> None:
    """Two level rods let go: F = m a and moments, worked out by hand, a1'' = -9 g / (7 l)."""
    rods = Rods((1.0, 1.0), 1.0, (0.0, 0.0))
    np.testing.assert_allclose(
        rods.acceleration(np.zeros(2), np.zeros(2)), [-9 * G / 7, 3 * G / 7], rtol=1e-12)
    np.testing.assert_allclose(rods.tip(np.array([[0.0, np.pi / 2]])), [[1.0, 1.0]], atol=1e-15)


def test_tolerance_of_the_integrations() -> None:
    """Tightening from 1e-10 to 1e-12 moves the tip by less than a thousandth of what is asked."""
    rods, times = Rods((1e-3, 0.1), 0.1, (-0.3, -1.0)), np.linspace(0.5, 5.0, 10)
    loose, tight = (rods.angles(times, rtol) for rtol in (1e-10, 1e-12))
    assert np.abs(loose - tight).max() < 1.5e-6


def test_andrews_as_published() -> None:
    """The test set's reference of its seven angles at 0.03 s; no loop opens on the way."""
    linkage = andrews.linkage()
    found = linkage.motion(np.array([0.01, squeezer.END]))[0]
    np.testing.assert_allclose(
        andrews.published(found)[-1], list(squeezer.KEPT.values()), atol=3e-8)
    assert linkage.open(found, np.array(linkage.start)).max() < 1e-12


def test_slider_crank_as_published() -> None:
    """Turns and speed of the crank, to nine digits, by a program of another author."""
    angle, rate = SLIDER_CRANK.motion(np.array(list(slider_crank.COURSE)))
    turns, speed = np.array(list(slider_crank.COURSE.values())).T
    np.testing.assert_allclose(angle[:, 0] / (2 * np.pi), turns, atol=2e-9)
    np.testing.assert_allclose(rate[:, 0], speed, atol=2e-6)


def test_a_linkage_of_rods_is_a_chain() -> None:
    """Two programs, one double pendulum."""
    rods, times = Rods((0.1, 0.3), 0.2, (0.4, -0.7)), np.linspace(0.1, 1.0, 10)
    half, whole = rods.length / 2, rods.length
    linkage = Linkage(rods.masses, tuple(rods.inertias.tolist()), ((half, 0.0), (whole, half)),
                      (), rods.start, (0.0, 0.0), gravity=G)
    np.testing.assert_allclose(linkage.motion(times)[0], rods.angles(times), atol=1e-8)


def test_free_four_bar_keeps_its_energy_and_its_loop() -> None:
    """Grashof: shortest and longest bar are shorter than the others, and the crank goes round."""
    bars = sorted((*BARS, BASE))
    assert bars[0] + bars[3] < bars[1] + bars[2]
    linkage, times = grashof(20.0), np.linspace(0.02, 2.0, 100)
    angle, rate = linkage.motion(times)
    start = np.array(linkage.start)
    first = linkage.kinetic(start[None], np.array([linkage.rate]))[0]
    np.testing.assert_allclose(linkage.kinetic(angle, rate), first, rtol=1e-9)
    assert linkage.open(angle, start).max() < 1e-9
    assert abs(angle[-1, 0]) > 2 * np.pi


def test_truss_of_equal_sides() -> None:
    """1 N down on the top of an equilateral triangle: half up on either side, 1/(2 sqrt 3)."""
    top = 0.5 + 0.5j * np.sqrt(3)
    rods, pinned, rolled = bar_forces(
        {"a": 0j, "b": 1 + 0j, "c": top}, (("a", "b"), ("b", "c"), ("c", "a")),
        {"a": 0j, "b": 0j, "c": -1j}, "a", "b")
    assert rods == pytest.approx([0.5 / np.sqrt(3), -1 / np.sqrt(3), -1 / np.sqrt(3)])
    assert pinned == pytest.approx(0.5j)
    assert rolled == pytest.approx(0.5)


def test_centre_of_pressure() -> None:
    """The L of 100 x 30 and 30 x 70 mm, and 3 N at 100 mm against 1 kg."""
    assert centre_of_pressure((30.0, 21.0), (50.0, 15.0)) == pytest.approx(35.588, abs=1e-3)
    assert centre_of_pressure((9.81,), (0.0,), 3.0, 0.1) == pytest.approx(0.030581, abs=1e-6)


def test_struck_in_sequence() -> None:
    """Published for e = 1, 0.5 and 0.9; momentum is kept."""
    assert struck_in_sequence([1, 0, 0, 0, 0], 1.0) == pytest.approx([0, 0, 0, 0, 1], abs=1e-12)
    assert struck_in_sequence([1, 1, 0, 0, 0], 1.0) == pytest.approx([0, 0, 0, 1, 1], abs=1e-12)
    half = struck_in_sequence([1, 0, 0], 0.5)
    assert half == pytest.approx([0.203125, 0.234375, 0.5625], abs=1e-6)
    five = struck_in_sequence([1, 0, 0, 0, 0], 0.5)
    assert five == pytest.approx([0.153870, 0.167175, 0.177979, 0.184570, 0.316406], abs=1e-6)
    nine = struck_in_sequence([1, 0, 0, 0, 0], 0.9)
    assert nine == pytest.approx([0.044, 0.045, 0.047, 0.049, 0.815], abs=1e-3)
    assert sum(nine) == pytest.approx(1.0)


def test_play_as_published() -> None:
    """Instants of the first impacts, turns, speed and height, to the digits given.

    Up to 0.05 s these are others'; after that each chatter adds what it is cut short by.
    """
    given = slider_with_play.COURSE
    found, impacts = TRUTH.motion(np.array(list(given)))
    np.testing.assert_allclose(impacts[:3], slider_with_play.HITS, atol=1e-10)
    turns, rate, height = np.array(list(given.values())).T
    np.testing.assert_allclose(found[:, 0] / (2 * np.pi), turns, atol=2e-8)
    np.testing.assert_allclose(found[:4, 0] / (2 * np.pi), turns[:4], atol=2e-9)
    np.testing.assert_allclose(found[:, 2], rate, atol=1e-5)
    np.testing.assert_allclose([TRUTH.height(y)[0] / TRUTH.play for y in found], height, atol=4e-6)


def test_toppling_as_published() -> None:
    """N = m g (3 cos a - 1)^2 / 4 and F = 3 m g sin a (3 cos a - 2) / 4 of a rod let go upright."""
    rod = Rod(0.3, 0.5, 1e-9, 1e-4)
    angle, (normal, friction) = rod.toppling(np.linspace(1.2, 1.9, 60))
    weight, c, s = rod.mass * G, np.cos(angle), np.sin(angle)
    assert angle[0] < 0.2
    assert angle[-1] > np.pi / 3
    np.testing.assert_allclose(normal / weight, (3 * c - 1)**2 / 4, atol=1e-7)
    np.testing.assert_allclose(friction / weight, 0.75 * s * (3 * c - 2), atol=1e-7)


def test_ladder_leaves_the_wall() -> None:
    """Where cos a = 2/3 cos a_0."""
    rod = Rod(2.0, 1.0, 1e-3, 0.5)
    angle, (floor, wall) = rod.ladder(np.linspace(0.01, 0.4, 400))
    left = np.interp(0.0, -wall, angle)
    assert np.cos(left) == pytest.approx(2 / 3 * np.cos(0.5), abs=1e-4)
    assert floor[0] == pytest.approx(2.0 * G * (1 - 0.75 * np.sin(0.5)**2), rel=1e-3)


def test_rolling_keeps_its_energy() -> None:
    """With an end so round that it matters: kinetic energy from the centre's finite differences."""
    rod, step = Rod(0.2, 0.5, 0.05, 0.1), 1e-4
    times = np.arange(1, 4001) * step
    angle, _ = rod.toppling(times)
    x = rod.radius * angle + 0.25 * np.sin(angle)
    y = rod.radius + 0.25 * np.cos(angle)
    vx, vy, w = (np.gradient(one, step) for one in (x, y, angle))
    energy = rod.mass * ((vx**2 + vy**2) / 2 + G * y) + rod.inertia * w**2 / 2
    np.testing.assert_allclose(energy[2:-2], energy[2], rtol=1e-5)


def test_rest_of_a_led_finger_is_least_energy() -> None:
    """The minimum that a search in all angles finds, whatever the equations say."""
    tension, angles = rest(SET_G.guides, SET_G.lengths, SET_G.before, SET_G.after,
                           SET_G.stiffness, 0.01, 1e5)
    guides = np.array(SET_G.guides)
    near = guides[:-1] - np.array([[0.0, 0.0], *([length, 0.0] for length in SET_G.lengths[:2])])

    def energy(q: np.ndarray) -> float:
        springs = sum(k * (across(np.array(a), np.array(b), t) - across(
            np.array(a), np.array(b), 0.0))**2 / 2 for k, a, b, t in zip(
                SET_G.stiffness, SET_G.before, SET_G.after, q, strict=True))
        drawn = sum(across(a, b, 0.0) - across(a, b, t)
                    for a, b, t in zip(near, guides[1:], q, strict=True))
        return float(springs + 1e5 * max(0.01 - drawn, 0.0)**2 / 2)

    found = minimize(energy, angles + 0.02, method="Nelder-Mead",
                     options={"xatol": 1e-10, "fatol": 1e-18, "maxiter": 4000})
    assert found.x == pytest.approx(angles, abs=2e-4)
    assert tension == pytest.approx(0.3609, abs=1e-4)
