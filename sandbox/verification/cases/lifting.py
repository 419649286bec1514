"""Cords that lift off their wheels: a wheel pushed into a cord, a pendulum that meets a peg."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.study.plain_mechanisms import G, fixed, mass, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

HALF, RADIUS = 0.3, 0.04
LENGTH, PEG = 0.5, 0.01


def _guide(body: str, at: tuple[float, float] = (0.0, 0.0), radius: float = 0.0,
           side: str = "left") -> dict[str, Any]:
    return {"body": body, "at": at, "radius": radius, "side": side}


def _path(height: Array) -> Array:
    """Between two eyes, past or round a wheel midway whose centre is that high above them [m]."""
    away = np.hypot(HALF, height)
    bend = np.maximum(2 * (np.arcsin(RADIUS / away) - np.arctan2(height, HALF)), 0.0)
    round_it = 2 * np.sqrt(away**2 - RADIUS**2) + RADIUS * bend
    return np.asarray(np.where(bend > 0, round_it, 2 * HALF))


def _pushed() -> Findings:
    """A wheel comes down on a straight cord twice, and leaves it again."""
    stiffness, start = 2000.0, 20.0
    run = simulate(mechanism(
        duration=2.0, run={"sample_rate": 2000.0}, bodies=[
            fixed("ground"), {"name": "wheel", "motion": "scheduled", "at": (0.0, 0.06),
                              "path": {"y": "=0.06 - 0.12 * sin(pi * t) ** 2"}}],
        tendons=[{"name": "cord", "stiffness": stiffness, "pretension": start, "guides": [
            _guide("ground", (-HALF, 0.0)), _guide("wheel", radius=RADIUS),
            _guide("ground", (HALF, 0.0))]}]))
    height = 0.06 - 0.12 * np.sin(math.pi * run.time)**2
    tension = start + stiffness * (_path(height) - 2 * HALF)
    off = height >= RADIUS
    return Findings([
        Check("tension, largest difference", "N", 0.0,
              float(np.abs(run["cord.tension"] - tension).max()), 1e-9 * tension.max(), "rounding"),
        Check("tension at the end", "N", start, float(run["cord.tension"][-1]), 1e-9 * start,
              "rounding"),
        Check("samples in which it is off the wheel, or on it, and should not be", "1", 0.0,
              float((run["cord.lifted_1"] != off).sum()), 0.0, "none"),
    ], [Panel("A wheel pushed into a cord", "time [ms]", "tension [N]", [
        Curve("closed form", 1e3 * run.time, tension),
        Curve("engine", 1e3 * run.time, run["cord.tension"])])])


def _interrupted(depth: float, start: float, duration: float, h: float = 2.5e-4) -> Any:
    """A pendulum let go at an angle [rad], its peg so far below the point that it hangs on."""
    return simulate(mechanism(
        duration=duration, step=h, run={"sample_rate": 1 / h}, gravity=(0.0, -G), bodies=[
            fixed("ground"), mass("bob", 1.0, (LENGTH * math.sin(start),
                                               -LENGTH * math.cos(start)))],
        tendons=[{"name": "cord", "stiffness": 1e7, "guides": [
            _guide("ground"), _guide("ground", (-PEG, -depth), PEG, "right"), _guide("bob")]}]))


def _galileo() -> Findings:
    """From 40 degrees as high again; from level once round the peg, or not."""
    swing, low, high = _interrupted(0.3, math.radians(40), 1.3), 0.32, 0.25
    height = -LENGTH * math.cos(math.radians(40))
    loop, fall = (_interrupted(depth, math.pi / 2, 0.8) for depth in (low, high))
    arm = LENGTH - low - math.pi * PEG
    late = loop.time > 0.4
    top = int(np.flatnonzero(late)[np.argmax(loop["bob.y"][late])])

    def pull(phi: float) -> float:  # the tension by m g, where it has bent by phi
        free = LENGTH - high - PEG * phi
        return (2 * (high + PEG * math.sin(phi) + free * math.cos(phi)) / free + math.cos(phi))

    slack, beyond = math.pi / 2, math.pi
    while beyond - slack > 1e-12:  # it pulls at the first and would push at the second
        middle = (slack + beyond) / 2
        slack, beyond = (middle, beyond) if pull(middle) > 0 else (slack, middle)
    hangs = int(np.flatnonzero((fall["cord.tension"] == 0) & (fall.time > 0.4))[0])
    place = (-PEG + PEG * math.cos(slack) - (LENGTH - high - PEG * slack) * math.sin(slack),
             -high - PEG * math.sin(slack) - (LENGTH - high - PEG * slack) * math.cos(slack))
    moved = 2.5e-4 * math.hypot(float(fall["bob.vx"][hangs]), float(fall["bob.vy"][hangs]))
    bends = 2.5e-4**2 * G * 6  # m g sin and 6 m g at the lowest point bend the way of a step
    return Findings([
        Check("height that it comes to beyond the peg", "m", height,
              float(swing["bob.y"][(swing.time > 0.3) & (swing.time < 0.8)].max()),
              1e-4 * LENGTH, "what a cord of 10⁷ N/m damps as it takes up the curve"),
        Check("and back, off the peg", "m", height, float(swing["bob.y"][swing.time > 0.9].max()),
              2e-4 * LENGTH, "twice that"),
        Check("top of its way round", "m", arm - low, float(loop["bob.y"][top]),
              max(bends, 1e-4 * LENGTH), "the same"),
        Check("tension there, by the weight", "1", 2 * (low - arm) / arm - 1,
              float(loop["cord.tension"][top]) / G, 2e-3, "the speed, from the energy's loss"),
        Check("where it falls slack below a peg that is too high, x", "m", place[0],
              float(fall["bob.x"][hangs]), 3 * moved, "what it moves in three steps"),
        Check("y", "m", place[1], float(fall["bob.y"][hangs]), 3 * moved, "the same"),
    ], [Panel("Ways of the bob", "x [mm]", "y [mm]", [
        Curve("from 40 degrees", 1e3 * swing["bob.x"], 1e3 * swing["bob.y"]),
        Curve("peg 320 mm below", 1e3 * loop["bob.x"], 1e3 * loop["bob.y"]),
        Curve("peg 250 mm below", 1e3 * fall["bob.x"], 1e3 * fall["bob.y"])],
        scale="plane")])


CASES = (
    Case("pushed_wheel", "A wheel pushed into a cord",
         "T = T₀ + k (2 √(a² + y² − r²) + r φ − 2 a), φ ≥ 0",
         "a wheel of 40 mm comes down on a straight cord twice and leaves it again",
         "tension with two tangents and an arc, and when the cord is off the wheel", _pushed),
    Case("galileo", "A pendulum that meets a peg",
         "v² = 2 g Δh; T = m v²/(l − d − r φ) + m g cos φ",
         "let go at 40° and level, a peg of 10 mm 300, 320 and 250 mm below",
         "heights, the tension at the top of a full turn and where the cord falls slack with "
         "closed forms", _galileo),
)
