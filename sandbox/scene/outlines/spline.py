"""A smooth curve through a periodic table: the cubic spline, twice continuously differentiable."""

from __future__ import annotations

import math

import numpy as np

from sandbox.numeric import Array


class PeriodicSpline:
    """The cubic spline through values [n] at angles [n] rad that rise by less than a turn.

    Between neighbours at a distance h it is the cubic with the second derivatives M at both, and
    with h_i M_i + 2 (h_i + h_j) M_j + h_j M_k = 6 (d_j - d_i) at each of them, d the slopes of the
    chords, its first derivative goes on smoothly. At least three values.
    """

    def __init__(self, angles: Array, values: Array) -> None:
        self.angles = angles
        """Where its values are given [rad], [n]."""
        self._step = np.append(angles[1:], angles[0] + math.tau) - angles
        self._value = values
        chord = (np.roll(values, -1) - values) / self._step
        n, before = len(angles), np.roll(self._step, 1)
        matrix = np.zeros((n, n))
        i = np.arange(n)
        matrix[i, i] = 2 * (before + self._step)
        np.add.at(matrix, (i, (i - 1) % n), before)
        np.add.at(matrix, (i, (i + 1) % n), self._step)
        self._bend = np.linalg.solve(matrix, 6 * (chord - np.roll(chord, 1)))
        self._slope = chord - self._step * (2 * self._bend + np.roll(self._bend, -1)) / 6
        self._jerk = (np.roll(self._bend, -1) - self._bend) / self._step

    def __call__(self, angle: Array) -> tuple[Array, Array, Array]:
        """Value and first and second derivative at angles [m] rad, [m] each."""
        turned = (angle - self.angles[0]) % math.tau + self.angles[0]
        k = np.searchsorted(self.angles, turned, side="right") - 1
        t, slope, bend, jerk = turned - self.angles[k], self._slope[k], self._bend[k], self._jerk[k]
        return (self._value[k] + t * (slope + t * (bend / 2 + t * jerk / 6)),
                slope + t * (bend + t * jerk / 2), bend + t * jerk)
