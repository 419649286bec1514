"""Parameters of a model from noisy data: the estimate, how sure it is, what the data can't tell.

Maximum likelihood for independent normal noise whose size may differ from column to column and is
estimated with the parameters. Intervals are those of the model made linear at the estimate
(Seber and Wild, Nonlinear Regression, 1989, ch. 5), with Student's t of each parameter's own
freedom; directions come from the singular values of the weighted Jacobian.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from sandbox.errors import SandboxError
from sandbox.numeric import Array, Integers

DIFFERENCE = 1e-3
"""Of a range: half the distance of the two runs whose difference is a column of the Jacobian."""
ROUNDS = 8
"""At most so often is the noise of columns estimated anew."""
SETTLED = 0.02
"""Noise that changes by a smaller share is known."""
BLIND = 0.5
"""A direction whose 95 % interval goes further than this to each side, in ranges, is not told."""
FINE = 1e-8
"""The search ends where a round lowers the sum of squares by a smaller share: of m numbers the
parameters are then within some sqrt(m FINE) of their standard deviations of the least."""
FOLLOWS, ALSO = 3.0, 1.6
"""Residuals that correlate with their neighbours by more standard errors are no noise, ..."""
SHORT = 10
"""... of columns of more numbers than this."""
Model = Callable[[Array], Array]
"""Shares [n, p] to what would be measured [n, m]."""


@dataclass(frozen=True)
class Estimated:
    """Parameters as shares of their ranges."""

    shares: Array
    """[p]."""
    noise: Array
    """Standard deviation of each column of data, in its unit, [columns]."""
    jacobian: Array
    """What is measured, over its noise, per share, [m, p]."""
    residuals: Array
    """Model less data, [m]."""
    columns: Integers
    """Which column each number belongs to, [m]."""
    freedom: float
    """Numbers less parameters, of which the noise was estimated; infinite where it was given."""

    @cached_property
    def singular(self) -> tuple[Array, Array]:
        """Singular values [p], largest first, and directions [p, p], a row each."""
        _, values, rows = np.linalg.svd(self.jacobian, full_matrices=True)
        full = np.zeros(self.jacobian.shape[1])
        full[:len(values)] = values
        return full, rows

    @property
    def halves(self) -> Array:
        """Half of each 95 % interval, in shares, [p]; infinite where nothing is told."""
        return self.halves_at(0.95)

    def halves_at(self, level: float) -> Array:
        """The same of intervals that hold the truth in another share of measurements, 0 to 1."""
        values, rows = self.singular
        told = values > values[0] * 1e-9 if values[0] > 0 else np.zeros(len(values), bool)
        spread = np.zeros(len(values))
        for value, row, good in zip(values, rows, told, strict=True):
            part = np.abs(row)
            spread += (row / value) ** 2 if good else np.where(part > 1e-6, np.inf, 0.0)
        with np.errstate(invalid="ignore"):
            return np.asarray(self._t(self._weights, level) * np.sqrt(spread))

    @property
    def blind(self) -> list[tuple[float, Array]]:
        """Directions that the data can't tell.

        Half of the 95 % interval of each, in ranges, and its unit vector [p].
        """
        values, rows = self.singular
        with np.errstate(divide="ignore"):
            halves = self._t(rows @ self._weights, 0.95) / np.where(
                values > values[0] * 1e-9, values, 0.0)
        return [(float(half), row * np.sign(row[np.argmax(np.abs(row))]))
                for half, row in zip(halves, rows, strict=True) if half > BLIND]

    @cached_property
    def _weights(self) -> Array:
        """How much each number, in units of its noise, moves each parameter, [p, m]."""
        return np.asarray(np.linalg.pinv(self.jacobian, rcond=1e-9))

    def _t(self, weights: Array, level: float) -> Array:
        """Student's t of intervals of what moves with the numbers as ``weights`` say, [n, m].

        A parameter that one column tells has the freedom of that column's noise and not that of
        all; one that several tell has in between (Welch and Satterthwaite, 1947).
        """
        from scipy import stats

        if not np.isfinite(self.freedom):
            return np.full(len(weights), float(stats.norm.ppf((1 + level) / 2)))
        each = self.freedom / len(self.columns) * np.maximum(np.bincount(self.columns), 1)
        parts = np.stack([(weights[:, self.columns == k] ** 2).sum(axis=1)
                          for k in range(len(each))], axis=1)
        whole = np.maximum(parts.sum(axis=1), 1e-300)
        freedom = whole**2 / np.maximum((parts**2 / each).sum(axis=1), 1e-300)
        return np.asarray(stats.t.ppf((1 + level) / 2,
                                      np.clip(freedom, each.min(), self.freedom)))


def estimate(
    model: Model, data: Array, columns: Integers, start: Array, *,
    noise: Array | None = None, difference: float = DIFFERENCE,
) -> Estimated:
    """The likeliest parameters.

    Args:
        model: what would be measured; many points at a time.
        data: [m].
        columns: which column each number belongs to, [m], from 0.
        start: shares to begin at, [p].
        noise: standard deviation of each column; estimated by default.
        difference: of the Jacobian's differences, in shares.

    Raises:
        SandboxError: fewer numbers than parameters.
    """
    if len(data) <= len(start):
        raise SandboxError(f"{len(data)} measured numbers cannot tell {len(start)} parameters",
                           code="no-answer")
    seen = _Differenced(model, difference)
    given = noise is not None
    sizes = noise if noise is not None else _spreads(data, columns)
    shares = start
    freedom = len(data) - len(start)
    for _ in range(1 if given else ROUNDS):
        shares = _solved(seen, data, sizes[columns], shares)
        residuals = seen.at(shares) - data
        if given:
            break
        before, sizes = sizes, _noise(residuals, columns, freedom / len(data), data)
        if np.all(np.abs(sizes - before) <= SETTLED * before):
            break
    if not given:
        sizes = _noise(residuals, columns, freedom / len(data), data)
    return Estimated(shares, sizes, seen.jacobian(shares) / sizes[columns][:, None], residuals,
                     columns, np.inf if given else float(freedom))


class _Differenced:
    """A model with its Jacobian by differences, and what it was asked last."""

    def __init__(self, model: Model, difference: float) -> None:
        self._model, self._step = model, difference
        self._last: tuple[bytes, Array, Array] | None = None

    def _all(self, shares: Array) -> tuple[Array, Array]:
        """The model and its Jacobian: all their points are asked for at once."""
        if self._last is None or self._last[0] != shares.tobytes():
            ways = np.eye(len(shares)) * self._step
            low, high = np.clip(shares - ways, 0, 1), np.clip(shares + ways, 0, 1)
            found = self._model(np.concatenate([shares[None], low, high]))
            if not np.isfinite(found).all():
                raise SandboxError("a run on the way has no values", code="no-answer")
            width = np.diagonal(high - low)[:, None]
            p = len(shares)
            self._last = shares.tobytes(), found[0], ((found[p + 1:] - found[1:p + 1]) / width).T
        return self._last[1], self._last[2]

    def at(self, shares: Array) -> Array:
        return self._all(shares)[0]

    def jacobian(self, shares: Array) -> Array:
        return self._all(shares)[1]


def _solved(seen: _Differenced, data: Array, sizes: Array, start: Array) -> Array:
    from scipy.optimize import least_squares

    found: Any = least_squares(
        lambda shares: (seen.at(shares) - data) / sizes, start,
        jac=lambda shares: seen.jacobian(shares) / sizes[:, None], bounds=(0.0, 1.0),
        xtol=1e-8, ftol=FINE, gtol=1e-10, max_nfev=60, x_scale=1.0)
    return np.asarray(found.x, dtype=float)


def following(residuals: Array, columns: Integers) -> dict[int, float]:
    """Columns of which neighbouring residuals go the same way, and how much they correlate.

    Empty where all may be independent noise. A correlation of n numbers has a standard error of
    1 / sqrt(n); those of all columns count together, since what lasts in one often does in others.

    Args:
        residuals: in each column in the order of time, [m].
        columns: which column each belongs to, [m], from 0.
    """
    found = {}
    for k in range(columns.max() + 1):
        about = residuals[columns == k] - residuals[columns == k].mean()
        if len(about) > SHORT and (total := float(about @ about)) > 0:
            found[k] = float(about[1:] @ about[:-1]) / total, float(np.sqrt(len(about)))
    together = sum(follow * root for follow, root in found.values()) / np.sqrt(max(len(found), 1))
    return {k: follow for k, (follow, root) in found.items()
            if follow * root > FOLLOWS or (together > FOLLOWS and follow * root > ALSO)}


def _spreads(data: Array, columns: Integers) -> Array:
    return np.array([np.std(data[columns == k]) or 1.0 for k in range(columns.max() + 1)])


def _noise(residuals: Array, columns: Integers, share: float, data: Array) -> Array:
    """Of each column, with the parameters' share of freedom taken off."""
    least = 1e-12 * _spreads(data, columns)
    found = np.array([np.sqrt(np.mean(residuals[columns == k] ** 2) / share)
                      for k in range(columns.max() + 1)])
    return np.asarray(np.maximum(found, least))
