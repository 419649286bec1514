"""Parameters of a model from noisy data: the estimate, how sure it is, what the data can't tell.

Maximum likelihood for independent normal noise whose size may differ from column to column and is
estimated with the parameters. Intervals are those of the model made linear at the estimate
(Seber and Wild, Nonlinear Regression, 1989, ch. 5), with Student's t; directions come from the
singular values of the weighted Jacobian.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
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
    t: float
    """Student's t of a 95 % interval."""

    @property
    def singular(self) -> tuple[Array, Array]:
        """Singular values [p], largest first, and directions [p, p], a row each."""
        _, values, rows = np.linalg.svd(self.jacobian, full_matrices=True)
        full = np.zeros(self.jacobian.shape[1])
        full[:len(values)] = values
        return full, rows

    @property
    def halves(self) -> Array:
        """Half of each 95 % interval, in shares, [p]; infinite where nothing is told."""
        values, rows = self.singular
        told = values > values[0] * 1e-9 if values[0] > 0 else np.zeros(len(values), bool)
        spread = np.zeros(len(values))
        for value, row, good in zip(values, rows, told, strict=True):
            part = np.abs(row)
            spread += (row / value) ** 2 if good else np.where(part > 1e-6, np.inf, 0.0)
        return np.asarray(self.t * np.sqrt(spread))

    @property
    def blind(self) -> list[tuple[float, Array]]:
        """Directions that the data can't tell.

        Half of the 95 % interval of each, in ranges, and its unit vector [p].
        """
        values, rows = self.singular
        with np.errstate(divide="ignore"):
            halves = self.t / np.where(values > values[0] * 1e-9, values, 0.0)
        return [(float(half), row * np.sign(row[np.argmax(np.abs(row))]))
                for half, row in zip(halves, rows, strict=True) if half > BLIND]


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
        raise SandboxError(f"{len(data)} measured numbers cannot tell {len(start)} parameters")
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
    from scipy import stats

    return Estimated(shares, sizes, seen.jacobian(shares) / sizes[columns][:, None], residuals,
                    float(stats.norm.ppf(0.975) if given else stats.t.ppf(0.975, freedom)))


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
                raise SandboxError("a run on the way has no values")
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


def following(rest: Array) -> tuple[float, float]:
    """Correlation of neighbours in what is left of a column, and that in standard errors.

    Of independent noise the second is nearly normal with a standard deviation of 1.

    Args:
        rest: residuals in the order of time, [n].
    """
    about = rest - rest.mean()
    total = float(about @ about)
    follow = float(about[1:] @ about[:-1]) / total if total > 0 else 0.0
    return follow, follow * float(np.sqrt(len(rest)))


def _spreads(data: Array, columns: Integers) -> Array:
    return np.array([np.std(data[columns == k]) or 1.0 for k in range(columns.max() + 1)])


def _noise(residuals: Array, columns: Integers, share: float, data: Array) -> Array:
    """Of each column, with the parameters' share of freedom taken off."""
    least = 1e-12 * _spreads(data, columns)
    found = np.array([np.sqrt(np.mean(residuals[columns == k] ** 2) / share)
                      for k in range(columns.max() + 1)])
    return np.asarray(np.maximum(found, least))
