"""The tendon network against pulleys and rockers whose tensions are known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.mechanics import differential
from sandbox.recording.recording import Recording
from sandbox.study import independent as reference

from .machines import G, fixed, mass, mechanism

H = 5e-4
STIFF = 1e5


def acceleration(run: Recording, name: str, start: int) -> float:
    """Of a straight fall from rest [m/s^2], fitted to y(t) from sample ``start`` on."""
    return float(2 * np.polyfit(run.time[start:], run[f"{name}.y"][start:], 2)[0])


def cord(name: str, *guides: tuple[Any, ...], **more: Any) -> dict[str, Any]:
    """A tendon through (body, at) or (body, at, radius, side)."""
    keys = ("body", "at", "radius", "side")
    return {"name": name, "guides": [dict(zip(keys, g, strict=False)) for g in guides], **more}


def test_atwood() -> None:
    """T = 2 m1 m2 g / (m1 + m2), a = (m1 - m2) g / (m1 + m2), cord over two eyes.

    A cord of stiffness k stretches by T / k = 15 um once, after which it is rigid: exact but for
    the ringing, which an implicit step damps to nothing (1e-9) within 0.2 s.
    """
    run = simulate(mechanism(
        duration=0.3, step=H, gravity=(0.0, -G),
        bodies=[fixed("beam"), mass("heavy", 0.2, (0.0, -0.5)), mass("light", 0.12, (0.1, -0.9))],
        tendons=[cord("cord", ("heavy",), ("beam", (0.0, 0.0)), ("beam", (0.1, 0.0)), ("light",),
                      stiffness=STIFF)]))
    a, tension = reference.atwood(0.2, 0.12, G)
    np.testing.assert_allclose(run["cord.tension"][-100:], tension, rtol=1e-9)
    assert acceleration(run, "heavy", 100) == pytest.approx(-a, rel=1e-5)
    assert acceleration(run, "light", 100) == pytest.approx(a, rel=1e-5)


@pytest.mark.parametrize("radius", [0.02, 0.0], ids=["wheel", "eye"])
def test_movable_pulley(radius: float) -> None:
    """2 T - W g = W a / 2, m (g - a) = T: a sliding pulley halves the motion and doubles the force.

    Strands vertical for the wheel; for an eye both lean outward from one point, so they start
    4 mm apart 0.8 m up, and cos(0.0025) = 1 - 3e-6.
    """
    gap = radius or 0.002
    run = simulate(mechanism(
        duration=0.25, step=H, gravity=(0.0, -G),
        bodies=[fixed("beam"), mass("pulley", 0.15, (0.0, -0.8)), mass("weight", 0.1, (0.3, -0.4))],
        tendons=[cord("cord", ("beam", (-gap, 0.0)), ("pulley", (0.0, 0.0), radius, "left"),
                      ("beam", (gap, 0.0)), ("beam", (0.3, 0.0)), ("weight",), stiffness=STIFF)]))
    a, tension = reference.movable_pulley(0.15, 0.1, G)
    np.testing.assert_allclose(run["cord.tension"][-100:], tension, rtol=2e-5)
    assert acceleration(run, "weight", 50) == pytest.approx(-a, rel=2e-5)
    assert acceleration(run, "pulley", 50) == pytest.approx(a / 2, rel=2e-5)


def damped(body: str, at: tuple[float, float], reach: float = 1.0) -> list[dict[str, Any]]:
    """Dampers without stiffness from a point of ``body`` to the wall along x and y."""
    x, y = at
    return [{"type": "linear", "name": f"{body}.damper{i}", "a": "wall", "b": body,
             "on_a": far, "stiffness": 0.0, "damping": 6.0}
            for i, far in enumerate([(x + reach, y), (x, y + reach)])]


def rocker(arms: tuple[float, float], pull: float, stiffness: tuple[float, float]) -> Recording:
    """A rocker pulled up at its middle pin; its ends hold two elastic cords to the wall below."""
    a, b = arms
    return simulate(mechanism(
        duration=2.0, step=H,
        bodies=[fixed("wall"), {"name": "rocker", "mass": 0.05, "inertia": 2e-5, "at": (0.0, 0.5)}],
        springs=damped("rocker", (0.0, 0.5)),
        tendons=[
            cord("main", ("rocker",), ("wall", (0.0, 1.0))),
            cord("first", ("rocker", (-a, 0.0)), ("wall", (-a, 0.0)), stiffness=stiffness[0],
                 damping=3.0),
            cord("second", ("rocker", (b, 0.0)), ("wall", (b, 0.0)), stiffness=stiffness[1],
                 damping=3.0)],
        drives=[{"type": "pull", "name": "actuator", "tendon": "main", "value": pull}]))


@pytest.mark.parametrize("arms", [(0.03, 0.03), (0.02, 0.03)])
def test_rocker_differential(arms: tuple[float, float]) -> None:
    """T_1 = F b / (a + b), T_2 = F a / (a + b), whatever the tilt.

    The cords of unequal stiffness tilt the rocker, so they lean a little: the moment balance with
    the pins and directions where they ended holds to what is left of the motion (1e-9 after two
    seconds); the plain lever law to the square of the cords' lean, 0.6 mm in 500 mm: 2e-6.
    """
    pull = 8.0
    run = rocker(arms, pull, (900.0, 700.0))
    tensions = np.array([run["first.tension"][-1], run["second.tension"][-1]])
    x, y, angle = (run[f"rocker.{q}"][-1] for q in ("x", "y", "angle"))
    c, s = np.cos(angle), np.sin(angle)
    pins = np.array([[c, -s], [s, c]]) @ np.array([[-arms[0], arms[1]], [0.0, 0.0]])
    walls = np.array([[-arms[0], arms[1]], [0.0, 0.0]]) - [[x], [y]]
    t_1, t_2, _ = differential.rocker_tensions_at(
        pull, pins[:, 0], pins[:, 1], *(walls - pins).T)
    np.testing.assert_allclose(tensions, [t_1, t_2], rtol=1e-9)
    np.testing.assert_allclose(tensions, differential.rocker_tensions(pull, *arms), rtol=2e-6)
    assert abs(angle) > 0.01
    # (3), (4) for rockers: tilt and axle from the ends' travel
    ends = pins + np.array([[x], [y]])
    travel = ends[1] - 0.5
    assert y - 0.5 == pytest.approx(float(differential.rocker_axle(*travel, *arms)), abs=1e-12)
    assert -angle == pytest.approx(float(differential.rocker_tilt(*travel, *arms)), abs=1e-12)


@pytest.mark.parametrize(("side", "drum", "sample_rate"), [
    ("left", "first", 1000.0), ("right", "last", 2.0)])
def test_a_winch_shortens_what_it_winds_up(drum: str, side: str, sample_rate: float) -> None:
    """Whichever end of the cord, and side of the path, the drum is: shortening is the load's rise.

    The load hangs straight below the drum's rim, so the free path is its distance, to rounding;
    the drum goes round 1.6 times, also between two samples. A turn of R phi winds up as much, less
    the stretch m g / k that the load makes at first (1e-9 of the ringing is left).
    """
    radius, turn = 0.02, 10.0
    x = radius if (side == "left") == (drum == "last") else -radius
    guides = [("load",), ("shaft", (0.0, 0.0), radius, side)]
    rate = {"table": [[0, 0], [0.1, turn / 0.6], [0.6, turn / 0.6], [0.7, 0]]}
    run = simulate(mechanism(
        duration=1.0, step=H, gravity=(0.0, -G), run={"sample_rate": sample_rate},
        bodies=[fixed("beam"), mass("shaft", 0.2, (0.0, 0.0)), mass("load", 0.1, (x, -0.4))],
        joints=[{"type": "pin", "name": "axle", "a": "beam", "b": "shaft", "on_a": (0, 0),
                 "positive": "counterclockwise" if x > 0 else "clockwise"}],
        tendons=[cord("cord", *(guides if drum == "last" else guides[::-1]), damping=100.0)],
        drives=[{"type": "motor", "name": "motor", "joint": "axle", "value": rate, "torque": 1.0}]))
    np.testing.assert_allclose(run["cord.shortening"], run["load.y"] + 0.4, atol=1e-14)
    assert run["cord.shortening"][-1] == pytest.approx(
        radius * run["axle.angle"][-1] - 0.1 * G / STIFF, abs=1e-9)
    assert run["axle.angle"][-1] > 9.9
