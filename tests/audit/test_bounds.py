"""What contact forces could be, against closed forms; what is outside asks for a look."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.audit.bounds import contact_bounds, push_limits
from sandbox.audit.evidence import Evidence
from sandbox.audit.outlines import touched
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from tests.audit.still import H, block, figures, machine, still
from tests.engine.machines import mechanism

G = 9.81
WEIGHT = 0.2 * G


def between(run, sample=-1):
    """Low and high of the normal and the tangential force of every contact row."""
    return [((one.normal.low, one.normal.high), (one.tangential.low, one.tangential.high))
            for one in contact_bounds(Evidence(run), sample)]


# -- a finger of two thin phalanges on a disc: two balances for four components


L1, R, PULL, ARMS = 0.05, 0.018, 10.0, (0.012, 0.006)


def grasp(theta, mu, near=None):
    """Its contacts' distances from the hinges, and the recording of some grasp or other.

    The hinges are at 0 and (L1, 0), the finger bends clockwise round the disc below it. With
    ``near`` the near phalanx lies so far off the disc [m], the far one carries all, and rubs for
    it; the largest force of the near one is then the last result.
    """
    theta = np.radians(theta)
    c, s = np.cos(theta), np.sin(theta)
    k2 = R * np.tan(theta / 2)
    k1, f2 = L1 - k2, PULL * ARMS[1] / k2
    along, out = np.array([c, -s]), np.array([s, c])

    def shape(off):
        return [{"type": "box", "size": (0.05, 0.01), "at": (0.025, 0.005 + off)}]
    machine_ = machine(
        {**block("one"), "shapes": shape(near or 0.0), "material": "m"},
        {**block("two", (L1, 0.0)), "angle": -theta, "shapes": shape(0.0), "material": "m"},
        {"name": "disc", "motion": "fixed", "at": (k1, -R), "material": "m",
         "shapes": [{"type": "circle", "radius": R}]},
        materials={"m": {"friction": mu}},
        groups=[{"name": "finger", "kind": "finger", "bodies": ["one", "two"]}],
        joints=[{"type": "pin", "name": "near", "a": "wall", "b": "one", "on_b": (0, 0)},
                {"type": "pin", "name": "far", "a": "one", "b": "two", "on_b": (0, 0)}],
        drives=[{"type": "torque", "name": f"t{i}", "joint": joint, "value": -PULL * arm}
                for i, (joint, arm) in enumerate(zip(("near", "far"), ARMS, strict=True))])
    first = (0, 1, 3, (0.0, 1.0), (0.0, 1.0), (k1, 0.0), 0.0)
    force, n = out, 1
    if near is not None:
        force, n = f2 * out - ((k2 + L1 * c) * f2 - PULL * ARMS[0]) / (L1 * s) * along, 200
    touches = [first] * (near is None) + [
        (n - 1, 2, 3, tuple(force), tuple(out), tuple((L1, 0.0) + k2 * along), 0.0)]
    run = still(machine_, lambda a: a["drive_value"].__setitem__(
        slice(None), [-PULL * arm for arm in ARMS]), n=n, touches=touches)
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


def groove(gap=None, **more):
    """A disc of 20 mm between two walls at 45 degrees, a smooth floor ``gap`` below it."""
    bodies = [{"name": "disc", "mass": 0.2, "at": (0.0, 0.03 * np.sqrt(2)), "material": "m",
               "shapes": [{"type": "circle", "radius": 0.02}]},
              *({"name": name, "motion": "fixed", "material": "m", "shapes": [
                  {"type": "capsule", "end": (sign * 0.1, 0.1), "radius": 0.01}]}
                for name, sign in (("left", -1), ("right", 1)))]
    if gap is not None:
        bodies.append({"name": "floor", "motion": "fixed", "material": "m", "shapes": [
            {"type": "box", "size": (0.02, 0.002), "at": (0.0, 0.03 * np.sqrt(2) - 0.021 - gap)}]})
        more.setdefault("contacts", [{"between": ("disc", "floor"), "friction": 0.0}])
    return {"bodies": bodies, "materials": {"m": {"friction": 0.5}}, "gravity": (0.0, -G)} | more


def test_a_disc_in_a_rough_groove_rubs_up_or_down_on_both_sides():
    """n = W / (2 (cos a + mu sin a)) to W / (2 (cos a - mu sin a)), a from the vertical: 45 deg.

    And the engine's choice is between them, while it settles, too.
    """
    mu, half, run = 0.5, np.sqrt(0.5), simulate(mechanism(duration=0.2, **groove()))
    low, high = WEIGHT * half / (1 + mu), WEIGHT * half / (1 - mu)
    for sample in (20, -1):
        sides = contact_bounds(Evidence(run), sample)
        for one, sign in zip(sides, (1, -1), strict=True):
            assert (one.normal.low, one.normal.high) == pytest.approx((low, high), rel=1e-6)
            rubs = sorted((sign * mu * low, -sign * mu * high))
            assert (one.tangential.low, one.tangential.high) == pytest.approx(rubs, rel=1e-6)
            assert not one.normal.outside
            assert not one.tangential.outside


BAR = {"type": "box", "size": (0.1, 0.02)}
CAPSULE = {"type": "capsule", "start": (-0.05, 0.0), "end": (0.05, 0.0), "radius": 0.01}


@pytest.mark.parametrize("shape", [BAR, CAPSULE])
def test_a_bar_that_lies_on_half_its_length_and_hangs_at_its_end(shape):
    """The floor at d left of the middle, 0 to a, the tendon at a: N = W / (1 + d / a)."""
    floor = {"name": "floor", "motion": "fixed", "shapes": [
        {"type": "box", "size": (0.2, 0.02), "at": (-0.1, -0.01)}]}
    run = still(
        machine({**block("bar", (0.0, 0.01)), "shapes": [shape]}, floor, gravity=(0.0, -G),
                contacts=[{"between": ("bar", "floor"), "friction": 0.0}],
                tendons=[{"name": "tendon", "guides": [{"body": "bar", "at": (0.05, 0.0)},
                                                       {"body": "wall", "at": (0.05, 0.3)}]}]),
        lambda a: a["tendon_tension"].__setitem__(slice(None), WEIGHT * 0.6 / 1.6), n=1,
        touches=[(0, 1, 2, (0.0, WEIGHT / 1.6), (0.0, 1.0), (-0.03, 0.0), 0.0)])
    ((normal, rubs),) = between(run)
    assert normal == pytest.approx((WEIGHT / 2, WEIGHT))
    assert rubs == (0.0, 0.0)
    assert figures(run)["contact.bounds"].verdict == "pass"


@pytest.mark.parametrize(("drive", "hinge", "arrays", "low", "high"), [
    ({"type": "torque", "value": -0.15}, {"limits": (0.0, 1.0)}, {}, 0.0, 3.0),
    ({"type": "torque", "value": 0.15}, {"limits": (-1.0, 0.0), "positive": "clockwise"}, {},
     0.0, 3.0),
    ({"type": "torque", "value": 0.15}, {"limits": (-1.0, 0.2), "positive": "clockwise"}, {},
     3.0, 3.0),
    *(({"type": "torque", "value": -0.15}, hinge,
       {"joint_sticks": sticks, "joint_friction": 0.0, "joint_force": (0.0, -3.0)},
       *((low, high) if sticks else (3.0, 3.0)))
      for hinge, low, high in (
          ({"friction": 0.1}, 1.0, 5.0), ({"friction": 0.1, "static": 1.2}, 0.6, 5.4),
          ({"friction_coefficient": 0.5, "pin_radius": 0.04}, 1.8, 4.2)) for sticks in (1.0, 0.0)),
    ({"type": "motor", "value": 1.0, "torque": 0.3}, {}, {}, 0.0, 6.0),
    ({"type": "brake", "value": 0.3}, {}, {}, 0.0, 6.0)])
def test_stops_friction_motors_and_brakes_may_carry_what_a_contact_does_not(
    drive, hinge, arrays, low, high,
):
    """A lever on a smooth disc, 50 mm from its hinge; a torque of 0.15 N m presses it down.

    Stops that are reached, friction that sticks under the recorded reaction, motors and brakes act
    up to their limits, whatever their recorded torque; friction that slips is known.
    """
    def change(a):
        a["drive_value"][:] = drive["value"]
        a["drive_torque"][:] = -0.15
        for key, value in arrays.items():
            a[key][:] = value
    run = still(machine(
        {**block("lever"), "shapes": [{"type": "box", "size": (0.1, 0.01), "at": (0.05, 0.005)}]},
        {"name": "disc", "motion": "fixed", "at": (0.05, -0.02),
         "shapes": [{"type": "circle", "radius": 0.02}]},
        contacts=[{"between": ("lever", "disc"), "friction": 0.0}],
        joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "lever", "on_b": (0, 0), **hinge}],
        drives=[{"name": "d", "joint": "pin", **drive}]),
        change, n=1, touches=[(0, 1, 2, (0.0, 3.0), (0.0, 1.0), (0.05, 0.0), 0.0)])
    ((normal, _),) = between(run)
    assert normal == pytest.approx((low, high), abs=1e-12)


# -- pushes


MASS = 0.2
RIGHT, UP, LEFT, DOWN = np.radians([0, 90, 180, 270])


def standing(mu, width, height, *more):
    """A box at rest on a floor."""
    return simulate(mechanism(
        duration=0.02, gravity=(0.0, -G),
        bodies=[
            {"name": "floor", "motion": "fixed", "material": "m",
             "shapes": [{"type": "box", "size": (1.0, 0.1), "at": (0.0, -0.05)}]},
            {"name": "box", "mass": MASS, "material": "m", "at": (0.0, height / 2),
             "shapes": [{"type": "box", "size": (width, height)}]}, *more],
        materials={"m": {"friction": mu}}))


def limits(run, *directions, body="box"):
    number = [each.name for each in run.mechanism.bodies].index(body)
    return push_limits(Evidence(run), number, directions)


@pytest.mark.parametrize(("mu", "width", "height"), [(0.3, 0.06, 0.04), (0.9, 0.04, 0.06)])
def test_a_box_slides_or_tips(mu, width, height):
    """By mu W or W b / h, whichever is less: the sides are flat, so that an edge may carry all."""
    least = min(mu * WEIGHT, WEIGHT * width / height)
    found = limits(standing(mu, width, height), RIGHT, LEFT, UP, DOWN)
    np.testing.assert_allclose(found[:3], [least, least, WEIGHT], rtol=1e-6)
    assert np.isinf(found[3])


def test_what_nothing_touches_and_what_nothing_balances():
    ball = {"name": "ball", "mass": 0.1, "at": (0.3, 1.0),
            "shapes": [{"type": "circle", "radius": 0.01}]}
    run = standing(0.3, 0.06, 0.04, ball)
    assert limits(run, RIGHT, UP, body="ball").tolist() == [0.0, 0.0]
    arrays = {key: np.array(value) for key, value in run.arrays.items()}
    arrays["body_acceleration"][-1, 1, 1] = -2 * G  # faster than it falls: a floor cannot pull
    assert np.isnan(limits(Recording(run.mechanism, arrays, run.info), RIGHT)).all()


def test_what_is_pressed_by_a_hand_that_gives_way():
    """A block between a wall and a jaw pushed with P: towards the jaw P, into the wall no bound.

    Across, friction of both sides: 2 mu P. It weighs nothing here.
    """
    mu, P = 0.4, 3.0
    run = simulate(mechanism(
        duration=0.05, materials={"m": {"friction": mu}}, bodies=[
            {"name": "wall", "motion": "fixed", "material": "m", "role": "palm",
             "shapes": [{"type": "box", "size": (0.02, 0.2), "at": (-0.01, 0.0)}]},
            {"name": "block", "mass": MASS, "at": (0.02, 0.0), "role": "object", "material": "m",
             "shapes": [{"type": "box", "size": (0.04, 0.04)}]},
            {"name": "jaw", "mass": 0.05, "at": (0.05, 0.0), "role": "phalanx", "material": "m",
             "shapes": [{"type": "box", "size": (0.02, 0.04)}]}],
        joints=[{"type": "slot", "name": "guide", "a": "wall", "b": "jaw", "on_b": (0, 0),
                 "start": (0.0, 0.0), "end": (0.2, 0.0), "turns": False}],
        drives=[{"type": "force", "name": "press", "body": "jaw", "direction": (-1, 0),
                 "value": P}]))
    found = limits(run, RIGHT, LEFT, UP, DOWN, body="block")
    np.testing.assert_allclose(found[[0, 2, 3]], [P, 2 * mu * P, 2 * mu * P], rtol=1e-6)
    assert np.isinf(found[1])


# -- what touches and carries nothing


OPEN = 10 * H**2 + 1e-9
"""What a step may leave open."""


def found(run, near=None):
    """Of every pair by its names the recorded normal force, its low and its high."""
    names = [body.name for body in run.mechanism.bodies]
    return {(names[one.body], names[one.other]): (
        one.normal.force, one.normal.low, one.normal.high)
        for one in contact_bounds(Evidence(run), near=near)}


def test_a_floor_that_carries_nothing_may_carry_all_of_the_weight():
    """n = (W - f) / (2 (cos 45 +- mu sin 45)) with any f of the floor from 0 to W."""
    run = simulate(mechanism(duration=0.05, **groove(1e-8)))
    names = [run.mechanism.bodies[b].name for b in run.arrays["contact_other"]]
    assert set(names) == {"left", "right"}
    seen, high = found(run), WEIGHT / (2 * np.sqrt(0.5) * 0.5)
    assert seen["disc", "floor"] == pytest.approx((0.0, 0.0, WEIGHT), rel=1e-6, abs=1e-9)
    for side in ("left", "right"):
        assert seen["disc", side][1:] == pytest.approx((0.0, high), rel=1e-6, abs=1e-9)
    assert figures(run)["contact.bounds"].verdict == "pass"


@pytest.mark.parametrize(("share", "counts"), [(0.999, True), (1.001, False)])
def test_what_is_further_than_a_step_may_leave_it_does_not_count(share, counts):
    """100 times that is a millimetre."""
    content, s = groove(share * OPEN), np.sqrt(0.5)
    machine_ = machine(*content.pop("bodies"), **content)
    n = WEIGHT / (2 * s * 1.2)  # with a fifth of it as friction, upward
    run = still(machine_, n=1, touches=[
        (0, 1, other, (-sign * 0.8 * n * s, 1.2 * n * s), (-sign * s, s),
         (sign * 0.02 * s, 0.04 * s), 0.0) for other, sign in ((2, -1), (3, 1))])
    seen = found(run)
    assert (("disc", "floor") in seen) is counts
    low, high = WEIGHT / (2 * s * 1.5), WEIGHT / (2 * s * 0.5)
    assert seen["disc", "left"] == pytest.approx((n, 0.0 if counts else low, high), abs=1e-9)
    # whoever measures can say what touching is
    assert ("disc", "floor") in found(run, near=1.1 * share * OPEN)
    assert ("disc", "floor") not in found(run, near=0.9 * share * OPEN)


@pytest.mark.parametrize("more", [
    {"contacts": [{"between": ("disc", "floor"), "collide": False}]},
    {"joints": [{"type": "slot", "name": "rail", "a": "floor", "b": "disc",
                 "start": (0.0, -1.0), "end": (0.0, 1.0), "on_b": (0.0, 0.0)}]},
])
def test_what_may_not_collide_does_not_touch(more):
    assert ("disc", "floor") not in found(simulate(mechanism(duration=0.01, **groove(0.0, **more))))


@pytest.mark.parametrize(("speed", "counts"), [(0.009, True), (0.011, False)])
def test_what_parts_or_comes_by_does_not_touch(speed, counts):
    """By 1e-5 m in a step, that is at 1 cm/s."""
    content = groove(0.0)
    run = still(machine(*content.pop("bodies"), **content), lambda a: a[
        "body_velocity"].__setitem__((slice(None), 1, 1), speed), n=1)
    assert (("disc", "floor") in found(run)) is counts


def test_a_near_phalanx_that_touches_without_force_may_press():
    """f2 = T h2 / k2; f1 = (T h1 - (k2 + l1 c) f2 + l1 s t2) / k1, t2 up to mu f2; here f1 = 0."""
    k1, k2, theta, run = grasp(75, 0.2, near=4.6e-9)
    f2 = PULL * ARMS[1] / k2
    most = (PULL * ARMS[0] - (k2 + L1 * (np.cos(theta) - 0.2 * np.sin(theta))) * f2) / k1
    seen = found(run)
    assert seen["two", "disc"] == pytest.approx((f2, f2, f2), rel=1e-9)
    assert most == pytest.approx(1.264063, abs=1e-6)
    assert seen["one", "disc"] == pytest.approx((0.0, 0.0, most), rel=1e-6, abs=1e-9)
    figure = figures(run)["contact.shared"]
    assert (figure.verdict, figure.value) == ("look", 1.0)
    assert "1 of 2 on finger" in figure.why
    assert figures(run)["contact.bounds"].verdict == "pass"


def test_a_seam_between_pieces_is_no_surface():
    """A disc on the notched side of a U: its bottom is two pieces; below the seam nothing lies."""
    outline = [(-0.04, 0.0), (0.04, 0.0), (0.04, 0.06), (0.03, 0.06), (0.03, 0.02), (-0.03, 0.02),
               (-0.03, 0.06), (-0.04, 0.06)]
    cup = {"name": "cup", "motion": "fixed", "shapes": [{"type": "polygon", "points": outline}]}
    disc = {**block("disc", (0.0, 0.03)), "shapes": [{"type": "circle", "radius": 0.01}]}
    a = touched(Evidence(still(machine(disc, cup), n=1)).last).run.arrays
    assert a["contact_normal"] == pytest.approx(np.array([(0.0, 1.0)]))
    assert a["contact_point"] == pytest.approx(np.array([(0.0, 0.02)]))


@pytest.mark.parametrize(("x", "bound"), [(0.03, np.inf), (0.03 + 2 * OPEN, 0.5 * WEIGHT)])
def test_a_wall_that_is_just_touched_holds_against_a_push(x, bound):
    floor = {"name": "floor", "motion": "fixed", "material": "m", "shapes": [
        {"type": "box", "size": (0.2, 0.02), "at": (0.0, -0.01)}]}
    wall = {"name": "stop", "motion": "fixed", "material": "m", "at": (x, 0.02), "shapes": [
        {"type": "box", "size": (0.02, 0.04)}]}
    box = {**block("box", (0.0, 0.02)), "material": "m", "shapes": [
        {"type": "box", "size": (0.04, 0.04)}]}
    run = still(machine(box, floor, wall, materials={"m": {"friction": 0.5}}, gravity=(0.0, -G)),
                n=1, touches=[(0, 1, 2, (0.0, WEIGHT), (0.0, 1.0), (0.0, 0.0), 0.0)])
    right, left = push_limits(Evidence(run), 1, (0.0, np.pi))
    assert left == pytest.approx(0.5 * WEIGHT)
    assert right == pytest.approx(bound)
