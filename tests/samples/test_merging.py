"""Contact rows from what is kept of each point, with numbers worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.samples.contacts import merge_contacts


def point(normal, tangent=0.0, at=(0.0, 0.0), towards=(0.0, 1.0)):
    """A point of two bodies: the forces on the second, along the normal and to its left."""
    x, y = towards
    return at, (tangent * y - normal * x, -normal * y - tangent * x), (-x, -y), normal


def merged(*points):
    """Rows of points, all of one sample."""
    none = np.zeros(len(points), dtype=np.int64)
    places, forces, normals, weights = map(np.array, zip(*points, strict=True))
    return merge_contacts(none, none, none + 1, places, forces, normals, weights,
                          *np.zeros((2, len(weights))))


def moment(at, force):
    return at[0] * force[1] - at[1] * force[0]


def test_the_place_lies_on_the_line_of_action_whatever_the_points():
    """In a corner, with friction: the moment of the sum is the sum of the moments."""
    points = [point(3e-4, 1e-4, (0.3, 0.1), (0.0, -1.0)), point(2e-4, -5e-5, (0.2, 0.25), (1, 0)),
              point(1e-4, 0.0, (0.25, 0.1), (0.6, -0.8))]
    found = merged(*points)
    total, place = found["force"][0], found["point"][0]
    each = [merged(one) for one in points]
    turn = sum(moment(one["point"][0], one["force"][0]) for one in each)
    assert total == pytest.approx(np.sum([one["force"][0] for one in each], axis=0))
    assert moment(place, total) == pytest.approx(turn, rel=1e-12)
    mean = np.average([one["point"][0] for one in each], axis=0, weights=[3, 2, 1])
    assert np.hypot(*(place - mean)) > 1e-3
    # no further from the mean than it has to be: across the force
    assert (place - mean) @ total == pytest.approx(0.0, abs=1e-12 * np.hypot(*total))


@pytest.mark.parametrize(("rest", "moved"), [(1e-10, False), (1e-9, True)])
def test_forces_that_cancel_have_no_line_of_action(rest, moved):
    """Squeezed from both sides, not in line: a couple of which no place gives the moment."""
    found = merged(point(2e-4, at=(0.0, 0.0), towards=(0.0, -1.0)),
                   point(2e-4 - rest, at=(0.01, 0.0), towards=(0.0, 1.0)))
    assert np.isfinite(found["point"]).all()
    assert bool(abs(found["point"][0, 0] - 0.005) > 1.0) is moved
