"""Loads by laws of a body's own motion, against closed forms and integrations.

Tolerances follow from the step: what a leapfrog and the midpoint rule leave is of second order.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import sandbox
from sandbox.errors import SimulationDiverged
from sandbox.recording.recording import Recording

from .machines import sound

G = 9.81


def _scene(*loads: dict[str, Any], h: float = 1e-3, duration: float = 1.0, g: float = 0.0,
           more: Any = (), **body: Any) -> dict[str, Any]:
    """A body of 1 kg with loads."""
    one = {"name": "b", "mass": 1, "shapes": [{"type": "circle", "radius": 0.1}], **body}
    return {"run": {"duration": duration, "step": h, "sample_rate": 1 / h}, "gravity": [0, -g],
            "bodies": [one, *more], "loads": list(loads)}


def _run(scene: dict[str, Any]) -> Recording:
    return sound(sandbox.simulate(sandbox.load_scene(scene)))


def _law(**more: Any) -> dict[str, Any]:
    return {"type": "law", "name": "law", **more}


def off_centre_drag(t: float, x: float, y: float, a: float, u: float, v: float, w: float,
                    ) -> list[float]:
    """F = -3 |v| v at the point (0.3, 0.1) of the body: linear and angular acceleration."""
    c, s = math.cos(a), math.sin(a)
    rx, ry = c * 0.3 - s * 0.1, s * 0.3 + c * 0.1
    px, py = u - w * ry, v + w * rx
    fx, fy = -3 * px * math.hypot(px, py), -3 * py * math.hypot(px, py)
    return [fx, fy, (rx * fy - ry * fx) / 0.05]


def keel(t: float, x: float, y: float, a: float, u: float, v: float, w: float) -> list[float]:
    """Little drag along the body, much across it, and a torque over time."""
    c, s = math.cos(a), math.sin(a)
    p, q = 1 - 0.2 * (c * u + s * v), -20 * (c * v - s * u)
    return [c * p - s * q, s * p + c * q, (0.3 * math.cos(3 * t) - 0.1 * w) / 0.05]


@pytest.mark.parametrize(("law", "accelerations", "start"), [
    ({"force": ["=-3 * vx * speed", "=-3 * vy * speed"], "at": [0.3, 0.1]}, off_centre_drag,
     [0, 0, 0, 2, 1, 5]),
    ({"force": ["=1 - 0.2 * vx", "=-20 * vy"], "frame": "body",
      "torque": "=0.3 * cos(3 * t) - 0.1 * omega"}, keel, [0, 0, 0, 2, 1, 1])])
def test_a_law_moves_and_turns_a_body_as_an_integration_does(
    law: dict[str, Any], accelerations: Callable[..., list[float]], start: list[float],
) -> None:
    """Second order in the step, against an integration of order 5 with a tolerance of 1e-11."""
    def error(h: float) -> float:
        run = _run(_scene(_law(**law), h=h, angle=start[2], velocity=start[3:5],
                          angular_velocity=start[5], inertia=0.05))
        truth = solve_ivp(lambda t, y: [*y[3:], *accelerations(t, *y)], (0, run.time[-1]), start,
                          rtol=1e-11, atol=1e-12, t_eval=run.time).y
        return float(max(np.abs(run[f"b.{name}"] - truth[i]).max()
                         for i, name in enumerate(("x", "y", "angle"))))

    errors = [error(h) for h in (1e-3, 5e-4, 2.5e-4)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.1)


def test_added_inertia_is_a_share_of_the_bodys_own() -> None:
    """T - s I alpha turns it as if it had (1 + s) I."""
    run = _run(_scene(_law(torque="=0.3 - 0.6 * inertia * alpha"), inertia=0.05))
    assert run["b.alpha"] == pytest.approx(0.3 / (1.6 * 0.05), rel=1e-9)


@pytest.mark.parametrize("k", [1e2, 1e9, 1e12])
def test_a_field_of_any_strength_holds(k: float) -> None:
    """Soft it swings as a spring does; too steep for the step, it is taken at the step's end."""
    run = _run(_scene(_law(force=[f"=-{k} * x", 0]), at=[0.1, 0], duration=0.5))
    if k * 1e-6 < 1:
        assert run["b.x"] == pytest.approx(0.1 * np.cos(math.sqrt(k) * run.time), abs=1e-5)
    else:
        assert abs(run["b.x"][-1]) < 1e-9
        assert np.abs(run["b.x"]).max() <= 0.1 + 1e-9


