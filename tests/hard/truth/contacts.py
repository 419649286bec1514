"""Statics of boxes at rest, and what touching balls do when they are struck."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def centre_of_pressure(weights: Sequence[float], at: Sequence[float], push: float = 0.0,
                       height: float = 0.0) -> float:
    """Where the ground carries a body [m]: moments of its weights and a push along +x vanish."""
    return float((np.dot(weights, at) + push * height) / np.sum(weights))


def struck_in_sequence(speeds: Sequence[float], restitution: float) -> list[float]:
    """Speeds of equal balls in a row after all impacts, one after the other, the fastest first.

    Each impact turns the speed of approach u of two neighbours into -e u and keeps their sum.
    """
    v = [float(speed) for speed in speeds]
    while True:
        approach = [v[i] - v[i + 1] for i in range(len(v) - 1)]
        i = int(np.argmax(approach))
        if approach[i] <= 1e-12:
            return v
        change = (1 + restitution) * approach[i] / 2
        v[i] -= change
        v[i + 1] += change
