"""A model's measurements near a point, to the second order of its parameters.

Where a fit is repeated thousands of times on noise that moves its parameters little, the runs of
one such surface stand for all of its runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from sandbox.numeric import Array, Integers


@dataclass(frozen=True)
class Surface:
    """f(c + d) = f + J d + d' H d / 2."""

    centre: Array
    """c, shares of the ranges, [p]."""
    value: Array
    """f, [m]."""
    slopes: Array
    """J, [m, p]."""
    bends: Array
    """H, [m, p, p]."""

    def __call__(self, shares: Array) -> Array:
        """What would be measured, [n, m], at shares [n, p]."""
        off = shares - self.centre
        return np.asarray(self.value + off @ self.slopes.T
                          + np.einsum("ni,mij,nj->nm", off, self.bends, off) / 2)

    def only(self, rows: Integers) -> Surface:
        """The surface of some of the measurements, by their numbers."""
        return Surface(self.centre, self.value[rows], self.slopes[rows], self.bends[rows])


def points_of_surface(centre: Array, steps: Array) -> Array:
    """Points to be run, [n, p]: the centre, each way alone, and each two ways together.

    1 + p (p + 1) of them.

    Args:
        centre: [p].
        steps: how far each way goes, [p].
    """
    ways = np.diag(steps)
    pairs = [ways[i] + ways[j] for i, j in combinations(range(len(steps)), 2)]
    found = [np.zeros(len(steps))]
    for way in [*ways, *pairs]:
        found += [way, -way]
    return np.asarray(centre + np.array(found))


def surface_of(values: Array, centre: Array, steps: Array) -> Surface:
    """The surface by central differences from runs at :func:`points_of_surface`.

    Args:
        values: what they measured, [n, m].
        centre: [p].
        steps: [p].
    """
    p = len(steps)
    middle, up, down = values[0], values[1::2], values[2::2]
    slopes = ((up[:p] - down[:p]) / (2 * steps[:, None])).T
    second = up + down - 2 * middle  # of a pair: H_ii a^2 + H_jj b^2 + 2 H_ij a b
    bends = np.zeros((values.shape[1], p, p))
    for i in range(p):
        bends[:, i, i] = second[i] / steps[i]**2
    for row, (i, j) in enumerate(combinations(range(p), 2), start=p):
        bends[:, i, j] = bends[:, j, i] = (
            second[row] - second[i] - second[j]) / (2 * steps[i] * steps[j])
    return Surface(centre, middle, slopes, bends)
