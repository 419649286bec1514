"""Contact points of one pair of bodies become one row: what it does is what they do together."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.sampler import merge_contacts
from sandbox.engine.state import CONTACT

H = 5e-4


def rows(*points, h=H):
    """Points: sample, a, b, place, normal from a to b, gap, normal and tangential impulse on b."""
    kept = np.zeros(len(points), CONTACT)
    for row, (_, a, b, (x, y), (nx, ny), gap, normal, tangent) in zip(kept, points, strict=True):
        for key, value in (("a", a), ("b", b), ("x", x), ("y", y), ("nx", nx), ("ny", ny),
                           ("gap", gap), ("normal", normal), ("tangent", tangent)):
            row[key] = value
    sample = np.array([point[0] for point in points], dtype=np.int64)
    return merge_contacts(sample, kept["a"].copy(), kept["b"].copy(), kept, h)


def moment(point, force):
    return point[0] * force[1] - point[1] * force[0]


def impulse(normal, along, across):
    """On the first body [N s]: against the normal to the second."""
    (nx, ny) = normal
    return np.array([-nx * along + ny * across, -ny * along - nx * across])


def test_a_single_point_is_its_row_with_the_force_on_the_first_body():
    found = rows((3, 1, 2, (0.1, 0.2), (0.6, 0.8), -2e-6, 5e-4, 1e-4))
    assert found["force"][0] == pytest.approx(impulse((0.6, 0.8), 5e-4, 1e-4) / H)
    assert found["normal"][0] == pytest.approx([-0.6, -0.8])
    assert found["point"][0].tolist() == [0.1, 0.2]
    assert (found["gap"][0], found["sample"][0], found["body"][0], found["other"][0]) == (
        -2e-6, 3, 1, 2)


def test_a_flat_contact_acts_at_its_centre_of_pressure():
    """3 and 1 parts on points 40 mm apart; friction along the face does not move the place."""
    for tangent in (0.0, 2e-4):
        found = rows((0, 0, 1, (0.0, 0.0), (0.0, -1.0), -1e-9, 3e-4, tangent),
                     (0, 0, 1, (0.04, 0.0), (0.0, -1.0), -3e-9, 1e-4, tangent / 3))
        assert found["point"][0] == pytest.approx([0.01, 0.0], abs=1e-15)
        assert found["gap"][0] == -3e-9
        assert found["force"][0, 1] == pytest.approx(4e-4 / H)


def test_the_place_lies_on_the_line_of_action_whatever_the_points():
    """In a corner, with friction: the moment of the sum is the sum of the moments."""
    points = [(0, 0, 1, (0.3, 0.1), (0.0, -1.0), 0.0, 3e-4, 1e-4),
              (0, 0, 1, (0.2, 0.25), (1.0, 0.0), 0.0, 2e-4, -5e-5),
              (0, 0, 1, (0.25, 0.1), (0.6, -0.8), 0.0, 1e-4, 0.0)]
    found = rows(*points)
    forces = [impulse(point[4], *point[6:]) / H for point in points]
    total = np.sum(forces, axis=0)
    assert found["force"][0] == pytest.approx(total)
    turn = sum(moment(point[3], force) for point, force in zip(points, forces, strict=True))
    assert moment(found["point"][0], total) == pytest.approx(turn, rel=1e-12)
    mean = np.average([point[3] for point in points], axis=0, weights=[3, 2, 1])
    # no further from the mean than it has to be: across the force
    assert (found["point"][0] - mean) @ total == pytest.approx(0.0, abs=1e-12)
    assert np.hypot(*found["normal"][0]) == pytest.approx(1.0)


@pytest.mark.parametrize(("rest", "moved"), [(1e-12, False), (1e-9, True)])
def test_forces_that_cancel_have_no_line_of_action(rest, moved):
    """Squeezed from both sides, not in line: a couple, which no place gives."""
    found = rows((0, 0, 1, (0.0, 0.0), (0.0, -1.0), 0.0, 2e-4, 0.0),
                 (0, 0, 1, (0.01, 0.0), (0.0, 1.0), 0.0, 2e-4 - rest, 0.0))
    assert np.isfinite(found["point"]).all()
    assert bool(abs(found["point"][0, 0] - 0.005) > 1.0) is moved


def test_rows_come_by_sample_then_body_then_other_in_their_rank():
    keys = [(1, 0, 1, 1e-4), (0, 2, 3, 2e-4), (0, 0, 4, 3e-4), (0, 0, 1, 4e-4), (1, 0, 1, 1e-4)]
    found = rows(*((sample, a, b, (i // 4, 0), (0, 1), 0.0, normal, 0.0)
                   for i, (sample, a, b, normal) in enumerate(keys)))
    assert np.column_stack([found[key] for key in ("sample", "body", "other")]).tolist() == [
        [0, 0, 1], [0, 0, 4], [0, 2, 3], [1, 0, 1]]
    assert found["force"][:, 1] * H == pytest.approx([-4e-4, -3e-4, -2e-4, -2e-4])
    assert found["point"][3].tolist() == [0.5, 0.0]
