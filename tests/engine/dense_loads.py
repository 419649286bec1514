"""Loads for the dense step, written from their laws in plain Python and not from the engine.

A load's three numbers are those of its law for the motion that a step is said to make; whether the
step then comes out as it was said is what the comparison asks.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

Law = Callable[..., tuple[float, float, float]]
"""From x, y, vx, vy, omega, ax, ay, alpha, t of the point, along the load's axes, to force and
torque."""


class PlainLoad(NamedTuple):
    """A load as a test says it."""

    body: int
    at: np.ndarray
    """From the centre of mass, in the body's frame."""
    turning: bool
    law: Law


def press(
    loads: list[PlainLoad], q: np.ndarray, before: np.ndarray, after: np.ndarray, h: float,
    t: float, stiff: set[int],
) -> np.ndarray:
    """Forces and torques of loads [3 nb] in a step from velocities ``before`` to ``after``.

    Those on bodies in ``stiff`` are taken at the step's end.
    """
    found = np.zeros(q.shape)
    for load in loads:
        b = load.body
        end = b in stiff
        x, y, angle = q[b] + (h * after[b] if end else 0.0)
        u, v, w = after[b] if end else (before[b] + after[b]) / 2
        a, ay, alpha = (after[b] - before[b]) / h
        c, s = math.cos(angle), math.sin(angle)
        R = np.array([[c, -s], [s, c]])
        rx, ry = R @ load.at
        velocity = np.array([u - w * ry, v + w * rx])
        acceleration = np.array([a - alpha * ry - w * w * rx, ay + alpha * rx - w * w * ry])
        if load.turning:
            velocity, acceleration = R.T @ velocity, R.T @ acceleration
        fx, fy, torque = load.law(x + rx, y + ry, *velocity, w, *acceleration, alpha, t)
        if load.turning:
            fx, fy = R @ (fx, fy)
        found[b] += fx, fy, torque + rx * fy - ry * fx
    return found.ravel()


def random_loads(rng: np.random.Generator) -> tuple[list[dict[str, Any]], list[Any]]:
    """Loads of all kinds: as a scene says them, and what each is, (body, at, turning, law)."""
    c, d, k, m = (float(10 ** rng.uniform(-1, 1)) for _ in range(4))
    stiff = float(10 ** rng.uniform(2, 5))
    at = rng.uniform(-0.05, 0.05, 2).tolist()
    specs: list[dict[str, Any]] = [
        {"type": "law", "name": "swim", "bodies": ["b0"], "at": at, "frame": "body",
         "force": [f"={c} - {d} * vx * speed", f"=-{k} * vy - {m} * ay"],
         "torque": f"=-0.001 * omega + 0.01 * sin({c} * t)"},
        {"type": "law", "name": "field", "bodies": ["b1", "b3"],
         "acceleration": [f"=-{k} * x + {c} * vy", f"=-{k} * y - {c} * vx"]},
        {"type": "drag", "name": "mud", "bodies": ["b2"], "linear": stiff, "turning": 1e-3,
         "flow": [0.1, -0.2]},
        {"type": "drag", "name": "air", "bodies": ["b*"], "area": d, "coefficient": 0.5,
         "density": 1.2}]

    def swim(x: float, y: float, vx: float, vy: float, w: float, ax: float, ay: float, al: float,
             t: float) -> tuple[float, float, float]:
        return (c - d * vx * math.hypot(vx, vy), -k * vy - m * ay,
                -0.001 * w + 0.01 * math.sin(c * t))

    def field(mass: float) -> Law:
        return lambda x, y, vx, vy, *_: (mass * (-k * x + c * vy), mass * (-k * y - c * vx), 0.0)

    def mud(x: float, y: float, vx: float, vy: float, w: float, *_: float
            ) -> tuple[float, float, float]:
        return -stiff * (vx - 0.1), -stiff * (vy + 0.2), -1e-3 * w

    def air(x: float, y: float, vx: float, vy: float, *_: float) -> tuple[float, float, float]:
        size = 0.5 * 1.2 * 0.5 * d * math.hypot(vx, vy)
        return -size * vx, -size * vy, 0.0

    return specs, [("b0", np.array(at), True, lambda mass: swim),
                   *((b, None, False, field) for b in ("b1", "b3")),
                   ("b2", None, False, lambda mass: mud),
                   *((f"b{i}", None, False, lambda mass: air) for i in range(4))]
