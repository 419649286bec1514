"""Equations (1)-(7): pulleys and rockers that share one pull."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.mechanics import differential
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import verdicts
from sandbox.scene.elements.tendons import RIGID
from sandbox.scene.read.load import load_scene
from sandbox.study.plain_mechanisms import G, cord, fixed, mass, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

LOADS = 4


def _tree(scene: str) -> Findings:
    """A shipped scene's own expectations, of which every one is a closed form."""
    run = simulate(load_scene(scene))
    checks = [Check(f"{v.statistic} of {v.quantity}", v.unit, (v.low + v.high) / 2, v.value,
                    (v.high - v.low) / 2, v.because) for v in verdicts(run)]
    travel = np.stack([-run[f"load{i + 1}.x"] for i in range(LOADS)], axis=1)
    s = run.time
    return Findings(checks, [
        Panel("Tensions, less a quarter of the pull", "time [s]", "T − F/4 [mN]", [
            Curve(f"string {i + 1}", s, 1e3 * (
                run[f"tree.string{i + 1}.tension"] - run["actuator.value"] / 4))
            for i in range(LOADS)]),
        Panel("Travel: the pull's is the mean", "time [s]", "travel [mm]", [
            *(Curve(f"load {i + 1}", s, 1e3 * travel[:, i]) for i in range(LOADS)),
            Curve("mean of the loads, (7)", s, 1e3 * travel.mean(axis=1), "dashed"),
            Curve("pull, engine", s[::60], 1e3 * run["X_P"][::60], "points")]),
    ])


def _winding() -> Findings:
    radius, angle, kilograms = 0.02, 1.5, 0.1
    run = simulate(mechanism(
        duration=1.2, step=5e-4, gravity=(0.0, -G),
        bodies=[
            {"name": "wheel", "motion": "scheduled",
             "path": {"angle": {"expression": f"=-{angle} * (1 - cos(pi * clip(t, 0, 1))) / 2"}}},
            mass("load", kilograms, (radius, -0.5))],
        tendons=[cord("cord", ("wheel", (0.0, 0.0), radius, "right"), ("load",), stiffness=RIGID,
                      damping=20.0)]))
    stretch = kilograms * G / RIGID
    moved = run["load.y"] + 0.5
    x_1, _ = differential.pulley_ends(0.0, run["wheel.angle"], radius)
    expected = -np.asarray(x_1)
    return Findings([
        Check("load lifted by the wheel's turn of 1.5 rad", "m", radius * angle,
              abs(float(moved[-1] + stretch)), 2e-6,
              "the cord's stretch T / k differs by m a / k < 1 μm between start and end"),
        Check("tension at the end", "N", kilograms * G, float(run["cord.tension"][-1]),
              1e-3 * kilograms * G, "the load hangs still but for what is left of the ramp"),
    ], [Panel("A cord wound on a wheel", "time [s]", "load lifted [mm]", [
        Curve("R θ, (1)", run.time, 1e3 * np.abs(expected)),
        Curve("engine", run.time[::60], 1e3 * np.abs(moved + stretch)[::60], "points")])])


def _damped(body: str, at: tuple[float, float]) -> list[dict[str, Any]]:
    """Dampers without stiffness from a body to the wall along x and y."""
    x, y = at
    return [{"type": "linear", "name": f"{body}.damper{i}", "a": "wall", "b": body,
             "on_a": far, "stiffness": 0.0, "damping": 6.0}
            for i, far in enumerate([(x + 1.0, y), (x, y + 1.0)])]


def _rocker_run(a: float, b: float, pull: float) -> Recording:
    return simulate(mechanism(
        duration=2.0, step=5e-4,
        bodies=[fixed("wall"), {"name": "rocker", "mass": 0.05, "inertia": 2e-5, "at": (0.0, 0.5)}],
        springs=_damped("rocker", (0.0, 0.5)),
        tendons=[cord("main", ("rocker",), ("wall", (0.0, 1.0))),
                 cord("first", ("rocker", (-a, 0.0)), ("wall", (-a, 0.0)), stiffness=900.0,
                      damping=3.0),
                 cord("second", ("rocker", (b, 0.0)), ("wall", (b, 0.0)), stiffness=700.0,
                      damping=3.0)],
        drives=[{"type": "pull", "name": "actuator", "tendon": "main", "value": pull}]))


def _rocker() -> Findings:
    pull, checks, shares = 8.0, [], []
    arms = [(0.03, 0.03), (0.025, 0.03), (0.02, 0.03), (0.015, 0.03)]
    for a, b in arms:
        run = _rocker_run(a, b, pull)
        found = [float(run[f"{name}.tension"][-1]) for name in ("first", "second")]
        expected = [float(t) for t in differential.rocker_tensions(pull, a, b)]
        shares.append((a / b, found[0] / pull))
        # strings of 0.5 m lean by what the rocker's tilt moves its pins sideways
        lean = (a + b) * (1 - np.cos(run["rocker.angle"][-1])) / 0.5
        slack = pull * float(max(lean, 1e-7) + abs(run["rocker.x"][-1]) / 0.5)
        checks += [
            Check(f"tension {i + 1}, arms {1e3 * a:g} and {1e3 * b:g} mm", "N", expected[i],
                  found[i], slack, "the strings lean a little as the rocker tilts: pull times lean")
            for i in (0, 1)]
    ratio, found_1 = np.array(shares).T
    fine = np.linspace(0.45, 1.05, 50)
    return Findings(checks, [Panel("Share of the pull on the first arm", "a / b [1]",
                                   "T₁ / F [1]", [
        Curve("b / (a + b)", fine, 1 / (1 + fine)), Curve("engine", ratio, found_1, "points")])])


CASES = (
    Case("pulley_wheel", "A wheel winds its cord", "(1)–(3)",
         "a wheel of 20 mm turned by 1.5 rad lifts 100 g", "the load's way with R θ", _winding),
    Case("pulley_tree", "Tree of sliding pulleys", "(1)–(7)", "`scenes/pulley_differential.json`",
         "tensions, travels and turns with the closed forms and virtual work",
         lambda: _tree("pulley_differential")),
    Case("rocker_tree", "Tree of rockers", "(5)–(7)", "`scenes/rocker_differential.json`",
         "tensions, travels and tilts with the closed forms and virtual work",
         lambda: _tree("rocker_differential")),
    Case("rocker_arms", "Rocker with unequal arms", "T₁ = F b/(a+b)",
         "one rocker, pulled by 8 N, on two elastic cords", "tensions with the lever law", _rocker),
)
