"""Coulomb friction: sticking, sliding, coming to rest."""

from __future__ import annotations

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.study import independent as reference
from sandbox.study.plain_mechanisms import G, fixed, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

H, MASS = 5e-4, 0.2
BOX = {"type": "box", "size": (0.06, 0.02)}


def _on_plane(slope: float, friction: float, speed: float = 0.0) -> Recording:
    """A block that rests on a plane falling toward +x, at first with a speed along it."""
    c, s = float(np.cos(slope)), float(np.sin(slope))
    return simulate(mechanism(
        duration=0.5, step=H, gravity=(0.0, -G), materials={"rough": {"friction": friction}},
        bodies=[fixed("plane", angle=-slope, material="rough", shapes=[
            {"type": "box", "size": (4.0, 0.02), "at": (0.0, -0.01)}]),
            {"name": "block", "mass": MASS, "at": (0.01 * s, 0.01 * c), "angle": -slope,
             "material": "rough", "shapes": [BOX], "velocity": (speed * c, -speed * s)}]))


def _incline() -> Findings:
    friction, checks, found = 0.4, [], []
    slopes = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0)
    for degrees in slopes:
        slope = float(np.radians(degrees))
        run = _on_plane(slope, friction)
        speed = np.hypot(run["block.vx"], run["block.vy"])
        a = float((speed[-1] - speed[100]) / (run.time[-1] - run.time[100]))
        found.append(a)
        normal = MASS * G * np.cos(slope)
        carried = min(friction * normal, MASS * G * np.sin(slope))
        checks += [
            Check(f"acceleration at {degrees:g} deg", "m/s^2",
                  reference.slide(slope, friction, G), a, 1e-8 * G,
                  "a constant force: the scheme is exact"),
            Check(f"friction at {degrees:g} deg", "N", float(carried),
                  abs(float(run["block.contact.tangential"][-1])), 1e-8 * float(normal),
                  "the law itself: two corners, solved together")]
    fine = np.linspace(0.0, 45.0, 91)
    return Findings(checks, [Panel("A block on a slope, μ = 0.4", "slope [deg]",
                                   "acceleration [m/s²]", [
        Curve("g (sin − μ cos), 0 below tan μ", fine, np.array(
            [reference.slide(float(np.radians(d)), friction, G) for d in fine])),
        Curve("engine", np.array(slopes), np.array(found), "points")])])


def _stopping() -> Findings:
    friction, checks, found = 0.4, [], []
    speeds = (0.2, 0.5, 0.8, 1.2)
    for speed in speeds:
        run = _on_plane(0.0, friction, speed)
        found.append(float(run["block.x"][-1]))
        checks.append(Check(f"distance from {speed:g} m/s", "m",
                            reference.stopping_distance(speed, friction, G), found[-1],
                            friction * G * H**2 / 8,
                            "μ g h²/8: exact but for the step in which it stops"))
    fine = np.linspace(0.0, 1.3, 60)
    return Findings(checks, [Panel("Stopping distance, μ = 0.4", "speed [m/s]", "distance [mm]", [
        Curve("v²/(2 μ g)", fine, 1e3 * fine**2 / (2 * friction * G)),
        Curve("engine", np.array(speeds), 1e3 * np.array(found), "points")])])


CASES = (
    Case("incline", "A block on a slope", "a = max(0, g (sin − μ cos))",
         "a block on planes of 5 to 40 deg, μ = 0.4, h = 0.5 ms",
         "acceleration and friction with Coulomb's law", _incline),
    Case("stopping", "A block that friction stops", "s = v²/(2 μ g)",
         "a block on a level plane, μ = 0.4, h = 0.5 ms", "distances with the closed form",
         _stopping),
)
