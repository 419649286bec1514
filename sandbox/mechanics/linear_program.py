"""Linear programs: the least that a weighted sum of forces can be, and a proof of it.

    minimise c x   subject to   A x = b,   x >= 0

by the simplex method: the values of the m columns of A in the basis follow from B x_B = b, the
prices of the rows from B^T y = c_B; a column with a reduced cost c - A^T y below 0 enters, the one
whose value falls to 0 first leaves. The inverse of B is updated in every round, and computed anew
now and then and at the end. There c - A^T y >= 0 proves the value: A x = b + d with x >= 0 implies
c x >= y (b + d). For mechanisms y is a virtual motion.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.numeric import Array, Integers

SMALL = 1e-9
"""Pivots and reduced costs below this are rounding: A and c are to be of the order of 1."""
ANEW = 50
"""Rounds after which the inverse is worked out again."""
PATIENCE = 4
"""After so many rounds for each row and column the first column that will do comes in, not the
best: then no basis comes twice (Bland)."""


class Least(NamedTuple):
    """The least value of a linear program."""

    value: float
    """-inf where there is no bound."""
    x: Array
    """Where it is reached, [n]."""
    prices: Array
    """y [m]: how the value changes with b; nan where there is no bound."""
    reduced: Array
    """c - A^T y, [n]."""


class LinearProgram:
    """A x = b, x >= 0, for one weight c after another.

    Args:
        A: of the order of 1, its rows independent of one another, [m, n].
        b: [m].
    """

    def __init__(self, A: Array, b: Array) -> None:
        m, n = A.shape
        wide = np.concatenate([A, np.diag(np.where(b < 0, -1.0, 1.0))], axis=1)
        first = _Basis(wide, b, np.arange(n, n + m))
        found = first.descend(np.concatenate([np.zeros(n), np.ones(m)]))
        self.missing = found.value
        """What is left of A x - b at the least, a sum of sizes; above rounding: no x will do."""
        self.against = found.prices
        """y [m] that proves it: A^T y <= 0 and y b = :attr:`missing`."""
        chosen = first.without(n)
        B = A[:, chosen]
        self.b: Array = B @ np.maximum(np.linalg.solve(B, b), 0.0)
        """What is balanced exactly: b, less what is :attr:`missing`."""
        self._basis = _Basis(A, self.b, chosen)

    def least(self, c: Array) -> Least:
        """The least c x; ``c`` [n] of the order of 1.

        Raises:
            ArithmeticError: it does not come to an end.
        """
        return self._basis.descend(c)


class _Basis:
    """Columns ``chosen`` [m] that span all rows, and the inverse of their matrix."""

    def __init__(self, A: Array, b: Array, chosen: Integers) -> None:
        self.A, self.b, self.chosen = A, b, chosen
        self.renew()

    def renew(self) -> None:
        """Work the inverse out anew."""
        self.inverse, self.fresh = np.linalg.inv(self.A[:, self.chosen]), True

    def descend(self, c: Array) -> Least:
        """From here to the best basis."""
        A, b, chosen = self.A, self.b, self.chosen
        rounds = PATIENCE * sum(A.shape)
        for turn in range(100 * (rounds + 1)):
            prices = c[chosen] @ self.inverse
            reduced = c - prices @ A
            reduced[chosen] = 0.0
            better = np.flatnonzero(reduced < -SMALL)
            comes = -1 if not len(better) else int(
                better[0] if turn > rounds else reduced.argmin())
            goes = self._first(comes, by_number=turn > rounds) if comes >= 0 else -1
            if goes >= 0:
                self._change(comes, goes)
            elif not self.fresh:
                self.renew()
            elif comes < 0:
                x = np.zeros(len(c))
                x[chosen] = np.maximum(self.inverse @ b, 0.0)
                return Least(float(c @ x), x, prices, reduced)
            else:
                return Least(-np.inf, *(np.full(size, np.nan) for size in (
                    len(c), len(b), len(c))))
            if turn % ANEW == ANEW - 1:
                self.renew()
        raise ArithmeticError("a linear program does not converge")

    def _first(self, comes: int, *, by_number: bool) -> int:
        """The place of what falls to 0 first where a column comes in; -1 if nothing falls."""
        falls = self.inverse @ self.A[:, comes]
        down = np.flatnonzero(falls > SMALL)
        if not len(down):
            return -1
        ways = np.maximum(self.inverse[down] @ self.b, 0.0) / falls[down]
        first = down[ways <= ways.min() * (1 + SMALL)]
        return int(first[self.chosen[first].argmin() if by_number else falls[first].argmax()])

    def _change(self, comes: int, goes: int) -> None:
        falls = self.inverse @ self.A[:, comes]
        row = self.inverse[goes] / falls[goes]
        self.inverse -= np.outer(falls, row)
        self.inverse[goes] = row
        self.chosen[goes], self.fresh = comes, False

    def without(self, n: int) -> Integers:
        """The columns, those from ``n`` on, which carry nothing, replaced by some before it."""
        for place in np.flatnonzero(self.chosen >= n).tolist():
            row = self.inverse[place] @ self.A[:, :n]
            row[self.chosen[self.chosen < n]] = 0.0
            self._change(int(np.abs(row).argmax()), place)
            self.renew()
        return self.chosen
