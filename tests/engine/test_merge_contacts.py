"""Contact rows from what is kept of each point, with numbers worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.sampler import merge_contacts
from sandbox.engine.touch_state import CONTACT

H = 0.5


def point(normal, tangent=0.0, at=(0.0, 0.0), towards=(0.0, 1.0), gap=0.0, a=0, b=1):
    """What is kept of one point: the impulses on b, along the normal and to its left."""
    return a, b, *at, *towards, gap, normal, tangent, 0.0


def merged(*points, sample=None, order=(0, 1, 2)):
    """Rows of points, all of sample 0 if nothing is said; ``order`` are the model's numbers."""
    kept = np.array(list(points), dtype=CONTACT)
    order = np.array(order)
    return merge_contacts(np.array(sample or [0] * len(points)), order[kept["a"]],
                          order[kept["b"]], kept, H)


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
