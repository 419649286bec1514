"""Springs whose force is a law: Duffing's oscillator, a bungee cord, a bump stop."""

from __future__ import annotations

import math

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.study.plain_mechanisms import G, fixed, mass, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

H = 5e-4
K1, K3 = 100.0, 2e4
"""Of the hardening spring [N/m, N/m^3]."""


def elliptic(m: float) -> float:
    """The complete integral K(m), by the arithmetic-geometric mean."""
    a, b = 1.0, math.sqrt(1.0 - m)
    for _ in range(20):
        a, b = (a + b) / 2, math.sqrt(a * b)
    return math.pi / (2 * a)


def _swings(x: float, *, gravity: float, duration: float, **spring: object) -> Recording:
    """A mass of 1 kg let go at a stretch x, on a spring along x."""
    return simulate(mechanism(
        duration=duration, step=H, gravity=(gravity, 0.0), run={"sample_rate": 1 / H},
        bodies=[fixed("wall"), mass("bob", 1.0, (1.0 + x, 0.0))],
        springs=[{"type": "linear", "name": "spring", "a": "wall", "b": "bob", "rest_length": 1.0,
                  **spring}]))


def _duffing() -> Findings:
    checks, exact, found = [], [], []
    amplitudes = (0.02, 0.05, 0.1, 0.2)
    for amplitude in amplitudes:
        square = K1 + K3 * amplitude**2
        period = 4 * elliptic(K3 * amplitude**2 / (2 * square)) / math.sqrt(square)
        run = _swings(amplitude, gravity=0.0, duration=3.3 * period,
                      force=f"={K1} * stretch + {K3} * stretch ** 3")
        x, t = run["bob.x"] - 1.0, run.time
        i = np.flatnonzero((x[:-1] > 0) & (x[1:] <= 0))
        zeros = t[i] + x[i] / (x[i] - x[i + 1]) * (t[i + 1] - t[i])
        exact.append(period)
        found.append(float(np.diff(zeros).mean()))
        checks.append(Check(
            f"period at {1e3 * amplitude:g} mm", "s", period, found[-1],
            period * 3 * square * H**2 / 24,
            "the leapfrog's (w h)²/24 with the largest slope, K1 + 3 K3 A², which is at most 3 w²"))
    return Findings(checks, [Panel("Period of a hardening spring", "amplitude [m]", "period [s]", [
        Curve("4 K(m) / w", np.array(amplitudes), np.array(exact)),
        Curve("engine", np.array(amplitudes), np.array(found), "points")])])


def _one_sided() -> Findings:
    checks, free, k = [], 0.4, 200.0
    run = _swings(-free, gravity=G, duration=2.0, stiffness=k, only="pull")
    deepest = (G + math.sqrt(G * G + 2 * k * G * free)) / k
    omega = math.sqrt(k)
    allowed = deepest * (omega * H)**2 + G * H * H
    why = "(w h)² of it, and what falls in a step before the cord is seen taut"
    checks.append(Check("lowest point of a bungee jump, below the cord's length", "m", deepest,
                        float(run["bob.x"].max()) - 1.0, allowed, why))
    checks.append(Check("largest pull", "N", k * deepest, float(run["spring.force"].max()),
                        k * allowed, "the same times k"))
    checks.append(Check("least pull", "N", 0.0, float(run["spring.force"].min()), 0.0,
                        "a cord never pushes"))
    speed, stop = 1.0, 1e4
    run = simulate(mechanism(
        duration=0.2, step=H, run={"sample_rate": 1 / H},
        bodies=[fixed("wall"), {**mass("bob", 1.0, (1.05, 0.0)), "velocity": (-speed, 0.0)}],
        springs=[{"type": "linear", "name": "spring", "a": "wall", "b": "bob", "rest_length": 1.0,
                  "stiffness": stop, "only": "push"}]))
    checks.append(Check("speed after a bump stop", "m/s", speed, float(run["bob.vx"][-1]),
                        speed * math.sqrt(stop) * H / 2, "the steps in which it is met and left "
                        "are each off by up to h v of the way, w h / 2 of the speed"))
    return Findings(checks)


CASES = (
    Case("duffing", "Period of a hardening spring",
         "T = 4 K(m) / w, w² = k₁ + k₃ A², m = k₃ A² / 2w²",
         "1 kg on F = k₁ s + k₃ s³, let go at four amplitudes, h = 0.5 ms",
         "the time from zero to zero against the complete elliptic integral", _duffing),
    Case("one_sided_springs", "Springs that only pull, or only push",
         "m g (L + s) = k s² / 2", "a bungee jump of 0.4 m; a mass that meets a bump stop at 1 m/s",
         "lowest point, largest and least pull, the speed that is given back", _one_sided),
)
