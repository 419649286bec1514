"""Linear programs: the least weighted sum of forces, with a proof.

    minimise c x   subject to   A x = b,   x >= 0

by the dual simplex method of HiGHS (:func:`scipy.optimize.linprog`). The prices y prove the value:
with c - A^T y >= 0 every x >= 0 with A x = b + d has c x >= y (b + d). For mechanisms y is a
virtual motion.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.numeric import Array

TOLERANCE = 1e-10
"""Of constraints and reduced costs: A and c are of the order of 1."""
UNBOUNDED = 3
"""The status of scipy."""


class Least(NamedTuple):
    """The least value of a linear program."""

    value: float
    """-inf where there is no bound."""
    x: Array
    """Where it is reached, [n]."""
    prices: Array
    """y [m], the derivative of the value by b; nan where there is no bound."""
    reduced: Array
    """c - A^T y, [n]."""


class LinearProgram:
    """A x = b, x >= 0, for one weight c after another.

    Args:
        A: of the order of 1, its rows linearly independent, [m, n].
        b: [m].
    """

    def __init__(self, A: Array, b: Array) -> None:
        (m, n), signs = A.shape, np.diag(np.where(b < 0, -1.0, 1.0))
        found = _solve(np.concatenate([np.zeros(n), np.ones(m)]),
                       np.concatenate([A, signs], axis=1), b)
        self.missing = found.value
        """Least sum of magnitudes of A x - b; above rounding there is no solution."""
        self.against = found.prices
        """y [m] that proves it: A^T y <= 0 and y b = :attr:`missing`."""
        self.A = A
        self.b: Array = A @ found.x[:n]
        """b with which there is a solution."""

    def least(self, c: Array) -> Least:
        """The least c x; ``c`` [n] of the order of 1.

        Raises:
            ArithmeticError: it does not converge.
        """
        return _solve(c, self.A, self.b)


def _solve(c: Array, A: Array, b: Array) -> Least:
    from scipy.optimize import linprog

    found = linprog(c, A_eq=A, b_eq=b, method="highs-ds", options={
        "presolve": False, "primal_feasibility_tolerance": TOLERANCE,
        "dual_feasibility_tolerance": TOLERANCE})
    if found.status == UNBOUNDED:
        return Least(-np.inf, *(np.full(size, np.nan) for size in (len(c), len(b), len(c))))
    if found.status:
        raise ArithmeticError("a linear program does not converge")
    x, prices = np.maximum(found.x, 0.0), found.eqlin.marginals
    return Least(float(c @ x), x, prices, c - A.T @ prices)
