"""Equations of motion integrated with DOP853 (order 8) to twelve digits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

RTOL, ATOL = 1e-12, 1e-13


def motion(times: np.ndarray, acceleration: Callable[[np.ndarray, np.ndarray], np.ndarray],
           start: np.ndarray, rate: np.ndarray, *, rtol: float = RTOL) -> np.ndarray:
    """q and q' of q'' = acceleration(q, q') at ``times`` [s], shape [2, n, coordinates]."""
    n = len(start)

    def derivative(_: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([y[n:], acceleration(y[:n], y[n:])])

    found = solve_ivp(derivative, (0.0, float(times[-1])), np.concatenate([start, rate]),
                      method="DOP853", t_eval=times, rtol=rtol, atol=ATOL)
    if not found.success:
        raise RuntimeError(found.message)
    return np.stack([found.y[:n].T, found.y[n:].T])
