"""Every kind of load as a force and a moment on its bodies, with numbers worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.samples.loads import Loads
from tests.audit.still import block, machine, still

AT = {"one": np.array([0.1, 0.2]), "two": np.array([0.3, 0.1])}
TURN = {"one": 0.5, "two": -0.4}
CENTRE = {"one": np.array([0.03, 0.01]), "two": np.array([-0.02, 0.04])}
ONE, TWO = 1, 2


def turned(angle, point):
    return np.array([math.cos(angle) * point[0] - math.sin(angle) * point[1],
                     math.sin(angle) * point[0] + math.cos(angle) * point[1]])


def pair(**elements):
    return machine(*(block(name, at=AT[name].tolist(), angle=TURN[name],
                           centre=CENTRE[name].tolist()) for name in AT), **elements)


def hinge(**more):
    return {"type": "pin", "name": "pin", "a": "one", "b": "two", "on_b": (0, 0), **more}


def arm(name, point):
    """From a body's centre of mass to a point of its frame, along the world's axes."""
    return turned(TURN[name], np.asarray(point) - CENTRE[name])


def moment(lever, force):
    return lever[0] * force[1] - lever[1] * force[0]


def totals(machine_, change=None, **more):
    return Loads(still(machine_, change, n=3, **more)).totals


def set_(key, value, sample=1):
    def change(a):
        a[key][sample, 0] = value
    return change


def test_a_straight_spring_pulls_its_ends_together():
    on = {"one": (0.05, -0.02), "two": (0.01, 0.03)}
    machine_ = pair(springs=[{"type": "linear", "name": "band", "a": "one", "b": "two",
                              "on_a": on["one"], "on_b": on["two"], "stiffness": 1.0}])
    found = totals(machine_, set_("spring_force", 7.0))
    ends = {name: AT[name] + turned(TURN[name], on[name]) for name in on}
    along = (ends["two"] - ends["one"]) / np.linalg.norm(ends["two"] - ends["one"])
    for body, name, sign in ((ONE, "one", 1), (TWO, "two", -1)):
        force = 7.0 * sign * along
        expected = [*force, moment(arm(name, on[name]), force)]
        assert found[:, body, 1] == pytest.approx(expected)
    assert (found[:, :, [0, 2]] == 0).all()


@pytest.mark.parametrize(("positive", "sense"), [("counterclockwise", 1), ("clockwise", -1)])
@pytest.mark.parametrize("kind", ["stop", "damping", "torque", "motor", "brake", "rotary"])
def test_torques_of_a_hinge_turn_its_b_one_way_and_its_a_the_other(kind, positive, sense):
    more = {}
    if kind in ("torque", "motor", "brake"):
        torque = {"motor": {"torque": 1.0}}.get(kind, {})
        more["drives"] = [{"type": kind, "name": "d", "joint": "pin", "value": 0, **torque}]
    if kind == "rotary":
        more["springs"] = [{"type": "rotary", "name": "coil", "joint": "pin", "stiffness": 4.0,
                            "rest_angle": 0.3, "damping": 99.0}]
    machine_ = pair(joints=[hinge(positive=positive)], **more)

    def change(a):
        a["joint_angle"][:, 0] = 0.3
        if kind in ("stop", "damping"):
            a[f"joint_{kind}"][1, 0] = 2.0
        elif kind == "rotary":
            a["joint_rate"][1, 0], a["spring_force"][1, 0] = 3.0, -2.0 + 99.0 * 3.0
        else:
            a["drive_value"][:, 0] = 9.0 if kind != "torque" else [0.0, 2.0, 0.0]
            a["drive_torque"][:, 0] = 9.0 if kind == "torque" else [np.nan, 2.0, 0.0]
    found = totals(machine_, change)
    assert found[2, :, 1].tolist() == [0.0, -2.0 * sense, 2.0 * sense]
    assert (found[:2] == 0).all()
    assert (found[:, :, [0, 2]] == 0).all()


@pytest.mark.parametrize(("frame", "turn"), [("world", 0.0), ("body", TURN["two"])])
def test_a_force_drive_pushes_along_its_direction_at_its_point(frame, turn):
    machine_ = pair(drives=[{"type": "force", "name": "push", "body": "two", "at": (0.05, -0.03),
                             "direction": (6, -8), "frame": frame, "value": 0}])
    found = totals(machine_, set_("drive_value", 10.0))
    force = 10.0 * turned(turn, (0.6, -0.8))
    assert found[:, TWO, 1] == pytest.approx([*force, moment(arm("two", (0.05, -0.03)), force)])
    assert (found[:, :TWO] == 0).all()


# -- contacts --------------------------------------------------------------------------------


DISC = {"type": "circle", "radius": 0.02}


def touching(shapes_one, shapes_two=(DISC,)):
    machine_ = pair()
    content = machine_.model_dump(by_alias=True)
    for body, shapes in zip(content["bodies"][1:], (shapes_one, shapes_two), strict=True):
        body["shapes"] = list(shapes)
    return type(machine_).model_validate(content)


def test_a_contact_acts_on_both_bodies_at_the_recorded_place():
    force, normal, point = np.array([3.0, -2.0]), np.array([0.8, -0.6]), np.array([0.22, 0.13])
    loads = Loads(still(touching((DISC,)), n=3, touches=[
        (1, TWO, ONE, tuple(force), tuple(normal), tuple(point), 0.002)]))
    for body, name, sign in ((TWO, "two", 1), (ONE, "one", -1)):
        centre = AT[name] + turned(TURN[name], CENTRE[name])
        assert loads.totals[:, body, 1] == pytest.approx(
            [*(sign * force), moment(point - centre, sign * force)])
    sides = loads.contact_sides
    assert sides.body.tolist() == [TWO, ONE]
    assert sides.at.tolist() == [pytest.approx(point)] * 2


def test_joints_act_on_b_and_the_other_way_on_a_where_each_holds_them():
    """A weld with a couple; a slot, whose groove is pressed where the pin is; gaps do no harm."""
    machine_ = pair(joints=[
        {"type": "weld", "name": "weld", "a": "one", "b": "two", "on_a": (0.1, 0.0),
         "on_b": (0.0, 0.05)},
        {"type": "slot", "name": "slot", "a": "one", "b": "two", "start": (0.0, 0.0),
         "end": (0.3, 0.0), "on_b": (0.02, 0.01)}])
    forces, couple = np.array([[3.0, -2.0], [0.5, 4.0]]), 0.7

    def change(a):
        a["joint_force"][1], a["joint_couple"][1, 0] = forces, couple
    loads = Loads(still(machine_, change, n=3))
    arms = [{ONE: turned(TURN["one"], np.array([0.1, 0.0]) - CENTRE["one"]),
             TWO: turned(TURN["two"], np.array([0.0, 0.05]) - CENTRE["two"])}]
    pin = AT["two"] + turned(TURN["two"], np.array([0.02, 0.01]))
    arms.append({body: pin - AT[name] - turned(TURN[name], CENTRE[name])
                 for body, name in ((ONE, "one"), (TWO, "two"))})
    for body, sign in ((TWO, 1), (ONE, -1)):
        assert loads.left[:2, body, 1] == pytest.approx(sign * forces.sum(axis=0))
        assert loads.left[2, body, 1] == pytest.approx(sign * (couple + sum(
            moment(arm[body], force) for arm, force in zip(arms, forces, strict=True))))
    assert not loads.left[:, 0].any()
    assert not loads.left[:, :, 0].any()


# -- the largest -----------------------------------------------------------------------------