def test_a_load_that_depends_on_time_wakes_a_body_at_rest() -> None:
    """A body at rest on the floor is woken by a load that nothing else announces."""
    floor = {"name": "floor", "motion": "fixed", "shapes": [{"type": "box", "size": [9, 1]}],
             "at": [0, -0.6]}
    run = _run(_scene(_law(force=[0, "=15 if t > 0.5 else 0"], bodies="b"), g=G, more=[floor]))
    assert abs(run["b.y"][run.time < 0.49]).max() < 1e-9
    assert run["b.y"][-1] == pytest.approx((15 - G) * 0.5**2 / 2, rel=5e-3)


def test_one_law_for_many_bodies_is_each_ones_own() -> None:
    more = [{"name": f"c{i}", "at": [0, 5 * i], "mass": i, "velocity": [1, 0],
             "shapes": [{"type": "circle", "radius": 0.1}]} for i in (1, 2, 3)]
    run = _run(_scene(_law(force=["=-mass * t * vx", 0], bodies=["c1", "c[23]"]),
                      {"type": "drag", "name": "d", "bodies": "c2", "linear": 0.5},
                      more=more, velocity=[1, 0]))
    assert run["b.vx"] == pytest.approx(1.0, abs=1e-12)
    for i in (1, 2, 3):
        slowed = run.time**2 / 2 + (0.25 * run.time if i == 2 else 0.0)
        assert run[f"c{i}.vx"] == pytest.approx(np.exp(-slowed), abs=1e-6)
    assert "law.b.fx" not in run


# --- liquids


@pytest.mark.parametrize("shape", [
    {"type": "box", "size": [0.4, 0.2]},
    {"type": "polygon", "points": [[-0.2, -0.1], [0.2, -0.1], [0.1, 0], [0.2, 0.1], [-0.2, 0.1]],
     "holes": [[[-0.1, -0.05], [0, -0.05], [0, 0.05], [-0.1, 0.05]]]},
    {"type": "capsule", "start": [-0.1, 0], "end": [0.1, 0.05], "radius": 0.05}])
def test_a_submerged_body_weighs_less_by_the_water_it_displaces(shape: dict[str, Any]) -> None:
    """Twice as dense as the water it sinks at g / 2, at any angle, and is not turned."""
    bodies = [{"name": "b", "density": 2000, "thickness": 0.1, "at": [0.3, -2], "angle": 1.0,
               "shapes": [shape]}]
    run = _run({**_scene({"type": "buoyancy", "name": "w"}, g=G, duration=0.2), "bodies": bodies})
    assert run["b.ay"] == pytest.approx(-G / 2, rel=1e-11)
    assert np.abs(run["b.alpha"]).max() < 1e-9


def test_displaced_shapes_are_scaled_and_mirrored_with_their_body() -> None:
    """Half a box to the right of the origin, in a mirror to its left, and twice as large."""
    part = {"type": "assembly", "name": "p", "mirror": "left-right", "scale": 2, "bodies": [
        {"name": "b", "mass": 4.0, "thickness": 0.1, "inertia": 1, "centre": [0, 0],
         "displaces": [{"type": "box", "size": [0.2, 0.2], "at": [0.1, 0]}]}]}
    scene = _scene({"type": "buoyancy", "name": "w", "level": 1}, g=G, h=1e-3, duration=1e-3)
    run = _run({**scene, "bodies": [], "parts": [part]})
    lift = 1000 * G * 0.1 * 0.4 * 0.4
    assert run["w.p.b.fy"][0] == pytest.approx(lift, rel=1e-12)
    assert run["w.p.b.torque"][0] == pytest.approx(-0.2 * lift, rel=1e-12)


def test_a_law_that_runs_out_of_numbers_is_named() -> None:
    with pytest.raises(SimulationDiverged, match=r"the load 'law' has no finite value there"):
        sandbox.simulate(sandbox.load_scene(_scene(_law(force=["=1 / max(0, y + 1)", 0]), g=G)))
