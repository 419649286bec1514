"""Coordinates of elements between two bodies: the distance of two points, or a relative angle.

A coordinate q has the rate

    q' = d . (v_b - v_a) + t_a omega_a + t_b omega_b

An effort along it (a force or a torque that is positive where q grows) is the force d on ``b``, the
opposite force on ``a``, and the moments t_a and t_b.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine.kernel import kernel
from sandbox.numeric import Array


@kernel
def ends(element: Any, body: Array, turn: Array) -> tuple[float, float, float, float, float, float]:
    """Arms of the two points of an element, and the vector from the first point to the second.

    Args:
        element: a record with bodies ``a`` and ``b`` and the points ``ax``, ``ay``, ``bx``, ``by``.
        body: poses of the centres of mass, [nb, 6].
        turn: cosine and sine of their angles, [nb, 2].

    Returns:
        x and y [m] in the world of the arm on ``a``, the arm on ``b``, and the vector.
    """
    a, b = element["a"], element["b"]
    ca, sa, cb, sb = turn[a, 0], turn[a, 1], turn[b, 0], turn[b, 1]
    ax, ay = ca * element["ax"] - sa * element["ay"], sa * element["ax"] + ca * element["ay"]
    bx, by = cb * element["bx"] - sb * element["by"], sb * element["bx"] + cb * element["by"]
    return ax, ay, bx, by, body[b, 0] + bx - body[a, 0] - ax, body[b, 1] + by - body[a, 1] - ay


@kernel
def measure_distance(element: Any, out: Any, body: Array, turn: Array) -> None:
    """Measure the distance of two points; points that coincide have no direction.

    ``out`` gets the value ``way`` and the coefficients ``dx``, ``dy``, ``ta``, ``tb``.
    """
    ax, ay, bx, by, x, y = ends(element, body, turn)
    length = math.hypot(x, y)
    dx, dy = (x / length, y / length) if length > 0.0 else (0.0, 0.0)
    out["way"], out["dx"], out["dy"] = length, dx, dy
    out["ta"], out["tb"] = ay * dx - ax * dy, bx * dy - by * dx


@kernel
def measure_angle(element: Any, out: Any, body: Array) -> None:
    """The same of the angle of ``b`` against ``a``."""
    out["way"] = body[element["b"], 2] - body[element["a"], 2]
    out["dx"] = out["dy"] = 0.0
    out["ta"], out["tb"] = -1.0, 1.0


@kernel
def rate(element: Any, out: Any, velocity: Array) -> float:
    """Rate of a coordinate as its bodies move with ``velocity`` [nb, 3]."""
    a, b = element["a"], element["b"]
    return float(out["dx"] * (velocity[b, 0] - velocity[a, 0])
                 + out["dy"] * (velocity[b, 1] - velocity[a, 1])
                 + out["ta"] * velocity[a, 2] + out["tb"] * velocity[b, 2])


@kernel
def put_row(J: Array, entry: int, out: Any) -> None:
    """The two entries of a bilateral row on a coordinate."""
    J[entry, 0], J[entry, 1], J[entry, 2] = 0.0 - out["dx"], 0.0 - out["dy"], out["ta"]
    J[entry + 1, 0], J[entry + 1, 1], J[entry + 1, 2] = out["dx"], out["dy"], out["tb"]


@kernel
def add_effort(element: Any, out: Any, effort: float, force: Array) -> None:
    """Add an effort along a coordinate to forces and torques on the bodies, [nb, 3]."""
    a, b = element["a"], element["b"]
    force[a, 0] -= out["dx"] * effort
    force[a, 1] -= out["dy"] * effort
    force[a, 2] += out["ta"] * effort
    force[b, 0] += out["dx"] * effort
    force[b, 1] += out["dy"] * effort
    force[b, 2] += out["tb"] * effort
