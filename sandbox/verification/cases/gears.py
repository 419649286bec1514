"""Gears and circles that roll: ratios, forces at the mesh, play, and a disc on another."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.samples.samples import Samples
from sandbox.study.independent import ATOL, RTOL, solve_ivp
from sandbox.study.plain_mechanisms import G, fixed, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

PRESSURE = math.radians(20.0)
STILL = "the winding up of the teeth, 10⁹ N/m, has died away"
STEPS = (1e-3, 5e-4)


def _wheel(name: str, x: float, y: float, kilograms: float, inertia: float,
           **more: Any) -> dict[str, Any]:
    return {"name": name, "at": (x, y), "mass": kilograms, "inertia": inertia, **more}


def _pin(name: str, a: str, b: str) -> dict[str, Any]:
    return {"type": "pin", "name": name, "a": a, "b": b, "on_b": (0.0, 0.0)}


def _gear(name: str, a: str, b: str, ra: float, rb: float, **more: Any) -> dict[str, Any]:
    return {"type": "gear", "name": name, "a": a, "b": b, "radius_a": ra, "radius_b": rb, **more}


def _pair() -> Findings:
    """A torque on a pinion that turns a wheel, outside and inside a ring."""
    ra, rb, ia, ib, torque = 0.02, 0.05, 2e-4, 3e-3, 0.5
    checks, curves = [], []
    for inside, word in ((False, "wheel"), (True, "ring")):
        run = simulate(mechanism(
            duration=0.2, step=1e-3,
            bodies=[fixed("ground"), _wheel("a", 0, 0, 1, ia),
                    _wheel("b", rb - ra if inside else ra + rb, 0, 2, ib)],
            joints=[_pin("on_a", "ground", "a"), _pin("on_b", "ground", "b"),
                    _gear("mesh", "a", "b", ra, rb, inside=inside)],
            drives=[{"type": "torque", "name": "m", "joint": "on_a", "value": torque}]))
        rate = torque / (ia + (ra / rb) ** 2 * ib)
        tangential = (torque - ia * rate) / ra
        push = float(run["mesh.reaction"][-1])
        checks += [
            Check(f"{word}: rate of the pinion", "rad/s", rate * float(run.time[-1]),
                  float(run["on_a.rate"][-1]), 1e-8 * rate, STILL),
            Check(f"{word}: its rate by the pinion's", "1", (1 if inside else -1) * ra / rb,
                  float(run["on_b.rate"][-1] / run["on_a.rate"][-1]), 1e-9, STILL),
            Check(f"{word}: push of the teeth times cos a, by torque over radius", "N",
                  tangential, push * math.cos(PRESSURE), 1e-8 * tangential, STILL),
            Check(f"{word}: on the bearing, along the line of centres", "N",
                  tangential * math.tan(PRESSURE), abs(float(run["on_b.reaction_x"][-1])),
                  1e-8 * tangential, STILL)]
        curves.append(Curve(word, run.time * 1e3, np.abs(run["on_b.rate"])))
    return Findings(checks, [Panel("What the pinion turns", "time [ms]", "rate [rad/s]", curves)])


def _planetary(h: float, planets: int) -> tuple[Samples, float, float]:
    """A sun drives a loaded carrier in a fixed ring; the run, the sun's rate, a mesh's force."""
    rs, rp, torque, load = 0.02, 0.015, 0.05, 0.08
    ring, arm, sun, carrier, planet, kilograms = rs + 2 * rp, rs + rp, 1e-4, 2e-4, 2e-5, 0.1
    bodies = [fixed("ring"), _wheel("sun", 0, 0, 1, sun), _wheel("carrier", 0, 0, 1, carrier)]
    joints = [_pin("on_sun", "ring", "sun"), _pin("on_carrier", "ring", "carrier")]
    for k in range(planets):
        q = math.tau * k / planets
        bodies.append(_wheel(f"p{k}", arm * math.cos(q), arm * math.sin(q), kilograms, planet))
        joints += [_pin(f"pin{k}", "carrier", f"p{k}"), _gear(f"sun{k}", "sun", f"p{k}", rs, rp),
                   _gear(f"ring{k}", "ring", f"p{k}", ring, rp, inside=True)]
    run = simulate(mechanism(duration=0.5, step=h, bodies=bodies, joints=joints, drives=[
        {"type": "torque", "name": "m", "joint": "on_sun", "value": torque},
        {"type": "torque", "name": "l", "joint": "on_carrier", "value": -load}]))
    ratio = rs / (2 * arm)
    spin = (ring - rp) / rp * ratio
    inertia = sun + ratio**2 * (carrier + planets * kilograms * arm**2) + planets * planet * spin**2
    rate = (torque - load * ratio) / inertia
    return run, rate, (torque - sun * rate) / rs / planets


def _planets() -> Findings:
    """One planet, and three that share though two would do."""
    checks, curves = [], []
    for planets in (1, 3):
        off, last = [], 0.0
        for h in STEPS:
            run, rate, push = _planetary(h, planets)
            last = rate * float(run.time[-1])
            off.append(float(np.abs(run["on_sun.rate"] - rate * run.time).max()))
            allowed = (last * 2 / 7 * h) ** 2 / 8
            word = f"{planets} planet{'s' * (planets > 1)}, h = {1e3 * h:g} ms"
            found = [float(run[f"sun{k}.tangential"][-1]) for k in range(planets)]
            worst = found[int(np.argmax(np.abs(np.array(found) - push)))]
            checks += [
                Check(f"{word}: sun's rate, largest difference", "rad/s", 0.0, off[-1],
                      last * allowed, "(ω h)²/8 of it: an arc's height over its chord where the "
                      "carrier turns by ω h in a step"),
                Check(f"{word}: carrier by sun", "1", 2 / 7,
                      float(run["on_carrier.rate"][-1] / run["on_sun.rate"][-1]), 1e-9,
                      "teeth follow each other; what yields is as good as still"),
                Check(f"{word}: tangential force of each mesh of the sun", "N", push, worst,
                      push * allowed, "the same")]
            curves.append(Curve(word, run.time * 1e3, np.abs(run["on_sun.rate"] - rate * run.time)))
        checks.append(Check(f"{planets}: error at 1 ms by that at 0.5 ms", "1", 4.0,
                            off[0] / off[1], 0.4, "second order, a tenth for the next term"))
    return Findings(checks, [Panel("Error of the sun's rate", "time [ms]", "[rad/s]", curves)])


def _backlash() -> Findings:
    """A wheel turns alone through half of its play, then hits one at rest."""
    r, play, start, one, other = 0.03, 1e-3, 10.0, 2e-4, 1e-3
    run = simulate(mechanism(
        duration=0.01, step=2.5e-4, run={"sample_rate": 4000.0},
        bodies=[fixed("ground"), _wheel("a", 0, 0, 1, one, angular_velocity=start),
                _wheel("b", 2 * r, 0, 2, other)],
        joints=[_pin("on_a", "ground", "a"), _pin("on_b", "ground", "b"),
                _gear("mesh", "a", "b", r, r, backlash=play)]))
    after = start * one / (one + other)
    instant = float(run.time[np.flatnonzero(run["on_b.rate"])[0]])
    return Findings([
        Check("both after the hit", "rad/s", after, float(run["on_a.rate"][-1]), 1e-7,
              "a plastic hit; 10⁻⁸ of the impulse is left to the rows' accuracy"),
        Check("the other wheel", "rad/s", -after, float(run["on_b.rate"][-1]), 1e-7, "the same"),
        Check("instant of the hit", "s", play / 2 / (start * r), instant, 2.5e-4, "a step"),
        Check("play that is left", "m", 0.0, float(run["mesh.gap"][-1]), 1e-10, "rounding"),
    ], [Panel("Through the play", "time [ms]", "rate [rad/s]", [
        Curve("the wheel that turns", 1e3 * run.time, run["on_a.rate"], "points"),
        Curve("the wheel that is hit", 1e3 * run.time, -run["on_b.rate"], "points")])])


def _disc() -> Findings:
    """Out of 0.3 rad, over the side of a fixed one."""
    ra, rb, kilograms, inertia, start = 0.05, 0.03, 1.0, 4.5e-4, 0.3
    arm = ra + rb
    whole = kilograms * arm**2 + inertia * (arm / rb) ** 2

    def slope(_t: float, state: Array) -> list[float]:
        return [float(state[1]), kilograms * G * arm * math.sin(state[0]) / whole]

    truth = solve_ivp(slope, (0, 0.8), [start, 0], rtol=RTOL, atol=ATOL, dense_output=True,
                      method="DOP853")
    checks, curves, off = [], [], []
    for h in STEPS:
        run = simulate(mechanism(
            duration=0.8, step=h, run={"sample_rate": 1 / h}, gravity=(0.0, -G),
            bodies=[fixed("ground"), _wheel("disc", arm * math.sin(start), arm * math.cos(start),
                                            kilograms, inertia)],
            joints=[{"type": "roll", "name": "joint", "a": "ground", "b": "disc", "radius_a": ra,
                     "radius_b": rb}]))
        turn, rate = truth.sol(run.time)
        found = np.unwrap(np.arctan2(run["disc.x"], run["disc.y"]))
        error = np.abs(found - turn)
        off.append(float(error.max()))
        curves.append(Curve(f"h = {1e3 * h:g} ms", 1e3 * run.time, error))
        pressed = kilograms * (G * np.cos(turn) - arm * rate**2)
        slip = np.abs(rb * run["disc.angle"] + arm * (found - start))
        checks += [
            Check(f"angle over the fixed disc at h = {1e3 * h:g} ms, largest difference", "rad",
                  0.0, off[-1], (float(rate[-1]) * h * arm / rb) ** 2 * float(turn[-1]),
                  "(ω h)² of it, ω h the disc's turn in a step"),
            Check(f"slip at h = {1e3 * h:g} ms", "m", 0.0, float(slip.max()), 1e-10,
                  "nothing adds up: places are kept, not speeds"),
            Check(f"force between the discs at h = {1e3 * h:g} ms, largest difference", "N", 0.0,
                  float(np.abs(run["joint.radial"] - pressed).max()),
                  kilograms * G * (float(rate[-1]) * h * arm / rb) ** 2 * float(turn[-1]),
                  "the same of the weight; less than nothing where the discs are held together")]
    checks.append(Check("error at 1 ms by that at 0.5 ms", "1", 4.0, off[0] / off[1], 0.4,
                        "second order, a tenth for the next term"))
    return Findings(checks, [Panel("Error of the angle", "time [ms]", "[rad]", curves)])


CASES = (
    Case("gear_pair", "A pair of gears", "ω' (I_a + (r_a/r_b)² I_b) = M; p cos a = F, F tan a",
         "a pinion in a wheel, and in a ring", "rates, push of the teeth, load of the bearing "
         "with the closed forms", _pair),
    Case("planetary_gear", "A planetary gear", "ω_c/ω_s = r_s/(r_s + r_r); Lagrange",
         "a sun drives a loaded carrier in a fixed ring, over one planet and over three",
         "rates and forces of the meshes with the closed forms", _planets),
    Case("backlash", "Through the play of teeth", "ω = ω₀ I_a/(I_a + I_b)",
         "a wheel turns into one as large that is at rest, over 1 mm of play",
         "rates after a plastic hit, and its instant", _backlash),
    Case("rolling_circles", "A disc that rolls over another",
         "(m l² + I (l/r)²) φ'' = m g l sin φ; N = m g cos φ − m l φ'²",
         "a disc, let go beside the top of a fixed one and held to it",
         "angle, slip and force with an integration of order 8", _disc),
)
