"""Fluid under pressure: a press, a column of oil, flow through valves, a shared line, gas."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from sandbox.elements.element import ATMOSPHERE
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from tests.support.mechanisms import Json, fixed, force, simulated, spring
from tests.support.reference import integrate

from .case import STEPS, Check, case

AREA = 1e-3


def rams(bodies: list[tuple[str, float, float]], duration: float, step: float,
         **elements: Any) -> Recording:
    """Recording of bodies that slide along x: name, mass, place of each."""
    return simulated(
        duration, step,
        bodies=[fixed("ground"), *({"name": name, "mass": m, "inertia": 1e-3, "at": (x, 0.0)}
                                   for name, m, x in bodies)],
        joints=[{"type": "slot", "name": f"on_{name}", "a": "ground", "b": name,
                 "start": (-9, 0), "end": (9, 0), "turns": False} for name, _, _ in bodies],
        **elements)


def line(name: str, *areas: tuple[str, float], **more: Any) -> Json:
    return {"name": name, "chambers": [{"type": "cylinder", "a": "ground", "b": b, "area": area}
                                       for b, area in areas], **more}


def push(body: str, value: float) -> Json:
    return force(f"push_{body}", body, (-1, 0), value)


@case("Press of one to ten", "p = F₁/A₁ = F₂/A₂, v₁ A₁ = v₂ A₂",
      "two pistons on one line of stiff oil, h = 1 ms")
def test_press() -> Iterator[Check]:
    run = rams([("small", 1.0, 0.1), ("large", 10.0, 0.1)], 0.05, 1e-3, drives=[push("small", 20)],
               lines=[line("oil", ("small", 1e-4), ("large", 1e-3), modulus=1e15)])
    a, t = 20 / (1 + 10 / 100), float(run.time[-1])
    yield Check("speeds of the pistons", "m/s", [-a * t, a * t / 10],
                [run["small.vx"][-1], run["large.vx"][-1]], 1e-9,
                "decay of the start after 50 steps; the oil's own stretch is 1e-15")
    yield Check("pressure", "Pa", a / AREA, run["oil.pressure"][-1], 1e-6 * a / AREA, "the same")


def refined(run: Callable[[float], Recording], truth: Callable[[Array], Array], what: str,
            size: float, allowed: Callable[[float], float], why: str) -> Iterator[Check]:
    """Errors of the ram's position by ``size`` [m] at three steps, and their order."""
    errors = []
    for step in STEPS:
        recording = run(step)
        error = (recording["ram.x"] - truth(recording.time)) / size
        errors.append(np.abs(error).max())
        yield Check(f"error by the {what}, h = {1e3 * step:g} ms", "1", 0.0, error, allowed(step),
                    why)
    yield Check("order of accuracy, 0.5 to 0.25 ms", "1", 2.0, np.log2(errors[1] / errors[2]), 0.1,
                "half the step leaves a quarter of the error")


@case("Weight on a column of oil", "k = A²/C, x = x₀ (1 − cos ω t)",
      "10 kg on a closed cylinder, 316 rad/s, ten cycles")
def test_oil_column() -> Iterator[Check]:
    c, m, duration = 1e-12, 10.0, 0.2
    omega = float(np.sqrt(AREA**2 / c / m))
    far = 1000 / (m * omega**2)
    yield from refined(
        lambda step: rams([("ram", m, 0.1)], duration, step, drives=[push("ram", 1000.0)], lines=[
            line("oil", ("ram", AREA), volume=1e-3, modulus=1e9, pressure=2e6)]),
        lambda t: 0.1 + far * (1 - np.cos(omega * t)), "deflection", far,
        lambda step: (omega * step)**2 / 12 * omega * duration,
        "the trapezoid rule's phase, (ω h)²/12 of ω t")


@case("Oil through a throttle", "m v′ = F − R A² v: v = v₁ (1 − e^(−r t)), r = R A²/m",
      "a ram that presses stiff oil through a throttle with 200 N, r = 20 / s")
def test_throttle() -> Iterator[Check]:
    m, rate, load, duration = 10.0, 20.0, 200.0, 0.3
    speed = load / (m * rate)
    yield from refined(
        lambda step: rams([("ram", m, 0.5)], duration, step, drives=[push("ram", load)], lines=[
            line("oil", ("ram", AREA), volume=1e-6, modulus=1e13)],
            valves=[{"name": "throttle", "a": "oil", "resistance": m * rate / AREA**2}]),
        lambda t: 0.5 - speed * (t - (1 - np.exp(-rate * t)) / rate), "travel", speed * duration,
        lambda step: (rate * step)**2 / 2 / (rate * duration),
        "BDF2: for a time 1/r the speed is off by (r h)²/3 of its last value, and after the first "
        "step by (r h)²/6")


