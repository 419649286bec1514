"""The pattern of the one solve: every product has its place, and there are few of them."""

from __future__ import annotations

from itertools import combinations, pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.engine.plan import Pattern, elimination, make_pattern
from sandbox.errors import SandboxError


def free(count: int, fixed: int = 1) -> np.ndarray:
    """Inverse masses of so many bodies, the last of which do not move."""
    inverse = np.ones((count, 2))
    inverse[count - fixed:] = 0.0
    return inverse


def sizes(pattern: Pattern) -> tuple[int, int, int]:
    """Slots, products of two of them, products that add up to the matrix."""
    return len(pattern.below), len(pattern.updates), len(pattern.pairs) + len(pattern.direct)


Machine = tuple[list[list[int]], np.ndarray, int]
"""Rows, inverse masses, how many rows are rigid."""


def chain(links: int) -> Machine:
    """Links in a row, the first on the ground: a pin (two rows) and a damper each."""
    bodies = [links, *range(links)]
    pairs = [[a, b] for a, b in pairwise(bodies)]
    return pairs * 3, free(links + 1), 2 * links


def tree(leaves: int) -> Machine:
    """Rockers over rockers, each with a pin on the one above."""
    count = 2 * leaves - 1
    rows = [[(i - 1) // 2 if i else count, i] for i in range(count)] * 2
    return rows, free(count + 1), len(rows)


def hand(fingers: int) -> Machine:
    """Fingers of three links on one free palm, damped; a cord runs over the palm and each of them.

    A finger's six rigid rows leave three of its links' freedoms; soft ones may be more.
    """
    rigid: list[list[int]] = []
    soft: list[list[int]] = []
    for i in range(fingers):
        a, b, c = 1 + 3 * i, 2 + 3 * i, 3 + 3 * i
        rigid += [[0, a], [a, b], [b, c]] * 2
        soft += [[0, a], [a, b], [b, c], [0, a, b, c]]
    return rigid + soft, free(2 + 3 * fingers), len(rigid)


def ladder(loops: int) -> Machine:
    """Two chains from the ground, joined rung by rung by pins."""
    count = 2 * loops
    rows: list[list[int]] = []
    for i in range(loops):
        left, right = 2 * i, 2 * i + 1
        below = [left - 2, right - 2] if i else [count, count]
        rows += [[below[0], left]] * 2 + [[below[1], right]] * 2 + [[left, right]] * 2
    return rows, free(count + 1), len(rows)


@pytest.mark.parametrize("made", [chain, tree, hand, ladder])
def test_all_sizes_grow_in_proportion(made: Any) -> None:
    """Each unit that is added costs the same: slots, products in the factor and in the matrix."""
    sized = np.array([sizes(make_pattern(*made(n))) for n in (32, 64, 128)])
    first, second = np.diff(sized, axis=0)
    np.testing.assert_allclose(second / first, 2.0, rtol=0.05)


def test_a_chain_fills_little() -> None:
    """A row meets, when it goes, the rows of its joint and of one neighbour: five at most."""
    assert sizes(make_pattern(*chain(100)))[0] <= 5 * 300


def test_a_hub_stays_in_the_system() -> None:
    """Of the hand's palm three unknowns, of no other body; without it all fingers meet."""
    rows, inverse, rigid = hand(20)
    pattern, dense = (make_pattern(rows, inverse, rigid, hub) for hub in (12, 10**6))
    assert (pattern.hubs[0] >= 0).all()
    assert (pattern.hubs[1:] == -1).all()
    assert len(pattern.starts) - 1 == len(rows) + 3
    assert sorted([*pattern.place, *pattern.hubs[0]]) == list(range(len(rows) + 3))
    assert (dense.hubs == -1).all()
    # each of 20 fingers has four rows on the palm: of 80 each meets the 79 others
    assert sizes(dense)[0] > 80 * 79 / 2 > 2 * sizes(pattern)[0]


def test_fixed_bodies_join_nothing() -> None:
    """Two pendulums on one wall have nothing to do with one another, however many there are."""
    rows = [[40, i] for i in range(40) for _ in range(2)]
    pattern = make_pattern(rows, free(41))
    assert len(pattern.below) == 40
    assert not pattern.hubs.max() >= 0


@settings(deadline=None, max_examples=80)
@given(st.data())
def test_elimination_is_a_factorisation(data: Any) -> None:
    """For random graphs: what an unknown still meets holds all of its column of Cholesky's L."""
    n = data.draw(st.integers(1, 12))
    links = data.draw(st.sets(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=20))
    groups: list[set[int]] = [{i} for i in range(n)]
    for i, j in links:
        groups[i].add(j)
        groups[j].add(i)
    order, met = elimination(groups)
    assert sorted(order) == list(range(n))
    rng = np.random.default_rng(n)
    A = np.zeros((n, n))
    for i, group in enumerate(groups):
        for j in group - {i}:
            A[i, j] = A[j, i] = rng.uniform(-1, 1)
    A += n * np.eye(n)
    L = np.linalg.cholesky(A[np.ix_(order, order)])
    place = {i: k for k, i in enumerate(order)}
    for k, i in enumerate(order):
        below = {place[j] for j in met[i]}
        assert min(below, default=n) > k
        missing = set(range(k + 1, n)) - below
        np.testing.assert_allclose(L[list(missing), k], 0, atol=1e-14)


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 10**6))
def test_branches_are_what_a_force_reaches(seed: int) -> None:
    """Forward substitution from the rows of a body fills its branch at most, in rising order."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 9))
    rows = [rng.choice(count, int(rng.integers(1, min(count, 4) + 1)), replace=False).tolist()
            for _ in range(int(rng.integers(1, 14)))]
    pattern = make_pattern(rows, free(count), hub=int(rng.integers(2, 8)),
                           rigid=int(rng.integers(0, len(rows) + 1)))
    n = len(pattern.starts) - 1
    for body in range(count - 1):
        first, last = pattern.branch_starts[body:body + 2]
        branch = pattern.branches[first:last].tolist()
        own = ({int(i) for i in pattern.hubs[body]} if pattern.hubs[body, 0] >= 0 else
               {int(pattern.place[row]) for row, bodies in enumerate(rows) if body in bodies})
        reached = set(own)
        for j in range(n):
            if j in reached:
                reached |= {int(i) for i in pattern.below[pattern.starts[j]:pattern.starts[j + 1]]}
        assert branch == sorted(branch)
        assert reached == set(branch)


def test_no_rows_no_pattern() -> None:
    pattern = make_pattern([], free(3))
    assert sizes(pattern) == (0, 0, 0)
    assert pattern.starts.tolist() == [0]


def test_what_cannot_be_factored_in_a_moment_is_refused() -> None:
    """Sixty bodies, every pair of them pinned: 3540 rows that all meet."""
    pairs = list(combinations(range(60), 2))
    rows = [pair for pair in pairs for _ in range(2)]
    with pytest.raises(SandboxError, match="hang together in so many loops"):
        make_pattern(rows, np.ones((60, 2)), len(rows))
