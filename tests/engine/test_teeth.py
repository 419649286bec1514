"""Gears, racks and circles that roll, against closed forms and independent integrations."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.audit.audit import audit

TAN, COS = math.tan(math.radians(20.0)), math.cos(math.radians(20.0))


def ran(h: float, duration: float = 0.5, **scene: Any) -> sandbox.Recording:
    """The run of a scene without gravity, every look of its audit refused but what is shared."""
    run = sandbox.simulate(sandbox.load_scene({
        "name": "teeth", "gravity": [0, 0],
        "run": {"duration": duration, "step": h, "sample_rate": 1000}, **scene}))
    looks = [one for one in audit(run) if one.verdict == "look" and one.name != "reaction.shared"]
    assert not looks, looks
    return run


def wheel(name: str, x: float, mass: float, inertia: float, **more: Any) -> dict[str, Any]:
    return {"name": name, "at": [x, 0], "mass": mass, "inertia": inertia, **more}


def pin(name: str, a: str, b: str) -> dict[str, Any]:
    return {"type": "pin", "name": name, "a": a, "b": b, "on_b": [0, 0]}


def pair(ra: float, rb: float, *, inside: bool = False, **gear: Any) -> dict[str, Any]:
    """Two gears on the ground, 0.2 and 3 g m^2."""
    return {"bodies": [{"name": "ground", "motion": "fixed"}, wheel("a", 0, 1, 2e-4),
                       wheel("b", abs(ra - rb) if inside else ra + rb, 2, 3e-3)],
            "joints": [pin("on_a", "ground", "a"), pin("on_b", "ground", "b"),
                       {"type": "gear", "name": "mesh", "a": "a", "b": "b", "radius_a": ra,
                        "radius_b": rb, "inside": inside, **gear}]}


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("torque", [0.5, -0.5])
def test_a_pair(inside: bool, torque: float) -> None:
    """I_a + (r_a / r_b)^2 I_b resists; the mesh pushes with F / cos, the bearing feels F tan too.

    Of the speed 1e9 N/m of teeth take the winding up, some sqrt(F^2 / k I) rad/s at most; which
    way round they push, the bearing is pushed outside, and of a ring inside.
    """
    ra, rb = 0.02, 0.05
    run = ran(1e-3, drives=[{"type": "torque", "name": "m", "joint": "on_a", "value": torque}],
              **pair(ra, rb, inside=inside))
    turn, rate = run["on_b.rate"], torque / (2e-4 + (ra / rb) ** 2 * 3e-3)
    tangential = 3e-3 * abs(rate) * ra / rb / rb
    slack = math.sqrt(tangential**2 / 1e9 / 2e-4)
    np.testing.assert_allclose(run["on_a.rate"], rate * run.time, atol=slack)
    np.testing.assert_allclose(turn * rb, (1 if inside else -1) * run["on_a.rate"] * ra,
                               atol=slack * ra)
    np.testing.assert_allclose(run["mesh.reaction"][5:], tangential / COS, rtol=1e-8)
    np.testing.assert_allclose(run["mesh.reaction_x"][5:], (-1 if inside else 1) * tangential * TAN,
                               rtol=1e-8)
    np.testing.assert_allclose(run["on_b.reaction"][5:], tangential / COS, rtol=1e-8)
    np.testing.assert_allclose(run["mesh.tangential"][5:], math.copysign(tangential, torque),
                               rtol=1e-8)
    np.testing.assert_allclose(run["mesh.radial"][5:], tangential * TAN, rtol=1e-7)


def test_a_rack_at_an_angle() -> None:
    """The rail carries F tan 20 degrees, the pinion's bearing F / cos."""
    slope, r = 0.3, 0.02
    c, s = math.cos(slope), math.sin(slope)
    run = ran(1e-3, bodies=[
        {"name": "ground", "motion": "fixed"}, wheel("a", 0, 1, 2e-4),
        {"name": "rack", "at": [r * s, -r * c], "angle": slope, "mass": 2, "inertia": 1}],
        joints=[pin("on_a", "ground", "a"),
                {"type": "slot", "name": "rail", "a": "ground", "b": "rack", "turns": False,
                 "start": [r * s - 5 * c, -r * c - 5 * s], "end": [r * s + 5 * c, -r * c + 5 * s]},
                {"type": "rack", "name": "mesh", "a": "a", "b": "rack", "radius": r}],
        drives=[{"type": "torque", "name": "m", "joint": "on_a", "value": 1.0}])
    acceleration = 1.0 * r / (2e-4 + r * r * 2)
    speed = np.hypot(run["rack.vx"], run["rack.vy"])
    np.testing.assert_allclose(speed, acceleration * run.time, atol=1e-5)
    np.testing.assert_allclose(run["mesh.reaction"][5:], 2 * acceleration / COS, rtol=1e-8)
    np.testing.assert_allclose(run["on_a.reaction"][5:], 2 * acceleration / COS, rtol=1e-8)
    np.testing.assert_allclose(run["rail.reaction"][5:], 2 * acceleration * TAN, rtol=1e-7)
    np.testing.assert_allclose(run["mesh.tangential"][5:], 2 * acceleration, rtol=1e-8)
    np.testing.assert_allclose(run["mesh.radial"][5:], 2 * acceleration * TAN, rtol=1e-7)
