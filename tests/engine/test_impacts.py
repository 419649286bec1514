"""Impacts: contacts that approach are reflected together, again and again while any does."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

from .machines import G, H, fixed, mechanism

R = 0.01


def row(
    speeds: list[float], e: float = 1.0, masses: list[float] | None = None, *,
    gaps: list[float] | None = None, steps: int = 4, reverse: bool = False,
) -> np.ndarray:
    """Velocities of balls in a row after some steps; they touch in the first one."""
    x = np.concatenate([[0.0], np.cumsum(2 * R + np.array(gaps or [0.0] * (len(speeds) - 1)))])
    bodies = [{"name": f"b{i}", "mass": (masses or [0.1] * len(speeds))[i], "material": "steel",
               "at": (float(x[i]) - H / 2 * v, 0.0), "velocity": (v, 0.0),
               "shapes": [{"type": "circle", "radius": R}]} for i, v in enumerate(speeds)]
    run = simulate(mechanism(
        duration=steps * H, bodies=bodies[::-1] if reverse else bodies,
        materials={"steel": {"restitution": e, "friction": 0.0}}))
    return np.array([run[f"b{i}.vx"][-1] for i in range(len(speeds))])


def in_turn(speeds: list[float], masses: list[float], e: float) -> np.ndarray:
    """The law, for balls that touch: all approaches reversed together, as long as there are any."""
    v, w = np.array(speeds), 1 / np.array(masses)
    C = np.diff(np.eye(len(v)), axis=0)
    while (C @ v < -1e-12).any():
        active = C @ v < -1e-12
        while True:
            on = C[active]
            p = np.linalg.solve((on * w) @ on.T, -(1 + e) * on @ v)
            if (p >= 0).all():
                break
            active[np.flatnonzero(active)[p < 0]] = False
        v = v + w * (on.T @ p)
    return v


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("count", [2, 3, 5, 9])
@pytest.mark.parametrize("striking", [1, 2])
def test_as_many_balls_leave_as_hit(count: int, striking: int, reverse: bool) -> None:
    """Newton's cradle, in whatever order the scene has them: rounding."""
    speeds = [0.5] * striking + [0.0] * (count - striking)
    np.testing.assert_allclose(row(speeds, reverse=reverse), speeds[::-1], rtol=0, atol=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_rows_of_any_balls_follow_the_law(seed: int) -> None:
    """Masses 1:10, with loss; approaches below 10 mm/s end plastically: as much and no more."""
    rng = np.random.default_rng(seed)
    count, e = int(rng.integers(3, 7)), float(rng.choice([1.0, 0.9, 0.5]))
    masses = (0.1 * 10 ** rng.uniform(-0.5, 0.5, count)).tolist()
    speeds = [1.0, *[0.0] * (count - 1)]
    found, law = row(speeds, e, masses), in_turn(speeds, masses, e)
    assert np.dot(masses, found) == pytest.approx(masses[0], rel=1e-9)
    np.testing.assert_allclose(found, law, rtol=0, atol=0.02 * count)
    if e == 1.0:
        assert np.dot(masses, found**2) == pytest.approx(masses[0], rel=5e-3)


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


def one_by_one(x: np.ndarray, v: np.ndarray, masses: np.ndarray) -> np.ndarray:
    """Velocities of balls in a row after all elastic impacts, each at its instant."""
    while True:
        approach = -np.diff(v)
        times = np.where(approach > 1e-9, np.maximum(np.diff(x) - 2 * R, 0.0)
                         / np.maximum(approach, 1e-12), np.inf)
        k = int(np.argmin(times))
        if not np.isfinite(times[k]):
            return v
        x = x + times[k] * v
        p = 2 * approach[k] / (1 / masses[k] + 1 / masses[k + 1])
        v = v + p * (np.eye(len(v))[k + 1] / masses[k + 1] - np.eye(len(v))[k] / masses[k])


@pytest.mark.parametrize("seed", range(12))
def test_balls_with_gaps_hit_one_by_one(seed: int) -> None:
    """Gaps smaller than the way of a step or up to three times as large: the order of impacts."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 7))
    gaps = (H * 10 ** rng.uniform(-3, 0.5, count - 1)).tolist()
    masses = 0.1 * 10 ** rng.uniform(-0.5, 0.5, count)
    speeds = [1.0, *[0.0] * (count - 1)]
    x = np.concatenate([[0.0], np.cumsum(2 * R + np.array(gaps))])
    found = row(speeds, masses=masses.tolist(), gaps=gaps, steps=200)
    law = one_by_one(x, np.array(speeds), masses)
    np.testing.assert_allclose(found, law, rtol=0, atol=1e-7)


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


def test_elastic_discs_keep_their_energy() -> None:
    """At the end of each step: to rounding, impacts hold impulses by 1e-10 of them."""
    run = simulate(discs(1.0, 0.0))
    a, h = run.arrays, H
    after = a["body_velocity"][:-1, 1:] + h / 2 * a["body_acceleration"][:-1, 1:]
    height = a["body_pose"][1:, 1:, 1] - h / 2 * after[:, :, 1]
    energy = 0.1 * ((after[:, :, :2] ** 2).sum(axis=(1, 2)) / 2 + G * height.sum(axis=1))
    assert len(a["contact_gap"]) > 100
    assert np.ptp(energy) < 1e-7 * energy[0]


@pytest.mark.parametrize("mu", [0.0, 0.4])
def test_an_audit_of_every_step_finds_impacts_in_balance(mu: float) -> None:
    """Momentum, moments between two free bodies, and work, with many impacts in a step."""
    run = simulate(discs(0.9, mu))
    assert [figure for figure in audit(run) if figure.verdict == "look"] == []


def test_pausing_changes_nothing() -> None:
    """Where impacts displace poses that pymunk has: bit by bit the same."""
    whole, paused = Simulation(discs(0.7, 0.3)), Simulation(discs(0.7, 0.3))
    whole.run()
    for k in range(1, 60):
        paused.run(7 * k)
    paused.run()
    for key, values in whole.recording().arrays.items():
        np.testing.assert_array_equal(paused.recording().arrays[key], values, err_msg=key)
