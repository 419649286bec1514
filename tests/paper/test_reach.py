"""Reachable poses: the sets against their own conditions in both directions, and the engine."""

from __future__ import annotations

import json

import numpy as np
import pytest

import sandbox
from sandbox.paper import proposals
from sandbox.paper.reach import PoseBox, common, reach_of
from sandbox.paper.reach_runs import finger_scene, settle
from sandbox.study.reference_fingers import SET_A

REACH = reach_of(SET_A)
TARGET = np.radians([5.0, 10.0, 15.0])
STOPS = np.array(SET_A.limits)
GRID = 2e-8
"""What lines between kept angles may be off [rad]."""


def poses(count: int, highest: np.ndarray | tuple[float, ...], seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.001, np.radians(highest), (count, 3))


# --- against numbers found elsewhere


def test_figure_18_and_the_stiffness_of_figures_19_and_20():
    # integrations of the finger in minimal coordinates, to the digits given
    assert np.degrees(REACH.free(4.6817)) == pytest.approx([1.4877, 5.1017, 22.2091], abs=2e-3)
    assert REACH.needed_stiffness(15.0, TARGET) == pytest.approx([16475, 9745, 4330], abs=1)
    assert REACH.needed_stiffness(10.0, TARGET) == pytest.approx([10983, 6497, 2887], abs=1)


def test_kept_arms_are_those_of_a_finer_grid():
    fine = reach_of(SET_A, points=10 * (REACH.angle.shape[1] - 1) + 1)
    assert REACH.free(5.0) == pytest.approx(fine.free(5.0), abs=GRID)


# --- folds


def test_no_stiffness_holds_a_joint_beyond_its_fold():
    for beyond, holds in ((-np.radians(0.5), True), (np.radians(0.5), False)):
        pose = REACH.fold + beyond
        rest = REACH.free(10.0, REACH.needed_stiffness(10.0, pose))
        assert (np.abs(rest - pose) < 1e-5).all() == holds
        # the other root of the same stiffness lies before the fold
        assert (rest <= REACH.fold).all()
    softer = 0.999 * REACH.needed_stiffness(10.0, REACH.fold)
    assert REACH.free(10.0, softer) == pytest.approx(STOPS)


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


def test_a_stop_is_reached_only_when_soft_springs_let_go():
    assert REACH.stiffness_box(5.0, 3.0).nearest(STOPS)[2] < REACH.fold[2]
    assert REACH.stiffness_box(10.0, 3.0).nearest(STOPS)[2] == pytest.approx(STOPS[2])
    assert REACH.stiffness_box(20.0, 3.0).joints[2] == ((STOPS[2], STOPS[2]),)


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


def test_a_lock_stays_slips_or_never_closes():
    load = REACH.load(15.0)
    assert REACH.locked(15.0, 0.08, TARGET) == pytest.approx(TARGET)
    slipped = REACH.locked(15.0, 0.05, np.radians([1.0, 5.0, 15.0]))
    assert REACH.at(load, slipped)[:2] == pytest.approx([0.05, 0.05], abs=1e-7)
    assert (slipped[:2] > np.radians([1.0, 5.0])).all()
    assert slipped[2] == STOPS[2]  # the load only grows: nothing stops it before the stop
    never = REACH.locked(15.0, 0.08, np.radians([7.0, 10.0, 15.0]))
    assert never[0] == pytest.approx(REACH.free(15.0)[0])


# --- antagonist


def test_poses_of_the_curve_are_in_balance_and_end_straight():
    curve = REACH.antagonist_curve(10.0, [5e-3] * 3, np.linspace(0, 10.0, 51))
    balance = np.array([REACH.at(REACH.load(10.0), pose) - tension * 5e-3
                        for tension, pose in zip(curve.tension, curve.poses, strict=True)])
    free = curve.poses < STOPS - 1e-9
    assert np.abs(balance[free & (curve.poses > 1e-9)]).max() < 1e-8
    assert (balance[~free] > 0).all()  # pressed on its stop
    assert curve.poses[-1] == pytest.approx(np.zeros(3), abs=1e-9)
    assert (np.diff(curve.poses, axis=0) <= 1e-12).all()


def test_wheels_made_for_a_pose_hold_it_up_to_where_it_runs_away():
    low, high = common(REACH.antagonist_pulls(TARGET))
    for pull, holds in ((0.999 * high, True), (1.01 * high, False)):
        arms = REACH.antagonist_arms(pull, 10.0, TARGET)
        found = REACH.with_antagonist(pull, 10.0, arms)
        assert (np.abs(found - TARGET) < 1e-4).all() == holds
    with pytest.raises(ValueError, match=r"pull must be more .* joint 1"):
        REACH.antagonist_arms(0.99 * low, 10.0, TARGET)


# --- pulls and boxes say the same


@pytest.mark.parametrize("pose", [(5.0, 10.0, 15.0), (3.0, 9.0, 16.0), (2.0, 10.0, 15.0),
                                  (2.0, 10.0, 50.0)])
def test_ranges_of_pulls_are_where_the_boxes_contain_the_pose(pose):
    asked = np.radians(pose)
    stiffness = REACH.stiffness_pulls(asked, 3.0)
    locks = REACH.lock_pulls(asked, 0.08)
    for pull in np.linspace(3.0, 30.0, 55) + 0.0123:
        within = ((stiffness[:, 0] <= pull) & (pull <= stiffness[:, 1])).all()
        assert REACH.stiffness_box(pull, 3.0).contains(asked) == within
        within = ((locks[:, 0] <= pull) & (pull <= locks[:, 1])).all()
        assert REACH.lock_box(pull, 0.08).contains(asked) == within


def test_which_proposal_holds_the_papers_pose():
    assert common(REACH.stiffness_pulls(TARGET, 3.0)) is None
    assert common(REACH.stiffness_pulls(TARGET, 3.6)) is not None
    assert common(REACH.lock_pulls(TARGET, 0.05)) is None
    assert common(REACH.lock_pulls(TARGET, 0.08)) == pytest.approx((13.657, 16.172), abs=1e-3)


def test_nearest_and_volume_of_a_box():
    box = PoseBox((((0.0, 1.0), (3.0, 3.0)), ((0.0, 2.0),)))
    assert box.nearest([1.9, -1.0]) == pytest.approx([1.0, 0.0])
    assert box.nearest([2.1, 1.5]) == pytest.approx([3.0, 1.5])
    assert box.volume == pytest.approx(2.0)
    assert box.contains([3.0, 2.0])
    assert not box.contains([2.0, 2.0])


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


def test_the_elastomer_keeps_to_its_rate():
    run = sandbox.simulate(sandbox.expand(sandbox.load_scene("finger_elastomer")))
    fastest = []
    for name, k0 in zip(("k1", "k2", "k3"), SET_A.stiffness, strict=True):
        value = run[f"{name}.value"]
        rate = np.abs(np.diff(value) / np.diff(run.time)).max() / k0
        assert rate <= 20 * 1.001
        fastest.append(rate)
        assert value.min() >= k0
        assert value.max() <= 3 * k0
    assert max(fastest) > 19.9  # the limit is felt


def test_the_study_writes_its_files(tmp_path):
    told = proposals.run(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        "proposals.json", *(f"proposals_{name}.{ending}" for name in ("maps", "pulls")
                            for ending in ("png", "svg", "pdf"))}
    numbers = json.loads((tmp_path / "proposals.json").read_text())
    assert numbers["at_pull"][2][proposals.LOCKS]["miss_rad"] == 0
    assert "15 N: " in told
    assert "joint locks: reaches the target" in told.splitlines()[2]
