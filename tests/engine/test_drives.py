"""Drives of stiffness, motors and brakes against closed forms.

A step changes velocities by (all impulses) / inertia exactly, so a turn under constant torques is a
polygon on the parabola: rates are exact to rounding (1e-12 of them, some thousand steps), and what
is asked of instants is asked to within a step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.inspect import inspect
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording

from .machines import G, H, fixed, mass, mechanism

SENSES = pytest.mark.parametrize(("positive", "sense"), [("counterclockwise", 1),
                                                         ("clockwise", -1)])
ROUNDING = 1e-12


# -- stiffness ---------------------------------------------------------------------


def sprung(drives: list[dict[str, Any]], *, step: float = H, duration: float = 0.4) -> Recording:
    """0.1 kg on a spring of 40 N/m from the wall, 20 mm beyond its rest length, at rest."""
    return simulate(mechanism(
        duration=duration, step=step, bodies=[fixed("wall"), mass("m", 0.1, (0.12, 0.0))],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "m", "stiffness": 40.0,
                  "rest_length": 0.1}], drives=drives))


def turned(drives: list[dict[str, Any]], *, positive: str = "counterclockwise", step: float = H,
           duration: float = 0.4) -> Recording:
    """A wheel of 4e-5 kg m^2 on a rotary spring of 0.01 N m/rad, zero 0.1, rest 0.2, at angle 0."""
    return simulate(mechanism(
        duration=duration, step=step, bodies=[fixed("wall"), wheel()],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "w", "on_a": (0, 0), "zero": 0.1,
                 "positive": positive}],
        springs=[{"type": "rotary", "name": "s", "joint": "p", "stiffness": 0.01,
                  "rest_angle": 0.2}], drives=drives))


def wheel(**more: Any) -> dict[str, Any]:
    return {"name": "w", "mass": 0.1, "inertia": 4e-5, **more}


def setting(value: Any = None) -> list[dict[str, Any]]:
    more = {} if value is None else {"value": value}
    return [{"type": "stiffness", "name": "k", "spring": "s", **more}]


def test_force_of_a_spring_whose_stiffness_changes() -> None:
    """F = k(t) (l - l0) at every sample, k as the signal says; below 0 it counts as 0."""
    run = sprung(setting({"from": 80.0, "to": -20.0, "over": 0.3}))
    k = np.clip(80 - 100 * run.time / 0.3, 0, None)
    np.testing.assert_allclose(run["k.value"], k, rtol=0, atol=1e-12)
    np.testing.assert_allclose(run["s.force"], k * (run["s.length"] - 0.1), rtol=0, atol=1e-14)
    assert (run["m.ax"][run.time > 0.25] == 0).all()


@SENSES
def test_torque_of_a_rotary_spring_whose_stiffness_changes(positive: str, sense: int) -> None:
    """tau = k(t) (angle - rest), against the hinge's own sense; I alpha = - tau."""
    run = turned(setting("=0.02 + 0.015 * sin(40 * t)"), positive=positive)
    k = 0.02 + 0.015 * np.sin(40 * run.time)
    np.testing.assert_allclose(
        run["s.torque"], k * (run["p.angle"] - 0.2), rtol=0, atol=1e-14)
    np.testing.assert_allclose(4e-5 * sense * run["w.alpha"], -run["s.torque"], atol=1e-12)


# -- brakes ------------------------------------------------------------------------


def hinged(drive: dict[str, Any], *, positive: str = "counterclockwise", omega: float = 0.0,
           gravity: float = 0.0, duration: float = 0.5, more: tuple[Any, ...] = ()) -> Recording:
    """A wheel, or under gravity an arm whose weight is 50 mm out, on a hinge with a drive."""
    out = 0.05 if gravity else 0.0
    return simulate(mechanism(
        duration=duration, gravity=(0.0, -gravity),
        bodies=[fixed("wall"), wheel(centre=(out, 0.0), angular_velocity=omega)],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "w", "on_a": (0, 0),
                 "positive": positive}],
        drives=[{"name": "d", "joint": "p", **drive}, *more]))


LOAD = 0.1 * G * 0.05
"""The arm's weight about its hinge [N m]."""


