"""Lines that coincide are taken apart where they do, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.figure.style import NEAR, SHORT, strands

X = np.linspace(0.0, 1.0, 201)


def test_where_two_part_each_runs_alone():
    """One bends at 0.6 with slope 1: it is alone from NEAR beyond that."""
    found = strands([(X, X), (X, np.minimum(X, 0.6))])
    for rank, parts in enumerate(found):
        together, alone = parts
        assert (together.turns, together.rank, together.first) == (2, rank, 0)
        assert (alone.turns, alone.rank) == (1, 0)
        assert X[together.last] == pytest.approx(0.6 + NEAR, abs=0.006)
        assert alone.first == together.last  # no gap between the two
        assert alone.last == len(X) - 1


def test_lines_that_cross_run_alone():
    """Two of slopes 1 and -1 are near to each other for a width of NEAR, less than SHORT."""
    assert NEAR < SHORT
    assert all(len(parts) == 1 and parts[0].turns == 1 for parts in strands([(X, X), (X, 1 - X)]))


def test_of_many_each_has_its_turn_whatever_its_samples():
    lines = [(X[::step], 0.5 + 0 * X[::step]) for step in (1, 2, 5, 10)]
    found = strands([*lines, (X, X * 0)])
    assert [parts[0].rank for parts in found[:4]] == [0, 1, 2, 3]
    assert {part.turns for parts in found[:4] for part in parts} == {4}
    assert [part.turns for part in found[4]] == [1]
