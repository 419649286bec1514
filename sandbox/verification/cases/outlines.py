"""Outlines: cams and their followers, curves in contact, a way over many joints."""

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

BASE, ROLLER, RISE, RATE, MASS = 0.025, 0.008, 0.01, 5.0, 0.1
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
    jerk = RATE**3 * float(np.abs(np.diff(spline(fine)[2]) / np.diff(fine)).max())
    for follower, radius, shape in (
            ("roller", ROLLER, {"type": "circle", "radius": ROLLER}),
            ("flat", 0.0, {"type": "box", "size": [0.06, 0.004], "at": [0, 0.002]})):
        made = {"type": "cam", "base": BASE, "lift": table, "follower": follower,
                **({"roller": ROLLER} if radius else {})}
        run = simulate(load_scene({
            "run": {"duration": math.tau / RATE, "step": H, "sample_rate": 1 / H},
            "gravity": [0, -G], "materials": {"oiled": {"friction": 0}},
            "bodies": [
                {"name": "cam", "motion": "scheduled", "path": {"angle": f"={RATE} * t"},
                 "material": "oiled", "shapes": [made]},
                {"name": "frame", "motion": "fixed"},
                {"name": "rod", "at": [0, BASE + radius], "mass": MASS, "material": "oiled",
                 "shapes": [shape]}],
            "joints": [{"type": "slot", "name": "guide", "a": "frame", "b": "rod",
                        "start": [0, 0], "end": [0, 0.1], "turns": False}]}))
        raised = run["rod.y"] - BASE - radius
        s, slope, bend = spline(run["cam.angle"])
        # the face bears at the outline's highest point; a roller leans by the pressure angle
        lean = np.hypot(1.0, slope / (BASE + radius + s)) if radius else np.ones_like(s)
        force = MASS * (G + bend * RATE**2) * lean
        checks += [
            Check(f"lift of the {follower} follower, largest difference", "m", 0.0,
                  float(np.abs((raised - s) / lean)[10:].max()), 1e-9 + H**3 * jerk,
                  "1 nm of the outline's spans, and h³ times the jerk"),
            Check(f"force on the {follower} follower, largest difference", "N", 0.0,
                  float(np.abs(run["cam/rod.normal"] - force)[10:].max()),
                  2 * MASS * H * jerk,
                  "the jerk jumps at the table's angles: there the force is off by m h times it")]
        curves.append(Curve(follower, np.degrees(run["cam.angle"])[::160], 1e3 * raised[::160],
                            "points"))
    return Findings(checks, [Panel("Two followers of one table", "turn [deg]", "lift [mm]",
                                   curves)])


BEND, BALL, EDGE = 3.0, 0.02, 0.4
"""Of the parabola y = BEND x²/2 up to |x| = EDGE, and the radius of a ball in it [1/m, m, m]."""


def _track() -> Findings:
    """A smooth ball swings in a parabola given by points: its force from its height alone."""
    x = np.linspace(-EDGE, EDGE, 201)
    at = np.linspace(-0.9 * EDGE, 0.9 * EDGE, 100_001)
    slope = BEND * at
    bend = BEND / np.hypot(1.0, slope)**3
    normal = np.stack([-slope, np.ones_like(at)]) / np.hypot(1.0, slope)
    centre = np.stack([at, BEND * at**2 / 2]) + BALL * normal
    start = int(np.searchsorted(at, -0.25))
    run = simulate(load_scene({
        "run": {"duration": 1.0, "step": 5e-4, "sample_rate": 2000},
        "gravity": [0, -G], "materials": {"oiled": {"friction": 0}},
        "bodies": [
            {"name": "track", "motion": "fixed", "material": "oiled", "shapes": [
                {"type": "curve", "closed": False,
                 "points": [[float(u), float(BEND * u**2 / 2)] for u in x]}]},
            {"name": "ball", "mass": MASS, "at": centre[:, start].tolist(), "material": "oiled",
             "shapes": [{"type": "circle", "radius": BALL}]}]}))
    where = np.interp(run["ball.x"], centre[0], at)
    height, around, up = (np.interp(where, at, each) for each in (
        centre[1], bend / (1 - BALL * bend), normal[1]))
    square = 2 * G * (centre[1, start] - height)
    force = MASS * (square * around + G * up)
    off = np.abs(run["ball.y"] - height)
    return Findings([
        Check("height above the parabola's offset, largest difference", "m", 0.0,
              float(off.max()), 1e-7, "the spline through 201 points, and what a step leaves"),
        Check("normal force, largest difference", "N", 0.0,
              float(np.abs(run["ball/track.normal"] - force).max()), 1e-4 * MASS * G,
              "second order in the step; the spline's curvature is exact to 1e-5"),
    ], [Panel("A ball in a parabola", "x [m]", "force [N]", [
        Curve("m (v² κ + g cos)", run["ball.x"], force),
        Curve("engine", run["ball.x"][::40], run["ball/track.normal"][::40], "points")])])


