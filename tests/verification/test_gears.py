"""Gears and rolling circles: ratios, forces at the mesh, backlash, a disc on another."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from tests.support.mechanisms import G, Json, fixed, pin, simulated
from tests.support.reference import integrate

from .case import Check, case

STILL = "the winding up of the teeth, 10⁹ N/m, has decayed"
SECOND = "second order, a tenth for the next term"


def wheel(name: str, x: float, y: float, kilograms: float, inertia: float, **more: Any) -> Json:
    return {"name": name, "at": (x, y), "mass": kilograms, "inertia": inertia, **more}


def gear(name: str, a: str, b: str, ra: float, rb: float, **more: Any) -> Json:
    return {"type": "gear", "name": name, "a": a, "b": b, "radius_a": ra, "radius_b": rb, **more}


@case("Pair of gears", "ω′ (I_a + (r_a/r_b)² I_b) = M; p cos α = F, F tan α",
      "a torque on a pinion in a wheel, and in a ring, α = 20°")
def test_gear_pair() -> Iterator[Check]:
    ra, rb, ia, ib, torque, pressure = 0.02, 0.05, 2e-4, 3e-3, 0.5, math.radians(20.0)
    for inside, word in ((False, "wheel"), (True, "ring")):
        run = simulated(
            0.2, 1e-3, bodies=[fixed("ground"), wheel("a", 0, 0, 1, ia),
                               wheel("b", rb - ra if inside else ra + rb, 0, 2, ib)],
            joints=[pin("on_a", "ground", "a"), pin("on_b", "ground", "b"),
                    gear("mesh", "a", "b", ra, rb, inside=inside)],
            drives=[{"type": "torque", "name": "m", "joint": "on_a", "value": torque}])
        growth = torque / (ia + (ra / rb)**2 * ib)
        tangential = (torque - ia * growth) / ra
        yield Check(f"{word}: rate of the pinion", "rad/s", growth * run.time[-1],
                    run["on_a.rate"][-1], 1e-8 * growth, STILL)
        yield Check(f"{word}: ratio of the rates", "1", (1 if inside else -1) * ra / rb,
                    run["on_b.rate"][-1] / run["on_a.rate"][-1], 1e-9, STILL)
        yield Check(f"{word}: force of the teeth along the tangent, and of the bearing along the "
                    "line of centres", "N", [tangential, tangential * math.tan(pressure)],
                    [run["mesh.reaction"][-1] * math.cos(pressure),
                     abs(run["on_b.reaction_x"][-1])], 1e-8 * tangential, STILL)


def planetary(h: float, planets: int) -> tuple[Recording, float, float]:
    """Sun that drives a loaded carrier in a fixed ring; the sun's acceleration, a mesh's force."""
    rs, rp, torque, load = 0.02, 0.015, 0.05, 0.08
    ring, arm, sun, carrier, planet, kilograms = rs + 2 * rp, rs + rp, 1e-4, 2e-4, 2e-5, 0.1
    bodies = [fixed("ring"), wheel("sun", 0, 0, 1, sun), wheel("carrier", 0, 0, 1, carrier)]
    joints = [pin("on_sun", "ring", "sun"), pin("on_carrier", "ring", "carrier")]
    for k in range(planets):
        q = math.tau * k / planets
        bodies.append(wheel(f"p{k}", arm * math.cos(q), arm * math.sin(q), kilograms, planet))
        joints += [pin(f"pin{k}", "carrier", f"p{k}"), gear(f"sun{k}", "sun", f"p{k}", rs, rp),
                   gear(f"ring{k}", "ring", f"p{k}", ring, rp, inside=True)]
    run = simulated(0.5, h, bodies=bodies, joints=joints, drives=[
        {"type": "torque", "name": "m", "joint": "on_sun", "value": torque},
        {"type": "torque", "name": "l", "joint": "on_carrier", "value": -load}])
    ratio = rs / (2 * arm)
    spin = (ring - rp) / rp * ratio
    inertia = sun + ratio**2 * (carrier + planets * kilograms * arm**2) + planets * planet * spin**2
    growth = (torque - load * ratio) / inertia
    return run, growth, (torque - sun * growth) / rs / planets


@case("Planetary gear", "ω_c/ω_s = r_s/(r_s + r_r); Lagrange",
      "a sun drives a loaded carrier in a fixed ring, over one planet and over three")
def test_planetary_gear() -> Iterator[Check]:
    for planets in (1, 3):
        off = []
        for h in (1e-3, 5e-4):
            run, growth, push = planetary(h, planets)
            last = growth * float(run.time[-1])
            off.append(np.abs(run["on_sun.rate"] - growth * run.time).max())
            share = (last * 2 / 7 * h)**2 / 8
            word = f"planets {planets}, h = {1e3 * h:g} ms"
            why = "(ω h)²/8: the arc's height over its chord where the carrier turns by ω h a step"
            yield Check(f"{word}: rate of the sun", "rad/s", growth * run.time, run["on_sun.rate"],
                        last * share, why)
            yield Check(f"{word}: carrier by sun", "1", 2 / 7,
                        run["on_carrier.rate"][-1] / run["on_sun.rate"][-1], 1e-9,
                        "the teeth do not yield any more")
            yield Check(f"{word}: tangential forces at the sun", "N", push,
                        [run[f"sun{k}.tangential"][-1] for k in range(planets)], push * share, why)
        yield Check(f"planets {planets}: error at 1 ms by that at 0.5 ms", "1", 4.0,
                    off[0] / off[1], 0.4, SECOND)


@case("Backlash", "ω = ω₀ I_a/(I_a + I_b)",
      "a wheel turns through 1 mm of backlash into an equal one at rest")
def test_backlash() -> Iterator[Check]:
    r, play, start, one, other, h = 0.03, 1e-3, 10.0, 2e-4, 1e-3, 2.5e-4
    run = simulated(
        0.01, h, every_step=True,
        bodies=[fixed("ground"), wheel("a", 0, 0, 1, one, angular_velocity=start),
                wheel("b", 2 * r, 0, 2, other)],
        joints=[pin("on_a", "ground", "a"), pin("on_b", "ground", "b"),
                gear("mesh", "a", "b", r, r, backlash=play)])
    after = start * one / (one + other)
    yield Check("rates after the impact", "rad/s", [after, -after],
                [run["on_a.rate"][-1], run["on_b.rate"][-1]], 1e-7,
                "a plastic impact; 10⁻⁸ of the impulse is left by the solver's accuracy")
    yield Check("instant of the impact", "s", play / 2 / (start * r),
                run.time[np.flatnonzero(run["on_b.rate"])[0]], h, "a step")
    yield Check("gap that is left", "m", 0.0, run["mesh.gap"][-1], 1e-10, "rounding")


@case("Disc that rolls over another", "(m l² + I (l/r)²) φ″ = m g l sin φ; N = m g cos φ − m l φ′²",
      "a disc released 0.3 rad from the top of a fixed one, held to it; integration of order 8")
def test_rolling_circles() -> Iterator[Check]:
    ra, rb, m, inertia, start = 0.05, 0.03, 1.0, 4.5e-4, 0.3
    arm = ra + rb
    whole = m * arm**2 + inertia * (arm / rb)**2

    def slope(_t: float, state: Array) -> list[float]:
        return [float(state[1]), m * G * arm * math.sin(state[0]) / whole]

    off = []
    for h in (1e-3, 5e-4):
        run = simulated(
            0.8, h, g=G, every_step=True,
            bodies=[fixed("ground"), wheel("disc", arm * math.sin(start), arm * math.cos(start),
                                           m, inertia)],
            joints=[{"type": "roll", "name": "joint", "a": "ground", "b": "disc", "radius_a": ra,
                     "radius_b": rb}])
        turn, rate = integrate(slope, [start, 0], run.time).T
        found = np.unwrap(np.arctan2(run["disc.x"], run["disc.y"]))
        off.append(np.abs(found - turn).max())
        allowed = (float(rate[-1]) * h * arm / rb)**2 * float(turn[-1])
        word = f"h = {1e3 * h:g} ms"
        yield Check(f"angle over the fixed disc, {word}", "rad", turn, found, allowed,
                    "(ω h)² of it, ω h the disc's turn in a step")
        yield Check(f"slip, {word}", "m", 0.0, rb * run["disc.angle"] + arm * (found - start),
                    1e-10, "positions are kept, not speeds: nothing adds up")
        yield Check(f"force between the discs, {word}", "N",
                    m * (G * np.cos(turn) - arm * rate**2), run["joint.radial"], m * G * allowed,
                    "the same of the weight; negative where the discs are held together")
    yield Check("error at 1 ms by that at 0.5 ms", "1", 4.0, off[0] / off[1], 0.4, SECOND)
