"""A law in a loop with a plant: held inputs, limits and rate limits as a run has them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.signal import cont2discrete

from sandbox.numeric import Array


@dataclass
class Plant:
    """x' = A x + B u, y = C x, exactly over periods h in which u is held."""

    A: Any
    B: Any
    C: Any
    h: float
    x: Array = field(init=False)

    def __post_init__(self) -> None:
        A, B = np.atleast_2d(np.array(self.A, float)), np.array(self.B, float).reshape(-1, 1)
        self.C = np.array(self.C, float).reshape(1, -1)
        self.Ad, self.Bd, *_ = cont2discrete((A, B, self.C, np.zeros((1, 1))), self.h)
        self.x = np.zeros((len(A), 1))

    def reading(self) -> float:
        return float((self.C @ self.x)[0, 0])

    def step(self, u: float) -> None:
        self.x = self.Ad @ self.x + self.Bd * u

    def fraction(self) -> tuple[Array, Array]:
        """Numerator and denominator of C (z - Ad)^-1 Bd, highest power first."""
        from scipy.signal import ss2tf
        numerator, denominator = ss2tf(self.Ad, self.Bd, self.C, np.zeros((1, 1)))
        return numerator[0], denominator


def closed(law: Any, plant: Any, targets: Sequence[float] | Callable[[int], float], count: int, *,
           h: float, start: float = 0.0, limits: tuple[float, float] = (-math.inf, math.inf),
           slew: float = math.inf) -> tuple[Array, Array]:
    """Readings and inputs [count] of a loop of one reading and one input."""
    target = targets if callable(targets) else targets.__getitem__
    applied, rows = start, []
    for k in range(count):
        reading = plant.reading()
        if k == 0:
            law.begin([reading], [target(0)], [applied])
        wanted = law.act(k * h, [reading], [target(k)], [applied])[0]
        applied = cut(wanted, applied, limits, slew * h)
        rows.append((reading, applied))
        plant.step(applied)
    return np.array(rows).T


def fed(law: Any, errors: Sequence[float], *, limits: tuple[float, float] = (-math.inf, math.inf),
        most: float = math.inf, start: float = 0.0) -> tuple[Array, Array]:
    """What a law wants and what it gets [n] when its reading is 0 and its target an error."""
    applied, rows = start, []
    for k, error in enumerate(errors):
        if k == 0:
            law.begin([0.0], [error], [applied])
        wanted = law.act(float(k), [0.0], [error], [applied])[0]
        applied = cut(wanted, applied, limits, most)
        rows.append((wanted, applied))
    return np.array(rows).T


def cut(wanted: float, now: float, limits: tuple[float, float], most: float) -> float:
    """Rate limit, then limits."""
    return min(max(min(max(wanted, now - most), now + most), limits[0]), limits[1])
