"""Loads by laws of a body's motion: drag, an orbit, a float, added mass."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.study.plain_mechanisms import G, mass, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

H = 1e-3


def _moved(*loads: Mapping[str, object], duration: float, gravity: float = 0.0, h: float = H,
           **body: object) -> Recording:
    """A body of 1 kg at the origin under loads."""
    return simulate(mechanism(
        duration=duration, step=h, gravity=(0.0, -gravity), run={"sample_rate": 1 / h},
        bodies=[{**mass("bob", 1.0, (0.0, 0.0)), **body}], loads=[dict(load) for load in loads]))


def _drag() -> Findings:
    k, v, checks = 1.5, (3.0, 4.0), []
    run = _moved({"type": "drag", "name": "air", "linear": k}, duration=2.0, gravity=G, velocity=v)
    t = run.time
    exact = {"x": v[0] / k * (1 - np.exp(-k * t)),
             "y": (v[1] + G / k) / k * (1 - np.exp(-k * t)) - G * t / k}
    for axis, fastest in (("x", v[0]), ("y", v[1] + G / k)):
        checks.append(Check(
            f"{axis} of a throw against a linear drag, at worst", "m", 0.0,
            float(np.abs(run[f"bob.{axis}"] - exact[axis]).max()), fastest / k * (H * k) ** 2,
            "the midpoint rule's and the leapfrog's (h k)², of the way that is left"))
    area = 0.5
    speed = math.sqrt(2 * G / (1.2 * area))
    fall = _moved({"type": "drag", "name": "air", "area": area}, duration=3.0, gravity=G)
    law = -speed * np.tanh(G * fall.time / speed)
    checks.append(Check("speed of a fall against the square of the speed, at worst", "m/s", 0.0,
                        float(np.abs(fall["bob.vy"] - law).max()), speed * (H * G / speed) ** 2,
                        "(h g / u)² of the speed of fall u"))
    few = slice(None, None, 150)
    curves = [Curve("-u tanh(g t / u)", fall.time, law),
              Curve("engine", fall.time[few], fall["bob.vy"][few], "points")]
    for h in (1e-2, 1e-3):
        stiff = _moved({"type": "drag", "name": "mud", "area": 1e6}, duration=1.0, gravity=G, h=h,
                       velocity=(100.0, 50.0))
        slow = math.sqrt(2 * G / 1.2e6)
        checks.append(Check(
            f"speed of fall in what stops 100 m/s at once, h = {1e3 * h:g} ms", "m/s", -slow,
            float(stiff["bob.vy"][-1]), 1e-9 * slow, "F at the step's end is that of the law, to "
            "1e-10 of it"))
    return Findings(checks, [Panel("A fall in air", "t [s]", "speed [m/s]", curves)])


def _orbit() -> Findings:
    a, e = 1.0, 0.5
    period, speed = 2 * math.pi, math.sqrt((1 + e) / (1 - e))
    law = {"type": "law", "name": "sun",
           "acceleration": ["=-x / hypot(x, y) ** 3", "=-y / hypot(x, y) ** 3"]}
    run = _moved(law, duration=period, at=(a * (1 - e), 0.0), velocity=(0.0, speed))
    x, y, vx, vy = (run[f"bob.{name}"] for name in ("x", "y", "vx", "vy"))
    areas, energy = x * vy - y * vx, (vx**2 + vy**2) / 2 - 1 / np.hypot(x, y)
    fastest = (1 - e) ** -3  # the square of the largest rate, at the near end
    angle = np.linspace(0, math.tau, 200)
    few = slice(None, None, 200)
    return Findings([
        Check("areas swept alike: largest less least", "m²/s", 0.0, float(np.ptp(areas)), 1e-11,
              "the pull has no moment in any step: rounding of 6000 of them"),
        Check("energy", "J/kg", -1 / (2 * a), float(energy.mean()), fastest * H**2,
              "the leapfrog's, the square of h times the fastest rate"),
        Check("far end of the ellipse", "m", -a * (1 + e), float(x.min()), 2 * fastest * H**2,
              "the same of the longer half axis, twice"),
        Check("back after one period: x", "m", a * (1 - e), float(x[-1]), fastest * H**2,
              "the same"),
    ], [Panel("An orbit", "x [m]", "y [m]", [
        Curve("ellipse", a * (np.cos(angle) - e), a * math.sqrt(1 - e * e) * np.sin(angle)),
        Curve("engine", x[few], y[few], "points")], scale="plane")])


def _float() -> Findings:
    width, height, thick, tilt = 0.6, 0.2, 0.1, 0.1
    weight, draught = 500 * width * height * thick * G, height / 2
    box: dict[str, Any] = {
        "mass": 500 * width * height * thick, "inertia": 1.0, "thickness": thick,
        "shapes": [{"type": "box", "size": (width, height)}]}
    water = {"type": "buoyancy", "name": "water"}
    run = _moved(water, duration=2.0, gravity=G, at=(0.0, 0.02), **box)
    rate = math.sqrt(G / draught)
    off = np.abs(run["bob.y"] - 0.02 * np.cos(rate * run.time)).max()
    askew = _moved(water, duration=2e-3, gravity=G, angle=tilt, **box)
    arm = (width**2 / (12 * draught) * (1 + math.tan(tilt) ** 2 / 2) + draught / 2 - height / 2)
    round_one = _moved(water, duration=2e-3, gravity=G, at=(0.0, 0.05), thickness=thick,
                       shapes=[{"type": "circle", "radius": 0.2}], inertia=1.0)
    d, r = float(round_one["bob.y"][0]), 0.2
    segment = r * r * math.acos(d / r) - d * math.sqrt(r * r - d * d)
    return Findings([
        Check("heave of a box, at worst", "m", 0.0, float(off), 0.02 * 2 * (rate * H) ** 2,
              "the leapfrog's (w h)² / 24 of the frequency, over two seconds"),
        Check("moment that rights a box at 0.1 rad", "N m", -weight * arm * math.sin(tilt),
              float(askew["water.bob.torque"][0]), 1e-4 * weight * arm * tilt,
              "it has moved for half a step"),
        Check("lift of a disc that is partly under", "N", 1000 * G * thick * segment,
              float(round_one["water.bob.fy"][0]), 1e-9, "rounding"),
    ])


def _field() -> Findings:
    rate, checks = 5.0, []
    run = _moved({"type": "law", "name": "coil", "force": [f"={rate} * vy", f"=-{rate} * vx"]},
                 duration=2.0, velocity=(1.0, 0.0))
    off = np.hypot(run["bob.x"] - np.sin(rate * run.time) / rate,
                   run["bob.y"] - (np.cos(rate * run.time) - 1) / rate).max()
    checks.append(Check("circle in a magnetic field, at worst", "m", 0.0, float(off),
                        2 * (rate * H) ** 2, "(w h)² / 12 of the frequency over two seconds, the "
                        "sagitta of a step"))
    checks.append(Check("work that the field does", "J", 0.0,
                        float(np.abs(run["coil.bob.work"]).max()), 1e-11, "rounding"))
    for share in (0.5, 10.0):
        heavy = _moved({"type": "law", "name": "water", "force": [0, f"=-{share} * mass * ay"]},
                       duration=0.1, gravity=G)
        checks.append(Check(f"fall with an added mass of {share:g} m", "m/s²", -G / (1 + share),
                            float(heavy["bob.ay"][-1]), 1e-8, "1e-10 of the force, and rounding"))
    return Findings(checks)


CASES = (
    Case("drag", "Drag of a body", "x = v/k (1 − e^(−k t)),   v = −u tanh(g t / u)",
         "a throw against a linear drag, a fall against a quadratic one, h = 1 ms; and into what "
         "would stop it at once", "place and speed against closed forms", _drag),
    Case("orbit", "An orbit in a central field", "r = a (1 − e²) / (1 + e cos φ),  T = 2π √(a³/μ)",
         "one turn round an ellipse of e = 0.5 by a law of acceleration, h = 1 ms",
         "areas, energy, the far end, and the place after one period", _orbit),
    Case("floating", "What a liquid lifts", "F = ρ g A,  w² = g / d,  GM = b² / 12 d + KB − KG",
         "a box that heaves, one that is askew, a disc partly under water",
         "motion, righting moment and lift against closed forms", _float),
    Case("fields", "Laws of velocity and acceleration", "r = m v / q B,   a = g / (1 + s)",
         "a body in a magnetic field, and with an added mass", "place, work, acceleration",
         _field),
)
