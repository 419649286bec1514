"""Linear programs: the minimum of a weighted sum of forces, and a proof of it.

    minimise c x   subject to   A x = b,   x >= 0

by the simplex method: the values of the m columns of A in the basis follow from B x_B = b, the
prices of the rows from B^T y = c_B; a column with a reduced cost c - A^T y below 0 enters, the one
whose value falls to 0 first leaves. At the end c - A^T y >= 0 proves the value: A x = b + d with
x >= 0 implies c x >= y (b + d). For mechanisms y is a virtual motion.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.numeric import Array, Integers

SMALL = 1e-9  # pivots and reduced costs below this are rounding: A and c are of the order of 1
RENEWAL = 50  # rounds after which the inverse is computed anew
# after so many rounds for each row and column the first column with a negative reduced cost
# enters, not that of the smallest: then no basis occurs twice (Bland)
PATIENCE = 4


class Least(NamedTuple):
    """The minimum of a linear program."""

    value: float  #: -inf where there is no bound
    x: Array  #: where it is reached, [n]
    prices: Array  #: y [m]: how the value changes with b; nan where there is no bound
    reduced: Array  #: c - A^T y, [n]


class LinearProgram:
    """A x = b, x >= 0, for one weight c after another.

    Args:
        A: of the order of 1, its rows independent of one another, [m, n].
        b: [m].
    """

    missing: float  #: minimum 1-norm of A x - b; above rounding there is no solution
    against: Array  #: y [m] that proves it: A^T y <= 0 and y b = :attr:`missing`
    b: Array  #: the nearest b with a solution, [m]

    def __init__(self, A: Array, b: Array) -> None:
        m, n = A.shape
        wide = np.concatenate([A, np.diag(np.where(b < 0, -1.0, 1.0))], axis=1)
        self._start(wide, b, np.arange(n, n + m))
        self.missing, _, self.against, _ = self.least(
            np.concatenate([np.zeros(n), np.ones(m)]))
        for place in np.flatnonzero(self._chosen >= n).tolist():  # these have the value 0
            row = self._inverse[place] @ wide[:, :n]
            row[self._chosen[self._chosen < n]] = 0.0
            self._change(int(np.abs(row).argmax()), place)
            self._renew()
        B = A[:, self._chosen]
        self._start(A, B @ np.maximum(np.linalg.solve(B, b), 0.0), self._chosen)

    def least(self, c: Array) -> Least:
        """The minimum of c x; ``c`` [n] of the order of 1.

        Raises:
            ArithmeticError: it does not converge.
        """
        A, b, chosen = self._A, self.b, self._chosen
        rounds = PATIENCE * sum(A.shape)
        for turn in range(100 * (rounds + 1)):
            prices = c[chosen] @ self._inverse
            reduced = c - prices @ A
            reduced[chosen] = 0.0
            better = np.flatnonzero(reduced < -SMALL)
            enters = -1 if not len(better) else int(
                better[0] if turn > rounds else reduced.argmin())
            leaves = self._first(enters, by_number=turn > rounds) if enters >= 0 else -1
            if leaves >= 0:
                self._change(enters, leaves)
            elif not self._fresh:
                self._renew()
            elif enters < 0:
                x = np.zeros(len(c))
                x[chosen] = np.maximum(self._inverse @ b, 0.0)
                return Least(float(c @ x), x, prices, reduced)
            else:
                return Least(-np.inf, *(np.full(size, np.nan) for size in (
                    len(c), len(b), len(c))))
            if turn % RENEWAL == RENEWAL - 1:
                self._renew()
        raise ArithmeticError("a linear program does not converge")

    def _start(self, A: Array, b: Array, chosen: Integers) -> None:
        """Begin with the columns ``chosen`` [m], which span all rows."""
        self._A, self.b, self._chosen = A, b, chosen
        self._renew()

    def _renew(self) -> None:
        self._inverse, self._fresh = np.linalg.inv(self._A[:, self._chosen]), True

    def _first(self, enters: int, *, by_number: bool) -> int:
        """The place whose value falls to 0 first if a column enters; -1 if none falls."""
        falls = self._inverse @ self._A[:, enters]
        down = np.flatnonzero(falls > SMALL)
        if not len(down):
            return -1
        ways = np.maximum(self._inverse[down] @ self.b, 0.0) / falls[down]
        first = down[ways <= ways.min() * (1 + SMALL)]
        return int(first[self._chosen[first].argmin() if by_number else falls[first].argmax()])

    def _change(self, enters: int, leaves: int) -> None:
        falls = self._inverse @ self._A[:, enters]
        row = self._inverse[leaves] / falls[leaves]
        self._inverse -= np.outer(falls, row)
        self._inverse[leaves] = row
        self._chosen[leaves], self._fresh = enters, False
