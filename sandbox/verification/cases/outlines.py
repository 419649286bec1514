"""Outlines cut into pieces: the lift of a cam's followers, and a way over many joints."""

from __future__ import annotations

import math

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.scene.outlines.spline import PeriodicSpline
from sandbox.scene.read.load import load_scene
from sandbox.study.plain_mechanisms import G, fixed, mechanism
from sandbox.verification.cases.case import Case, Check, Findings
from sandbox.wording import counted

BASE, ROLLER, RISE, TOLERANCE, RATE = 0.025, 0.008, 0.01, 1e-5, 5.0
TURNS = np.arange(0.0, math.tau, math.pi / 12)
H = 2.5e-4


def _cycloid(turn: Array) -> Array:
    """A cycloidal rise over 120 deg, a dwell of 60, the return, a dwell [m]."""
    x = np.interp(turn, np.radians([0, 120, 180, 300, 360]), [0.0, 1.0, 1.0, 0.0, 0.0])
    return np.asarray(RISE * (x - np.sin(math.tau * x) / math.tau))


def _lifts() -> Findings:
    """Both followers over a whole turn, against the spline through the table."""
    lift = _cycloid(TURNS)
    spline = PeriodicSpline(TURNS, lift)
    table = [[float(a), float(s)] for a, s in zip(TURNS, lift, strict=True)]
    checks, curves = [], []
    fine = np.linspace(0, math.tau, 361)
    curves.append(Curve("spline through the table", np.degrees(fine), 1e3 * spline(fine)[0]))
    for follower, radius, shape in (
            ("roller", ROLLER, {"type": "circle", "radius": ROLLER}),
            ("flat", 0.0, {"type": "box", "size": [0.06, 0.004], "at": [0, 0.002]})):
        made = {"type": "cam", "base": BASE, "lift": table, "follower": follower,
                "tolerance": TOLERANCE, **({"roller": ROLLER} if radius else {})}
        run = simulate(load_scene({
            "run": {"duration": math.tau / RATE, "step": H, "sample_rate": 1000},
            "gravity": [0, -G], "materials": {"oiled": {"friction": 0}},
            "bodies": [
                {"name": "cam", "motion": "scheduled", "path": {"angle": f"={RATE} * t"},
                 "material": "oiled", "shapes": [made]},
                {"name": "frame", "motion": "fixed"},
                {"name": "rod", "at": [0, BASE + radius], "mass": 0.1, "material": "oiled",
                 "shapes": [shape]}],
            "joints": [{"type": "slot", "name": "guide", "a": "frame", "b": "rod",
                        "start": [0, 0], "end": [0, 0.1], "turns": False}]}))
        turn = run["cam.angle"]
        raised = run["rod.y"] - BASE - radius
        s, slope, _ = spline(turn)
        # the face bears at the outline's highest point; a roller leans by the pressure angle
        lean = np.hypot(1.0, slope / (BASE + radius + s)) if radius else 1.0
        checks.append(Check(
            f"lift of the {follower} follower, largest difference", "m", 0.0,
            float(np.abs((raised - s) / lean).max()), TOLERANCE + H * RATE * H * RATE * RISE,
            "the tolerance of the outline's chords, and the rest of a step's end"))
        curves.append(Curve(follower, np.degrees(turn)[::40], 1e3 * raised[::40], "points"))
    return Findings(checks, [Panel("Two followers of one table", "turn [deg]", "lift [mm]",
                                   curves)])


def _joints() -> Findings:
    """A block slides down a slope of one segment, and of many: the same to rounding."""
    slope, checks = math.radians(15.0), []
    c, s = math.cos(slope), math.sin(slope)
    curves = []
    for count in (1, 10, 200):
        x = np.linspace(-0.5, 3.5, count + 1)
        run = simulate(mechanism(
            duration=1.0, step=5e-4, gravity=(0.0, -G), materials={"oiled": {"friction": 0.0}},
            bodies=[fixed("slope", angle=-slope, material="oiled", shapes=[
                {"type": "polyline", "points": [(float(at), 0.0) for at in x]}]),
                {"name": "block", "mass": 0.2, "at": (0.01 * s, 0.01 * c), "angle": -slope,
                 "material": "oiled", "shapes": [{"type": "box", "size": (0.06, 0.02)}]}]))
        speed = np.hypot(run["block.vx"], run["block.vy"])
        a = float((speed[-1] - speed[100]) / (run.time[-1] - run.time[100]))
        label = counted(count, "segment")
        checks.append(Check(f"acceleration on {label}", "m/s^2", G * s, a, 1e-8 * G,
                            "a constant force: the scheme is exact, and nothing catches"))
        curves.append(Curve(label, run.time[::100], speed[::100], "points"))
    curves.append(Curve("g sin(15 deg) t", run.time, G * s * run.time))
    return Findings(checks, [Panel("Down a slope of many segments", "time [s]", "speed [m/s]",
                                   curves)])


CASES = (
    Case("cam_lift", "Cams from a lift table", "y = b + r + s(θ)",
         "a cycloidal rise and return in a table of 15 deg, for a roller and for a flat face",
         "recorded lift with the periodic cubic spline through the table", _lifts),
    Case("chain_of_segments", "A slope of many segments", "a = g sin(slope)",
         "a block without friction on a polyline of 1, 10 and 200 segments in one line",
         "acceleration with the closed form", _joints),
)
