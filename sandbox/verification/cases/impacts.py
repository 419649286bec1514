"""Impacts at their instants within the step: rows of balls, a disc and a box with friction, discs.

The references go from impact to impact: closed forms of free flight, the instant of the next one as
a root, Newton's law with Coulomb friction there. None of them knows a step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.study.plain_mechanisms import G, fixed, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

STEPS = (1e-3, 5e-4, 2.5e-4)
PLACED = ("pymunk finds normals to some 10⁻⁸, impulses that stick are held to the last by 10⁻⁷; "
          "impacts and turns multiply both")
E, MU, MASS = 0.7, 0.5, 0.4


def _run(
    step: float, duration: float, bodies: list[dict[str, Any]], e: float, mu: float,
    gravity: float = G, **more: Any,
) -> Recording:
    return simulate(mechanism(
        duration=duration, step=step, gravity=(0.0, -gravity), run={"sample_rate": 1 / step},
        materials={"m": {"restitution": e, "friction": mu}},
        bodies=[{"material": "m", **body} for body in bodies], **more))


FLOOR = fixed("floor", shapes=[{"type": "box", "size": (8.0, 0.2), "at": (0.0, -0.1)}])


def _last(run: Recording, name: str, keys: tuple[str, ...]) -> Array:
    return np.array([run[f"{name}.{key}"][-1] for key in keys])


# -- rows of balls ------------------------------------------------------------------

R, FIRST = 0.01, -0.0113
ROWS: tuple[tuple[tuple[float, ...], float], ...] = (
    ((0.05,) * 5, 1.0), ((0.05,) * 5, 0.9), ((0.05,) * 5, 0.5),
    ((0.05, 0.1, 0.05, 0.03, 0.05), 1.0), ((0.15, 0.05, 0.05, 0.05), 1.0))
GAPS = (0.0, 1e-5, 5e-5, 1e-4, 1e-3)


def _balls(masses: tuple[float, ...], gap: float) -> tuple[Array, Array]:
    x = np.arange(len(masses), dtype=np.float64) * (2 * R + gap)
    x[0] = FIRST
    v = np.zeros(len(masses))
    v[0] = 1.0
    return x, v


def _in_turn(masses: tuple[float, ...], gap: float, e: float) -> Array:
    """Velocities of the balls after all impacts, one after the other."""
    m = np.array(masses)
    x, v = _balls(masses, gap)
    while True:
        approach = -np.diff(v)
        time = np.full(len(approach), np.inf)
        near = approach > 1e-9
        time[near] = np.maximum(np.diff(x) - 2 * R, 0.0)[near] / approach[near]
        k = int(np.argmin(time))
        if not math.isfinite(time[k]):
            return v
        x = x + time[k] * v
        p = (1 + e) * approach[k] / (1 / m[k] + 1 / m[k + 1])
        v[k], v[k + 1] = v[k] - p / m[k], v[k + 1] + p / m[k + 1]


def _row(masses: tuple[float, ...], gap: float, e: float) -> Array:
    x, v = _balls(masses, gap)
    run = _run(5e-4, 0.15, [
        {"name": f"b{i}", "mass": masses[i], "at": (float(x[i]), 0.0),
         "velocity": (float(v[i]), 0.0), "shapes": [{"type": "circle", "radius": R}]}
        for i in range(len(x))], e, 0.0, gravity=0.0)
    return np.array([run[f"b{i}.vx"][-1] for i in range(len(x))])


def _cradles() -> Findings:
    checks = []
    for masses, e in ROWS:
        off = max(float(np.abs(_row(masses, gap, e) - _in_turn(masses, gap, e)).max())
                  for gap in GAPS)
        grams = " : ".join(f"{1e3 * m:g}" for m in masses)
        checks.append(Check(
            f"{grams} g, e = {e:g}: largest difference", "m/s", 0.0, off,
            1e-8 if e == 1 else 0.01, "impulses are held to the last by 10⁻¹⁰ of them" if e == 1
            else "approaches slower than 1 cm/s give nothing back"))
    return Findings(checks)


# -- one body above a floor ---------------------------------------------------------


def _box(angle: float) -> Array:
    """From the centre to the lowest corner of a box of 100 mm by 60 mm."""
    c, s = math.cos(angle), math.sin(angle)
    return min((np.array([c * x - s * y, s * x + c * y])
                for x in (0.05, -0.05) for y in (0.03, -0.03)), key=lambda arm: float(arm[1]))


def _disc(_: float) -> Array:
    return np.array([0.0, -0.05])


Arm = Callable[[float], Array]


def _flight(state: Array, t: float) -> Array:
    """Place, angle, velocities of x, y and angle, [6]."""
    result = state.copy()
    result[:3] += t * state[3:]
    result[1] -= G * t * t / 2
    result[4] -= G * t
    return result


def _impact(state: Array, r: Array, inertia: float) -> Array:
    """Newton's law of the normal, Coulomb's of the tangential velocity at the end of the impact."""
    un, ut = state[4] + state[5] * r[0], state[3] - state[5] * r[1]
    nn, tt = 1 / MASS + r[0] ** 2 / inertia, 1 / MASS + r[1] ** 2 / inertia
    nt = -r[0] * r[1] / inertia
    pn, pt = np.linalg.solve([[nn, nt], [nt, tt]], [-(1 + E) * un, -ut])
    if abs(pt) > MU * pn:
        sign = math.copysign(1.0, pt)
        pn = -(1 + E) * un / (nn + nt * MU * sign)
        pt = sign * MU * pn
    result = state.copy()
    result[3:] += pt / MASS, pn / MASS, (r[0] * pn - r[1] * pt) / inertia
    return result


def _exact(state: Array, arm: Arm, inertia: float, end: float) -> Array:
    """From impact to impact; each is bracketed and then bisected."""
    def height(t: float) -> float:
        now = _flight(state, t)
        return float(now[1] + arm(now[2])[1])

    while True:
        low = 1e-6
        while low < end and height(low + 1e-4) > 0:
            low += 1e-4
        if low >= end:
            return _flight(state, end)
        high = low + 1e-4
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if height(middle) > 0 else (low, middle)
        if high > end:
            return _flight(state, end)
        state, end = _flight(state, high), end - high
        state = _impact(state, arm(float(state[2])), inertia)


def _above_floor(
    shape: dict[str, Any], arm: Arm, inertia: float, start: tuple[float, ...], end: float,
) -> Findings:
    """Three impacts at most."""
    checks = []
    for step in STEPS:
        run = _run(step, end, [FLOOR, {
            "name": "b", "mass": MASS, "inertia": inertia, "at": start[:2], "angle": start[2],
            "velocity": start[3:5], "angular_velocity": start[5], "shapes": [shape]}], E, MU)
        law = _exact(np.array(start), arm, inertia, float(run.time[-1]))
        found = _last(run, "b", ("x", "y", "angle", "vx", "vy", "omega"))
        off = np.abs(found - law) / np.repeat(np.abs(law.reshape(2, 3)).max(axis=1), 3)
        checks.append(Check(f"h = {1e3 * step:g} ms: largest relative error of pose and velocity",
                            "1", 0.0, float(off.max()), 1e-5, PLACED))
    return Findings(checks)


# -- two free discs -----------------------------------------------------------------

DISCS = (("a", 0.3, 0.05, (0.0, 0.0), (1.0, 0.2), 25.0),
         ("b", 0.2, 0.03, (0.2, 0.031), (-0.8, -0.3), -12.0))
E_DISCS, MU_DISCS = 0.8, 0.4


def _two_discs(end: float) -> Array:
    """x, y, vx, vy, omega of both, [2, 5]."""
    (m, r, x, v, w), (n, s, y, u, q) = (
        (mass, radius, np.array(at), np.array(velocity), omega)
        for _, mass, radius, at, velocity, omega in DISCS)
    apart, way = y - x, u - v
    a, b, c = way @ way, apart @ way, apart @ apart - (r + s) ** 2
    hit = (-b - math.sqrt(b * b - a * c)) / a
    x, y = x + hit * v, y + hit * u
    normal = (y - x) / (r + s)
    along = np.array([-normal[1], normal[0]])
    pn = -(1 + E_DISCS) * (way @ normal) / (1 / m + 1 / n)
    slides = way @ along - w * r - q * s
    pt = float(np.clip(-slides / (3 / m + 3 / n), -MU_DISCS * pn, MU_DISCS * pn))
    p = pn * normal + pt * along
    v, u, w, q = v - p / m, u + p / n, w - 2 * pt / (m * r), q - 2 * pt / (n * s)
    return np.array([[*(x + (end - hit) * v), *v, w], [*(y + (end - hit) * u), *u, q]])


def _discs() -> Findings:
    checks = []
    for step in STEPS:
        run = _run(step, 0.2, [
            {"name": name, "mass": mass, "inertia": mass * radius**2 / 2, "at": at,
             "velocity": velocity, "angular_velocity": omega,
             "shapes": [{"type": "circle", "radius": radius}]}
            for name, mass, radius, at, velocity, omega in DISCS], E_DISCS, MU_DISCS, gravity=0.0)
        law = _two_discs(float(run.time[-1]))
        found = np.stack([_last(run, name, ("x", "y", "vx", "vy", "omega")) for name in "ab"])
        checks.append(Check(
            f"h = {1e3 * step:g} ms: largest relative error of place and velocity", "1", 0.0,
            float((np.abs(found - law) / np.abs(law).max(axis=0)).max()), 1e-6, PLACED))
    return Findings(checks)


# -- balls ---------------------------------------------------------------------------


def _apexes() -> Findings:
    """A sample is at most half a step off the apex: g (h/2)² / 2 below it."""
    checks, radius, top, e = [], 0.05, 1.0, 0.8
    for step in STEPS:
        run = _run(step, 3.0, [FLOOR, {
            "name": "b", "mass": 0.3, "at": (0.0, top + radius),
            "shapes": [{"type": "circle", "radius": radius}]}], e, 0.0)
        speed = math.sqrt(2 * G * top) * np.cumprod(np.full(5, e))
        lands = math.sqrt(2 * top / G) + np.cumsum([0.0, *(2 * speed / G)])
        heights = [float(run["b.y"][(run.time > a) & (run.time < b)].max()) - radius
                   for a, b in pairwise(lands[:5])]
        checks.append(Check(f"h = {1e3 * step:g} ms: fourth apex", "m", e**8 * top, heights[3],
                            G * step**2 / 8 + 1e-8, "half a step beside the apex of a parabola"))
    return Findings(checks)


def _on_spring() -> Findings:
    """Against a wall at x = 0 from x = a at rest, e = 0.8: x = a e^k |cos wt|, each half period."""
    checks, a, k, m, e = [], 0.1, 80.0, 0.2, 0.8
    omega, radius = math.sqrt(k / m), 0.02
    quarter = math.pi / 2 / omega
    for step in STEPS:
        run = _run(step, 4.6 * quarter, [
            fixed("wall", shapes=[{"type": "box", "size": (0.2, 1.0), "at": (-0.1 - radius, 0.0)}]),
            {"name": "b", "mass": m, "inertia": 1e-4, "at": (a, 0.0),
             "shapes": [{"type": "circle", "radius": radius}]}], e, 0.0, gravity=0.0,
            springs=[{"type": "linear", "name": "s", "a": "wall", "b": "b", "on_a": (-1.0, 0.0),
                      "stiffness": k, "rest_length": 1.0}])
        hits = np.floor((run.time / quarter + 1) / 2)
        law = a * e**hits * np.abs(np.cos(omega * run.time))
        square = (omega * step) ** 2
        checks.append(Check(
            f"h = {1e3 * step:g} ms: largest error of the place, in amplitudes", "1", 0.0,
            float(np.abs(run["b.x"] - law).max()) / a,
            square * (2 * (1 + e) / 2 + omega * run.time[-1] / 24),
            "each impact has the spring's force of the path before it for the rest of its step, "
            "(1 + e) (ωh)² / 2; the leapfrog is ahead by ωt (ωh)² / 24"))
    return Findings(checks)


CASES = (
    Case("impact_cradles", "Rows of balls with gaps", "v₂' − v₁' = −e (v₂ − v₁)",
         f"4 and 5 balls, gaps {', '.join(f'{1e3 * gap:g}' for gap in GAPS)} mm, the first at "
         "1 m/s, h = 0.5 ms", "velocities after all impacts against impacts one after the other",
         _cradles),
    Case("impact_disc", "A disc that lands spinning, three bounces", "v_n' = −e v_n, |p_t| ≤ μ p_n",
         "a disc of 400 g and 100 mm, e = 0.7, μ = 0.5", "pose and velocity after three impacts "
         "with friction, three steps", lambda: _above_floor(
             {"type": "circle", "radius": 0.05}, _disc, MASS * 0.05**2 / 2,
             (0.0, 0.3, 0.0, -2.0, 0.0, -40.0), 0.9)),
    Case("impact_box", "A box that lands on a corner", "v_n' = −e v_n, |p_t| ≤ μ p_n",
         "a box of 400 g, 100 mm by 60 mm, e = 0.7, μ = 0.5", "pose and velocity after its "
         "impacts, three steps", lambda: _above_floor(
             {"type": "box", "size": (0.1, 0.06)}, _box, MASS * (0.1**2 + 0.06**2) / 12,
             (0.0, 0.15, 0.5, 0.6, -1.0, 1.5), 0.22)),
    Case("impact_discs", "Two free rough discs", "v_n' = −e v_n, |p_t| ≤ μ p_n",
         "discs of 300 g and 200 g that meet aslant with spin, e = 0.8, μ = 0.4",
         "places and velocities after the impact, three steps", _discs),
    Case("impact_apexes", "The fourth apex of a bouncing ball", "h₄ = e⁸ h",
         "a ball falls by 1 m, e = 0.8", "the height of the fourth apex, three steps", _apexes),
    Case("impact_on_spring", "A ball on a spring that meets a wall", "x = a eᵏ |cos ωt|",
         "200 g on 80 N/m, e = 0.8, wall at the equilibrium",
         "the largest error of the place, which falls with the square of the step", _on_spring),
)
