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

from sandbox.numeric import Array

SMALL = 1e-9  # pivots and reduced costs below this are rounding: A and c are of the order of 1
RENEWAL = 50  # rounds after which the inverse is computed anew
# after so many rounds for each row and column the first column with a negative reduced cost
# enters, not that of the smallest: then no basis occurs twice (Bland)
PATIENCE = 4


class Minimum(NamedTuple):
    """The minimum of a linear program."""

    value: float  #: -inf where there is no bound
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
        self._A = np.concatenate([A, np.diag(np.where(b < 0, -1.0, 1.0))], axis=1)
        self.b, self._basis = b, np.arange(n, n + m)
        self._renew()
        self.missing, self.against, _ = self.minimum(np.repeat([0.0, 1.0], [n, m]))
        self._A = A
        for place in np.flatnonzero(self._basis >= n).tolist():  # these have the value 0
            row = self._inverse[place] @ A
            row[self._basis[self._basis < n]] = 0.0
            self._exchange(int(np.abs(row).argmax()), place)
        self._renew()
        B = A[:, self._basis]
        self.b = B @ np.maximum(np.linalg.solve(B, b), 0.0)

    def minimum(self, c: Array) -> Minimum:
        """The minimum of c x; ``c`` [n] of the order of 1.

        Raises:
            ArithmeticError: it does not converge.
        """
        A, b, basis = self._A, self.b, self._basis
        patience = PATIENCE * sum(A.shape)
        for turn in range(100 * (patience + 1)):
            prices = c[basis] @ self._inverse
            reduced = c - prices @ A
            reduced[basis] = 0.0
            better = np.flatnonzero(reduced < -SMALL)
            leaves = -1
            if len(better):
                enters = int(better[0] if turn > patience else reduced.argmin())
                leaves = self._first(enters, by_number=turn > patience)
            if leaves >= 0:
                self._exchange(enters, leaves)
            elif not self._fresh:
                self._renew()
            elif not len(better):
                value = c[basis] @ np.maximum(self._inverse @ b, 0.0)
                return Minimum(float(value), prices, reduced)
            else:
                return Minimum(-np.inf, np.full(len(b), np.nan), np.full(len(c), np.nan))
            if turn % RENEWAL == RENEWAL - 1:
                self._renew()
        raise ArithmeticError("a linear program does not converge")

    def _renew(self) -> None:
        self._inverse, self._fresh = np.linalg.inv(self._A[:, self._basis]), True

    def _first(self, enters: int, *, by_number: bool) -> int:
        """The place whose value falls to 0 first if a column enters; -1 if none falls."""
        falls = self._inverse @ self._A[:, enters]
        down = np.flatnonzero(falls > SMALL)
        if not len(down):
            return -1
        ways = np.maximum(self._inverse[down] @ self.b, 0.0) / falls[down]
        first = down[ways <= ways.min() * (1 + SMALL)]
        return int(first[self._basis[first].argmin() if by_number else falls[first].argmax()])

    def _exchange(self, enters: int, leaves: int) -> None:
        falls = self._inverse @ self._A[:, enters]
        row = self._inverse[leaves] / falls[leaves]
        self._inverse -= np.outer(falls, row)
        self._inverse[leaves] = row
        self._basis[leaves], self._fresh = enters, False
