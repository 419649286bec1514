"""What joints may drift in one step, term by term, and what the figures of geometry add to it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.audit.evidence import Evidence
from tests.audit.still import H, block, figures, machine, still, turns

ROUNDING = 1e-12
SLOP = 1e-6
SIZE = np.array([0.3, -0.4])
"""An arm of 0.5 m."""


def cross(turn: float, arm: np.ndarray) -> np.ndarray:
    """Velocity of a point at ``arm`` from the centre of a body that turns."""
    return np.cross([0.0, 0.0, turn], [*arm, 0.0])[:2]


def hung(**joint: Any):
    """One body on the wall, its centre of mass 0.5 m from the anchor."""
    body = block("one", at=(0.1, 0.2), centre=(-SIZE).tolist())
    return machine(body, joints=[{"name": "joint", "a": "wall", "b": "one", "on_b": (0, 0),
                                  "type": "pin", **joint}])


def moved(body: int, by: float, **arrays: Any):
    """A body off by ``by`` along x, with velocities and accelerations as told, [nb, 3]."""
    def change(a: dict[str, np.ndarray]) -> None:
        a["body_pose"][:, body, 0] += by
        for key, rows in arrays.items():
            a[key][:] = rows
    return change


def test_a_joint_at_rest_is_held_to_rounding():
    turns("joint.drift", ROUNDING, lambda e: still(hung(), moved(1, e)), by=1e-3)


@pytest.mark.parametrize(("turn", "alpha"), [(40.0, 0.0), (40.0, 6000.0), (-25.0, 6000.0)])
def test_a_body_that_turns_on_for_a_step_leaves_half_h2_w2_r(turn, alpha):
    """w is that before the step: the recorded mean less half the step's change; a tenth more."""
    before = turn - H / 2 * alpha
    allowed = 1.1 * H**2 * before**2 * 0.5 / 2 + ROUNDING
    turns("joint.drift", allowed, lambda e: still(hung(), moved(
        1, e, body_velocity=[[0, 0, 0], [0, 0, turn]],
        body_acceleration=[[0, 0, 0], [0, 0, alpha]])))


def test_both_bodies_of_a_hinge_count_with_their_own_arms_and_turns():
    """The one at 0.5 m from its centre, the other at 0.13 m."""
    machine_ = machine(block("one", centre=(-SIZE).tolist()), block("two", centre=(0.05, 0.12)),
                       joints=[{"type": "pin", "name": "pin", "a": "one", "b": "two",
                                "on_a": (0, 0)}])
    allowed = 1.1 * H**2 * (30.0**2 * 0.5 + 70.0**2 * 0.13) / 2 + ROUNDING
    turns("joint.drift", allowed, lambda e: still(machine_, moved(
        2, e, body_velocity=[[0, 0, 0], [9, 9, 30.0], [-9, 9, -70.0]])))


@pytest.mark.parametrize("w_a", [20.0, -20.0])
def test_a_groove_that_turns_leaves_h2_w_v_more(w_a):
    """v is that of the pin along and across the groove, and of the gap that turns with it."""
    carriage, pin = np.array([0.02, 0.01]), np.array([0.1, 0.03])
    machine_ = machine(
        block("one", centre=carriage.tolist()), block("two", at=(0.25, 0.06), centre=pin.tolist()),
        joints=[{"type": "slot", "name": "slot", "a": "one", "b": "two", "start": (0.05, 0.06),
                 "end": (0.55, 0.06), "on_a": (0.15, 0.06)}])
    v_a, (v_b, w_b) = np.array([0.4, -0.3]), (np.array([-0.7, 0.2]), -11.0)
    arm_a, arm_b = np.array([0.15, 0.06]) - carriage, -pin
    slides = v_b + cross(w_b, arm_b) - v_a - cross(w_a, arm_a)
    drift = ((w_a**2 * np.hypot(*arm_a) + w_b**2 * np.hypot(*arm_b)) / 2
             + abs(w_a) * (np.hypot(*slides) + abs(w_a) * 0.1))

    def make(error: float):
        def change(a):
            a["body_pose"][:, 2, 1] += error
            a["body_velocity"][:, 1], a["body_velocity"][:, 2] = [*v_a, w_a], [*v_b, w_b]
        return still(machine_, change)

    # the gap along the groove is what the error makes longer, by its square: 1e-8 of 0.1 m
    turns("joint.drift", 1.1 * H**2 * drift + ROUNDING, make, by=1e-4)


