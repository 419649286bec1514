"""Linear programs against another solver, and the proof that each comes with."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from sandbox.mechanics.linear_program import LinearProgram


def drawn(seed):
    """A program of up to 7 rows; every other one of halves, where much is alike."""
    rng = np.random.default_rng(seed)
    m = int(rng.integers(1, 8))
    n = m + int(rng.integers(0, 10))
    A = rng.normal(size=(m, n))
    A = np.round(2 * A) / 2 if seed % 2 else A
    b = A @ np.maximum(rng.normal(size=n), 0) if seed % 3 else rng.normal(size=m)
    return A, b, rng.normal(size=n)


def test_programs_drawn_at_random_have_the_value_that_another_solver_finds():
    seen = set()
    for seed in range(100):
        A, b, c = drawn(seed)
        if np.linalg.matrix_rank(A) < len(A):
            continue
        truth, found = linprog(c, A_eq=A, b_eq=b), LinearProgram(A, b)
        seen.add(truth.status)
        if truth.status == 2:  # nothing balances, which the prices prove
            assert found.missing > 1e-6
            assert (found.against @ A).max() < 1e-8
            assert found.against @ b == pytest.approx(found.missing)
            continue
        assert found.missing < 1e-12
        least = found.least(c)
        if truth.status == 3:
            assert least.value == -np.inf
            continue
        assert least.value == pytest.approx(truth.fun, abs=1e-9)
        assert least.x.min() >= 0
        assert A @ least.x == pytest.approx(b, abs=1e-11)
        # the proof: whoever balances has at least y b
        assert least.reduced.min() > -1e-8
        assert least.reduced == pytest.approx(c - A.T @ least.prices, abs=1e-11)
        assert least.prices @ b == pytest.approx(least.value, abs=1e-11)
    assert seen == {0, 2, 3}


def test_the_example_on_which_the_best_column_alone_goes_round_in_a_ring_comes_to_an_end():
    """Beale's: -0.05 at x = (0.04, 0, 1, 0)."""
    A = np.array([[0.25, -60, -1 / 25, 9, 1, 0, 0], [0.5, -90, -1 / 50, 3, 0, 1, 0],
                  [0, 0, 1, 0, 0, 0, 1]])
    least = LinearProgram(A, np.array([0.0, 0.0, 1.0])).least(
        np.array([-0.75, 150, -0.02, 6, 0, 0, 0]))
    assert least.value == pytest.approx(-0.05)
    assert least.x[[0, 2]] == pytest.approx([0.04, 1.0])


def test_nothing_to_balance_leaves_what_costs_nothing_at_zero():
    program = LinearProgram(np.zeros((0, 2)), np.zeros(0))
    assert program.missing == 0.0
    assert program.least(np.array([1.0, 0.0])).value == 0.0
    assert program.least(np.array([1.0, -1.0])).value == -np.inf
