"""Gears, racks and circles that roll, against closed forms and independent integrations."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

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


def test_a_ring_drives_its_pinion() -> None:
    """Told from the ring's side the push is the same, and presses the two apart as well."""
    run = ran(1e-3, drives=[{"type": "torque", "name": "m", "joint": "on_a", "value": 0.5}],
              **pair(0.05, 0.02, inside=True))
    tangential = 0.5 / (2e-4 + 2.5**2 * 3e-3) * 2.5 * 3e-3 / 0.02
    np.testing.assert_allclose(run["mesh.tangential"][5:], tangential, rtol=1e-7)
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


def test_play_is_passed_and_then_hit() -> None:
    """A wheel turns 0.5 mm at its circle alone, then both go on as after a plastic impact."""
    scene = pair(0.03, 0.03, backlash=1e-3)
    scene["bodies"][1] |= {"inertia": 5e-4, "angular_velocity": 10.0}
    scene["bodies"][2] |= {"inertia": 1e-3}
    run = ran(1e-3, 0.1, **scene)
    alone = run.time * 10.0 * 0.03 < 0.5e-3 - 0.03 * 10.0 * 1e-3
    np.testing.assert_allclose(run["on_a.rate"][alone], 10.0, rtol=1e-12)
    np.testing.assert_array_equal(run["on_b.rate"][alone], 0.0)
    np.testing.assert_allclose(run["mesh.gap"][alone], 0.5e-3 - 0.3 * run.time[alone], atol=1e-15)
    np.testing.assert_allclose(run["mesh.gap"][10:], 0.0, atol=1e-11)
    np.testing.assert_allclose(run["on_a.rate"][10:], 10.0 / 3, rtol=1e-8)
    np.testing.assert_allclose(run["on_b.rate"][10:], -10.0 / 3, rtol=1e-8)


def planetary(h: float, planets: int) -> tuple[sandbox.Recording, float, float]:
    """A sun drives a loaded carrier in a fixed ring; the run, the sun's rate, a mesh's force."""
    rs, rp, torque, load = 0.02, 0.015, 0.05, 0.08
    ring, arm = rs + 2 * rp, rs + rp
    bodies = [{"name": "ring", "motion": "fixed"}, wheel("sun", 0, 1, 1e-4),
              wheel("carrier", 0, 1, 2e-4)]
    joints = [pin("on_sun", "ring", "sun"), pin("on_carrier", "ring", "carrier")]
    for k in range(planets):
        q = 2 * math.pi * k / planets
        bodies.append(wheel(f"p{k}", 0, 0.1, 2e-5) | {"at": [arm * math.cos(q), arm * math.sin(q)]})
        joints += [pin(f"pin{k}", "carrier", f"p{k}"),
                   {"type": "gear", "name": f"sun{k}", "a": "sun", "b": f"p{k}", "radius_a": rs,
                    "radius_b": rp},
                   {"type": "gear", "name": f"ring{k}", "a": "ring", "b": f"p{k}",
                    "radius_a": ring, "radius_b": rp, "inside": True}]
    run = ran(h, bodies=bodies, joints=joints, drives=[
        {"type": "torque", "name": "m", "joint": "on_sun", "value": torque},
        {"type": "torque", "name": "l", "joint": "on_carrier", "value": -load}])
    ratio = rs / (2 * arm)
    spin = (ring - rp) / rp * ratio
    inertia = 1e-4 + ratio**2 * (2e-4 + planets * 0.1 * arm**2) + planets * 2e-5 * spin**2
    rate = (torque - load * ratio) / inertia
    return run, rate, (torque - 1e-4 * rate) / rs / planets / COS


@pytest.mark.parametrize("planets", [1, 3])
def test_a_planetary_gear(planets: int) -> None:
    """Second order in the step; three planets share the load, though two would do."""
    errors, meshes = [], []
    for h in (1e-3, 5e-4):
        run, rate, mesh = planetary(h, planets)
        errors.append(abs(run["on_sun.rate"][-1] - rate * run.time[-1]) / (rate * run.time[-1]))
        meshes.append(max(abs(run[f"sun{k}.reaction"][-1] / mesh - 1) for k in range(planets)))
    assert errors[0] < 2e-4
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)
    assert meshes[0] < 3e-4
    assert meshes[0] / meshes[1] == pytest.approx(4, rel=0.2)


@pytest.mark.parametrize(("ra", "rb", "inside", "start"), [
    (0.05, 0.03, False, 0.3), (0.05, 0.02, True, 0.5), (0.02, 0.05, True, 0.5)])
def test_a_disc_rolls_on_a_fixed_one(ra: float, rb: float, inside: bool, start: float) -> None:
    """(m k^2 + I (k / r)^2) phi'' = m g k sin phi from above, - inside: integrated to 1e-11."""
    arm, up = (abs(ra - rb), -1.0) if inside else (ra + rb, 1.0)
    inertia = 4.5e-4
    whole = arm**2 + inertia * (arm / rb) ** 2
    truth = solve_ivp(lambda t, y: [y[1], up * 9.81 * arm * math.sin(y[0]) / whole], (0, 0.8),
                      [start, 0], rtol=1e-11, atol=1e-12, dense_output=True)
    errors = []
    for h in (1e-3, 5e-4):
        run = ran(h, 0.8, gravity=[0, -9.81], bodies=[
            {"name": "ground", "motion": "fixed"},
            {"name": "disc", "mass": 1, "inertia": inertia,
             "at": [arm * math.sin(start), up * arm * math.cos(start)]}],
            joints=[{"type": "roll", "name": "joint", "a": "ground", "b": "disc", "radius_a": ra,
                     "radius_b": rb, "inside": inside}])
        angle = np.unwrap(np.arctan2(run["disc.x"], up * run["disc.y"]))
        errors.append(np.abs(angle - truth.sol(run.time)[0]).max())
    assert errors[0] < 1.5e-4
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.15)
