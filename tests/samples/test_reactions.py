"""Joint reactions as the solve finds them, on machines with a known answer."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.model.supports import shared_joints
from tests.engine.machines import G, fixed, mass, mechanism

SHARED = 1e-3
"""Shares follow from a compliance of 1e-12 of the masses' own: digits leave 1e-4 of them."""


def run_of(*bodies, duration=0.02, **more):
    return simulate(mechanism(
        gravity=(0.0, -G), bodies=[fixed("wall"), *bodies], duration=duration, **more))


def four_bar():
    links = [("crank", 0.1, (0.0, 0.0), (0.0, 0.1)), ("coupler", 0.2, (0.0, 0.1), (0.2, 0.15)),
             ("rocker", 0.15, (0.25, 0.0), (0.2, 0.15))]
    bodies = [mass(name, weight, start) for name, weight, start, _ in links]
    ends = [("wall", "crank", (0.0, 0.0)), ("crank", "coupler", (0.0, 0.1)),
            ("coupler", "rocker", (0.2, 0.05)), ("wall", "rocker", (0.25, 0.0))]
    joints = [{"type": "pin", "name": f"pin{i}", "a": a, "b": b, "on_a": at}
              for i, (a, b, at) in enumerate(ends)]
    return bodies, joints


def test_supports_that_share_a_load_carry_the_least_and_are_named():
    """A beam welded at both ends, its weight in the middle: half of it each; rods in line, too."""
    run = run_of(mass("beam", 0.5, (0.0, 0.0)), joints=[
        {"type": "weld", "name": f"end{i}", "a": "wall", "b": "beam", "on_b": (x, 0)}
        for i, x in enumerate((-0.1, 0.1))])
    half = np.array([[0.0, 0.25 * G]] * 2)
    assert run.arrays["joint_force"][-1] == pytest.approx(half, rel=SHARED, abs=SHARED)
    pose = run.model.bodies.pose
    assert shared_joints(run.model, pose) == ({0, 1}, True)
    run = run_of(mass("bob", 0.5, (0.0, -0.1)), joints=[
        {"type": "rod", "name": f"rod{i}", "a": "wall", "b": "bob"} for i in range(2)])
    assert run.arrays["joint_force"][-1, :, 1] == pytest.approx([0.25 * G] * 2, rel=SHARED)
    assert shared_joints(run.model, run.model.bodies.pose).joints == {0, 1}


def test_joints_that_statics_decides_share_nothing():
    bodies, joints = four_bar()
    model = run_of(*bodies, joints=joints).model
    assert shared_joints(model, model.bodies.pose) == (set(), True)
    # a fifth bar beside the coupler holds nothing that is not held, the ring but not the load
    joints = [*joints, {"type": "rod", "name": "extra", "a": "wall", "b": "coupler"},
              {"type": "rod", "name": "again", "a": "wall", "b": "rocker", "on_b": (0.01, 0.0)}]
    model = run_of(*bodies, joints=joints).model
    names = {model.joints.name[j] for j in shared_joints(model, model.bodies.pose).joints}
    assert {"extra", "again"} <= names
