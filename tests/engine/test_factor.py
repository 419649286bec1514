"""L D L^T along its pattern against dense algebra, hubs and loops included."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.engine.factor import assemble, backward, factor, forward
from sandbox.engine.plan import Pattern, make_pattern


def dense(
    pattern: Pattern, inverse: np.ndarray, J: np.ndarray, compliance: np.ndarray,
) -> np.ndarray:
    """The matrix of the plan's docstring, in the order of the unknowns."""
    n = len(pattern.starts) - 1
    A = np.zeros((n, n))
    hubs = pattern.hubs[:, 0] >= 0
    for a, (row, body) in enumerate(zip(pattern.entry_row, pattern.entry_body, strict=True)):
        if hubs[body]:
            A[row, pattern.hubs[body]] += J[a]
            A[pattern.hubs[body], row] += J[a]
            continue
        w = inverse[body, [0, 0, 1]]
        for b in np.flatnonzero(pattern.entry_body == body):
            A[row, pattern.entry_row[b]] += J[a] @ (w * J[b])
    A[pattern.place, pattern.place] += compliance
    for body in np.flatnonzero(hubs):
        A[pattern.hubs[body], pattern.hubs[body]] = -1 / inverse[body, [0, 0, 1]]
    return A


def solved(
    pattern: Pattern, inverse: np.ndarray, J: np.ndarray, compliance: np.ndarray, rhs: np.ndarray,
) -> np.ndarray:
    """The solution by the factor, added up and factored as a step does it."""
    n = len(pattern.starts) - 1
    values = np.full(len(pattern.below) + n, np.nan)
    WJ = inverse[pattern.entry_body][:, [0, 0, 1]] * J
    assemble(pattern.pairs, pattern.direct, J, WJ, values)
    diagonal = values[len(pattern.below):]
    diagonal[pattern.place] += compliance
    for body in np.flatnonzero(pattern.hubs[:, 0] >= 0):
        diagonal[pattern.hubs[body]] -= 1 / inverse[body, [0, 0, 1]]
    factor(pattern.starts, pattern.below, pattern.updates, values, np.zeros(n))
    y = rhs.copy()
    forward(pattern.starts, pattern.below, values, y)
    backward(pattern.starts, pattern.below, values, y)
    return y


def agree(
    rows: list[list[int]], inverse: np.ndarray, compliance: np.ndarray, hub: int,
    rng: np.random.Generator,
) -> Pattern:
    """Both solutions agree to rounding, which the condition magnifies; rows of no compliance are
    the first.
    """
    pattern = make_pattern(rows, inverse, int((compliance == 0.0).sum()), hub)
    J = rng.uniform(-1, 1, (len(pattern.entry_row), 3))
    A = dense(pattern, inverse, J, compliance)
    rhs = rng.uniform(-1, 1, len(A))
    truth = np.linalg.solve(A, rhs)
    found = solved(pattern, inverse, J, compliance, rhs)
    atol = 1e-15 * len(A) * np.linalg.cond(A) * abs(truth).max()
    assert atol < 1e-3 * abs(truth).max()
    np.testing.assert_allclose(found, truth, rtol=0, atol=atol)
    return pattern


@settings(deadline=None, max_examples=150)
@given(st.integers(0, 10**6))
def test_random_patterns(seed: int) -> None:
    """Rows on one to four bodies, some of these fixed, up to all bodies hubs; compliances of the
    size of the masses' part, so that redundant rows have a solution, too.
    """
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 9))
    inverse = 10 ** rng.uniform(-1, 1, (count, 2))
    inverse[rng.uniform(size=count) < 0.2] = 0.0
    rows = [rng.choice(count, int(rng.integers(1, min(count, 4) + 1)), replace=False).tolist()
            for _ in range(int(rng.integers(1, 16)))]
    agree(rows, inverse, rng.uniform(0.1, 1, len(rows)), int(rng.integers(0, 10)), rng)