@case("Gas through an orifice into a cylinder",
      "M′ = C_d A √(2 Δp/ρ), p + p₀ = p₀ (M/V)ⁿ, m x″ = p A − F − k x − c x′",
      "a ram on a spring and a damper, lifted by gas of 6 bar; integration of order 8")
def test_filling() -> Iterator[Check]:
    m, n, load, source, k, c, duration = 10.0, 1.4, 200.0, 6e5, 2000.0, 300.0, 0.5
    volume, start = 2e-4, load / AREA
    law = 7.0 / 2 / (0.6 * 2e-6)**2

    def rates(_: float, state: Array) -> list[float]:
        x, v, content = state
        p = ATMOSPHERE * ((content / (volume + AREA * x))**n - 1)
        return [v, (p * AREA - load - k * x - c * v) / m,
                float(np.copysign(np.sqrt(abs(source - p) / law), source - p))]

    def exact(t: Array) -> Array:
        return integrate(rates, [0.0, 0.0, volume * (start / ATMOSPHERE + 1)**(1 / n)], t)[:, 0]

    omega = np.sqrt((k + n * (source + ATMOSPHERE) * AREA**2 / volume) / m)
    yield from refined(
        lambda step: rams([("ram", m, 0.1)], duration, step, lines=[
            line("gas", ("ram", AREA), gas=n, volume=volume, pressure=start),
            line("vessel", volume=1e-3, gas=n, pressure=source)],
            valves=[{"name": "orifice", "a": "vessel", "b": "gas", "area": 2e-6, "discharge": 0.6,
                     "density": 7.0}],
            springs=[spring("spring", "ground", "ram", on_a=(-1, 0), stiffness=k, damping=c)],
            drives=[push("ram", load),
                    {"type": "pressure", "name": "source", "line": "vessel", "value": source}]),
        lambda t: 0.1 + exact(t), "travel", float(exact(np.array([duration]))[0]),
        lambda step: (omega * step)**2 / 12,
        "the trapezoid rule's phase, (ω h)²/12 of a radian, by when the damper has it")


@case("Orifice", "Q = C_d A √(2 Δp/ρ)",
      "a piston that 1 MPa feeds through 1 mm², against four loads, h = 1 ms")
def test_orifice() -> Iterator[Check]:
    for load in (100.0, 400.0, 700.0, 900.0):
        run = rams([("ram", 1.0, 0.1)], 0.2, 1e-3, lines=[
            line("oil", ("ram", AREA)), line("source", volume=1e-6)],
            valves=[{"name": "hole", "a": "source", "b": "oil", "area": 1e-6, "discharge": 0.6,
                     "density": 850}],
            drives=[push("ram", load),
                    {"type": "pressure", "name": "pump", "line": "source", "value": 1e6}])
        speed = 0.6e-6 * float(np.sqrt(2 * (1e6 - load / AREA) / 850)) / AREA
        yield Check(f"speed against {load:g} N", "m/s", speed, run["ram.vx"][-1], 1e-9 * speed,
                    "Newton's method ends at 1e-9 of the flow")


@case("Five pistons on one line of air", "p Aᵢ = kᵢ xᵢ, (p + p₀) Vⁿ = const",
      "five unequal pistons against springs, pumped with as much air as they held, h = 1 ms")
def test_shared_line() -> Iterator[Check]:
    areas, stiffness = (1e-4, 2e-4, 3e-4, 4e-4, 5e-4), (1e3, 2.5e3, 3e3, 4.5e3, 5e3)
    run = rams([(f"b{i}", 0.1, 0.1 + 0.1 * i) for i in range(5)], 2.0, 1e-3, lines=[
        line("air", *((f"b{i}", area) for i, area in enumerate(areas)), gas=1.4, volume=2e-4)],
        springs=[spring(f"k{i}", "ground", f"b{i}", on_a=(-1, 0), stiffness=k, damping=30.0)
                 for i, k in enumerate(stiffness)],
        drives=[{"type": "flow", "name": "pump", "line": "air", "value": {
            "table": [(0, 2e-4), (1.0, 0)], "between": "step"}}])
    p = float(run["air.pressure"][-1])
    travel = p * np.divide(areas, stiffness)
    yield Check("travels", "m", travel, [run[f"b{i}.x"][-1] - 0.1 - 0.1 * i for i in range(5)],
                1e-6 * travel, "springs and dampers come within 1e-6 of rest in 1 s")
    whole = ATMOSPHERE * 4e-4**1.4
    yield Check("(p + p₀) V^1.4", "Pa m^4.2", whole,
                (p + ATMOSPHERE) * run["air.volume"][-1]**1.4, 1e-5 * whole,
                "of 0.4 l of free air; the law is linear within a step, (ΔV / V)² of it")
