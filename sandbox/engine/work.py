"""Work done by every element that carries force, added up step by step.

Over one step a force does h F . (v_before + v_after) / 2, and that makes the
balance exact: summed over all forces and impulses on a body it is its gain of
kinetic energy, to rounding. Sampling afterwards could not: an impact lasts one
step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sandbox.engine.native import real_at

Array = NDArray[np.float64]
Records = NDArray[Any]


@njit(cache=True)
def add_work(
    h: float, state: Array, before: Array,
    actions: Records, springs: Records, dampers: Records, spans: Records, nodes: Records,
) -> None:
    """Add the work [J] of the step just made to ``work``, and put it alone into ``gain``.

    ``state`` [nb, 6] and ``before`` [nb, 3] hold the velocities after and before the step.
    """
    v = np.empty((len(state), 3))
    for i in range(len(state)):
        for j in range(3):
            v[i, j] = (state[i, 3 + j] + before[i, j]) / 2
    for i in range(len(actions)):
        s = actions[i]
        a = s["a"]
        if s["motor"]:
            s["torque"] = real_at(s["motor"]) / h
        if s["b"] >= 0:
            power = s["torque"] * (v[s["b"], 2] - v[a, 2])
        else:
            power = s["fx"] * v[a, 0] + s["fy"] * v[a, 1] + s["torque"] * v[a, 2]
        s["gain"] = h * power
        s["work"] += s["gain"]
    for i in range(len(springs)):
        s = springs[i]
        a, b = s["a"], s["b"]
        rate = (
            s["ux"] * (v[b, 0] - v[a, 0]) + s["uy"] * (v[b, 1] - v[a, 1])
            + s["tb"] * v[b, 2] - s["ta"] * v[a, 2]
        )
        s["gain"] = -h * s["force"] * rate
        s["work"] += s["gain"]
    for i in range(len(dampers)):
        s = dampers[i]
        s["gain"] = h * s["torque"] * (v[s["b"], 2] - v[s["a"], 2])
        s["work"] += s["gain"]
    for e in range(len(spans)):
        s = spans[e]
        rate = 0.0
        for n in range(s["first"], s["last"]):
            node = nodes[n]
            b = node["body"]
            rate += node["jx"] * v[b, 0] + node["jy"] * v[b, 1] + node["jt"] * v[b, 2]
        s["gain"] = -h * s["tension"] * rate
        s["work"] += s["gain"]
