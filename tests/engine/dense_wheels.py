"""Gaps of teeth and of circles that roll, from textbook forms that take complex numbers too.

With inv x = tan x - x, o the sum of the base radii (their difference inside) and x the pressure
angle at the present distance d, cos x = o / d, the flanks of two gears are apart by

    s (o inv x - o b + r_a t_a -+ r_b t_b)        b the bearing of the line of centres

up to a constant, s = -1 for one flank and 1 for the other, r base radii, t angles.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from sandbox.model.model import Model

Apart = Callable[[np.ndarray], np.ndarray]
Gap = Callable[[np.ndarray], Any]


def bearing(d: np.ndarray, near: float) -> Any:
    """Of a vector, from a direction within a quarter turn of it [rad]."""
    c, s = math.cos(near), math.sin(near)
    return near + np.arctan((c * d[1] - s * d[0]) / (c * d[0] + s * d[1]))


def teeth(model: Model, j: int, side: float, apart: Apart, near: float) -> Gap:
    """How far a flank is from being met, along the line of action, were there no play [m].

    ``apart`` gives the way from the centre of ``a`` to that of ``b`` (of a rack to a point of its
    pitch line) at poses q [nb, 3]; ``near`` is about where that leads.
    """
    joints = model.joints
    a, b = joints.bodies[j].tolist()
    pressure = float(joints.pressure[j])
    ra, rb = joints.radii[j] * math.cos(pressure)

    def rack(q: np.ndarray) -> Any:
        x, y = joints.along[j]
        lean = q[b, 2] - side * pressure
        action = side * np.array([np.cos(lean) * x - np.sin(lean) * y,
                                  np.sin(lean) * x + np.cos(lean) * y])
        return action @ apart(q) - side * ra * (q[a, 2] - q[b, 2])

    def gear(q: np.ndarray) -> Any:
        d = apart(q)
        outside = not joints.inside[j]
        o = side * (ra + rb if outside else ra - rb)
        x = np.arccos(abs(o) / np.sqrt((d**2).sum()))
        way = (abs(o) * (np.tan(x) - x) - o * bearing(d, near)
               + side * (ra * q[a, 2] + (rb if outside else -rb) * q[b, 2]))
        return way if outside else -way

    return rack if joints.kind[j].keeps == "rack" else gear


def rolling(model: Model, j: int, apart: Apart, near: float) -> Gap:
    """How far two circles have slipped [m]."""
    joints = model.joints
    a, b = joints.bodies[j].tolist()
    ra, rb = joints.radii[j]
    rb = -rb if joints.inside[j] else rb
    return lambda q: ra * (q[a, 2] - bearing(apart(q), near)) + rb * (
        q[b, 2] - bearing(apart(q), near))
