"""Reachable poses: the sets against their own conditions in both directions, and the engine."""

from __future__ import annotations

import json

import numpy as np
import pytest

from sandbox.paper import proposals
from sandbox.paper.reach import common, reach_of
from sandbox.paper.reach_runs import finger_scene, settle
from sandbox.study.reference_fingers import SET_A

REACH = reach_of(SET_A)
TARGET = np.radians([5.0, 10.0, 15.0])
STOPS = np.array(SET_A.limits)


def poses(count: int, highest: np.ndarray | tuple[float, ...], seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.001, np.radians(highest), (count, 3))


# --- against numbers found elsewhere


def test_figure_18_and_the_stiffness_of_figures_19_and_20():
    # integrations of the finger in minimal coordinates, to the digits given
    assert np.degrees(REACH.free(4.6817)) == pytest.approx([1.4877, 5.1017, 22.2091], abs=2e-3)
    assert REACH.needed_stiffness(15.0, TARGET) == pytest.approx([16475, 9745, 4330], abs=1)
    assert REACH.needed_stiffness(10.0, TARGET) == pytest.approx([10983, 6497, 2887], abs=1)


# --- folds


# --- stiffness


@pytest.mark.parametrize("pull", [5.0, 10.0, 15.0])
def test_stiffness_box_holds_what_springs_in_range_hold_and_nothing_else(pull):
    box = REACH.stiffness_box(pull, 3.0)
    inside = 0
    edge = np.degrees([joint[0][1] for joint in box.joints])
    for pose in poses(400, np.minimum(1.4 * edge, np.degrees(STOPS))):
        share = REACH.needed_stiffness(pull, pose) / REACH.stiffness
        margin = np.minimum(np.abs(share - 1), np.abs(share - 3)).min()
        if margin < 1e-4:
            continue
        held = ((share > 1) & (share < 3) & (pose < REACH.fold)).all()
        assert box.contains(pose) == held
        inside += held
    assert 20 < inside < 300


# --- locks


@pytest.mark.parametrize(("pull", "holding"),
                         [(5.0, 0.05), (10.0, 0.03), (15.0, 0.05), (15.0, 0.08)])
def test_lock_box_holds_what_locks_carry_and_nothing_else(pull, holding):
    box, free = REACH.lock_box(pull, holding), REACH.free(pull)
    for pose in poses(400, (6.0, 60.0, 70.0)):
        load = REACH.at(REACH.load(pull), pose)
        for i in range(3):
            if min(abs(load[i] - holding), abs(pose[i] - free[i])) < 1e-6:
                continue
            other = box.nearest(np.zeros(3))
            other[i] = pose[i]
            assert box.contains(other) == (load[i] < holding and pose[i] < free[i])


# --- antagonist


# --- pulls and boxes say the same


def test_which_proposal_holds_the_papers_pose():
    assert common(REACH.stiffness_pulls(TARGET, 3.0)) is None
    assert common(REACH.stiffness_pulls(TARGET, 3.6)) is not None
    assert common(REACH.lock_pulls(TARGET, 0.05)) is None
    assert common(REACH.lock_pulls(TARGET, 0.08)) == pytest.approx((13.657, 16.172), abs=1e-3)


# --- the engine


def test_simulations_confirm_points_of_the_maps():
    for check in proposals.confirmations(REACH):
        # at rest: 0.01 deg; a lock closes at the first look after its angle is passed; the jolt of
        # a joint that runs on to its stop makes loaded locks give way a little
        allowed = 0.01 if check["set"] != proposals.LOCKS else 0.1
        if "38 deg slips" in check["where"]:
            allowed = 0.5
        assert np.degrees(check["off_rad"]) < allowed, check["where"]


def test_a_fold_is_one_in_the_engine():
    k = REACH.needed_stiffness(10.0, np.array([*TARGET[:2], REACH.fold[2]]))
    held = settle(finger_scene(10.0, stiffness=k * [1, 1, 1.02]))
    lost = settle(finger_scene(10.0, stiffness=k * [1, 1, 0.98]))
    assert held[2] < REACH.fold[2]
    assert lost[2] == pytest.approx(STOPS[2], abs=1e-4)


@pytest.mark.nightly
def test_the_study_writes_its_files(tmp_path):
    told = proposals.run(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        "proposals.json", *(f"proposals_{name}.{ending}" for name in ("maps", "pulls")
                            for ending in ("png", "svg", "pdf"))}
    numbers = json.loads((tmp_path / "proposals.json").read_text())
    assert numbers["at_pull"][2][proposals.LOCKS]["miss_rad"] == 0
    assert "15 N: " in told
    assert "joint locks: reaches the target" in told.splitlines()[2]
