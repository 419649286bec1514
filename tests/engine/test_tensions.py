"""Tendons in a running simulation: shares, stretch at rest, noise, and hard cases."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate

from .machines import G, H, cord, disc, fixed, mass, mechanism


@pytest.mark.parametrize("step", [1e-4, 5e-4, 2e-3])
def test_slack_then_taut(step: float) -> None:
    """A load falls 0.1 m into its cord: no pull before, no more speed after than it came with.

    Overrun: half a period of the cord's own swing reaches v sqrt(m / k) = 1.4 mm at most, or the
    step's travel v h if that is longer.
    """
    run = simulate(mechanism(
        duration=0.6, step=step, gravity=(0.0, -G),
        bodies=[fixed("beam"), mass("m", 0.1, (0, -0.1))],
        tendons=[cord("cord", ("beam",), ("m",), slack=0.1)]))
    free = run.time < np.sqrt(2 * 0.1 / G) - 2 * step
    assert (run["cord.tension"][free] == 0).all()
    assert (run["cord.tension"] >= 0).all()
    speed = np.sqrt(2 * G * 0.1)
    assert run["m.vy"].max() < speed
    assert run["m.y"].min() > -0.2 - 1.1 * speed * max(step, np.sqrt(0.1 / 1e5))
    assert run["cord.tension"].max() > 10 * 0.1 * G


def test_cords_in_parallel_share() -> None:
    """Five like cords side by side, one load: the matrix is all but singular, T = m g / 5 each."""
    run = simulate(mechanism(
        duration=0.5, gravity=(0.0, -G), bodies=[fixed("beam"), mass("m", 0.1, (0.0, -0.2))],
        tendons=[cord(f"leaf{i}", ("beam",), ("m",)) for i in range(5)]))
    np.testing.assert_allclose(run.arrays["tendon_tension"][-1], 0.1 * G / 5, rtol=1e-9)


@pytest.mark.parametrize(("path", "response"), [
    ([("beam",), ("m",)], 1), ([("beam",), ("m",), ("beam",)], 4)])
def test_a_tendon_too_stiff_for_the_step_is_damped(path: list[Any], response: float) -> None:
    """From h^2 k response / m = 1 on, where a tendon folded at the load counts four times."""
    for share, rings in ((0.9, True), (1.1, False)):
        run = simulate(mechanism(
            duration=0.1, gravity=(0.0, -G), bodies=[fixed("beam"), mass("m", 0.01, (0.0, -0.1))],
            tendons=[cord("cord", *path, stiffness=share * 0.01 / (H**2 * response))]))
        assert (np.ptp(run["cord.tension"][-20:]) > 0.01) == rings


def test_fixed_ends_only() -> None:
    """Nothing moves; the tension is k times what it is short, at once and for ever."""
    run = simulate(mechanism(
        duration=0.05, bodies=[fixed("a"), fixed("b", at=(0.3, 0.0)), disc("d", 0.01, (9.0, 0.0))],
        tendons=[cord("t", ("a",), ("b",), stiffness=500.0, rest_length=0.28)]))
    np.testing.assert_allclose(run["t.tension"], 10.0, rtol=1e-12)
    assert run["t.length"][0] == pytest.approx(0.3, rel=1e-14)
    assert run.time[0] == H / 2
