"""Slots with a path: a pin on a circle, a cycloid and a parabola, against closed forms."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from sandbox.recording.recording import Recording
from tests.support.mechanisms import G, Json, fixed, mass, simulated

from .case import STEPS, Check, case, order_check
from .test_orders import SMOOTH, oscillated, second_order

R, M = 0.2, 0.1
LENGTH = 0.2
"""From the bottom of the cycloid to its end [m]: four times the radius of the rolling circle."""


def circle(count: int) -> list[tuple[float, float]]:
    """Points of a circle of radius R about the origin, counter-clockwise from the bottom."""
    return [(R * math.sin(a), -R * math.cos(a)) for a in math.tau * np.arange(count) / count]


def beads(step: float, duration: float, joint: Json, *at: tuple[float, float], g: float = G,
          speed: float = 0.0) -> Recording:
    """Beads of 100 g on equal joints of a frame, every step recorded."""
    names = [f"bead{k}" for k in range(len(at))]
    return simulated(
        duration, step, g=g, every_step=True,
        bodies=[fixed("frame"), *(mass(name, M, place, velocity=(speed, 0.0))
                                  for name, place in zip(names, at, strict=True))],
        joints=[{**joint, "name": name.replace("bead", "slot"), "a": "frame", "b": name}
                for name in names])


RING = {"type": "slot", "path": circle(48), "closed": True}


@case("Bead on a circular path: pendulum", "θ″ = −(g / r) sin θ, N = m (g cos θ + r θ′²)",
      f"{SMOOTH}; the path has 48 points; and against the same bead on a rod")
def test_bead_on_circle() -> Iterator[Check]:
    start = 2.0
    swing = oscillated(lambda x: -G / R * float(np.sin(x)), start)
    at = R * math.sin(start), -R * math.cos(start)

    def run(step: float) -> Recording:
        return beads(step, 1.0, RING, at)

    yield from second_order(run, {"slot0.position": lambda t: R * swing(t)})
    yield from second_order(run, {"slot0.normal": lambda t: M * G * (
        3 * np.cos(swing(t)) - 2 * math.cos(start))}, after=STEPS[0])
    for step in STEPS:
        rod = beads(step, 1.0, {"type": "rod", "on_a": (0.0, 0.0), "on_b": (0.0, 0.0)}, at)
        away = np.hypot(*(run(step)[f"bead0.{axis}"] - rod[f"bead0.{axis}"] for axis in "xy"))
        yield Check("distance from the bead on a rod", "m", 0.0, away.max(), 1e-6,
                    "the spline is within 1e-10 m of the circle, and its slope within 1e-7")


@case("Beads on a cycloid: tautochrone", "s = s₀ cos(t √(g / 4 r)) from any height",
      f"{SMOOTH}; three beads on a path of 181 points, arc lengths from the bottom")
def test_tautochrone() -> Iterator[Check]:
    rate, r, starts = math.sqrt(G / LENGTH), LENGTH / 4, (-2.5, -1.5, 0.5)
    t = np.linspace(-3.0, 3.0, 181)
    points = list(zip(r * (t + np.sin(t)), r * (1 - np.cos(t)), strict=True))

    def at(angle: float) -> tuple[float, float]:
        return r * (angle + math.sin(angle)), r * (1 - math.cos(angle))

    joint = {"type": "slot", "path": points}
    yield from second_order(lambda step: beads(step, 1.0, joint, *map(at, starts)), {
        f"slot{k}.position": lambda t, angle=angle: LENGTH * (
            math.sin(1.5) + math.sin(angle / 2) * np.cos(rate * t))
        for k, angle in enumerate(starts)})


@case("Bead on a rough circle", "v′ = −μ v² / r: s = (r / μ) ln(1 + μ v₀ t / r)",
      "errors of the arc length at h = 1, 0.5 and 0.25 ms; friction follows the normal force")
def test_bead_on_rough_circle() -> Iterator[Check]:
    mu, speed = 0.3, 1.0
    yield from second_order(
        lambda step: beads(step, 1.0, {**RING, "friction_coefficient": mu}, (0.0, -R), g=0.0,
                           speed=speed),
        {"slot0.position": lambda t: R / mu * np.log(1 + mu * speed / R * t)})


@case("Bead on the parabola of a free plate", "E and p are constant",
      "kinetic energy at h = 1, 0.5 and 0.25 ms before the bead comes to the end: order 2; "
      "momentum to rounding")
def test_bead_on_free_plate() -> Iterator[Check]:
    x = np.linspace(-0.2, 0.2, 41)
    masses = {"plate": (0.5, 0.004), "bead": (M, 1e-5)}

    def run(step: float) -> Recording:
        return simulated(
            0.12, step, every_step=True,
            bodies=[{"name": "plate", "mass": 0.5, "inertia": 0.004, "angular_velocity": 2.0},
                    {"name": "bead", "mass": M, "inertia": 1e-5, "velocity": (1.0, 0.0)}],
            joints=[{"type": "slot", "name": "slot", "a": "plate", "b": "bead",
                     "path": list(zip(x, 4 * x**2, strict=True))}])

    energies = []
    for step in STEPS:
        last = run(step)
        energies.append(np.abs(0.058 - sum(
            m * (last[f"{name}.vx"]**2 + last[f"{name}.vy"]**2) / 2
            + inertia * last[f"{name}.omega"]**2 / 2
            for name, (m, inertia) in masses.items())).max())
        for axis, expected in (("vx", 0.1), ("vy", 0.0)):
            total = sum(m * last[f"{name}.{axis}"] for name, (m, _) in masses.items())
            yield Check(f"momentum, {axis}", "N s", expected, total, 1e-13, "rounding")
    for (h, k), (a, b) in zip(pairwise(STEPS), pairwise(energies), strict=True):
        yield order_check("the kinetic energy", 2, h, k, a, b)
