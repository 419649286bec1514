"""Lengths of tendons over wheels, and that their forces are those of their lengths."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording

from .machines import fixed, mechanism

FAR, R = 0.1, 0.02


def measured(*guides: tuple[Any, ...], bodies: tuple[Any, ...] = (), duration: float = 1e-3,
             step: float = 1e-3) -> Recording:
    """The run of a tendon over guides (body, point, radius, side, more)."""
    written = [{"body": body, "at": at, "radius": radius, "side": side, **(more[0] if more else {})}
               for body, at, radius, side, *more in guides]
    return simulate(mechanism(
        duration=duration, step=step, bodies=[fixed("wall"), *bodies],
        tendons=[{"name": "cord", "guides": written, "stiffness": 1.0}]))


@pytest.mark.parametrize(("side", "wrap"), [("right", math.pi / 2), ("left", 3 * math.pi / 2)])
def test_a_wheel_between_two_points(side: str, wrap: float) -> None:
    """From (-L, 0) over a wheel at the origin to (0, -L), tangents of length sqrt(L^2 - r^2).

    On the right the wheel takes 90 deg + 2 asin(r / L) of the rim; on the left the tendon crosses
    itself: 270 deg + 2 asin(r / L).
    """
    run = measured(("wall", (-FAR, 0), 0, "left"), ("wall", (0, 0), R, side, {"begins": "on"}),
                   ("wall", (0, -FAR), 0, "left"))
    expected = 2 * math.sqrt(FAR**2 - R**2) + R * (wrap + 2 * math.asin(R / FAR))
    assert run["cord.length"][0] == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("sides", [("right", "right"), ("left", "left"), ("left", "right")])
def test_a_belt_between_two_wheels(sides: tuple[str, str]) -> None:
    """Open: sqrt(d^2 - (r1 - r2)^2); crossed: sqrt(d^2 - (r1 + r2)^2). Wound on at both ends."""
    run = measured(("wall", (0, 0), 0.02, sides[0]), ("wall", (0, FAR), 0.03, sides[1]))
    between = 0.01 if sides[0] == sides[1] else 0.05
    assert run["cord.length"][0] == pytest.approx(math.sqrt(FAR**2 - between**2), rel=1e-14)


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_tendon_that_grazes_its_wheel_does_not_go_round_it(side: str) -> None:
    """Three points in line: the wrap is 0, not 2 pi, however the rounding falls."""
    for angle in np.linspace(0, 2 * math.pi, 24):
        u = np.array([math.cos(angle), math.sin(angle)])
        centre = 0.05 * u + (1 if side == "right" else -1) * 0.01 * np.array([u[1], -u[0]])
        run = measured(("wall", (0, 0), 0, "left"), ("wall", tuple(centre), 0.01, side),
                       ("wall", tuple(0.1 * u), 0, "left"))
        assert run["cord.length"][0] == pytest.approx(0.1, abs=1e-9)


def test_the_wrap_is_continuous_for_more_than_a_turn() -> None:
    """A point circles a wheel twice: the length grows by r dphi in each step."""
    eye = {"name": "eye", "motion": "scheduled", "at": (FAR, 0.0), "path": {
        "x": f"={FAR} * cos(4 * pi * t)", "y": f"=-{FAR} * sin(4 * pi * t)"}}
    run = measured(("wall", (-FAR, 0), 0, "left"), ("wall", (0, 0), R, "right", {"turns": 1}),
                   ("eye", (0, 0), 0, "left"), bodies=(eye,), duration=1.0)
    np.testing.assert_allclose(np.diff(run["cord.length"])[1:], R * 4 * math.pi * 1e-3, rtol=1e-9)
