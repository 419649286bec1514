"""Contact rows from what is kept of each point, with numbers worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.sampler import merge_contacts
from sandbox.engine.touch_state import CONTACT

H = 0.5


def point(normal, tangent=0.0, at=(0.0, 0.0), towards=(0.0, 1.0), gap=0.0, a=0, b=1):
    """What is kept of one point: the impulses on b, along the normal and to its left."""
    return a, b, *at, *towards, gap, normal, tangent


def merged(*points, sample=None, order=(0, 1, 2)):
    """Rows of points, all of sample 0 if nothing is said; ``order`` are the model's numbers."""
    kept = np.array(list(points), dtype=CONTACT)
    order = np.array(order)
    return merge_contacts(np.array(sample or [0] * len(points)), order[kept["a"]],
                          order[kept["b"]], kept, H)


def test_force_and_normal_are_those_on_the_first_body():
    """2 N s along +y and 0.3 N s along -x on the second body, within half a second."""
    found = merged(point(2.0, 0.3))
    assert (found["body"].tolist(), found["other"].tolist()) == ([0], [1])
    assert found["normal"].tolist() == [[0.0, -1.0]]
    assert found["force"] == pytest.approx(np.array([[0.6, -4.0]]))


def test_the_tangent_is_to_the_left_of_the_normal():
    """Normal along +x: left is +y, so that 1 N s of it on the second is -2 N on the first."""
    found = merged(point(3.0, 1.0, towards=(1.0, 0.0)))
    assert found["force"] == pytest.approx(np.array([[-6.0, -2.0]]))
    assert found["normal"].tolist() == [[-1.0, 0.0]]


def test_the_place_is_the_centre_of_pressure_and_the_gap_the_least():
    """A box whose corners, 40 mm apart, carry 1 and 3: the resultant is at three quarters."""
    found = merged(point(1.0, at=(0.010, 0.0), gap=-1e-3), point(3.0, at=(0.050, 0.0), gap=2e-3))
    assert found["point"] == pytest.approx(np.array([[0.040, 0.0]]))
    assert found["gap"].tolist() == [-1e-3]
    assert found["force"] == pytest.approx(np.array([[0.0, -8.0]]))


def test_normals_are_weighted_by_what_they_carry():
    """1 N s along +y and 3 N s along +x: the normal lies along (3, 1), the force along it, too."""
    found = merged(point(1.0, -0.2, at=(0.01, 0.0)),
                   point(3.0, 0.4, at=(0.03, 0.008), towards=(1.0, 0.0)))
    assert found["normal"] == pytest.approx(np.array([[-3.0, -1.0]]) / np.sqrt(10))
    assert found["force"] == pytest.approx(-np.array([[3.0 + 0.2, 1.0 + 0.4]]) / H)


def test_the_pairs_force_does_at_its_place_all_that_its_points_do():
    """Of surfaces that are not in line, with friction: the moment about anything is the same, and
    the place is the one on that line of action that is nearest to the mean of the points.
    """
    places = np.array([[0.010, 0.0], [0.030, 0.008], [-0.01, 0.02]])
    normals = np.array([[0.0, 1.0], [1.0, 0.0], [0.6, 0.8]])
    sizes, tangents = np.array([1.0, 3.0, 2.0]), np.array([-0.2, 0.4, 0.1])
    found = merged(*(point(*each, at=at, towards=way) for *each, at, way in zip(
        sizes, tangents, places, normals, strict=True)))
    left = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    each = -(sizes[:, None] * normals + tangents[:, None] * left) / H
    at, force = found["point"][0], found["force"][0]
    assert at[0] * force[1] - at[1] * force[0] == pytest.approx(
        (places[:, 0] * each[:, 1] - places[:, 1] * each[:, 0]).sum(), rel=1e-12)
    mean = sizes @ places / sizes.sum()
    assert (at - mean) @ force == pytest.approx(0.0, abs=1e-15)
    assert np.hypot(*(at - mean)) > 1e-3


def test_forces_that_cancel_stay_where_they_are():
    """A squeeze from both sides is no force, but maybe a couple, which no place gives."""
    found = merged(point(1.0, at=(0.0, 0.01)), point(1.0, at=(0.02, -0.01), towards=(0.0, -1.0)))
    assert found["force"] == pytest.approx(np.zeros((1, 2)))
    assert found["point"] == pytest.approx(np.array([[0.01, 0.0]]))
    assert found["normal"].tolist() == [[0.0, -1.0]]  # of the first point


def test_rows_come_by_sample_then_body_then_other():
    """In pymunk's order of bodies, named by the model's numbers."""
    pairs = [(0, 1), (1, 2), (0, 2), (0, 1), (0, 1)]
    found = merged(*(point(1.0 + i, a=a, b=b) for i, (a, b) in enumerate(pairs)),
                   sample=[1, 0, 0, 1, 0], order=(7, 3, 5))
    assert [tuple(int(found[key][i]) for key in ("sample", "body", "other"))
            for i in range(len(found["gap"]))] == [(0, 7, 3), (0, 7, 5), (0, 3, 5), (1, 7, 3)]
    assert found["force"][:, 1].tolist() == [-10, -6, -4, -10]  # the last of two points
    assert found["merged"].tolist() == [1, 1, 1, 2]


def test_nothing_kept_no_rows():
    found = merge_contacts(*(np.zeros(0, dtype=np.int64),) * 3, np.zeros(0, dtype=CONTACT), H)
    assert {len(column) for column in found.values()} == {0}


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
