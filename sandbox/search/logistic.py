"""A threshold that random starts blur: the logistic curve of the share that holds, by Bayes' rule.

The chance to hold at x is 1 / (1 + exp(∓(x - m) / w)). Flat priors of the middle m over the range
and of log w leave, on a grid, a posterior that exists for any answers, those of a sharp step too,
of which maximum likelihood has no estimate. The next points lie where the posterior thinks that
they tell most of m and w: at m ± 1.5 w of values drawn from it (Minkin, J. Am. Stat. Assoc. 82
(1987) 1098: the D-optimal ones; drawn as by Thompson, Biometrika 25 (1933) 285).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array, Flags

WIDTHS = (1e-4, 1.0)
"""Of w, in shares of the range."""
MIDDLES, SPREADS = 121, 25
"""Points of the grid."""
TELLING = 1.5434
"""Where two points tell most: ± this many w from the middle."""
LEVELS = (0.025, 0.5, 0.975)


@dataclass(frozen=True)
class Posterior:
    """What answers leave of the middle and the width."""

    rises: bool
    """Whether more holds at larger shares."""
    middles: Array
    """[m], shares of the range."""
    widths: Array
    """[w]."""
    weights: Array
    """[m, w], which add up to 1."""

    def level(self, share: float) -> tuple[float, float, float]:
        """Where such a share of starts holds: low end of the 95 % interval, median, high end."""
        shift = math.log(share / (1 - share)) * (1 if self.rises else -1)
        values = (self.middles[:, None] + shift * self.widths[None, :]).ravel()
        order = np.argsort(values)
        total = np.cumsum(self.weights.ravel()[order])
        found = np.interp(LEVELS, total - 0.5 * self.weights.ravel()[order], values[order])
        return float(found[0]), float(found[1]), float(found[2])

    def telling(self, count: int, rng: np.random.Generator) -> Array:
        """Shares at which to ask next, [count]."""
        drawn = rng.choice(self.weights.size, size=count, p=self.weights.ravel())
        middle, width = np.unravel_index(drawn, self.weights.shape)
        sides = np.where(np.arange(count) % 2, TELLING, -TELLING)
        return np.asarray(np.clip(self.middles[middle] + sides * self.widths[width], 0.0, 1.0))


def posterior(shares: Array, held: Flags, *, rises: bool) -> Posterior:
    """The posterior of answers ``held`` [n] at ``shares`` [n] of the range."""
    middles = np.linspace(0.0, 1.0, MIDDLES)
    widths = np.geomspace(*WIDTHS, SPREADS)
    found = _weighed(shares, held, rises, middles, widths)
    for _ in range(2):  # the grid is drawn together about what is left
        low, high = _part(found.weights.sum(axis=1))
        middles = np.linspace(middles[max(low - 1, 0)], middles[min(high + 1, MIDDLES - 1)],
                              MIDDLES)
        low, high = _part(found.weights.sum(axis=0))
        widths = np.geomspace(widths[max(low - 1, 0)], widths[min(high + 1, SPREADS - 1)], SPREADS)
        found = _weighed(shares, held, rises, middles, widths)
    return found


def _weighed(
    shares: Array, held: Flags, rises: bool, middles: Array, widths: Array,
) -> Posterior:
    sides = np.where(held == rises, 1.0, -1.0)
    log = np.zeros((len(middles), len(widths)))
    for share, side in zip(shares, sides, strict=True):
        log -= np.logaddexp(0.0, -side * (share - middles[:, None]) / widths[None, :])
    weights = np.exp(log - log.max())
    return Posterior(rises, middles, widths, weights / weights.sum())


def _part(weights: Array) -> tuple[int, int]:
    """The first and the last place that matter."""
    places = np.flatnonzero(weights > 1e-7 * weights.max())
    return int(places[0]), int(places[-1])


def wilson(held: int, count: int, z: float = 1.959964) -> tuple[float, float]:
    """The 95 % interval of a share of which ``held`` of ``count`` were seen (Wilson, 1927)."""
    if count == 0:
        return 0.0, 1.0
    share, more = held / count, z * z / count
    centre = (share + more / 2) / (1 + more)
    half = z / (1 + more) * math.sqrt(share * (1 - share) / count + more / (4 * count))
    return max(centre - half, 0.0), min(centre + half, 1.0)
