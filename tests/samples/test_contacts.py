"""Contact rows: sums and means, quantities, the body that a force is shown on."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.samples.contacts import merge_contacts, on_the_other
from sandbox.scene.mechanism import Mechanism
from tests.draw.conftest import recording as drawn_recording
from tests.recording.sample import CONTACTS, N, S, recording


@pytest.fixture(scope="module")
def run():
    return recording(contacts=CONTACTS)


def over(run, name):
    """The quantity in samples 0 to 4; the later ones have no contact at all."""
    assert run[name].shape == (N,)
    assert not run[name][5:].any()
    return run[name][:5].tolist()


def test_normal_and_tangential_split_of_a_force(run):
    # normal = f.u and tangential = f.(u turned by +90 degrees); u = (0, 1) turned is (-1, 0)
    assert over(run, "finger1.distal/disc.normal") == [0, 3.0, 0, 5e-7, 0]
    assert over(run, "finger1.distal/disc.tangential") == [0, 0.5, 0, 0, 0]
    # f = (2, 0) on u = (1, 1)/sqrt 2: normal sqrt 2, tangential -sqrt 2; one rounding each
    assert run["finger1.proximal/disc.normal"][2] == pytest.approx(2 * S, rel=1e-15)
    assert run["finger1.proximal/disc.tangential"][2] == pytest.approx(-2 * S, rel=1e-15)


def test_resultant_follows_action_and_reaction(run):
    assert over(run, "finger1.distal.contact.fx") == [0, -0.5, 0, 0, 0]
    assert over(run, "finger1.distal.contact.fy") == [0, 3.0 + 1.0, 0, 5e-7, 0]
    assert over(run, "disc.contact.fx") == [0, 0.5, -2.0 + 0.25, 0, 0]
    total = sum(run[f"{body.name}.contact.fy"] for body in run.mechanism.bodies)
    assert np.array_equal(total, np.zeros(N))


def test_a_group_counts_outside_touches_only(run):
    # sample 1: distal on disc and the phalanges on each other; sample 3: below 1e-6 N
    assert over(run, "finger1.contact.count") == [0, 1, 1, 0, 0]
    assert over(run, "finger1.contact.normal") == pytest.approx([0, 3, 2 * S, 5e-7, 0], rel=1e-15)


# --- the body that a force acts on


@pytest.mark.parametrize(("roles", "lengths", "swapped"), [
    (("phalanx", "object"), (1.0, 0.0), True),
    (("link", "link"), (0.5, 1.0), True),
    (("ground", "link"), (0.0, 1.0), True),
    (("object", "object"), (0.5, 1.0), True),
    (("link", "link"), (1.0, 1.0 + 1e-9), False),
])
def test_it_acts_on_the_object_else_on_what_goes_farther(roles, lengths, swapped):
    mechanism = Mechanism.model_validate({"bodies": [
        {"name": f"body{i}", "mass": 1, "role": role,
         "shapes": [{"type": "circle", "radius": 0.1}]} for i, role in enumerate(roles)]})
    time = np.linspace(0, 1, 11)
    found = drawn_recording(mechanism, time, time[:, None, None] * [[x, 0, 0] for x in lengths])
    ask = on_the_other(found.model, found.arrays, np.array([0]), np.array([1]))
    assert ask.tolist() == [swapped]


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