def test_a_brake_lets_go_and_takes_hold_when_told() -> None:
    """Free below 0.1 s and from 0.3 s on, held between: its torque counts at the very step."""
    run = hinged({"type": "brake", "value": {"table": [(0.0, -1.0), (0.1, 1.0), (0.3, 0.0)],
                                             "between": "step"}}, gravity=G, duration=0.4)
    t = run.time
    assert (run["d.value"] == np.where((t >= 0.1) & (t < 0.3), 1.0, 0.0)).all()
    assert (run["d.torque"][t < 0.1] == 0).all()
    assert (run["d.torque"][t > 0.3] == 0).all()
    held = (t > 0.1 + 20 * H) & (t < 0.3)  # it slips for some steps before
    assert np.ptp(run["p.angle"][held]) < 1e-12
    load = LOAD * np.cos(run["p.angle"][held])
    np.testing.assert_allclose(run["d.torque"][held], load, rtol=1e-9)
    assert np.ptp(run["p.angle"][t > 0.3]) > 0.1


# -- motors ------------------------------------------------------------------------


@SENSES
def test_a_free_motor_reaches_its_speed(positive: str, sense: int) -> None:
    """omega = tau t / I up to the speed, which it then keeps without torque."""
    run = hinged({"type": "motor", "value": 20.0, "torque": 2e-3}, positive=positive)
    ready = 20.0 * 4e-5 / 2e-3
    rate = np.minimum(run.time / ready, 1.0) * 20.0
    still = np.abs(run.time - ready) > H
    np.testing.assert_allclose(run["p.rate"][still], rate[still], rtol=1e-9)
    np.testing.assert_allclose(sense * run["w.omega"], run["p.rate"], rtol=ROUNDING)
    np.testing.assert_allclose(run["d.torque"][run.time < ready - H], 2e-3, rtol=ROUNDING)
    np.testing.assert_allclose(run["d.torque"][run.time > ready + H], 0.0, atol=1e-12)
    assert run["d.work"][-1] == pytest.approx(4e-5 * 20.0**2 / 2, rel=1e-9)
    assert run.unit("d.torque") == "N m"
    assert run.unit("d.value") == "rad/s"


@SENSES
def test_a_stalled_motor_gives_its_torque(positive: str, sense: int) -> None:
    """Against a brake of twice its torque: exactly its own, and the brake the same against it."""
    run = hinged({"type": "motor", "value": -3.0, "torque": 2e-3}, positive=positive,
                 more=({"type": "brake", "name": "hold", "joint": "p", "value": 4e-3},))
    np.testing.assert_allclose(run["d.torque"], -2e-3, rtol=1e-9)
    np.testing.assert_allclose(run["hold.torque"], 2e-3, rtol=1e-9)
    assert np.abs(run["p.angle"]).max() < 1e-9


@SENSES
@pytest.mark.parametrize(("value", "speed"), [
    ("=20 + 30 * t", lambda t: 20 + 30 * t),
    ("=20 + 4 * sin(9 * t)", lambda t: 20 + 4 * np.sin(9 * t))])
def test_a_motor_that_starts_at_speed_turns_from_the_end_of_the_first_step_on(
        positive: str, sense: int, value: str, speed: Any) -> None:
    """The first pose is that of the scene, so the angle lags by what the first half step lacks.

    A blow is no acceleration: led half a step back along it, the first pose would be h u / 8 off.
    Of what the signal changes by itself h^2 / 8 may be there.
    """
    run = hinged({"type": "motor", "value": value, "torque": 100.0}, positive=positive)
    change = 36.0
    assert sense * run["w.angle"][0] == pytest.approx(0.0, abs=H**2 / 8 * change)
    turned = np.cumsum(H * speed(run.time + H / 2))[:-1]
    lead = run["p.angle"][1:] - turned - run["p.angle"][0]
    np.testing.assert_allclose(lead, 0.0, atol=1e-11)


# -- the machinery -----------------------------------------------------------------


@pytest.mark.parametrize(("value", "more"), [
    (40.0, {}), ({"to": 9e5, "over": 0.1}, {}), ({"table": [(0, 1.0), (0.1, 9e5)]}, {}),
    (40.0, {"controllers": [{"type": "schedule", "name": "c", "writes": "k", "value": 50.0,
                             "limits": (0.0, 9e5)}]}),
    (40.0, {"events": [{"name": "e", "at": 0.1, "set": {"k": 9e5}}]}),
])
def test_inspection_warns_of_a_stiffness_beyond_the_step(value: Any, more: Any) -> None:
    """h w = 5e-4 sqrt(9e5 / 0.1) = 1.5, a table's last point, a limit and an event included."""
    machine = mechanism(
        bodies=[fixed("wall"), mass("m", 0.1, (0.12, 0.0))],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "m", "stiffness": 40.0}],
        drives=setting(value), **more)
    warned = [f for f in inspect(machine) if f.element == "s"]
    plain = value == 40.0 and not more
    assert len(warned) == (0 if plain else 1)
    if not plain:
        assert "h w = 1.5" in warned[0].message
