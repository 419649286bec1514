"""Impacts at their instants within the step: rows of balls, rough bodies, a ball on a spring.

The references go from impact to impact: free flight in closed form, the instant of the next impact
as a root, Newton's law with Coulomb friction there. None of them has a step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from tests.support.mechanisms import G, Json, fixed, pin, simulated, spring

from .case import STEPS, Check, case

PLACED = ("pymunk finds normals to some 10⁻⁸, sticking impulses are accurate to 10⁻⁷; impacts and "
          "turns multiply both")


def struck(step: float, duration: float, bodies: list[Json], e: float, mu: float,
           g: float = G, **more: Any) -> Recording:
    return simulated(
        duration, step, g=g, every_step=True, materials={"m": {"restitution": e, "friction": mu}},
        bodies=[{"material": "m", **body} for body in bodies], **more)


FLOOR = fixed("floor", shapes=[{"type": "box", "size": (8.0, 0.2), "at": (0.0, -0.1)}])


def in_turn(m: Array, x: Array, v: Array, e: float) -> Array:
    """Velocities of balls of 10 mm after all impacts, one after the other."""
    x, v = x.copy(), v.copy()
    while True:
        approach = -np.diff(v)
        time = np.full(len(approach), np.inf)
        near = approach > 1e-9
        time[near] = np.maximum(np.diff(x) - 0.02, 0.0)[near] / approach[near]
        k = int(np.argmin(time))
        if not math.isfinite(time[k]):
            return v
        x += time[k] * v
        p = (1 + e) * approach[k] / (1 / m[k] + 1 / m[k + 1])
        v[k:k + 2] += [-p / m[k], p / m[k + 1]]


@case("Rows of balls with gaps", "v₂′ − v₁′ = −e (v₂ − v₁)",
      "4 and 5 balls, gaps 0 to 1 mm, the first at 1 m/s, h = 0.5 ms; impacts one after the other")
def test_impact_cradles() -> Iterator[Check]:
    for masses, e in (((0.05,) * 5, 1.0), ((0.05,) * 5, 0.9), ((0.05,) * 5, 0.5),
                      ((0.05, 0.1, 0.05, 0.03, 0.05), 1.0), ((0.15, 0.05, 0.05, 0.05), 1.0)):
        expected, found = [], []
        for gap in (0.0, 1e-5, 5e-5, 1e-4, 1e-3):
            x = np.arange(len(masses)) * (0.02 + gap)
            x[0] = -0.0113
            v = np.eye(len(masses))[0]
            expected.append(in_turn(np.array(masses), x, v, e))
            run = struck(5e-4, 0.15, [
                {"name": f"b{i}", "mass": m, "at": (float(x[i]), 0.0), "velocity": (float(v[i]), 0),
                 "shapes": [{"type": "circle", "radius": 0.01}]} for i, m in enumerate(masses)],
                e, 0.0, g=0.0)
            found.append([run[f"b{i}.vx"][-1] for i in range(len(masses))])
        yield Check(f"velocities, {' : '.join(f'{1e3 * m:g}' for m in masses)} g, e = {e:g}", "m/s",
                    expected, found, 1e-8 if e == 1 else 0.01,
                    "impulses are accurate to 10⁻¹⁰ of them" if e == 1
                    else "approaches slower than 1 cm/s are plastic")


E, MU, MASS = 0.7, 0.5, 0.4
Arm = Callable[[float], Array]
"""From the centre to the lowest point, by the angle."""


def lowest_corner(angle: float) -> Array:
    """Of a box of 100 mm by 60 mm."""
    turn = complex(math.cos(angle), math.sin(angle))
    low = min((turn * complex(x, y) for x in (0.05, -0.05) for y in (0.03, -0.03)),
              key=lambda corner: corner.imag)
    return np.array([low.real, low.imag])


def flight(state: Array, t: float) -> Array:
    """Position, angle and their rates after a time, shape [6]."""
    result = state.copy()
    result[:3] += t * state[3:]
    result[1] -= G * t * t / 2
    result[4] -= G * t
    return result


def impact(state: Array, r: Array, inertia: float) -> Array:
    """Newton's law of the normal, Coulomb's of the tangential velocity at the end of the impact."""
    un, ut = state[4] + state[5] * r[0], state[3] - state[5] * r[1]
    nn, tt = 1 / MASS + r[0]**2 / inertia, 1 / MASS + r[1]**2 / inertia
    nt = -r[0] * r[1] / inertia
    pn, pt = np.linalg.solve([[nn, nt], [nt, tt]], [-(1 + E) * un, -ut])
    if abs(pt) > MU * pn:
        sign = math.copysign(1.0, pt)
        pn = -(1 + E) * un / (nn + nt * MU * sign)
        pt = sign * MU * pn
    result = state.copy()
    result[3:] += pt / MASS, pn / MASS, (r[0] * pn - r[1] * pt) / inertia
    return result


def bounced(state: Array, arm: Arm, inertia: float, end: float) -> Array:
    """State at ``end`` [s], from impact to impact."""
    def height(t: float) -> float:
        now = flight(state, t)
        return float(now[1] + arm(now[2])[1])

    while True:
        low = 1e-6
        while low < end and height(low + 1e-4) > 0:
            low += 1e-4
        instant = end if low >= end else float(brentq(height, low, low + 1e-4, xtol=1e-16))
        if instant >= end:
            return flight(state, end)
        state, end = flight(state, instant), end - instant
        state = impact(state, arm(float(state[2])), inertia)


def above_floor(shape: Json, arm: Arm, inertia: float, start: list[float], end: float,
                ) -> Iterator[Check]:
    for step in STEPS:
        run = struck(step, end, [FLOOR, {
            "name": "b", "mass": MASS, "inertia": inertia, "at": start[:2], "angle": start[2],
            "velocity": start[3:5], "angular_velocity": start[5], "shapes": [shape]}], E, MU)
        truth = bounced(np.array(start), arm, inertia, float(run.time[-1]))
        size = np.repeat(np.abs(truth.reshape(2, 3)).max(axis=1), 3)
        found = np.array([run[f"b.{key}"][-1] for key in ("x", "y", "angle", "vx", "vy", "omega")])
        yield Check(f"pose and velocity, relative, h = {1e3 * step:g} ms", "1", truth / size,
                    found / size, 1e-5, PLACED)


@case("Disc that lands spinning, three bounces", "v_n′ = −e v_n, |p_t| ≤ μ p_n",
      "a disc of 400 g and 100 mm, e = 0.7, μ = 0.5, three steps")
def test_impact_disc() -> Iterator[Check]:
    yield from above_floor({"type": "circle", "radius": 0.05}, lambda _: np.array([0.0, -0.05]),
                           MASS * 0.05**2 / 2, [0.0, 0.3, 0.0, -2.0, 0.0, -40.0], 0.9)


@case("Box that lands on a corner", "v_n′ = −e v_n, |p_t| ≤ μ p_n",
      "a box of 400 g, 100 mm by 60 mm, e = 0.7, μ = 0.5, three steps")
def test_impact_box() -> Iterator[Check]:
    yield from above_floor({"type": "box", "size": (0.1, 0.06)}, lowest_corner,
                           MASS * (0.1**2 + 0.06**2) / 12, [0.0, 0.15, 0.5, 0.6, -1.0, 1.5], 0.22)


@case("Two free rough discs", "v_n′ = −e v_n, |p_t| ≤ μ p_n",
      "discs of 300 g and 200 g that meet obliquely with spin, e = 0.8, μ = 0.4, three steps")
def test_impact_discs() -> Iterator[Check]:
    e, mu = 0.8, 0.4
    (m, r, x0, v0, w0), (n, s, y0, u0, q0) = (
        (0.3, 0.05, np.zeros(2), np.array([1.0, 0.2]), 25.0),
        (0.2, 0.03, np.array([0.2, 0.031]), np.array([-0.8, -0.3]), -12.0))
    apart, way = y0 - x0, u0 - v0
    a, b, c = way @ way, apart @ way, apart @ apart - (r + s)**2
    hit = (-b - math.sqrt(b * b - a * c)) / a
    x, y = x0 + hit * v0, y0 + hit * u0
    normal = (y - x) / (r + s)
    along = np.array([-normal[1], normal[0]])
    pn = -(1 + e) * (way @ normal) / (1 / m + 1 / n)
    slip = way @ along - w0 * r - q0 * s
    pt = float(np.clip(-slip / (3 / m + 3 / n), -mu * pn, mu * pn))
    p = pn * normal + pt * along
    v, u = v0 - p / m, u0 + p / n
    for step in STEPS:
        run = struck(step, 0.2, [
            {"name": name, "mass": kilograms, "inertia": kilograms * radius**2 / 2,
             "at": tuple(at), "velocity": tuple(velocity), "angular_velocity": omega,
             "shapes": [{"type": "circle", "radius": radius}]}
            for name, kilograms, radius, at, velocity, omega in (
                ("a", m, r, x0, v0, w0), ("b", n, s, y0, u0, q0))], e, mu, g=0.0)
        left = float(run.time[-1]) - hit
        truth = np.array([[*(x + left * v), *v, w0 - 2 * pt / (m * r)],
                          [*(y + left * u), *u, q0 - 2 * pt / (n * s)]])
        found = np.array([[run[f"{name}.{key}"][-1] for key in ("x", "y", "vx", "vy", "omega")]
                          for name in "ab"])
        size = np.abs(truth).max(axis=0)
        yield Check(f"position and velocity, relative, h = {1e3 * step:g} ms", "1", truth / size,
                    found / size, 1e-6, PLACED)


@case("Ball on a spring that meets a wall", "x = a eᵏ |cos ωt|",
      "200 g on 80 N/m, e = 0.8, wall at the equilibrium, three steps")
def test_impact_on_spring() -> Iterator[Check]:
    a, k, m, e, radius = 0.1, 80.0, 0.2, 0.8, 0.02
    omega = math.sqrt(k / m)
    quarter = math.pi / 2 / omega
    for step in STEPS:
        run = struck(step, 4.6 * quarter, [
            fixed("wall", shapes=[{"type": "box", "size": (0.2, 1.0), "at": (-0.1 - radius, 0.0)}]),
            {"name": "b", "mass": m, "inertia": 1e-4, "at": (a, 0.0),
             "shapes": [{"type": "circle", "radius": radius}]}], e, 0.0, g=0.0,
            springs=[spring("s", "wall", "b", on_a=(-1.0, 0.0), stiffness=k, rest_length=1.0)])
        hits = np.floor((run.time / quarter + 1) / 2)
        yield Check(f"position in amplitudes, h = {1e3 * step:g} ms", "1",
                    e**hits * np.abs(np.cos(omega * run.time)), run["b.x"] / a,
                    (omega * step)**2 * (1 + e + omega * run.time[-1] / 24),
                    "each impact has the spring's force of the path before it for the rest of its "
                    "step, (1 + e) (ωh)²/2; the leapfrog is ahead by ωt (ωh)²/24")


@case("Pendulum that meets a slanted wall", "θ′⁺ = −e θ′⁻ at the instant of the impact",
      "a bob of 200 g and 40 mm on a rod of 300 mm, e = 0.7, eight starts, three steps")
def test_impact_pendulum() -> Iterator[Check]:
    length, radius, wall, slant, e, m, inertia = 0.3, 0.02, 0.1, 0.5, 0.7, 0.2, 0.002
    normal = np.array([math.cos(slant), math.sin(slant)])
    centre = 0.8 * length
    rate = m * G * centre / (inertia + m * centre**2)

    def gap(angle: float) -> float:
        return float(wall - radius - length * normal @ [math.sin(angle), -math.cos(angle)])

    def truth(angle: float, end: float) -> Array:
        state, now = np.array([angle, 0.0]), 0.0
        hit: Any = lambda t, y: gap(y[0])  # noqa: E731
        hit.terminal, hit.direction = True, -1
        while True:
            found = solve_ivp(lambda t, y: [y[1], -rate * math.sin(y[0])], [now, end], state,
                              rtol=1e-12, atol=1e-13, events=hit)
            now, state = float(found.t[-1]), found.y[:, -1]
            if found.status != 1:
                return state
            state = np.array([state[0], -e * state[1]])

    for step in STEPS:
        expected, found = [], []
        for start in -1.2 + 0.0113 * np.arange(8):
            run = struck(step, 0.55, [
                fixed("wall", angle=slant, at=tuple((wall + 0.5) * normal), shapes=[
                    {"type": "box", "size": (1.0, 4.0)}]),
                {"name": "bob", "mass": m, "inertia": inertia, "centre": (0.0, -centre),
                 "angle": float(start), "shapes": [
                     {"type": "circle", "radius": radius, "at": (0.0, -length)}]}], e, 0.0,
                joints=[pin("pin", "wall", "bob", on_b=(0.0, 0.0), collide=True)])
            expected.append(truth(start, float(run.time[-1])))
            found.append([run["bob.angle"][-1], run["bob.omega"][-1]])
        fastest = float(np.abs(expected).max())
        yield Check(f"angle and rate, h = {1e3 * step:g} ms", "rad, rad/s", expected, found,
                    fastest * rate * step**2, "(ω h)² of the largest rate, as of smooth forces")


@case("Pendulum against a stop, mass on a rope that becomes taut", "v_n⁺ = 0 at the instant",
      "eight starts of each, three steps; the pendulum falls back from its stop, the mass swings")
def test_impact_without_restitution() -> Iterator[Check]:
    m, inertia, arm, limit, length = 0.2, 5e-4, 0.1, 0.1, 0.3
    rate = m * G * arm / (inertia + m * arm**2)

    def until(acceleration: float, angle: float, speed: float, end: float,
              stop: float = math.inf) -> Any:
        hit: Any = lambda t, y: y[0] - stop  # noqa: E731
        hit.terminal = True
        return solve_ivp(lambda t, y: [y[1], -acceleration * math.sin(y[0])], [0.0, end],
                         [angle, speed], rtol=1e-12, atol=1e-13, events=hit)

    for step in STEPS:
        expected, found = [], []
        for k in range(8):
            start, height = -1.0 - 0.0013 * k, -0.05 - 0.0013 * k
            run = simulated(0.6, step, g=G, every_step=True, bodies=[
                fixed("wall"),
                {"name": "bob", "mass": m, "inertia": inertia, "centre": (0.0, -arm),
                 "angle": start},
                {"name": "ball", "mass": m, "inertia": 1e-5, "at": (0.0, height),
                 "velocity": (0.8, 0.0)}], joints=[
                pin("pin", "wall", "bob", on_b=(0.0, 0.0), limits=(-3.0, limit)),
                {"type": "rope", "name": "rope", "a": "wall", "b": "ball", "on_a": (0.0, 0.0),
                 "on_b": (0.0, 0.0), "longest": length}])
            end = float(run.time[-1])
            first = until(rate, start, 0.0, end, limit)
            swing = until(rate, limit, 0.0, end - first.t[-1]).y[0, -1]
            taut = brentq(lambda t, y=height: math.hypot(0.8 * t, y - G * t * t / 2) - length,
                          0.01, 0.4, xtol=1e-15)
            x, y = 0.8 * taut, height - G * taut**2 / 2
            turn = (x * -G * taut - y * 0.8) / length**2
            hangs = until(G / length, math.atan2(x, -y), turn, end - taut).y[0, -1]
            expected.append([swing, hangs])
            found.append([run["bob.angle"][-1], math.atan2(run["ball.x"][-1], -run["ball.y"][-1])])
        yield Check(f"angles, h = {1e3 * step:g} ms", "rad", expected, found,
                    rate * step**2, "(ω h)² of a radian, as of smooth forces")
