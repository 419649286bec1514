"""Outlines: cams and their followers, curves in contact, a path over many segments."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.interpolate import CubicSpline

from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.scene.read.load import load_scene
from tests.support.mechanisms import G, Json, fixed, simulated

from .case import Check, case

MASS = 0.1


def smooth(name: str, friction: float = 0.0) -> Json:
    return {name: {"friction": friction}}


@case("Cams from a lift table", "y = b + r + s(θ); N cos = m (g + s″ ω²)",
      "a cycloidal rise and return in a table of 15°, for a roller and for a flat face")
def test_cam_lift() -> Iterator[Check]:
    """Rise over 120 deg, a dwell of 60, the return, a dwell."""
    base, roller, rate, h = 0.025, 0.008, 5.0, 2.5e-4
    turns = np.arange(0.0, math.tau, math.pi / 12)
    share = np.interp(turns, np.radians([0, 120, 180, 300, 360]), [0.0, 1.0, 1.0, 0.0, 0.0])
    lift = 0.01 * (share - np.sin(math.tau * share) / math.tau)
    spline = CubicSpline([*turns, math.tau], [*lift, lift[0]], bc_type="periodic")
    jerk = rate**3 * float(np.abs(spline(turns, 3)).max())
    for follower, radius, shape in (
            ("roller", roller, {"type": "circle", "radius": roller}),
            ("flat", 0.0, {"type": "box", "size": [0.06, 0.004], "at": [0, 0.002]})):
        outline = {"type": "cam", "base": base, "lift": np.column_stack([turns, lift]).tolist(),
                   "follower": follower, **({"roller": roller} if radius else {})}
        run = simulate(load_scene({
            "run": {"duration": math.tau / rate, "step": h, "sample_rate": 1 / h},
            "gravity": [0, -G], "materials": smooth("oiled"), "bodies": [
                {"name": "cam", "motion": "scheduled", "path": {"angle": f"={rate} * t"},
                 "material": "oiled", "shapes": [outline]},
                {"name": "frame", "motion": "fixed"},
                {"name": "rod", "at": [0, base + radius], "mass": MASS, "material": "oiled",
                 "shapes": [shape]}],
            "joints": [{"type": "slot", "name": "guide", "a": "frame", "b": "rod",
                        "start": [0, 0], "end": [0, 0.1], "turns": False}]}))
        s, slope, bend = (spline(run["cam.angle"], order) for order in range(3))
        # the flat face bears at the outline's highest point; a roller at the pressure angle
        lean = np.hypot(1.0, slope / (base + radius + s)) if radius else np.ones_like(s)
        yield Check(f"lift of the {follower} follower", "m", (s / lean)[10:],
                    ((run["rod.y"] - base - radius) / lean)[10:], 1e-9 + h**3 * jerk,
                    "1 nm of the outline's spans, and h³ times the jerk")
        yield Check(f"force on the {follower} follower", "N",
                    (MASS * (G + bend * rate**2) * lean)[10:], run["cam/rod.normal"][10:],
                    2 * MASS * h * jerk, "the jerk jumps at the table's angles: m h times it")


@case("Ball in a parabola", "N = m (v² κ + g cos), v² = 2 g Δh",
      "a ball without friction on an open curve through 201 points of a parabola, h = 0.5 ms")
def test_curved_track() -> Iterator[Check]:
    curvature, ball, edge = 3.0, 0.02, 0.4
    at = np.linspace(-0.9 * edge, 0.9 * edge, 100_001)
    slope = curvature * at
    bend = curvature / np.hypot(1.0, slope)**3
    normal = np.stack([-slope, np.ones_like(at)]) / np.hypot(1.0, slope)
    centre = np.stack([at, curvature * at**2 / 2]) + ball * normal
    start, x = int(np.searchsorted(at, -0.25)), np.linspace(-edge, edge, 201)
    run = simulate(load_scene({
        "run": {"duration": 1.0, "step": 5e-4, "sample_rate": 2000},
        "gravity": [0, -G], "materials": smooth("oiled"), "bodies": [
            {"name": "track", "motion": "fixed", "material": "oiled", "shapes": [
                {"type": "curve", "closed": False,
                 "points": np.column_stack([x, curvature * x**2 / 2]).tolist()}]},
            {"name": "ball", "mass": MASS, "at": centre[:, start].tolist(), "material": "oiled",
             "shapes": [{"type": "circle", "radius": ball}]}]}))

    def read(values: Array) -> Array:
        return np.asarray(np.interp(np.interp(run["ball.x"], centre[0], at), at, values))

    height = read(centre[1])
    speed2 = 2 * G * (centre[1, start] - height)
    yield Check("height", "m", height, run["ball.y"], 1e-7,
                "the spline through 201 points, and the error of a step")
    yield Check("normal force", "N",
                MASS * (speed2 * read(bend / (1 - ball * bend)) + G * read(normal[1])),
                run["ball/track.normal"], 1e-4 * MASS * G,
                "second order in the step; the spline's curvature is exact to 1e-5")


@case("Disc that rolls off a disc", "N = m g (7 cos θ − 4 cos θ₀) / 3",
      "circles, and curves through 240 points of a circle, in all four pairs, h = 0.5 ms")
def test_rolling_off() -> Iterator[Check]:
    large, small, start = 0.05, 0.02, math.radians(15.0)
    gap = large + small

    def shape(radius: float, curved: bool) -> Json:
        turns = np.arange(240) * math.tau / 240
        points = radius * np.column_stack([np.cos(turns), np.sin(turns)])
        return ({"type": "curve", "points": points.tolist()} if curved else
                {"type": "circle", "radius": radius})

    for below, above in ((False, False), (True, False), (False, True), (True, True)):
        run = simulate(load_scene({
            "run": {"duration": 0.2, "step": 5e-4, "sample_rate": 2000},
            "gravity": [0, -G], "materials": smooth("rough", 5), "bodies": [
                {"name": "large", "motion": "fixed", "material": "rough",
                 "shapes": [shape(large, below)]},
                {"name": "small", "mass": MASS, "inertia": MASS * small**2 / 2, "centre": [0, 0],
                 "at": [gap * math.sin(start), gap * math.cos(start)], "material": "rough",
                 "shapes": [shape(small, above)]}]}))
        label = " on ".join("a curve" if curved else "a circle" for curved in (above, below))
        yield Check(f"normal force of {label}", "N",
                    (MASS * G * (7 * run["small.y"] / gap - 4 * math.cos(start)) / 3)[4:],
                    run["small/large.normal"][4:], 3e-4 * MASS * G,
                    "second order in the step; 240 points have the curvature to 6e-5")


@case("Slope of many segments", "a = g sin(slope)",
      "a block without friction on a polyline of 1, 10 and 200 segments in one line, 15°")
def test_chain_of_segments() -> Iterator[Check]:
    slope = math.radians(15.0)
    c, s = math.cos(slope), math.sin(slope)
    for count in (1, 10, 200):
        run = simulated(
            1.0, g=G, materials=smooth("oiled"), bodies=[
                fixed("slope", angle=-slope, material="oiled", shapes=[{
                    "type": "polyline",
                    "points": [(float(x), 0.0) for x in np.linspace(-0.5, 3.5, count + 1)]}]),
                {"name": "block", "mass": 0.2, "at": (0.01 * s, 0.01 * c), "angle": -slope,
                 "material": "oiled", "shapes": [{"type": "box", "size": (0.06, 0.02)}]}])
        speed = np.hypot(run["block.vx"], run["block.vy"])
        yield Check(f"acceleration, segments: {count}", "m/s^2", G * s,
                    (speed[-1] - speed[100]) / (run.time[-1] - run.time[100]), 1e-8 * G,
                    "a constant force: the scheme is exact, and nothing catches")
