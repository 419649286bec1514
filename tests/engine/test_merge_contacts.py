"""Contact rows from what the engine lists of each arbiter, with numbers worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.sampler import merge_contacts

UNSET = 77.0
"""What stands in the columns of a second point that does not exist."""


def arbiter(impulse, normal, *points):
    """[14]: impulse on the first, normal to the second, then (on first, on second, gap) twice."""
    row = [*impulse, *normal]
    for on_first, on_second, gap in points:
        row += [*on_first, *on_second, gap]
    return row + [UNSET] * (14 - len(row))


def merged(rows, *, first=None, second=None, sample=None, rank=(0, 1, 2)):
    """Rows of (number of points, floats) between bodies 0 and 1 in sample 0, if nothing is said."""
    n = len(rows)
    return merge_contacts(
        np.array(sample or [0] * n), np.array(first or [0] * n), np.array(second or [1] * n),
        np.array([len_ for len_, _ in rows]), np.array([floats for _, floats in rows]),
        np.array(rank))


ONE = ((0.010, 0.002), (0.010, 0.001), -1e-3)
OTHER = ((0.030, 0.005), (0.030, 0.001), -4e-3)


@pytest.mark.parametrize("points", [(ONE, OTHER), (OTHER, ONE)])
def test_the_gap_of_two_points_is_the_deeper_and_their_place_the_middle(points):
    found = merged([(2, arbiter((0.0, -3.0), (0.0, 1.0), *points))])
    assert found["gap"].tolist() == [-4e-3]
    assert found["point"][0] == pytest.approx([0.020, 0.00225])  # of all four places


def test_points_apart_and_in_touch_count_with_their_sign():
    apart = ((0.0, 0.0), (0.0, 2e-3), 2e-3)
    assert merged([(2, arbiter((0, 0), (0, 1), apart, ONE))])["gap"].tolist() == [-1e-3]
    assert merged([(2, arbiter((0, 0), (0, 1), ONE, apart))])["gap"].tolist() == [-1e-3]


@pytest.mark.parametrize("unset", [-UNSET, UNSET])
def test_of_a_single_point_nothing_else_is_read(unset):
    row = arbiter((0.0, -3.0), (0.0, 1.0), ONE)
    row[9:] = [unset] * 5
    found = merged([(1, row)])
    assert found["gap"].tolist() == [-1e-3]
    assert found["point"][0] == pytest.approx([0.010, 0.0015])


def test_force_and_normal_are_those_on_the_body_that_comes_first():
    """The engine gives the impulse on its first body and the normal towards its second."""
    row = (1, arbiter((0.5, -3.0), (0.0, 1.0), ONE))
    found = merged([row])
    assert (found["body"].tolist(), found["other"].tolist()) == ([0], [1])
    assert found["force"].tolist() == [[0.5, -3.0]]
    assert found["normal"].tolist() == [[0.0, -1.0]]  # a push along it: -3 N . -1 = 3 N
    turned = merged([row], rank=(1, 0, 2))
    assert (turned["body"].tolist(), turned["other"].tolist()) == ([1], [0])
    assert turned["force"].tolist() == [[-0.5, 3.0]]
    assert turned["normal"].tolist() == [[0.0, 1.0]]


def test_arbiters_of_one_pair_are_added_up_weighted_by_their_normal_impulse():
    """1 N s at x = 10 mm with its normal along y, 3 N s at 30 mm with its normal along x."""
    found = merged([
        (1, arbiter((0.2, -1.0), (0.0, 1.0), ((0.010, 0.0), (0.010, 0.0), -1e-3))),
        (1, arbiter((-3.0, 0.4), (1.0, 0.0), ((0.030, 0.008), (0.030, 0.008), -2e-3)))])
    assert found["force"] == pytest.approx(np.array([[-2.8, -0.6]]))
    assert found["point"] == pytest.approx(np.array([[0.025, 0.006]]))
    assert found["gap"].tolist() == [-2e-3]
    assert found["normal"] == pytest.approx(np.array([[-3.0, -1.0]]) / np.sqrt(10))


def test_rows_come_by_sample_then_body_then_other_in_their_rank():
    row = (1, arbiter((0.0, -3.0), (0.0, 1.0), ONE))
    found = merged([row] * 5, sample=[1, 0, 0, 1, 0], first=[0, 1, 0, 0, 0],
                   second=[1, 2, 2, 1, 1])
    assert [tuple(int(found[key][i]) for key in ("sample", "body", "other"))
            for i in range(len(found["gap"]))] == [(0, 0, 1), (0, 0, 2), (0, 1, 2), (1, 0, 1)]
    assert found["force"][:, 1].tolist() == [-3, -3, -3, -6]  # the last of two arbiters
