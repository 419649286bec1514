"""On which of two bodies a force is shown: the object, else what goes farther."""

import numpy as np
import pytest

from sandbox.samples.acted import contacts_on, on_the_other, ways
from sandbox.scene.mechanism import Mechanism
from tests.draw.conftest import recording


def run(roles, poses, rows=(), **given):
    """Bodies of these roles that go where ``poses`` [n, nb, 3] say; ``rows`` of contacts."""
    mechanism = Mechanism.model_validate({"bodies": [
        {"name": f"body{i}", "mass": 1, "role": role,
         "shapes": [{"type": "circle", "radius": 0.1}]} for i, role in enumerate(roles)]})
    poses = np.asarray(poses, dtype=float)
    time = np.arange(len(poses)) / 10.0
    rows = np.array([(0, *row) for row in rows], dtype=float).reshape(-1, 5)
    return recording(mechanism, time, poses, contact_sample=rows[:, 0].astype(int),
                     contact_body=rows[:, 1].astype(int), contact_other=rows[:, 2].astype(int),
                     contact_force=rows[:, 3:5], contact_point=np.zeros((len(rows), 2)),
                     contact_normal=np.zeros((len(rows), 2)), contact_gap=np.zeros(len(rows)),
                     **given)


def along_x(*lengths, samples=11):
    """Each body goes so far to the right, evenly."""
    share = np.linspace(0, 1, samples)
    return np.stack([np.stack((length * share, 0 * share, 0 * share), axis=1)
                     for length in lengths], axis=1)


def test_a_way_is_that_of_the_centre_and_of_the_turning():
    """A circle of 0.2 m once round is 2 pi 0.2 m; a body that spins about its centre once goes
    2 pi times its radius of gyration, here sqrt(0.09 / 1) m."""
    turn = np.linspace(0, 2 * np.pi, 2001)
    poses = np.zeros((len(turn), 3, 3))
    poses[:, 0, :2] = 0.2 * np.stack((np.cos(turn), np.sin(turn)), axis=1)
    poses[:, 1, 2] = turn
    inertia = np.array([1.0, 0.09, np.inf])
    poses[:, 2, 2] = turn
    found = ways(run(["link"] * 3, poses, body_inertia=inertia,
                     body_mass=np.array([1.0, 1.0, np.inf])).arrays)
    # a polygon of n sides is short by (2 pi / n)^2 / 24
    assert found == pytest.approx([0.4 * np.pi, 0.6 * np.pi, 0.0], rel=(2 * np.pi / 2000) ** 2)


@pytest.mark.parametrize(("roles", "lengths", "swapped"), [
    (("phalanx", "object"), (1.0, 0.0), True),
    (("link", "link"), (0.5, 1.0), True),
    (("ground", "link"), (0.0, 1.0), True),
    (("object", "object"), (0.5, 1.0), True),
    (("link", "link"), (1.0, 1.0 + 1e-9), False),
])
def test_it_acts_on_the_object_else_on_what_goes_farther(roles, lengths, swapped):
    found = run(roles, along_x(*lengths))
    ask = on_the_other(found.model, found.arrays, np.array([0]), np.array([1]))
    assert ask.tolist() == [swapped]


def test_the_order_of_the_file_does_not_count():
    """One pair written either way round: the same body, the same force on it."""
    poses = along_x(0.0, 1.0)
    for roles in (("link", "link"), ("object", "phalanx"), ("phalanx", "object")):
        one = run(roles, poses, [(0, 1, 3.0, -4.0)])
        two = run(roles, poses, [(1, 0, -3.0, 4.0)])
        (on_one, force_one), (on_two, force_two) = (
            contacts_on(each.model, each.arrays) for each in (one, two))
        assert on_one.tolist() == on_two.tolist()
        assert force_one.tolist() == force_two.tolist()
