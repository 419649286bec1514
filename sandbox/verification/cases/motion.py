"""Whole motions: a closing finger against an independent integration, textbook machines."""

from __future__ import annotations

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.scene.elements.tendons import RIGID
from sandbox.study import independent as reference
from sandbox.study.plain_mechanisms import G, cord, finger, fixed, mass, mechanism
from sandbox.study.reference_fingers import SET_G
from sandbox.verification.cases.case import Case, Check, Findings
from sandbox.verification.cases.closing import angles

H = 5e-4


def _free_closing() -> Findings:
    checks, curves, panels = [], [], []
    for step, allowed in ((1e-3, None), (5e-4, 6e-3), (2.5e-4, 1.5e-3)):
        run = simulate(finger(SET_G, pull=3.0, duration=0.06, step=step, stops=False))
        truth = reference.integrate(SET_G, run.time, pull=3.0)
        error = np.degrees(np.abs(angles(run) - truth.angle))
        ms = 1e3 * run.time
        curves.append(Curve(f"h = {1e3 * step:g} ms", ms, error.max(axis=1)))
        if allowed is not None:
            checks.append(Check(f"largest error of any joint at h = {1e3 * step:g} ms", "deg", 0.0,
                                float(error.max()), allowed, "what the project asks at 0.5 ms, "
                                "and a quarter of it at half the step"))
        if step == 5e-4:
            panels.append(Panel("Joint angles, h = 0.5 ms", "time [ms]", "angle [deg]", [
                c for i in range(3) for c in (
                    Curve(f"joint {i + 1}, integrated", ms, np.degrees(truth.angle[:, i])),
                    Curve(f"joint {i + 1}, engine", ms[::3], np.degrees(angles(run)[::3, i]),
                          "points"))]))
    panels.append(Panel("Largest error of any joint", "time [ms]", "error [deg]", curves))
    return Findings(checks, panels)


def _crossings(time: Array, value: Array) -> Array:
    """Instants [s] at which ``value`` goes through 0, by straight lines between samples."""
    i = np.flatnonzero(np.diff(np.sign(value)))
    return np.asarray(time[i] - value[i] * (time[i + 1] - time[i]) / (value[i + 1] - value[i]))


def _pendulum() -> Findings:
    length, kilograms, inertia = 0.1, 0.05, 2e-5
    pivot = inertia + kilograms * length**2
    omega = float(np.sqrt(kilograms * G * length / pivot))
    checks, shown = [], []
    swings = (5.0, 30.0, 60.0, 90.0, 120.0, 150.0)
    for degrees in swings:
        amplitude = float(np.radians(degrees))
        period = reference.pendulum_period(length, inertia, kilograms, amplitude, G)
        run = simulate(mechanism(
            duration=2.2 * period, step=H, gravity=(0.0, -G),
            bodies=[fixed("wall"), {"name": "rod", "mass": kilograms, "inertia": inertia,
                                    "angle": amplitude, "centre": (0.0, -length)}],
            joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "rod", "on_a": (0.0, 0.0)}]))
        through = _crossings(run.time, run["pin.angle"])
        shown.append(float(through[2] - through[0]))
        checks.append(Check(f"period at {degrees:g} deg", "s", period, shown[-1],
                            period * (omega * H)**2,
                            "(ω h)² of a period: the scheme's (ω h)²/24, up to four times that at "
                            "the bottom of a large swing, and the straight line between samples"))
    fine = np.linspace(1.0, 160.0, 80)
    curve = [reference.pendulum_period(length, inertia, kilograms, float(np.radians(d)), G)
             for d in fine]
    return Findings(checks, [Panel("Period of a pendulum", "amplitude [deg]", "period [s]", [
        Curve("4 √(I/mgl) K", fine, np.array(curve)),
        Curve("engine", np.array(swings), np.array(shown), "points")])])


def _atwood() -> Findings:
    checks, found = [], []
    light = (0.04, 0.08, 0.12, 0.16)
    for kilograms in light:
        run = simulate(mechanism(
            duration=0.3, step=H, gravity=(0.0, -G),
            bodies=[fixed("beam"), mass("heavy", 0.2, (0.0, -0.5)),
                    mass("light", kilograms, (0.1, -0.9))],
            tendons=[cord("cord", ("heavy",), ("beam", (0.0, 0.0)), ("beam", (0.1, 0.0)),
                          ("light",), stiffness=RIGID)]))
        a, tension = reference.atwood(0.2, kilograms, G)
        late = run.time > 0.2
        fitted = 2 * np.polyfit(run.time[late], run["heavy.y"][late], 2)[0]
        found.append(float(run["cord.tension"][-1]))
        checks += [
            Check(f"tension with {1e3 * kilograms:g} g", "N", tension, found[-1], 1e-6 * tension,
                  "the cord's ringing has died away by 1e-6 after 0.2 s"),
            Check(f"acceleration with {1e3 * kilograms:g} g", "m/s^2", -a, float(fitted), 1e-5 * G,
                  "a parabola fitted to positions")]
    fine = np.linspace(0.02, 0.19, 40)
    return Findings(checks, [Panel("Atwood's machine, 200 g on one side", "other mass [g]",
                                   "tension [N]", [
        Curve("2 m₁ m₂ g/(m₁ + m₂)", 1e3 * fine,
              np.array([reference.atwood(0.2, float(m), G)[1] for m in fine])),
        Curve("engine", 1e3 * np.array(light), np.array(found), "points")])])


CASES = (
    Case("free_closing", "A finger closing freely", "M q'' = T h − k Δlm hm − d q' − C",
         "finger of Set G under 3 N for 0.06 s",
         "joint angles with an integration in minimal coordinates, of order 8 (DOP853), that "
         "shares no code with the engine", _free_closing),
    Case("pendulum", "Pendulum of any swing", "T = 4 √(I/(m g l)) K(sin²(A/2))",
         "a rod on a pin, h = 0.5 ms", "periods with the complete elliptic integral", _pendulum),
    Case("atwood", "Atwood's machine", "T = 2 m₁ m₂ g/(m₁ + m₂)",
         "two masses on a cord over two eyes, h = 0.5 ms",
         "tension and acceleration with the closed form", _atwood),
)
