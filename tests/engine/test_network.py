"""Lengths of tendons over wheels, and that their forces are those of their lengths."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
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


@pytest.mark.parametrize("seed", range(4))
def test_forces_of_a_tendon_over_moving_wheels_keep_momentum_and_energy(seed: int) -> None:
    """Elastic energy k (L - L0)^2 / 2 and kinetic energy are exchanged, to second order."""
    rng = np.random.default_rng(seed)
    bodies = [{"name": f"b{i}", "mass": 0.1, "inertia": 1e-4, "angle": float(rng.uniform(-3, 3)),
               "at": (0.3 * i, 0.2 * (i % 2)), "angular_velocity": float(rng.uniform(-9, 9)),
               "velocity": rng.uniform(-0.3, 0.3, 2).tolist()} for i in range(4)]
    guides = [{"body": f"b{i}", "at": rng.uniform(-0.03, 0.03, 2).tolist(),
               "radius": float(rng.choice([0.0, 0.02, 0.04])), "turns": 1,
               "side": str(rng.choice(["left", "right"]))} for i in range(4)]
    for guide in guides:
        if not guide["radius"] or guide in (guides[0], guides[-1]):
            del guide["turns"]
    errors = []
    for step in (1e-4, 5e-5):
        run = simulate(mechanism(
            duration=0.05, step=step, bodies=bodies,
            tendons=[{"name": "cord", "guides": guides, "stiffness": 200.0, "pretension": 8.0}]))
        verdicts = {figure.name: figure.verdict for figure in audit(run)}
        assert verdicts["momentum.force"] == verdicts["momentum.moment"] == "pass"
        energy = run["cord.tension"]**2 / (2 * 200.0) + sum(
            0.1 / 2 * (run[f"b{i}.vx"]**2 + run[f"b{i}.vy"]**2)
            + 1e-4 / 2 * run[f"b{i}.omega"]**2 for i in range(4))
        errors.append(np.ptp(energy) / energy[0])
    assert errors[0] < 1e-4
    assert errors[0] / errors[1] > 3