def _rolling_off() -> Findings:
    """A disc rolls off a disc, each a circle or a curve through 240 points."""
    large, small, start = 0.05, 0.02, math.radians(15.0)
    checks, curves = [], []
    gap = large + small

    def shape(radius: float, curved: bool) -> dict[str, object]:
        turns = np.arange(240) * math.tau / 240
        points = [[radius * math.cos(turn), radius * math.sin(turn)] for turn in turns]
        return ({"type": "curve", "points": points} if curved else
                {"type": "circle", "radius": radius})

    for below, above in ((False, False), (True, False), (False, True), (True, True)):
        run = simulate(load_scene({
            "run": {"duration": 0.2, "step": 5e-4, "sample_rate": 2000},
            "gravity": [0, -G], "materials": {"rough": {"friction": 5}},
            "bodies": [
                {"name": "large", "motion": "fixed", "material": "rough",
                 "shapes": [shape(large, below)]},
                {"name": "small", "mass": MASS, "inertia": MASS * small**2 / 2, "centre": [0, 0],
                 "at": [gap * math.sin(start), gap * math.cos(start)], "material": "rough",
                 "shapes": [shape(small, above)]}]}))
        cosine = run["small.y"] / gap
        force = MASS * G * (7 * cosine - 4 * math.cos(start)) / 3
        label = " on ".join("a curve" if curved else "a circle" for curved in (above, below))
        checks.append(Check(f"normal force of {label}, largest difference", "N", 0.0,
                            float(np.abs(run["small/large.normal"] - force)[4:].max()),
                            3e-4 * MASS * G,
                            "second order in the step; 240 points have the curvature to 6e-5"))
        curves.append(Curve(label, np.degrees(np.arccos(cosine))[::40],
                            run["small/large.normal"][::40], "points"))
    angle = np.linspace(start, math.radians(45.0), 60)
    curves.append(Curve("m g (7 cos θ − 4 cos θ₀) / 3", np.degrees(angle),
                        MASS * G * (7 * np.cos(angle) - 4 * math.cos(start)) / 3))
    return Findings(checks, [Panel("A disc rolls off a disc", "θ [deg]", "force [N]", curves)])


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
    Case("cam_lift", "Cams from a lift table", "y = b + r + s(θ); N cos = m (g + s″ ω²)",
         "a cycloidal rise and return in a table of 15 deg, for a roller and for a flat face",
         "recorded lift and force with the periodic cubic spline through the table", _lifts),
    Case("curved_track", "A ball in a parabola", "N = m (v² κ + g cos), v² = 2 g Δh",
         "a ball without friction on an open curve through 201 points of a parabola, h = 0.5 ms",
         "place and force with the parabola itself", _track),
    Case("rolling_off", "A disc rolls off a disc", "N = m g (7 cos θ − 4 cos θ₀) / 3",
         "circles and curves through 240 points of a circle in all four pairs, h = 0.5 ms",
         "force with the closed form", _rolling_off),
    Case("chain_of_segments", "A slope of many segments", "a = g sin(slope)",
         "a block without friction on a polyline of 1, 10 and 200 segments in one line",
         "acceleration with the closed form", _joints),
)
