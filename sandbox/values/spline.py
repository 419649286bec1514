"""A smooth curve through a table: the cubic spline, twice continuously differentiable.

Between neighbours at a distance h it is the cubic with the second derivatives M at both, and with
h_i M_i + 2 (h_i + h_j) M_j + h_j M_k = 6 (d_j - d_i) at each of them, d the slopes of the chords,
its first derivative is smooth. The conditions at the ends distinguish the splines: a periodic one
has no ends, a natural one has M = 0 there, so a straight line continues it smoothly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sandbox.numeric import Array
from sandbox.wording import WrongValueError


def check_distinct(points: Sequence[tuple[float, float]], *, closed: bool) -> None:
    """Check that neighbouring points of a curve differ.

    Raises:
        WrongValueError: two that do not.
    """
    for i, one in enumerate(points):
        j = (i + 1) % len(points)
        if one == points[j] and (closed or j):
            raise WrongValueError("bad-outline", f"points {i} and {j} are the same point",
                                  allowed="each point once; a closed curve closes automatically")


def natural(at: Array, values: Array, *, bent: bool = False) -> Array:
    """The natural spline through values [n] at places [n] that rise; two of them or more.

    With ``bent`` its ends are not straight: the third derivative does not jump at the place next
    to an end.

    Value, slope, half the second and a sixth of the third derivative where each piece begins,
    [n - 1, 4].
    """
    step, n = np.diff(at), len(at)
    chord = np.diff(values) / step
    matrix, i = np.eye(n), np.arange(1, n - 1)
    matrix[i, i - 1], matrix[i, i + 1] = step[:-1], step[1:]
    matrix[i, i] = 2 * (step[:-1] + step[1:])
    if bent and n > 2:
        matrix[0, :3] = -step[1], step[0] + step[1], -step[0]
        matrix[-1, -3:] = -step[-1], step[-2] + step[-1], -step[-2]
    if bent and n == 3:     # both end conditions are the same: a parabola
        matrix[0, :] = 1, -1, 0
    bend = np.linalg.solve(matrix, np.concatenate([[0.0], 6 * np.diff(chord), [0.0]]))
    slope = chord - step * (2 * bend[:-1] + bend[1:]) / 6
    return np.stack([values[:-1], slope, bend[:-1] / 2, np.diff(bend) / step / 6], axis=1)


class PeriodicSpline:
    """The spline through values [n] at angles [n] rad that rise by less than a turn.

    At least three values. With another ``period`` it repeats after that.
    """

    def __init__(self, angles: Array, values: Array, period: float = math.tau) -> None:
        self.angles = angles
        """Where its values are given [rad], [n]."""
        self._period = period
        self._step = np.append(angles[1:], angles[0] + period) - angles
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
        turned = (angle - self.angles[0]) % self._period + self.angles[0]
        k = np.searchsorted(self.angles, turned, side="right") - 1
        t, slope, bend, jerk = turned - self.angles[k], self._slope[k], self._bend[k], self._jerk[k]
        return (self._value[k] + t * (slope + t * (bend / 2 + t * jerk / 6)),
                slope + t * (bend + t * jerk / 2), bend + t * jerk)

    @property
    def pieces(self) -> Array:
        """As :func:`natural` gives them, the last one up to where it begins again, [n, 4]."""
        return np.stack([self._value, self._slope, self._bend / 2, self._jerk / 6], axis=1)
