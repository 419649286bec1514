"""Dry friction in pins and slots, and motors with a line of torque over speed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.study.plain_mechanisms import G, fixed, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

H = 5e-4


def _pinned(body: dict[str, Any], *drives: dict[str, Any], duration: float, **pin: Any,
            ) -> Recording:
    return simulate(mechanism(
        duration=duration, step=H, gravity=(0.0, -G), bodies=[fixed("ground"), body],
        drives=list(drives), joints=[{"type": "pin", "name": "p", "a": "ground",
                                      "b": body["name"], "on_a": (0.0, 0.0), **pin}]))


def _pendulum() -> Findings:
    """An arm let go level, with more and less friction in its pin."""
    mass, arm, inertia = 0.5, 0.08, 1e-3
    weight, checks, curves = mass * G * arm, [], []
    body = {"name": "arm", "mass": mass, "inertia": inertia, "at": (arm, 0.0)}
    for degrees in (90.0, 120.0, 150.0):
        turn = math.radians(degrees)
        run = _pinned(body, duration=0.6, positive="clockwise",
                      friction=weight * math.sin(turn) / turn)
        found = float(run["p.angle"].max())
        checks.append(Check(
            f"where it turns round, τ for {degrees:g} deg", "rad", turn, found,
            2.0 * weight / (inertia + mass * arm**2) * H**2,
            "α h²: the step in which it turns round"))
        curves.append(Curve(f"turns round at {degrees:g}°", 1e3 * run.time,
                            np.degrees(run["p.angle"])))
    held = _pinned(body, duration=0.2, friction=1.001 * weight)
    checks += [
        Check("held by a little more than its weight", "rad", 0.0,
              float(np.abs(held["p.angle"]).max()), 1e-12, "rounding: nothing creeps"),
        Check("torque of the friction that holds it", "N m", weight,
              float(held["p.friction"][-1]), 1e-9 * weight, "it gives what is needed"),
    ]
    return Findings(checks, [Panel("An arm with friction in its pin", "time [ms]",
                                   "angle below level [deg]", curves)])


def _journal() -> Findings:
    """A flywheel whose weight rests on its pin."""
    mu, journal, mass, radius, spin = 0.15, 0.01, 2.0, 0.07, 3.0
    inertia = mass * radius**2 / 2
    run = _pinned({"name": "wheel", "mass": mass, "inertia": inertia, "angular_velocity": spin},
                  duration=0.7, friction_coefficient=mu, pin_radius=journal)
    alpha = mu * journal * mass * G / inertia
    slows = run.time < spin / alpha - H
    return Findings([
        Check("angular acceleration", "rad/s^2", -alpha,
              float(run["wheel.alpha"][slows].mean()), 1e-9 * alpha, "rounding"),
        Check("angle at which it stands still", "rad", spin**2 / (2 * alpha),
              float(run["wheel.angle"][-1]), alpha * H**2 / 2,
              "α h²/2: the step in which it stops"),
        Check("arm of the reaction: friction circle", "m", mu * journal,
              float(np.abs(run["p.friction"] / run["p.reaction"])[slows].max()), 1e-9 * journal,
              "how closely friction is measured by the reaction"),
    ], [Panel("A flywheel on its journal", "time [ms]", "speed [rad/s]", [
        Curve("ω₀ − μ R m g t / I", 1e3 * run.time, np.maximum(spin - alpha * run.time, 0.0)),
        Curve("engine", 1e3 * run.time, run["wheel.omega"])])])


def _grooves() -> Findings:
    """A block on grooves of several slopes, and one that breaks away."""
    mu, mass, checks, found = 0.3, 1.0, [], []
    slopes = (5.0, 10.0, 15.0, 16.5, 17.0, 20.0, 30.0, 45.0)
    for degrees in slopes:
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        run = simulate(mechanism(
            duration=0.2, step=H, gravity=(0.0, -G),
            bodies=[fixed("ground"), {"name": "block", "mass": mass, "inertia": 1e-3}],
            joints=[{"type": "slot", "name": "s", "a": "ground", "b": "block",
                     "start": (-c, -s), "end": (c, s), "friction_coefficient": mu}]))
        a = -float(c * run["block.ax"][-1] + s * run["block.ay"][-1])
        found.append(a)
        checks.append(Check(f"acceleration at {degrees:g} deg", "m/s^2",
                            max(0.0, G * (s - mu * c)), a, 1e-8 * G,
                            "a constant force: the scheme is exact"))
    rise, rubs, static = 8.0, 2.0, 1.5
    run = simulate(mechanism(
        duration=0.6, step=H, bodies=[fixed("ground"), {"name": "block", "mass": mass,
                                                        "inertia": 1e-3}],
        joints=[{"type": "slot", "name": "s", "a": "ground", "b": "block", "start": (-1, 0),
                 "end": (1, 0), "friction": rubs, "static": static}],
        drives=[{"type": "force", "name": "push", "body": "block", "direction": (1, 0),
                 "value": f"={rise} * t"}]))
    lets_go = float(run.time[np.flatnonzero(run["s.sticks"] == 0.0)[0]])
    checks += [
        Check("instant at which a rising push breaks away", "s", static * rubs / rise, lets_go,
              2 * H, "a step, and one sample after it"),
        Check("friction from then on", "N", rubs, -float(run["s.friction"][-1]), 1e-12, "rounding"),
    ]
    fine = np.linspace(0.0, 50.0, 101)
    return Findings(checks, [
        Panel("A block on a groove, μ = 0.3", "slope [deg]", "acceleration [m/s²]", [
            Curve("g (sin − μ cos), 0 below tan μ", fine, np.maximum(
                G * (np.sin(np.radians(fine)) - mu * np.cos(np.radians(fine))), 0.0)),
            Curve("engine", np.array(slopes), np.array(found), "points")]),
        Panel("A block that breaks away", "time [ms]", "force [N]", [
            Curve("push", 1e3 * run.time, rise * run.time),
            Curve("friction", 1e3 * run.time, -run["s.friction"])])])


def _line() -> Findings:
    """A flywheel run up along a motor's line, with and without a limit, and reversed."""
    stall, free, inertia = 0.4, 50.0, 2e-3
    lag, checks, curves = inertia * free / stall, [], []
    allowed = free * (H / lag)**2 / 7
    why = "a sample is the mean of two speeds, off by w″ h²/8"
    for what, more in (("full", {}), ("half the torque", {"torque": stall / 2}),
                       ("reversed", {"value": f"={free} if t < 0.5 else -{free}"})):
        run = _pinned({"name": "wheel", "mass": 1.0, "inertia": inertia},
                      {"type": "motor", "name": "m", "joint": "p", "stall": stall,
                       "no_load": free, **more}, duration=1.0)
        t = run.time
        truth = free * (1 - np.exp(-t / lag))
        if what == "half the torque":
            truth = np.where(t < lag, free / 2 * t / lag,
                             free * (1 - np.exp(-np.maximum(t - lag, 0.0) / lag) / 2))
        if what == "reversed":
            top = free * (1 - math.exp(-0.5 / lag))
            truth = np.where(t < 0.5, truth,
                             -free + (top + free) * np.exp(-np.maximum(t - 0.5, 0.0) / lag))
        checks.append(Check(f"{what}: speed, largest difference", "rad/s", 0.0,
                            float(np.abs(run["p.rate"] - truth).max()),
                            allowed * (2 if what == "reversed" else 1),
                            why + (" of twice the way" if what == "reversed" else "")))
        curves += [Curve(f"{what}, closed form", 1e3 * t, truth),
                   Curve(f"{what}, engine", 1e3 * t, run["p.rate"], "points")]
    return Findings(checks, [Panel("Motors with a line", "time [ms]", "speed [rad/s]", curves)])


CASES = (
    Case("pin_friction", "A pendulum with dry friction in its pin", "m g l sin α = τ α",
         "an arm of 0.5 kg let go level, h = 0.5 ms", "where it turns round, and that it is held",
         _pendulum),
    Case("journal", "A journal that rubs by what it carries", "α = μ R N / I",
         "a flywheel of 2 kg on a pin of 10 mm, μ = 0.15, h = 0.5 ms",
         "its deceleration, its way, and the friction circle", _journal),
    Case("groove_friction", "Dry friction along a groove", "a = max(0, g (sin − μ cos))",
         "a block on grooves of 5 to 45 deg, μ = 0.3; one that is pushed by more and more",
         "accelerations; when it breaks away, and with what it rubs then", _grooves),
    Case("motor_line", "Motors with a line of torque over speed", "ω = ω₀ (1 − e^(−t/τ))",
         "a flywheel of 0.002 kg m², 0.4 N m at rest, 50 rad/s without load, h = 0.5 ms",
         "speeds with closed forms: along the line, below a limit, reversed", _line),
)