def test_a_rod_whose_ends_move_across_it_leaves_h2_v2_over_2_l_more():
    """Ends 0.25 m apart; the one on the body at an arm of 0.13 m."""
    arm = np.array([-0.05, -0.12])
    machine_ = machine(
        block("one", at=(0.15, 0.2), centre=(-arm).tolist()),
        joints=[{"type": "rod", "name": "rod", "a": "wall", "b": "one"}])
    v, w = np.array([0.3, -0.1]), 4.0
    end = v + cross(w, arm)
    allowed = 1.1 * H**2 * (w**2 * 0.13 / 2 + end @ end / (2 * 0.25)) + ROUNDING

    def make(error: float):
        def change(a):
            a["body_pose"][1:, 1, :2] += error * np.array([0.6, 0.8])
            a["body_velocity"][1:, 1] = [*v, w]
        return still(machine_, change)

    turns("joint.drift", allowed, make, by=1e-4)


@pytest.mark.parametrize(("length", "gap"), [({"length": 0.5}, 2e-4), ({"length": 0.503}, 2.8e-3),
                                             ({}, 2e-4)])
def test_a_rod_has_its_given_length_or_that_of_the_scene(length, gap):
    """0.5 m in the scene, recorded as 0.5002 m."""
    machine_ = machine(block("one", at=(0.3, 0.4)), joints=[
        {"type": "rod", "name": "rod", "a": "wall", "b": "one", **length}])
    run = still(machine_, lambda a: a["body_pose"][:, 1].__iadd__([1.2e-4, 1.6e-4, 0]))
    assert figures(run)["joint.drift"].value == pytest.approx(gap, rel=1e-9)


def test_a_slot_drifts_across_its_groove_however_it_lies():
    """A groove along (3, 4) / 5 of a carriage turned by 0.3; along it the pin is free."""
    along = np.array([0.6, 0.8])
    c, s = np.cos(0.3), np.sin(0.3)
    out = np.array([c * along[0] - s * along[1], s * along[0] + c * along[1]])
    aside = np.array([-out[1], out[0]])
    for slides, off in ((0.07, 0.0), (0.07, 3e-5), (-0.02, -3e-5)):
        machine_ = machine(
            block("one", at=(0.1, 0.1), angle=0.3), block("two", at=(0.4, 0.4)),
            joints=[{"type": "slot", "name": "slot", "a": "one", "b": "two", "start": (0.02, 0.01),
                     "end": (0.62, 0.81)}])
        start = np.array([0.1 + c * 0.02 - s * 0.01, 0.1 + s * 0.02 + c * 0.01])
        at = start + (0.2 + slides) * out + off * aside
        run = still(machine_, lambda a, at=at: a["body_pose"].__setitem__(
            (slice(None), 2, slice(0, 2)), at))
        figure = figures(run)["joint.drift"]
        assert figure.value == pytest.approx(abs(off), abs=1e-15)
        assert figure.threshold == ROUNDING


@pytest.mark.parametrize("busy", ["contact", "stop", "motor", "rope"])
def test_while_the_solver_has_more_to_solve_joints_are_held_to_slop(busy):
    joints = [{"type": "pin", "name": "pin", "a": "wall", "b": "one", "on_b": (0, 0)},
              {"type": "weld", "name": "weld", "a": "wall", "b": "two", "on_b": (0, 0)}]
    more: dict[str, Any] = {}
    if busy == "rope":
        joints.append({"type": "rope", "name": "rope", "a": "wall", "b": "one", "longest": 9})
    if busy == "motor":
        more["drives"] = [{"type": "motor", "name": "motor", "joint": "pin", "value": 1,
                           "torque": 1}]
    machine_ = machine(block("one"), block("two"), joints=joints, run={"slop": 3e-6}, **more)
    touch = [(2, 1, 2, (0.0, 0.0), (0.0, 1.0), (0.0, 0.0), 0.0)] if busy == "contact" else []

    def change(a):
        if busy == "stop":
            a["joint_stop"][2, 0] = 0.1
        if busy == "motor":
            a["drive_torque"][2, 0] = 0.1
        a["drive_torque"][0] = a["joint_stop"][0, 1:] = np.nan  # drives and joints that have none
    slack = Evidence(still(machine_, change, n=6, touches=touch)).joint_slack[0]
    samples = [1, 1, 1, 1, 1, 1] if busy == "rope" else [0, 0, 1, 1, 0, 0]  # and the next one
    assert slack == pytest.approx(3e-6 * np.array(samples), abs=0)


