"""What is let go, breaks and is taken up; surfaces that run."""

from __future__ import annotations

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.study.plain_mechanisms import G, fixed, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

LOAD, GROWS = 15.0, 30.0
WEIGHT = {"name": "weight", "mass": 1.0, "inertia": 0.01, "at": (0.0, -0.5)}


def _pulled(h: float) -> Recording:
    """1 kg on a rod that breaks at 15 N, under a pull that grows by 30 N/s."""
    return simulate(mechanism(
        duration=0.5, step=h, gravity=(0.0, -G), bodies=[fixed("frame"), WEIGHT],
        joints=[{"type": "rod", "name": "rod", "a": "frame", "b": "weight", "breaks_at": LOAD}],
        drives=[{"type": "force", "name": "pull", "body": "weight", "direction": (0.0, -1.0),
                 "value": f"={GROWS} * t"}]))


def _fallen(t: Array) -> Array:
    """Its speed downwards."""
    broke = (LOAD - G) / GROWS
    return np.asarray(np.where(t > broke, G * (t - broke) + GROWS * (t**2 - broke**2) / 2, 0.0))


def _breaking() -> Findings:
    checks: list[Check] = []
    curves: list[Curve] = []
    for h in (1e-3, 0.53e-3, 0.25e-3, 0.13e-3):
        run = _pulled(h)
        # by the mean of before and after; the step in which it breaks is over by then
        expected = (_fallen(run.time[-1:] - h / 2) + _fallen(run.time[-1:] + h / 2)) / 2
        checks.append(Check(
            f"speed, h = {1e3 * h:g} ms", "m/s", float(expected[0]), -float(run["weight.vy"][-1]),
            h**2 * GROWS, "h² dT/dt / m: of the last impulse; without it up to h T / (2 m)"))
        if not curves:
            curves = [Curve("closed form", run.time, _fallen(run.time)),
                      Curve("engine", run.time[::25], -run["weight.vy"][::25], "points")]
    return Findings(checks, [Panel("A rod that breaks at 15 N", "t [s]", "speed [m/s]", curves)])


def _taking_up() -> Findings:
    over, caught = 0.02, 0.1
    checks: list[Check] = []
    curves: list[Curve] = []
    d, u = G * caught**2 / 2, G * caught
    for h in (1e-3, 0.5e-3, 0.25e-3):
        run = simulate(mechanism(
            duration=0.4, step=h, gravity=(0.0, -G), run={"sample_rate": 1 / h},
            bodies=[fixed("frame"), {**WEIGHT, "at": (0.0, 0.0)}],
            joints=[{"type": "pin", "name": "hook", "a": "frame", "b": "weight",
                     "on_a": (0.0, 0.0), "released": True, "takes_up_in": over}],
            events=[{"name": "catch", "at": caught, "take_up": "hook"}]))
        t = run.time - caught
        gap = np.where(t < 0, G * run.time**2 / 2, (d + (u + d / over) * t) * np.exp(-t / over))
        off = float(np.abs(run["weight.y"] + gap).max())
        checks.append(Check(f"place, h = {1e3 * h:g} ms", "m", 0.0, off, h * (u + d / over),
                            "h (u + d / T): the instant of an event is known to a step"))
        checks.append(Check(
            f"largest force, h = {1e3 * h:g} ms", "N", G + 2 * u / over + d / over**2,
            float(run["hook.reaction_y"].max()), h * 3 * (u + d / over) / over**2,
            "h times how fast the force falls at first, 3 u / T² + 2 d / T³, rounded up"))
        if not curves:
            curves = [Curve("closed form", run.time, 1e3 * gap),
                      Curve("engine", run.time[::10], -1e3 * run["weight.y"][::10], "points")]
    return Findings(checks, [Panel("A falling weight that a pin takes up", "t [s]", "gap [mm]",
                                   curves)])


def _conveyor() -> Findings:
    mu, m, v, h, checks, curves = 0.4, 2.0, 1.0, 1e-3, [], []
    for slope in (0.0, 10.0, 15.0):
        angle = float(np.radians(slope))
        c, s = float(np.cos(angle)), float(np.sin(angle))
        run = simulate(mechanism(
            duration=1.5, step=h, gravity=(0.0, -G), materials={"rough": {"friction": mu}},
            bodies=[fixed("belt", angle=angle, material="rough",
                          shapes=[{"type": "box", "size": (6.0, 0.1)}]),
                    {"name": "box", "mass": m, "angle": angle, "material": "rough",
                     "at": (-2.0 * c - 0.1 * s, -2.0 * s + 0.1 * c),
                     "shapes": [{"type": "box", "size": (0.2, 0.1)}]}],
            drives=[{"type": "surface", "name": "run", "body": "belt", "positive": "clockwise",
                     "value": v}]))
        a = G * (mu * c - s)
        speed = c * run["box.vx"] + s * run["box.vy"]
        way = c * run["box.x"] + s * run["box.y"] + 2.0
        lag = v**2 / (2 * a)
        checks += [
            Check(f"way at {slope:g} deg", "m", v * float(run.time[-1]) - lag, float(way[-1]),
                  a * h**2, "a h²: exact but for the step in which it sticks"),
            Check(f"power at {slope:g} deg", "W", mu * m * G * c * v,
                  float(run["run.power"][50]), 1e-8 * m * G, "friction times speed"),
            Check(f"work at {slope:g} deg", "J",
                  mu * m * G * c * v * v / a + m * G * s * v * (float(run.time[-1]) - v / a),
                  float(run["run.work"][-1]), m * G * v * h, "one step's friction at most")]
        curves += [Curve(f"{slope:g}°, closed form", run.time, np.minimum(a * run.time, v)),
                   Curve(f"{slope:g}°, engine", run.time[::25], speed[::25], "points")]
    return Findings(checks, [Panel("Boxes on belts at 1 m/s, μ = 0.4", "t [s]", "speed [m/s]",
                                   curves)])


CASES = (
    Case("breaking", "A rod that breaks at a load", "v = g (t − t_b) + dF/dt (t² − t_b²) / (2 m)",
         "1 kg under a pull of 30 N/s on a rod that breaks at 15 N, four steps",
         "speed with the closed form, wherever in a step it breaks", _breaking),
    Case("taking_up", "A pin that takes up what falls", "x = (d + (u + d / T) t) exp(−t / T)",
         "1 kg that fell for 0.1 s, taken up with T = 20 ms, three steps",
         "place and largest force with the closed form", _taking_up),
    Case("conveyor", "Boxes on belts that run and climb", "v = g (μ cos − sin) t, up to the belt's",
         "a box put down on belts at 0, 10 and 15 deg, μ = 0.4, h = 1 ms",
         "way, power and work with the closed form", _conveyor),
)
