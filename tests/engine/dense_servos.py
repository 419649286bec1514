"""Servos and drives of actuators as dense rows, from the formulas of sandbox/engine/servos.py.

A row with a bound is ("motor", D, want, most, give): D v + want + give p = 0 while |p| < most.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sandbox.model.model import Model


def servo(
    model: Model, h: float, d: int, value: float, line: Any, v: np.ndarray, q: np.ndarray, *,
    target: float, stiff: bool,
) -> tuple[Any, ...]:
    """The row of a servo, ``extend`` or ``length``.

    Args:
        model: the mechanism.
        h: the step [s].
        d: the drive's number.
        value: its value.
        line: the row of its rate, and its place over the poses.
        v: velocities before, flat.
        q: poses, [nb, 3].
        target: of the step before, nan in the first, as the place is counted.
        stiff: whether a stiffness is taken at the step's end.
    """
    D, place = line
    drives = model.drives
    kind, most, k, c = drives.kind[d], h * drives.most[d], drives.stiffness[d], drives.damping[d]
    rate, now = D @ v, float(np.real(place(q)))
    bend = (float(np.real(place(q + h * v.reshape(q.shape)))) - now) / h - rate
    if not kind.places:
        return "motor", D, bend - value, most, 0.0
    if math.isfinite(k):
        lead = c + h * k if stiff else c / 2 + h * k / 4
        past = 0.0 if stiff else c / 2 - h * k / 4
        return "motor", D, (past * rate - k * (value - now)) / lead, most, 1 / (h * lead)
    along = rate if math.isnan(target) else (value - target) / h
    return "motor", D, bend - along - (value - now - h * along) / h, most, 0.0
