"""Impacts: contacts that approach are reflected together, again and again while any does."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

from .machines import G, H, fixed, mechanism

R = 0.01


@pytest.mark.parametrize("spin", [0.0, 5.0])
@pytest.mark.parametrize("late", [0.1, 0.5, 0.9])
def test_a_disc_meets_a_free_plate_where_it_is_at_the_instant(spin: float, late: float) -> None:
    """Smooth and elastic: one impulse J n at the arm a along the plate, at the root of the gap.

    J = 2 u / (1/m + 1/M + a^2 / Iz) with the approach u. The way from the pose to the instant is
    straight in the plate's frame to first order: a may be off by spin |v| h^2 / 2.
    """
    m, M, Iz, half = 0.1, 0.4, 2e-3, 0.02
    velocity, start = np.array([4.0, -1.0]), np.array([0.05, half + R + (3 + late) * H])

    def state(t: float) -> tuple[np.ndarray, np.ndarray]:
        turn = spin * t
        return start + velocity * t, np.array([-np.sin(turn), np.cos(turn)])

    def gap(t: float) -> float:
        place, normal = state(t)
        return float(normal @ place) - half - R

    place, n = state(brentq(gap, 0.0, 10 * H, xtol=1e-16))
    a = float(n[1] * place[0] - n[0] * place[1])
    u = spin * a - float(n @ velocity)
    J = 2 * u / (1 / m + 1 / M + a**2 / Iz)
    run = simulate(mechanism(
        duration=12 * H, materials={"m": {"restitution": 1.0, "friction": 0.0}}, bodies=[
            {"name": "plate", "mass": M, "inertia": Iz, "material": "m", "angular_velocity": spin,
             "shapes": [{"type": "box", "size": (0.4, 2 * half)}]},
            {"name": "disc", "mass": m, "material": "m", "at": tuple(start),
             "velocity": tuple(velocity), "shapes": [{"type": "circle", "radius": R}]}]))
    off = spin * float(np.hypot(*velocity)) * H**2 / 2
    assert run["plate.omega"][-1] == pytest.approx(spin - J * a / Iz, abs=1e-9 + J / Iz * off)
    np.testing.assert_allclose([run["disc.vx"][-1], run["disc.vy"][-1]], velocity + J * n / m,
                               rtol=0, atol=1e-9 + J**2 * a / (Iz * m) * off)


def dropped(shapes: list[dict[str, Any]], e: float, **more: Any) -> Recording:
    """A body that falls 2 mm onto a floor."""
    return simulate(mechanism(
        duration=0.06, gravity=(0.0, -G), materials={"m": {"restitution": e, "friction": 0.3}},
        bodies=[fixed("floor", material="m", shapes=[{"type": "box", "size": (1.0, 0.02)}]),
                {"name": "b", "mass": 0.1, "material": "m", "at": (0.0, 0.022), "shapes": shapes,
                 **more}]))


@pytest.mark.parametrize("e", [1.0, 0.5])
def test_a_box_that_falls_flat_leaves_flat(e: float) -> None:
    """Both corners are reflected together; it comes back with e times its speed.

    It is hit up to a step before it would arrive, and looked at up to three steps after: 4 g h.
    """
    run = dropped([{"type": "box", "size": (0.06, 0.02)}], e)
    assert np.abs(run["b.angle"]).max() < 1e-9
    hit = int(np.argmax(run["b.vy"] > 0))
    arrived = np.sqrt(2 * G * 0.002)
    assert run["b.vy"][hit + 1] == pytest.approx(e * arrived, abs=4 * G * H)


def test_slow_approaches_end() -> None:
    """A ball with e = 0.5 comes to rest: bounces below 10 mm/s give nothing back."""
    run = simulate(mechanism(
        duration=0.3, gravity=(0.0, -G), materials={"m": {"restitution": 0.5, "friction": 0.3}},
        bodies=[fixed("floor", material="m", shapes=[{"type": "box", "size": (1.0, 0.02)}]),
                {"name": "b", "mass": 0.1, "material": "m", "at": (0.0, 0.022),
                 "shapes": [{"type": "circle", "radius": R}]}]))
    late = run.time > 0.2
    assert np.ptp(run["b.y"][late]) < 1e-9
    np.testing.assert_allclose(run["b/floor.normal"][late], 0.1 * G, rtol=1e-9)


def test_what_joints_carry_of_an_impact_is_theirs() -> None:
    """A ball against the end of a pinned bar: the bar turns by Newton's law about its pin.

    e = 1, I about the pin, arm L: p = 2 v / (1 / m + L^2 / I) between the two.
    """
    inertia, m, length, v = 2e-4, 0.1, 0.1, 0.5
    about = inertia + 0.05 * 0.05**2
    run = simulate(mechanism(
        duration=6 * H, materials={"m": {"restitution": 1.0, "friction": 0.0}},
        bodies=[fixed("wall"),
                {"name": "bar", "mass": 0.05, "inertia": inertia, "centre": (0.05, 0.0),
                 "material": "m", "shapes": [{"type": "circle", "radius": R, "at": (length, 0.0)}]},
                {"name": "ball", "mass": m, "material": "m", "at": (length, -2 * R - 0.6 * v * H),
                 "velocity": (0.0, v), "shapes": [{"type": "circle", "radius": R}]}],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "bar", "on_b": (0.0, 0.0)}]))
    p = 2 * v / (1 / m + length**2 / about)
    assert run["ball.vy"][-1] == pytest.approx(v - p / m, rel=1e-3)
    assert run["p.rate"][-1] == pytest.approx(p * length / about, rel=1e-3)


def discs(e: float, mu: float, step: float = H) -> Mechanism:
    """Sixteen in a box, flying about: many impacts share a step."""
    rng = np.random.default_rng(3)
    wall = fixed("wall", material="m", shapes=[
        {"type": "box", "size": size, "at": at} for size, at in (
            ((0.4, 0.1), (0.0, -0.05)), ((0.1, 1.0), (-0.15, 0.5)), ((0.1, 1.0), (0.15, 0.5)))])
    return mechanism(
        duration=0.4, step=step, gravity=(0.0, -G), run={"sample_rate": 1 / step},
        materials={"m": {"restitution": e, "friction": mu}},
        bodies=[wall, *({
            "name": f"d{i}", "mass": 0.1, "material": "m",
            "at": (0.04 * (i % 4) - 0.06, 0.03 + 0.03 * (i // 4)),
            "velocity": tuple(rng.normal(size=2).tolist()), "angular_velocity": rng.normal(),
            "shapes": [{"type": "circle", "radius": 0.012}]} for i in range(16))])


@pytest.mark.parametrize("mu", [0.0, 0.4])
def test_an_audit_of_every_step_finds_impacts_in_balance(mu: float) -> None:
    """Momentum, moments between two free bodies, and work, with many impacts in a step."""
    run = simulate(discs(0.9, mu))
    assert [figure for figure in audit(run) if figure.verdict == "look"] == []
