"""What touches and carries nothing: it is found by its shapes, and may carry what balance leaves.

:data:`H` is 1 ms, so a step may leave 1e-5 m open, and a nanometre.
"""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.audit.bounds import contact_bounds, push_limits
from sandbox.audit.evidence import Evidence
from sandbox.audit.outlines import touched
from sandbox.engine.simulate import simulate
from tests.audit.still import H, block, figures, machine, still
from tests.engine.machines import mechanism

G = 9.81
WEIGHT = 0.2 * G
OPEN = 10 * H**2 + 1e-9


def found(run, near=None):
    """Of every pair by its names the recorded normal force, its low and its high."""
    names = [body.name for body in run.mechanism.bodies]
    return {(names[one.body], names[one.other]): (
        one.normal.force, one.normal.low, one.normal.high)
        for one in contact_bounds(Evidence(run), near=near)}


# -- a disc in a rough groove, and a smooth floor that it just does not need


def groove(gap, **more):
    """A disc of 20 mm between two walls at 45 degrees, a floor ``gap`` below it."""
    bottom = 0.03 * np.sqrt(2) - 0.02 - gap
    walls = [{"name": name, "motion": "fixed", "material": "m", "shapes": [
        {"type": "capsule", "end": (sign * 0.1, 0.1), "radius": 0.01}]}
        for name, sign in (("left", -1), ("right", 1))]
    floor = {"name": "floor", "motion": "fixed", "material": "m", "shapes": [
        {"type": "box", "size": (0.02, 0.002), "at": (0.0, bottom - 0.001)}]}
    disc = {"name": "disc", "mass": 0.2, "at": (0.0, 0.03 * np.sqrt(2)), "material": "m",
            "shapes": [{"type": "circle", "radius": 0.02}]}
    rules = [{"between": ("disc", "floor"), "friction": 0.0}]
    return {"bodies": [disc, *walls, floor], "materials": {"m": {"friction": 0.5}},
            "gravity": (0.0, -G), "contacts": rules} | more


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


# -- a finger of two thin phalanges of which one touches


L1, R, PULL, ARMS, MU, THETA = 0.05, 0.018, 10.0, (0.012, 0.006), 0.2, np.radians(75)


def finger(gap):
    """The near phalanx lies ``gap`` off the disc, the far one carries all; both rub as they must.

    The hinges are at 0 and (L1, 0), the finger bends clockwise round the disc below it.
    """
    c, s = np.cos(THETA), np.sin(THETA)
    k2 = R * np.tan(THETA / 2)
    k1, f2 = L1 - k2, PULL * ARMS[1] / k2
    t2 = ((k2 + L1 * c) * f2 - PULL * ARMS[0]) / (L1 * s)
    bodies = [
        {**block(name, at), "angle": angle, "material": "m", "shapes": [
            {"type": "box", "size": (0.05, 0.01), "at": (0.025, 0.005 + off)}]}
        for name, at, angle, off in (("one", (0.0, 0.0), 0.0, gap), ("two", (L1, 0.0), -THETA, 0))]
    machine_ = machine(
        *bodies, {"name": "disc", "motion": "fixed", "at": (k1, -R), "material": "m",
                  "shapes": [{"type": "circle", "radius": R}]},
        materials={"m": {"friction": MU}},
        groups=[{"name": "finger", "kind": "finger", "bodies": ["one", "two"]}],
        joints=[{"type": "pin", "name": "near", "a": "wall", "b": "one", "on_b": (0, 0)},
                {"type": "pin", "name": "far", "a": "one", "b": "two", "on_b": (0, 0)}],
        drives=[{"type": "torque", "name": f"t{i}", "joint": joint, "value": -PULL * arm}
                for i, (joint, arm) in enumerate(zip(("near", "far"), ARMS, strict=True))])
    out, along = np.array([s, c]), np.array([c, -s])
    run = still(machine_, lambda a: a["drive_value"].__setitem__(
        slice(None), [-PULL * arm for arm in ARMS]), n=200, touches=[
            (199, 2, 3, tuple(f2 * out - t2 * along), tuple(out), tuple((L1, 0.0) + k2 * along),
             0.0)])
    return run, f2, (PULL * ARMS[0] - (k2 + L1 * c - L1 * s * MU) * f2) / k1


def test_a_near_phalanx_that_touches_without_force_may_press():
    """f2 = T h2 / k2; f1 = (T h1 - (k2 + l1 c) f2 + l1 s t2) / k1, t2 up to mu f2; here f1 = 0."""
    run, f2, most = finger(4.6e-9)
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
