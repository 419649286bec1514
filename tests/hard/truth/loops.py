"""Linkages with loops, in the fewest coordinates."""

from __future__ import annotations

import numpy as np

from tests.hard.truth.integrate import RTOL, motion

G = 9.81


def parallelogram(times: np.ndarray, loops: int, speed: float = 1.0,
                  rtol: float = RTOL) -> np.ndarray:
    """Angle of the cranks from the x axis [rad] and its rate, shape [2, n].

    IFToMM's benchmark A02: ``loops`` + 1 cranks and ``loops`` couplers of 1 m and 1 kg, upright
    at the start, the tips moving at ``speed`` [m/s] to +x. As long as the cranks stay parallel

        ((N + 1) / 3 + N) a'' = - ((N + 1) / 2 + N) g cos a
    """
    ratio = ((loops + 1) / 2 + loops) / ((loops + 1) / 3 + loops) * G
    found = motion(times, lambda q, _: -ratio * np.cos(q), np.array([np.pi / 2]),
                   np.array([-speed]), rtol=rtol)
    return found[:, :, 0]
