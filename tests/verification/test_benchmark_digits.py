"""Digits of the benchmarks with impacts and friction, by closed forms and integrations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from sandbox.verification.benchmarks import (
    bouncing_ball,
    cam,
    painleve,
    rocking_block,
    rolling_disc,
    struck_row,
    toppling_rod,
    woodpecker,
)
from tests.hard.truth.contacts import struck_in_sequence
from tests.hard.truth.woodpecker import course

G = 9.81
Forces = Callable[[float], tuple[float, float]]


def test_bouncing_ball() -> None:
    """Flights of 2 v/g, speeds v, e v, e² v: a geometric series."""
    e, first = bouncing_ball.RESTITUTION, (2 * bouncing_ball.DROP / G)**0.5
    flights = 2 * first * e**np.arange(1, 5)
    assert first + np.cumsum([0.0, *flights]) == pytest.approx(bouncing_ball.TOUCHES, abs=1e-9)
    assert e**(2 * np.arange(1, 4)) == pytest.approx(bouncing_ball.APEXES)
    assert first * (1 + e) / (1 - e) == pytest.approx(bouncing_ball.REST, abs=1e-9)
    last = bouncing_ball.SPEED * e**bouncing_ball.BLOWS
    assert last == pytest.approx(bouncing_ball.SLOW)


@pytest.mark.parametrize("block", rocking_block.BLOCKS)
def test_rocking_block(block: rocking_block.Block) -> None:
    """θ'' = −p² sin(α − θ) on one corner; at the blow moments about the other one."""
    def fall(rate: float, start: float) -> tuple[float, float, float]:
        """When it is flat, its rate there, its peak."""
        def flat(_: float, y: np.ndarray) -> float:
            return float(y[0])

        flat.terminal, flat.direction = True, -1  # type: ignore[attr-defined]
        found = solve_ivp(lambda _, y: [y[1], -block.turning * np.sin(block.slender - y[0])],
                          (0.0, 3.0), [start, rate], method="DOP853", rtol=1e-12, atol=1e-14,
                          events=[flat, lambda _, y: y[1]])
        peaks = [y[0] for y in found.y_events[1]]
        return found.t[-1], -found.y[1, -1], max(peaks, default=start)

    flat, rate, _ = fall(0.0, block.tilt * block.slender)
    again, _, peak = fall(block.kept * rate, 1e-15)
    assert (flat, rate) == pytest.approx((block.flat, block.rate), abs=1e-8)
    assert (peak / block.slender, flat + again) == pytest.approx(
        (block.peak, block.again), abs=1e-8)


@pytest.mark.parametrize(("row", "speeds"), struck_row.ROWS.items())
def test_struck_row(row: tuple[int, float], speeds: tuple[float, ...]) -> None:
    count, e = row
    found = struck_in_sequence([1.0, *[0.0] * (count - 1)], e)
    assert found == pytest.approx(speeds, abs=1e-6)


def first_slip(forces: Forces, friction: float) -> float:
    """The least angle [deg] at which |F| = μ N."""
    def left(degrees: float) -> float:
        normal, along = forces(np.radians(degrees))
        return friction * normal - abs(along)

    angles = np.linspace(1.0, 70.0, 6901)
    k = next(i for i, angle in enumerate(angles) if left(angle) < 0)
    return float(brentq(left, angles[k - 1], angles[k]))


@pytest.mark.parametrize(("friction", "angle"), toppling_rod.ONSET.items())
def test_toppling_rod(friction: float, angle: float) -> None:
    def forces(a: float) -> tuple[float, float]:
        return (3 * np.cos(a) - 1)**2 / 4, 0.75 * np.sin(a) * (3 * np.cos(a) - 2)

    assert first_slip(forces, friction) == pytest.approx(angle, abs=1e-6)
    assert np.degrees(np.arccos(2 / 3)) == pytest.approx(toppling_rod.TURNS, abs=1e-7)
    steep = [along / normal for normal, along in map(forces, np.linspace(0.5, 0.7, 20001))]
    assert max(steep) == pytest.approx(toppling_rod.STEEPEST, abs=1e-9)


def test_rolling_disc() -> None:
    def forces(a: float) -> tuple[float, float]:
        return (7 * np.cos(a) - 4) / 3, np.sin(a) / 3

    for one in rolling_disc.SLIPS:
        assert first_slip(forces, one.friction) == pytest.approx(one.angle, abs=1e-6)
    for one in rolling_disc.LEAVES:
        assert np.cos(np.radians(one.angle)) == pytest.approx(2 / (3 + one.share), abs=1e-8)


@pytest.mark.parametrize("rod", painleve.RODS)
def test_painleve(rod: painleve.SlidingRod) -> None:
    """Newton's and Euler's laws, solved as they stand for N and the three accelerations."""
    a, mu = np.radians(rod.degrees), rod.friction
    c, s = np.cos(a), np.sin(a)
    #            N             x''  y''  φ''
    laws = [[-mu, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0], [(c - mu * s) / 2, 0.0, 0.0, 1 / 12],
            [0.0, 0.0, 1.0, -c / 2]]  # the last: the tip stays on the floor
    found = np.linalg.solve(laws, [0.0, -G, 0.0, 0.0])
    assert found == pytest.approx([rod.force * G, rod.ax, rod.ay, rod.turn], abs=5e-6)


def test_cam() -> None:
    for one in cam.CAMS:
        lightest = (cam.MASS * G + one.stiffness * (one.pressed + 2 * cam.ECCENTRIC)
                    ) / (cam.MASS * cam.ECCENTRIC)
        assert one.limit == pytest.approx(lightest**0.5, abs=1e-7)
        if one.share > 1:
            assert one.force(np.sin(one.lifts())) == pytest.approx(0.0, abs=1e-12)
    for one in cam.CAMS[:2]:
        assert cam.FORCES[one.name] == pytest.approx((one.force(1.0), one.force(-1.0)), abs=1e-6)


@pytest.mark.parametrize(("real", "start", "cycle"), [
    (False, (-0.1036, -0.2788), (0.146065, -0.019476)),
    (True, woodpecker.START, woodpecker.CYCLE)], ids=["published", "real corners"])
def test_woodpecker(real: bool, start: tuple[float, float], cycle: tuple[float, float]) -> None:
    """The program that its digits are from meets the published cycle, and so the other one.

    Four blows a cycle, each up to a step late to be found and another to be answered, at 0.5 m/s.
    """
    step = 1e-4
    time, states = course(0.8, step, start, real=real)
    passed = woodpecker.cycles(time, states[:, 0], states[:, 2])[:, -4:]
    found = (passed[:, -1] - passed[:, 0]) / 3
    assert found[0] == pytest.approx(cycle[0], abs=8 * step)
    assert found[1] == pytest.approx(cycle[1], abs=0.5 * 8 * step)