# -- overlaps taken apart --------------------------------------------------------------------


def touching(*gaps: float) -> list[Any]:
    """Between bodies 1 and 2, one contact a sample; without one where the gap is nan."""
    return [(i, 1, 2, (0.0, 0.0), (0.0, 1.0), (0.0, 0.0), gap)
            for i, gap in enumerate(gaps) if not np.isnan(gap)]


def test_a_shift_is_the_deepest_overlap_beyond_slop_now_or_just_before():
    machine_ = machine(block("one"), block("two"), run={"slop": 1e-5})
    touches = [*touching(np.nan, -4e-5, -2e-5, np.nan, np.nan, -1e-5, 3e-5),
               (6, 0, 1, (0.0, 0.0), (0.0, 1.0), (0.0, 0.0), -5e-5)]
    evidence = Evidence(still(machine_, n=8, touches=touches))
    assert evidence.shift == pytest.approx([0, 3e-5, 3e-5, 1e-5, 0, 0, 4e-5, 4e-5], abs=1e-20)


def chain(**more: Any):
    """Wall, one, two on hinges; the lowest pin's zero and sense are others. Two others touch."""
    return machine(
        block("one", at=(0.0, 0.0), angle=0.2, centre=(0.05, 0.0)),
        block("two", at=(0.1, 0.05), angle=-0.4, centre=(0.0, 0.05)), block("three"),
        joints=[{"type": "pin", "name": "first", "a": "wall", "b": "one", "on_b": (0.02, -0.01)},
                {"type": "pin", "name": "second", "a": "two", "b": "one", "on_a": (0.015, 0.01),
                 "positive": "clockwise", "zero": 0.15}], **more)


SPIN = [[0, 0, 0], [0, 0, 30.0], [0, 0, -20.0], [0, 0, 0]]
FIRST = 1.1 * H**2 * 30.0**2 * np.hypot(0.03, 0.01) / 2
_C, _S = np.cos(-0.4), np.sin(-0.4)
_FAR = np.array([0.1 + _C * 0.015 - _S * 0.01 - 0.05 * np.cos(0.2),
                 0.05 + _S * 0.015 + _C * 0.01 - 0.05 * np.sin(0.2)])
"""From the first's centre of mass to the second hinge."""
SECOND = 1.1 * H**2 * (30.0**2 * np.hypot(*_FAR) + 20.0**2 * np.hypot(0.015, 0.04)) / 2


def test_placed_bodies_may_be_off_by_all_hinges_on_the_way():
    """(31) from the wall out: the second gets the drift, the shift and the rounding of both."""
    shift = 4e-6
    touches = [(i, 3, 0, (0.0, 0.0), (0.0, 1.0), (0.0, 0.0), -SLOP - shift) for i in range(4)]
    allowed = FIRST + SECOND + 2 * SLOP + 2 * shift + 2 * ROUNDING
    turns("poses", allowed, lambda e: still(chain(), moved(2, e, body_velocity=SPIN),
                                            touches=touches))
    alone = FIRST + SLOP + shift + ROUNDING

    def both(error):  # the second along with the first, so that its hinge stays closed
        def change(a):
            a["body_pose"][:, 1:3, 1] -= error
            a["body_velocity"][:] = SPIN
        return still(chain(), change, touches=touches)
    turns("poses", alone, both)


def test_bodies_placed_at_rest_may_be_off_by_the_rounding_of_each_hinge():
    turns("poses", 2 * ROUNDING, lambda e: still(chain(), moved(2, e)), by=1e-3)