@pytest.mark.parametrize("seed", range(20))
def test_rigid_rows_on_hubs_only(seed: int) -> None:
    """A palm with fingers all round, held to the ground and to a second hub by rigid rows.

    Three rows hold the palm where it is and two the second hub to it: without any compliance these
    have no pivot of their own before the bodies' unknowns have gone.
    """
    rng = np.random.default_rng(seed)
    fingers = 6
    rows: list[list[int]] = [[0]] * int(rng.integers(1, 4)) + [[0, 1]] * int(rng.integers(1, 3))
    for hub in (0, 1):
        for i in range(fingers):
            rows += [[hub, 2 + fingers * hub + i]] * 2
    rows = [rows[i] for i in rng.permutation(len(rows))]
    inverse = 10 ** rng.uniform(-1, 1, (2 + 2 * fingers, 2))
    pattern = agree(rows, inverse, np.zeros(len(rows)), 6, rng)
    assert (pattern.hubs[:2] >= 0).all()
    assert (pattern.hubs[2:] == -1).all()


@pytest.mark.parametrize("seed", range(10))
def test_a_link_that_other_rows_hold_already(seed: int) -> None:
    """A link pinned to the ground and to the palm: its own three freedoms do not carry four rows.

    The palm's do; a cord over both has a compliance and need not wait.
    """
    rng = np.random.default_rng(seed)
    rigid = [[1]] * 2 + [[0, 1]] * 2 + [[0, i] for i in range(2, 8) for _ in range(2)]
    rows = [rigid[i] for i in rng.permutation(len(rigid))] + [[0, 1, 2]]
    compliance = np.zeros(len(rows))
    compliance[-1] = 0.1
    inverse = 10 ** rng.uniform(-1, 1, (8, 2))
    pattern = agree(rows, inverse, compliance, 12, rng)
    assert (pattern.hubs[0] >= 0).all()
    assert (pattern.hubs[1:] == -1).all()
    assert sorted(pattern.place) != sorted(range(len(rows)))  # some go after the palm's


@pytest.mark.parametrize("axis", range(3))
def test_a_row_that_feels_one_velocity_of_a_hub(axis: int) -> None:
    """A slot along x holds y alone: its pivot comes of that velocity, whichever goes first."""
    rows = [[0]] + [[0, i] for i in range(1, 7) for _ in range(2)]
    inverse = np.ones((7, 2))
    rng = np.random.default_rng(axis)
    pattern = make_pattern(rows, inverse, len(rows), 6)
    assert (pattern.hubs[0] >= 0).all()
    J = rng.uniform(-1, 1, (len(pattern.entry_row), 3))
    J[0] = np.eye(3)[axis]
    A = dense(pattern, inverse, J, np.zeros(len(rows)))
    rhs = rng.uniform(-1, 1, len(A))
    found = solved(pattern, inverse, J, np.zeros(len(rows)), rhs)
    np.testing.assert_allclose(found, np.linalg.solve(A, rhs), rtol=1e-10)


@pytest.mark.parametrize("loops", [1, 8, 40])
def test_loops(loops: int) -> None:
    """Rungs between two chains: rigid, not redundant (a rung's pins leave it free to turn)."""
    rng = np.random.default_rng(loops)
    count = 3 * loops
    rows: list[list[int]] = []
    for i in range(loops):
        left, rung, right = 3 * i, 3 * i + 1, 3 * i + 2
        if i:
            rows += [[left - 3, left]] * 2 + [[right - 3, right]] * 2
        else:
            rows += [[left]] * 2 + [[right]] * 2
        rows += [[left, rung]] * 2 + [[rung, right]] * 2
    inverse = 10 ** rng.uniform(-1, 1, (count, 2))
    # eight rows a loop hold nine freedoms
    agree(rows, inverse, np.zeros(len(rows)), 10**6, rng)


def test_zero_right_sides_stay_zero() -> None:
    rng = np.random.default_rng(0)
    pattern = make_pattern([[0, 1], [1, 2], [2]], np.ones((3, 2)))
    found = solved(pattern, np.ones((3, 2)), rng.uniform(-1, 1, (5, 3)), np.ones(3), np.zeros(3))
    assert found.tolist() == [0.0, 0.0, 0.0]
