"""Newton's method to rest: from near an equilibrium, stable or not, onto it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.engine.still import Still
from sandbox.equilibria.balance import PoseBalance
from sandbox.numeric import Array

TIMES = 25
"""Iterations at most; near rest four do."""
EXACT = 1e-11
"""A motion by this share of the size is none: the engine closes gaps to some 1e-13 m."""
FLAT = 1e-9
"""Directions with a smaller share of the largest stiffness have none to lead anywhere."""


class Polished(NamedTuple):
    """Where it led."""

    exact: bool
    """Whether it settled."""
    balance: PoseBalance
    """At the last pose."""


def look(still: Still, drive: Array, size: float) -> PoseBalance:
    """What holds where the bodies of ``still`` are; they are left there, without speed.

    Raises:
        ArithmeticError: contacts whose place is not told.
    """
    pose = still.pose
    still.put(pose)
    still.move(drive, kept=True)
    found = PoseBalance(still, still.recording(), size)
    still.put(pose)
    return found


def polish(still: Still, drive: Array, size: float, *, most: float) -> Polished:
    """Go to rest by Newton's method, no farther than ``most`` [m] in one iteration.

    Raises:
        ArithmeticError: contacts whose place is not told.
        SimulationDiverged: the motion stopped being finite.
    """
    balance = look(still, drive, size)
    for _ in range(TIMES):
        motion = balance.free @ solved(balance.stiffness, balance.left) + balance.closing()
        way = float(np.abs(motion).max(initial=0.0))
        if way <= EXACT * size:
            return Polished(True, balance)
        still.put(balance.moved(motion * min(1.0, most / way)))
        balance = look(still, drive, size)
    return Polished(False, balance)


def solved(stiffness: Array, left: Array) -> Array:
    """The motion K^-1 r, none along what has no stiffness, [k]."""
    if not len(left):
        return left
    out, values, into = np.linalg.svd(stiffness)
    firm = values > FLAT * values.max(initial=0.0)
    return np.asarray(into[firm].T @ ((out.T @ left)[firm] / values[firm]))
