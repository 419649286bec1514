"""What contact forces could be, against closed forms; what is outside asks for a look."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.audit.bounds import contact_bounds
from sandbox.audit.evidence import Evidence
from sandbox.engine.simulate import simulate
from tests.audit.still import block, figures, machine, still
from tests.engine.machines import mechanism

G = 9.81
WEIGHT = 0.2 * G


def between(run, sample=-1):
    """Low and high of the normal and the tangential force of every contact row."""
    return [((one.normal.low, one.normal.high), (one.tangential.low, one.tangential.high))
            for one in contact_bounds(Evidence(run), sample)]


# -- a finger of two thin phalanges on a disc: two balances for four components

L1, R, PULL, ARMS = 0.05, 0.018, 10.0, (0.012, 0.006)


def grasp(theta, mu):
    """Its contacts' distances from the hinges, and the recording of some grasp or other.

    The hinges are at 0 and (L1, 0), the finger bends clockwise round the disc below it.
    """
    theta = np.radians(theta)
    k2 = R * np.tan(theta / 2)
    k1 = L1 - k2
    along, out = np.array([np.cos(theta), -np.sin(theta)]), np.array([np.sin(theta),
                                                                     np.cos(theta)])
    centre = np.array([k1, -R])
    shape = {"type": "box", "size": (0.05, 0.01), "at": (0.025, 0.005)}
    machine_ = machine(
        {**block("one"), "shapes": [shape], "material": "m"},
        {**block("two", (L1, 0.0)), "angle": -theta, "shapes": [shape], "material": "m"},
        {"name": "disc", "motion": "fixed", "at": tuple(centre), "material": "m",
         "shapes": [{"type": "circle", "radius": R}]},
        materials={"m": {"friction": mu}},
        joints=[{"type": "pin", "name": "near", "a": "wall", "b": "one", "on_b": (0, 0)},
                {"type": "pin", "name": "far", "a": "one", "b": "two", "on_b": (0, 0)}],
        drives=[{"type": "torque", "name": f"t{i}", "joint": joint, "value": -PULL * arm}
                for i, (joint, arm) in enumerate(zip(("near", "far"), ARMS, strict=True))])

    def touch(body, k, origin, way, normal):
        at = origin + k * way
        return (0, body, 3, tuple(1.0 * normal), tuple(normal), tuple(at), 0.0)
    run = still(machine_, lambda a: a["drive_value"].__setitem__(
        slice(None), [-PULL * arm for arm in ARMS]), n=1, touches=[
            touch(1, k1, np.zeros(2), np.array([1.0, 0.0]), np.array([0.0, 1.0])),
            touch(2, k2, np.array([L1, 0.0]), along, out)])
    return k1, k2, theta, run


@pytest.mark.parametrize(("theta", "mu", "first"), [
    (60, 0.4, (0, 0.395439)), (75, 0.2, (0, 1.264063)),
    (75, 0.0, (0.104548, 0.104548)),
    (90, 0.2, (0.833333, 2.916667)),
])
def test_friction_of_the_far_phalanx_opens_an_interval_for_the_near_one(theta, mu, first):
    """f2 = T h2 / k2 whatever rubs; f1 k1 = T h1 - (k2 + l1 c) f2 + l1 s t2, |t2| <= mu f2."""
    k1, k2, angle, run = grasp(theta, mu)
    f2 = PULL * ARMS[1] / k2
    ends = [(PULL * ARMS[0] - (k2 + L1 * np.cos(angle)) * f2 + L1 * np.sin(angle) * t) / k1
            for t in (-mu * f2, mu * f2)]
    low, high = max(ends[0], 0.0), ends[1]
    assert (low, high) == pytest.approx(first, abs=1e-6)
    (near, rubs_near), (far, rubs_far) = between(run)
    assert near == pytest.approx((low, high), rel=1e-9, abs=1e-11)
    assert far == pytest.approx((f2, f2), rel=1e-9)
    assert rubs_near == pytest.approx((-mu * high, mu * high), rel=1e-9, abs=1e-11)
    # the tangent is the normal turned to the left: towards the finger's base
    least = (PULL * ARMS[0] - (k2 + L1 * np.cos(angle)) * f2 - k1 * low) / (-L1 * np.sin(angle))
    assert rubs_far == pytest.approx((-mu * f2, -least), rel=1e-9, abs=1e-11)


def test_without_enough_friction_nothing_holds_the_finger():
    *_, run = grasp(60, 0.2)
    assert np.isnan(between(run)).all()
    figure = figures(run)["contact.bounds"]
    assert (figure.verdict, figure.value) == ("look", np.inf)


# -- what else may carry


def test_a_disc_in_a_rough_groove_rubs_up_or_down_on_both_sides():
    """n = W / (2 (cos a + mu sin a)) to W / (2 (cos a - mu sin a)), a from the vertical: 45 deg.

    And the engine's choice is between them, while it settles, too.
    """
    mu, half = 0.5, np.sqrt(0.5)
    walls = [{"name": name, "motion": "fixed", "material": "m", "shapes": [
        {"type": "capsule", "end": (sign * 0.1, 0.1), "radius": 0.01}]}
        for name, sign in (("left", -1), ("right", 1))]
    run = simulate(mechanism(
        duration=0.2, gravity=(0.0, -G), materials={"m": {"friction": mu}},
        bodies=[{"name": "disc", "mass": 0.2, "at": (0.0, 0.03 * np.sqrt(2)), "material": "m",
                 "shapes": [{"type": "circle", "radius": 0.02}]}, *walls]))
    low, high = WEIGHT * half / (1 + mu), WEIGHT * half / (1 - mu)
    for sample in (20, -1):
        sides = contact_bounds(Evidence(run), sample)
        for one, sign in zip(sides, (1, -1), strict=True):
            assert (one.normal.low, one.normal.high) == pytest.approx((low, high), rel=1e-6)
            rubs = sorted((sign * mu * low, -sign * mu * high))
            assert (one.tangential.low, one.tangential.high) == pytest.approx(rubs, rel=1e-6)
            assert not one.normal.outside
            assert not one.tangential.outside


def resting(normal, *, at=(0.0, 0.0), shape=None, change=None, **more):
    """A block of 0.2 kg on a smooth floor, and what else holds it."""
    shape = shape or {"type": "circle", "radius": 0.01}
    floor = {"name": "floor", "motion": "fixed", "shapes": [
        {"type": "box", "size": (0.2, 0.02), "at": (-0.1, -0.01)}], "material": "m"}
    return still(
        machine({**block("block", (0.0, 0.01)), "shapes": [shape], "material": "m"}, floor,
                gravity=(0.0, -G), materials={"m": {"friction": 0.0}}, **more),
        change, n=1, touches=[(0, 1, 2, (0.0, normal), (0.0, 1.0), at, 0.0)])


BAR = {"type": "box", "size": (0.1, 0.02)}
CORD = {"name": "cord", "guides": [{"body": "block", "at": (0.05, 0.0)},
                                   {"body": "wall", "at": (0.05, 0.3)}]}


def pulled(tension):
    return lambda a: a["tendon_tension"].__setitem__(slice(None), tension)


@pytest.mark.parametrize("shape", [BAR, {"type": "capsule", "start": (-0.05, 0.0),
                                         "end": (0.05, 0.0), "radius": 0.01}])
def test_a_bar_that_lies_on_half_its_length_and_hangs_at_its_end(shape):
    """The floor at d left of the middle, 0 to a, the cord at a: N = W / (1 + d / a)."""
    run = resting(WEIGHT / 1.6, at=(-0.03, 0.0), shape=shape, tendons=[CORD],
                  change=pulled(WEIGHT * 0.6 / 1.6))
    ((normal, rubs),) = between(run)
    assert normal == pytest.approx((WEIGHT / 2, WEIGHT))
    assert rubs == (0.0, 0.0)
    assert figures(run)["contact.bounds"].verdict == "pass"


def lever(drive, rate=0.0, arrays=None, **hinge):
    """What a lever on a smooth disc, 50 mm from its hinge, may press with; it turns down [rad/s].

    What a motor or brake is said to have given is not asked.
    """
    def change(a):
        a["drive_value"][:] = drive["value"]
        a["drive_torque"][:] = -0.15
        a["body_velocity"][:, 1, 2] = -rate
        for key, value in (arrays or {}).items():
            a[key][:] = value
    run = still(machine(
        {**block("lever"), "shapes": [{"type": "box", "size": (0.1, 0.01), "at": (0.05, 0.005)}],
         "material": "m"},
        {"name": "disc", "motion": "fixed", "at": (0.05, -0.02), "material": "m",
         "shapes": [{"type": "circle", "radius": 0.02}]},
        materials={"m": {"friction": 0.0}},
        joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "lever", "on_b": (0, 0), **hinge}],
        drives=[{"name": "d", "joint": "pin", **drive}]),
        change, n=1, touches=[(0, 1, 2, (0.0, 3.0), (0.0, 1.0), (0.05, 0.0), 0.0)])
    ((normal, _),) = between(run)
    return normal


@pytest.mark.parametrize(("limits", "low", "positive"), [
    ((0.0, 1.0), 0.0, "counterclockwise"), ((0.0, 1.0), 0.0, "clockwise"),
    ((-0.2, 1.0), 3.0, "clockwise")])
def test_a_stop_that_is_reached_may_carry_what_the_contact_does_not(limits, low, positive):
    """0.15 N m press it down; a stop may hold it up."""
    sign = 1 if positive == "counterclockwise" else -1
    ends = tuple(sorted(sign * limit for limit in limits))
    found = lever({"type": "torque", "value": -0.15 * sign}, limits=ends, positive=positive)
    assert found == pytest.approx((low, 3.0), abs=1e-12)


@pytest.mark.parametrize(("hinge", "reaction", "low", "high"), [
    ({"friction": 0.1}, 3.0, 1.0, 5.0), ({"friction": 0.1, "static": 1.2}, 3.0, 0.6, 5.4),
    ({"friction_coefficient": 0.5, "pin_radius": 0.04}, 3.0, 1.8, 4.2)])
@pytest.mark.parametrize("holds", [1.0, 0.0])
def test_friction_that_holds_may_carry_what_the_contact_does_not(
    hinge, reaction, low, high, holds,
):
    """Up to its bound, under the reaction that was recorded; what slips is known."""
    found = lever({"type": "torque", "value": -0.15}, **hinge, arrays={
        "joint_sticks": holds, "joint_friction": 0.0, "joint_force": (0.0, -reaction)})
    assert found == pytest.approx((low, high) if holds else (3.0, 3.0), abs=1e-12)


@pytest.mark.parametrize("drive", [
    {"type": "motor", "value": 1.0, "torque": 0.3}, {"type": "brake", "value": 0.3}])
def test_motors_and_brakes_give_up_to_their_most_whatever_is_recorded(drive):
    assert lever(drive) == pytest.approx((0.0, 0.3 / 0.05), abs=1e-12)
