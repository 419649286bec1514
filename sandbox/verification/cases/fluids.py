"""Fluid under pressure: a press, a column of oil, flow through valves, a shared line, gas."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.kinds.elements import ATMOSPHERE
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.study.independent import ATOL, RTOL, solve_ivp
from sandbox.study.orders import STEPS
from sandbox.study.plain_mechanisms import fixed, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

AREA = 1e-3


def _run(rams: list[tuple[str, float, float]], duration: float, step: float,
         **elements: Any) -> Recording:
    """Bodies that slide along x: name, mass, place of each."""
    return simulate(mechanism(
        duration=duration, step=step, gravity=(0.0, 0.0),
        bodies=[fixed("ground"), *({"name": name, "mass": m, "inertia": 1e-3, "at": (x, 0.0)}
                                   for name, m, x in rams)],
        joints=[{"type": "slot", "name": f"on_{name}", "a": "ground", "b": name,
                 "start": (-9, 0), "end": (9, 0), "turns": False} for name, _, _ in rams],
        **elements))


def _line(name: str, *areas: tuple[str, float], **more: Any) -> dict[str, Any]:
    return {"name": name, "chambers": [{"type": "cylinder", "a": "ground", "b": b, "area": area}
                                       for b, area in areas], **more}


def _push(body: str, value: float) -> dict[str, Any]:
    return {"type": "force", "name": f"push_{body}", "body": body, "direction": (-1, 0),
            "value": value}


def _press() -> Findings:
    run = _run([("small", 1.0, 0.1), ("large", 10.0, 0.1)], 0.05, 1e-3, lines=[
        _line("oil", ("small", 1e-4), ("large", 1e-3), modulus=1e15)], drives=[_push("small", 20)])
    a, t = 20 / (1 + 10 / 100), float(run.time[-1])
    why = "what is left of the start after 50 steps, the oil's own stretch 1e-15"
    return Findings([
        Check("speed of the small piston", "m/s", -a * t, float(run["small.vx"][-1]), 1e-9, why),
        Check("speed of the large piston", "m/s", a * t / 10, float(run["large.vx"][-1]), 1e-9,
              why),
        Check("pressure", "Pa", a / AREA, float(run["oil.pressure"][-1]), 1e-6 * a / AREA, why)])


def _refined(
    title: str, run: Callable[[float], Recording], truth: Callable[[Array], Array],
    size: tuple[str, float], allowed: Callable[[float], float], why: str,
) -> Findings:
    """Largest errors of the ram's position at three steps, and their order.

    Args:
        title: of the picture.
        run: the engine's, at a step [s].
        truth: position of the ram [m] at times [s].
        size: the distance that errors are divided by: name, value [m].
        allowed: that share of it, at a step [s].
        why: where ``allowed`` comes from.
    """
    checks, curves, errors = [], [], []
    for step in STEPS:
        recording = run(step)
        error = np.abs(recording["ram.x"] - truth(recording.time)) / size[1]
        errors.append(float(error.max()))
        curves.append(Curve(f"h = {1e3 * step:g} ms", 1e3 * recording.time, error))
        checks.append(Check(
            f"largest error at h = {1e3 * step:g} ms, share of the {size[0]}", "1", 0.0,
            errors[-1], allowed(step), why))
    checks.append(Check("order", "1", 2.0, float(np.log2(errors[1] / errors[2])), 0.1,
                        "half the step leaves a quarter of the error"))
    return Findings(checks, [Panel(title, "time [ms]", f"error / {size[0]}", curves)])


def _column() -> Findings:
    """10 kg on a column that stands for a spring of 1e6 N/m: 316 rad/s, ten cycles."""
    c, m, duration = 1e-12, 10.0, 0.2
    omega = float(np.sqrt(AREA**2 / c / m))
    far = 1000 / (m * omega**2)
    return _refined(
        "A weight on a column of oil", lambda step: _run([("ram", m, 0.1)], duration, step, lines=[
            _line("oil", ("ram", AREA), volume=1e-3, modulus=1e9, pressure=2e6)],
            drives=[_push("ram", 1000.0)]),
        lambda t: 0.1 + far * (1 - np.cos(omega * t)), ("deflection", far),
        lambda step: (omega * step) ** 2 / 12 * omega * duration,
        "the trapezoid rule's phase, (ω h)² / 12 of ω t")


def _throttle() -> Findings:
    """Oil that 200 N press out of a cylinder; its rate is 20 / s."""
    m, rate, force, duration = 10.0, 20.0, 200.0, 0.3
    resistance, speed = m * rate / AREA**2, force / (m * rate)
    return _refined(
        "Oil through a throttle", lambda step: _run([("ram", m, 0.5)], duration, step, lines=[
            _line("oil", ("ram", AREA), volume=1e-6, modulus=1e13)],
            valves=[{"name": "throttle", "a": "oil", "resistance": resistance}],
            drives=[_push("ram", force)]),
        lambda t: 0.5 - speed * (t - (1 - np.exp(-rate * t)) / rate), ("travel", speed * duration),
        lambda step: (rate * step) ** 2 / 2 / (rate * duration),
        "BDF2: for a time 1/r the speed is off by (r h)² / 3 of its last value, and after the "
        "first step by (r h)² / 6")


def _filling() -> Findings:
    """Gas from a vessel of 6 bar under a ram on a spring and a damper, 20 rad/s."""
    m, n, load, source, k, c, duration = 10.0, 1.4, 200.0, 6e5, 2000.0, 300.0, 0.5
    volume, start = 2e-4, load / AREA
    law = 7.0 / 2 / (0.6 * 2e-6) ** 2

    def rates(_: float, state: Array) -> list[float]:
        x, v, content = state
        p = ATMOSPHERE * ((content / (volume + AREA * x)) ** n - 1)
        return [v, (p * AREA - load - k * x - c * v) / m,
                float(np.copysign(np.sqrt(abs(source - p) / law), source - p))]

    exact = solve_ivp(
        rates, (0, duration), [0.0, 0.0, volume * (start / ATMOSPHERE + 1) ** (1 / n)],
        method="DOP853", rtol=RTOL, atol=ATOL, dense_output=True).sol
    omega = np.sqrt((k + n * (source + ATMOSPHERE) * AREA**2 / volume) / m)
    return _refined(
        "Gas through an orifice", lambda step: _run([("ram", m, 0.1)], duration, step, lines=[
            _line("gas", ("ram", AREA), gas=n, volume=volume, pressure=start),
            _line("vessel", volume=1e-3, gas=n, pressure=source)],
            valves=[{"name": "orifice", "a": "vessel", "b": "gas", "area": 2e-6, "discharge": 0.6,
                     "density": 7.0}],
            springs=[{"type": "linear", "name": "spring", "a": "ground", "b": "ram",
                      "on_a": (-1, 0), "stiffness": k, "damping": c}],
            drives=[_push("ram", load),
                    {"type": "pressure", "name": "source", "line": "vessel", "value": source}]),
        lambda t: 0.1 + exact(t)[0], ("travel", float(exact(duration)[0])),
        lambda step: (omega * step) ** 2 / 12,
        "the trapezoid rule's phase, (ω h)² / 12 of a radian, by when the damper has it")


def _orifice() -> Findings:
    checks, loads, found = [], (100.0, 400.0, 700.0, 900.0), []
    for load in loads:
        run = _run([("ram", 1.0, 0.1)], 0.2, 1e-3, lines=[
            _line("oil", ("ram", AREA)), _line("source", volume=1e-6)],
            valves=[{"name": "hole", "a": "source", "b": "oil", "area": 1e-6, "discharge": 0.6,
                     "density": 850}],
            drives=[_push("ram", load),
                    {"type": "pressure", "name": "pump", "line": "source", "value": 1e6}])
        flow = 0.6e-6 * float(np.sqrt(2 * (1e6 - load / AREA) / 850))
        found.append(float(run["ram.vx"][-1]))
        checks.append(Check(f"speed against {load:g} N", "m/s", flow / AREA, found[-1],
                            1e-9 * flow / AREA, "Newton's method ends at 1e-9 of the flow"))
    fine = np.linspace(0.0, 1000.0, 200)
    law = 0.6e-6 * np.sqrt(2 * (1e6 - fine / AREA) / 850) / AREA
    return Findings(checks, [Panel("1 MPa through 1 mm²", "load [N]", "speed [mm/s]", [
        Curve("Cd A √(2 Δp / ρ) / area", fine, 1e3 * law),
        Curve("engine", np.array(loads), 1e3 * np.array(found), "points")])])


def _shared() -> Findings:
    """Five unequal pistons against five springs, fed with as much air as they held."""
    areas, stiffness = (1e-4, 2e-4, 3e-4, 4e-4, 5e-4), (1e3, 2.5e3, 3e3, 4.5e3, 5e3)
    run = _run([(f"b{i}", 0.1, 0.1 + 0.1 * i) for i in range(5)], 2.0, 1e-3, lines=[
        _line("air", *((f"b{i}", area) for i, area in enumerate(areas)), gas=1.4, volume=2e-4)],
        springs=[{"type": "linear", "name": f"k{i}", "a": "ground", "b": f"b{i}", "on_a": (-1, 0),
                  "stiffness": k, "damping": 30.0} for i, k in enumerate(stiffness)],
        drives=[{"type": "flow", "name": "pump", "line": "air", "value": {
            "table": [(0, 2e-4), (1.0, 0)], "between": "step"}}])
    p = float(run["air.pressure"][-1])
    checks = [Check(f"travel of piston {i + 1}", "m", p * area / k,
                    float(run[f"b{i}.x"][-1]) - 0.1 - 0.1 * i, 1e-6 * p * area / k,
                    "p A = k x at rest, which springs and dampers come to within 1e-6 in 1 s")
              for i, (area, k) in enumerate(zip(areas, stiffness, strict=True))]
    whole = ATMOSPHERE * 4e-4**1.4
    checks.append(Check(
        "(p + p0) V^1.4", "Pa m^4.2", whole,
        (p + ATMOSPHERE) * float(run["air.volume"][-1]) ** 1.4, 1e-5 * whole,
        "of 0.4 l of free air; the law is taken straight within a step, (ΔV / V)² of it"))
    return Findings(checks)


CASES = (
    Case("press", "A press of one to ten", "p = F₁/A₁ = F₂/A₂, v₁ A₁ = v₂ A₂",
         "two pistons on one line of stiff oil, h = 1 ms",
         "speeds and pressure with the closed form", _press),
    Case("oil_column", "A weight on a column of oil", "k = A²/C, x = x₀ (1 − cos ω t)",
         "10 kg on a cylinder that is shut, 316 rad/s, ten cycles",
         "the motion with the cosine, at three steps", _column),
    Case("throttle", "Oil through a throttle", "m v' = F − R A² v: v = v₁ (1 − exp(−r t)), "
         "r = R A²/m", "a ram that presses stiff oil through a throttle, r = 20 / s",
         "the motion with the closed form, at three steps", _throttle),
    Case("filling", "Gas through an orifice into a cylinder",
         "M' = C_d A √(2 Δp/ρ), p + p₀ = p₀ (M/V)ⁿ, m x'' = p A − F − k x − c x'",
         "a ram on a spring and a damper, lifted by gas from a vessel of 6 bar",
         "the motion with an integration of the three equations, at three steps", _filling),
    Case("orifice", "An orifice", "Q = C_d A √(2 Δp/ρ)",
         "a piston that 1 MPa feeds through 1 mm², against four loads, h = 1 ms",
         "speeds with the closed form", _orifice),
    Case("shared_line", "Five pistons on one line of air", "p Aᵢ = kᵢ xᵢ, (p + p₀) Vⁿ = const",
         "five unequal pistons against springs, pumped with air, h = 1 ms",
         "travels with the shared pressure, pressure with the gas law", _shared),
)
