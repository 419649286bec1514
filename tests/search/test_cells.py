"""Cells that are divided where answers differ: circles, corners, islands, limits."""

import math

import numpy as np
import pytest

from sandbox.search.cells import FAILS, HOLDS, SILENT, UNDECIDED, divide, trace


def found_of(rule, *, coarse=4, levels=4, ways=2, sheets=1, most=10**6):
    """What is found of a rule of shares, and all nodes that were asked for."""
    side, asked = coarse * 2 ** levels, []

    def ask(nodes):
        asked.extend(nodes)
        return [rule(*(at / side for at in node[1:])) for node in nodes]

    return divide(ask, sheets=sheets, ways=ways, coarse=coarse, levels=levels, most=most), asked


def circle(x, y):
    return HOLDS if math.hypot(x - 0.45, y - 0.52) < 0.3 else FAILS


def test_a_circle_is_found_without_a_dense_grid():
    found, asked = found_of(circle)
    assert len(asked) == len(set(asked)) == len(found.answers)
    assert len(asked) < 65**2 / 4
    states = found.states(0)
    low, high = (states == HOLDS).mean(), ((states == HOLDS) | (states == UNDECIDED)).mean()
    assert low < math.pi * 0.3**2 < high
    assert high - low < 3 * 2 * math.pi * 0.3 / 64  # a band of some cells about its line
    line, = trace(found, 0)
    assert (line[0] == line[-1]).all()
    # the middle of a crossed edge is half a cell from the circle at most
    assert np.abs(np.hypot(line[:, 0] - 0.45, line[:, 1] - 0.52) - 0.3).max() <= 0.5 / 64


def test_all_undecided_cells_are_small_even_where_only_a_side_tells():
    # a spike between points of the coarse grid: only the neighbour's new points see it
    def spiked(x, y):
        return HOLDS if y > 0.5 or (abs(x - 0.125) < 0.03 and y > 0.1) else FAILS

    found, _ = found_of(spiked)
    assert {cell.size for cell in found.cells if found.of(cell) is None} == {1}
    line, = trace(found, 0)
    assert line[:, 1].min() < 0.12


def test_a_boundary_that_leaves_the_map_is_open_and_several_are_apart():
    found, _ = found_of(lambda x, y: HOLDS if x < 0.3 or x > 0.7 else FAILS)
    lines = trace(found, 0)
    assert len(lines) == 2
    for line, at in zip(sorted(lines, key=lambda each: each[0, 0]), (0.3, 0.7), strict=True):
        assert {line[0, 1], line[-1, 1]} == {0.0, 1.0}
        assert np.abs(line[:, 0] - at).max() <= 1 / 64


def test_what_touches_no_point_of_the_coarse_grid_is_missed():
    def island(x, y):
        return HOLDS if math.hypot(x - 0.625, y - 0.625) < 0.1 else FAILS

    assert not (found_of(island)[0].states(0) == HOLDS).any()
    assert (found_of(island, coarse=8, levels=3)[0].states(0) == HOLDS).any()


def test_a_line_has_brackets():
    found, asked = found_of(lambda x: HOLDS if 0.2 < x < 0.81 else FAILS, ways=1)
    brackets = [[node[1] / found.side for node in edge] for edge in found.crossed]
    assert len(asked) == 5 + 2 * 4
    for (low, high), at in zip(brackets, (0.2, 0.81), strict=True):
        assert low <= at <= high == low + 1 / 64


def test_sheets_do_not_know_of_each_other():
    def ask(nodes):
        return [HOLDS if node[1] < (8, 40)[node[0]] else FAILS for node in nodes]

    found = divide(ask, sheets=2, ways=2, coarse=4, levels=4, most=10**6)
    assert [np.mean(found.states(k) == HOLDS) for k in (0, 1)] == [7 / 64, 39 / 64]
    assert trace(found, 1)[0][0, 0] == 39.5 / 64


def test_no_more_is_asked_for_than_is_allowed():
    found, asked = found_of(circle, most=150)
    assert len(asked) <= 150
    assert found.lacking > 0
    assert {cell.size for cell in found.cells if found.of(cell) is None} == {4}
    assert len(trace(found, 0)) == 1


def test_corners_that_hold_are_kept_apart_in_a_saddle():
    found, _ = found_of(lambda x, y: HOLDS if x == y else FAILS, coarse=1, levels=0)
    assert len(trace(found, 0)) == 2
    (one, other) = sorted(map(np.ndarray.tolist, trace(found, 0)))
    assert sorted(one) == [[0.0, 0.5], [0.5, 0.0]]
    assert sorted(other) == [[0.5, 1.0], [1.0, 0.5]]


@pytest.mark.parametrize("answer", [HOLDS, FAILS, SILENT])
def test_where_all_is_alike_there_is_no_boundary(answer):
    found, asked = found_of(lambda x, y: answer)
    assert len(asked) == 25
    assert (found.states(0) == answer).all()
    assert trace(found, 0) == []


def test_silence_has_a_border_that_is_no_boundary():
    found, _ = found_of(lambda x, y: SILENT if x > 0.6 else HOLDS)
    assert (found.states(0) == SILENT).mean() == pytest.approx(0.4, abs=1 / 64)
    assert trace(found, 0) == []
    assert found.crossed == []
