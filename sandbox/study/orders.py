"""Order of accuracy: how fast an error falls as the step is halved.

With errors e(h) = C h^p of one motion at h, h/2, h/4 against an exact solution,

    p = log2( e(h) / e(h/2) )

Every element that carries force is held against an independent solution of its
own; see :mod:`sandbox.study.exact_motions`. Where the scheme makes the motion itself, no error
but rounding is left: there is no order then, and the error is held against its floor.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

STEPS = (1e-3, 5e-4, 2.5e-4)
"""Steps of the study [s]."""
EXACT = math.inf
"""The order of what has no error but rounding."""


@dataclass(frozen=True)
class ExactMotion:
    """An element that carries force, a motion it makes, and the exact motion."""

    name: str
    machine: Callable[[float], Mechanism]
    """The mechanism at a step [s]."""
    error: Callable[[Recording], float]
    """Largest error of a run against the exact solution."""
    unit: str
    theory: float
    """Order that is looked for: 2, or :data:`EXACT`."""
    solution: str
    """The equation and its independent solution."""
    why: str
    """Where the order comes from."""
    steps: Sequence[float] = STEPS
    floor: float = 0.0
    """Errors up to here are rounding's, in the unit; of what is exact."""


@dataclass(frozen=True)
class Order:
    """What was measured of one element."""

    element: ExactMotion
    errors: tuple[float, ...]
    """One for each step."""

    @property
    def orders(self) -> tuple[float, ...]:
        """Order from each step to the next, log2 of the ratio of their errors.

        :data:`EXACT` where neither is above the floor.
        """
        e = np.array(self.errors)
        ratio = np.diff(-np.log(e)) / np.diff(-np.log(np.array(self.element.steps)))
        below = np.maximum(e[1:], e[:-1]) <= self.element.floor
        return tuple(float(p) for p in np.where(below, EXACT, ratio))


def measure(element: ExactMotion) -> Order:
    """Run the element's motion at every step."""
    return Order(element, tuple(
        element.error(simulate(element.machine(step))) for step in element.steps))
