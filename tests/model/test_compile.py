"""The model of a mechanism: every number worked out by hand."""

import math
from dataclasses import fields

import numpy as np
import pytest

from sandbox.model.compile import compile_mechanism
from sandbox.scene.mechanism import Mechanism

MECHANISM = {
    "bodies": [
        {"name": "ground", "motion": "fixed", "at": [1, 0], "angle": "90 deg"},
        {"name": "arm", "at": [2, 0], "angle": 0.25, "mass": 2, "centre": [0.1, 0.2],
         "inertia": 0.5},
        {"name": "cart", "motion": "scheduled", "path": {"x": "=t"}},
        {"name": "ball", "at": [3, 4], "mass": 1,
         "shapes": [{"type": "circle", "radius": 0.5, "at": [0.5, 0]}]},
    ],
    "joints": [
        {"type": "rope", "name": "leash", "a": "ground", "b": "ball", "longest": 9, "shortest": 1},
        {"type": "pin", "name": "hinge", "a": "ground", "b": "arm", "on_b": [0, 0], "zero": 0.5,
         "positive": "clockwise", "limits": [-1, 2], "damping": 0.3},
        {"type": "slot", "name": "rail", "a": "ground", "b": "ball", "start": [0, 0],
         "end": [0, 5], "turns": False, "on_b": [0.1, 0]},
        {"type": "weld", "name": "glue", "a": "arm", "b": "ball", "on_a": [1, 0]},
        {"type": "rod", "name": "rod", "a": "ground", "b": "ball", "on_a": [-0.3, 0],
         "on_b": [0.2, 0.1]},
    ],
    "springs": [
        {"type": "rotary", "name": "coil", "joint": "hinge", "stiffness": 7, "rest_angle": 0.1},
        {"type": "linear", "name": "strut", "a": "arm", "b": "ball", "stiffness": 5, "damping": 1,
         "on_b": [0, 1]},
    ],
    "tendons": [
        {"name": "one", "guides": [{"body": "ground"}, {"body": "ball"}], "slack": 0.1},
        {"name": "two", "rest_length": 3, "guides": [
            {"body": "ball", "at": [1, 2]}, {"body": "ground", "radius": 0.2, "side": "right"},
            {"body": "arm", "radius": 0.1}]},
    ],
    "drives": [
        {"type": "stiffness", "name": "k", "spring": "strut"},
        {"type": "pull", "name": "pull", "tendon": "two", "value": 1},
        {"type": "force", "name": "push", "body": "ball", "direction": [3, 4], "frame": "body",
         "at": [0, 1], "value": 2},
        {"type": "motor", "name": "motor", "joint": "hinge", "value": 1, "torque": 4},
        {"type": "radius", "name": "swell", "body": "ball", "value": 1},
    ],
}


@pytest.fixture(scope="module")
def model():
    return compile_mechanism(Mechanism.model_validate(MECHANISM))


def test_bodies(model):
    bodies = model.bodies
    assert bodies.free.tolist() == [False, True, False, True]
    assert bodies.fixed.tolist() == [True, False, False, False]
    assert bodies.scheduled.tolist() == [False, False, True, False]
    assert bodies.mass.tolist() == [math.inf, 2, math.inf, 1]
    assert bodies.inertia.tolist() == [math.inf, 0.5, math.inf, pytest.approx(0.125)]
    assert bodies.centre.tolist() == [[0, 0], [0.1, 0.2], [0, 0], [0.5, 0]]
    np.testing.assert_allclose(bodies.pose[0], [1, 0, math.pi / 2])


def test_joints(model):
    joints = model.joints
    assert joints.bodies.tolist() == [[0, 3], [0, 1], [0, 3], [1, 3], [0, 3]]
    # (2, 0) in the world is 1 m ahead of the ground's frame, which looks up: (0, -1) there
    np.testing.assert_allclose(joints.anchor[1], [[0, -1], [0, 0]], atol=1e-15)
    assert joints.turns.tolist() == [True, True, False, False, True]
    assert joints.hinges.tolist() == joints.pivots.tolist() == joints.stopped.tolist() == [1]
    assert joints.keeping("point").tolist() == [1, 3]
    assert joints.keeping("range", "groove").tolist() == [0, 2]
    assert joints.sense[1] == -1
    assert np.isnan(np.delete(joints.sense, 1)).all()
    assert joints.stops[1].tolist() == [-1, 2]
    assert joints.start[1] == pytest.approx(-(0.25 - math.pi / 2) - 0.5)
    assert joints.groove[2].tolist() == [[0, 0], [0, 5]]
    assert joints.reach[0].tolist() == [1, 9]
    # from (1, -0.3), 0.3 m behind the ground's frame, to (3.2, 4.1) on the ball
    np.testing.assert_allclose(joints.reach[4], math.hypot(2.2, 4.4))
    assert np.isnan(joints.reach[1:4]).all()
    assert joints.unknowns.tolist() == [1, 2, 2, 3, 1]
    assert model.neighbours[3] == ((0, 0), (2, 0), (3, 1), (4, 0))


def test_springs(model):
    springs = model.springs
    assert springs.straight.tolist() == [False, True]
    assert springs.bodies.tolist() == [[0, 1], [1, 3]]
    assert springs.joint.tolist() == [1, -1]
    assert springs.rest.tolist() == [0.1, pytest.approx(math.hypot(1, 5))]
    assert springs.start.tolist() == [model.joints.start[1], springs.rest[1]]
    assert springs.drive.tolist() == [-1, 0]


def test_tendons(model):
    tendons = model.tendons
    assert tendons.guide_body[tendons.guides(0)].tolist() == [0, 3]
    assert tendons.guide_body[tendons.guides(1)].tolist() == [3, 0, 1]
    assert tendons.guide_radius[tendons.guides(1)].tolist() == [0, 0.2, -0.1]
    assert tendons.stretch_first.tolist() == [0, 2, 3]
    assert tendons.stretch_tendon.tolist() == [0, 1, 1]
    assert tendons.drive.tolist() == [-1, 1]
    assert np.isnan(tendons.rest[0])
    assert tendons.rest[1] == 3
    assert tendons.slack.tolist() == [0.1, 0]


def test_drives(model):
    drives = model.drives
    assert drives.target.tolist() == [1, 1, 3, 1, 3]
    assert drives.direction[2].tolist() == pytest.approx([0.6, 0.8])
    assert drives.turning.tolist() == [False, False, True, False, False]
    assert drives.most[3] == 4
    assert drives.shape.tolist() == [-1, -1, -1, -1, 0]
    assert drives.floor.tolist() == [0, 0, -math.inf, -math.inf, 1e-9]
    assert drives.giving("force", "torque").tolist() == [2, 3]


def test_nothing_can_be_changed(model):
    for part in (model.bodies, model.joints, model.springs, model.tendons, model.drives):
        for field in fields(part):
            if isinstance(array := getattr(part, field.name), np.ndarray):
                assert not array.flags.writeable