def test_angles_of_placed_bodies_are_held_to_rounding():
    """1e-12 (1 + |angle|) rad: here of a body turned by 19.6 rad, shown beside metres."""
    def make(error):
        def change(a):
            a["joint_angle"][:, 1] += 20.0  # clockwise of one against two: two turns on with it
            for turn, sign in ((-0.4, 1), (19.6, -1)):  # about the hinge, which stays
                c, s = np.cos(turn), np.sin(turn)
                a["body_pose"][:, 2, 0] += sign * (c * 0.015 - s * 0.01)
                a["body_pose"][:, 2, 1] += sign * (s * 0.015 + c * 0.01)
            a["body_pose"][:, 2, 2] += 20.0 + error
        return still(chain(), change)
    allowed = ROUNDING * (1 + 19.6)
    for error, verdict in ((0.9 * allowed, "pass"), (1.1 * allowed, "look")):
        figure = figures(make(error))["poses"]
        assert figure.verdict == verdict
        assert figure.threshold == pytest.approx(allowed, rel=0.01)
        assert "angle of two" in figure.why


def test_stops_may_be_overrun_by_a_turn_of_one_step_and_the_shift_on_its_shortest_lever():
    """1e-6 rad + h max |rate| + shift / the shortest stretch that a force runs along."""
    machine_ = machine(
        block("one"), block("two"),
        joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "one", "on_b": (0, 0),
                 "limits": (-0.5, 0.7)}],
        springs=[{"type": "linear", "name": "band", "a": "wall", "b": "two", "stiffness": 1}],
        tendons=[{"name": "cord", "guides": [{"body": "wall"}, {"body": "two", "at": (0.03, 0.04)},
                                             {"body": "two", "at": (0.03, 0.24)}]}])
    shift = 2e-6
    touches = [(i, 2, 0, (0.0, 0.0), (0.0, 1.0), (0.0, 0.0), -SLOP - shift) for i in range(4)]
    for sign, limit in ((1.0, 0.7), (-1.0, -0.5)):
        for length, shortest in ((0.02, 0.02), (0.3, 0.05), (0.0, 1.0)):
            def make(error, sign=sign, limit=limit, length=length):
                def change(a):
                    a["joint_angle"][:, 0] = limit + sign * error
                    a["joint_rate"][:, 0] = [3.0, -8.0, 1.0, 0.0]
                    a["spring_length"][:] = length
                return still(machine_, change, touches=touches)
            turns("stop.overrun", 1e-6 + H * 8.0 + shift / shortest, make)
    nothing = machine(block("one"), block("two"), joints=[j.model_dump() for j in machine_.joints])
    turns("stop.overrun", 1e-6 + shift / 1.0, lambda e: still(
        nothing, lambda a: a["joint_angle"].__setitem__((slice(None), 0), 0.7 + e),
        touches=touches), by=1e-5)


def test_overlaps_taken_apart_may_open_joints_too():
    touch = [(i, 2, 0, (0.0, 0.0), (0.0, 1.0), (0.0, 0.0), -SLOP - 5e-6) for i in range(4)]
    machine_ = machine(block("one"), block("two"), joints=[
        {"type": "pin", "name": "pin", "a": "wall", "b": "one", "on_b": (0, 0)}])
    turns("joint.drift", SLOP + 5e-6 + ROUNDING, lambda e: still(
        machine_, moved(1, e), touches=touch))


def test_the_first_four_of_many_stops_are_told_and_the_others_counted():
    def told(count):
        machine_ = machine(*(block(f"b{i}") for i in range(count)), joints=[
            {"type": "pin", "name": f"j{i}", "a": "wall", "b": f"b{i}", "on_b": (0, 0),
             "limits": (-1, 1)} for i in range(count)])
        return figures(still(machine_, lambda a: a["joint_stop"].__iadd__(-0.5)))[
            "stop.overrun"].why
    each = [f"j{i} from 0.0005 s, up to 0.5 N m" for i in range(4)]
    assert told(4) == "touched: " + "; ".join(each) + "; one step's turn is allowed"
    assert told(6) == "touched: " + "; ".join(each) + " and 2 more; one step's turn is allowed"
    assert told(0) == "no hinge has stops"


def test_stops_that_were_touched_are_told_with_their_start_and_their_most():
    def change(a):
        a["joint_stop"][:, 0] = [0.0, 0.0, -0.25, 0.125]
    machine_ = hung(limits=(-0.5, 0.7))
    assert "joint from 0.0025 s, up to 0.25 N m" in figures(still(machine_, change))[
        "stop.overrun"].why
