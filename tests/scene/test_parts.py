"""A finger spelled out: frames, names, mirror, springs and tendon as mechanics places them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from sandbox.scene.elements.bodies import Body
from sandbox.scene.geometry import anchors, pose_of, to_body, to_world
from sandbox.scene.parts.expansion import Elements
from sandbox.scene.parts.finger import Finger, expand_finger, hinge_names, phalanx_names
from sandbox.scene.parts.section import Section, expand_section
from sandbox.scene.parts.trees import Known, PulleyTree, RockerTree, expand_tree

SET_G = {
    "type": "finger", "name": "f",
    "lengths": ["45 mm", "26 mm", "21 mm"], "radii": ["9 mm", "8 mm", "7.5 mm"],
    "masses": ["12 g", "6 g", "4 g"],
    "guides": [["-22 mm", "-14 mm"], ["24 mm", "-8 mm"], ["10 mm", "-3 mm"], ["4 mm", "-1 mm"]],
    "springs": {"stiffness": "300 N/m", "from": ["-8 mm", "8 mm"], "to": ["8 mm", "8 mm"]},
    "damping": [4e-3, 1.2e-3, 3e-4], "limits": ["85 deg", "95 deg", "75 deg"],
}


def finger(**changes):
    return Finger.model_validate(SET_G | changes)


def worlds(elements, *, palm=None):
    """World points of everything that has a place: hinges, guides, spring ends."""
    bodies = {body.name: body for body in (*elements.bodies, *([palm] if palm else []))}
    points = []
    for joint in elements.joints:
        for name, at in zip((joint.a, joint.b),
                            anchors(joint, bodies[joint.a], bodies[joint.b]), strict=True):
            points.append(to_world(pose_of(bodies[name]), at))
    for spring in elements.springs:
        points.append(to_world(pose_of(bodies[spring.a]), spring.on_a))
        points.append(to_world(pose_of(bodies[spring.b]), spring.on_b))
    for guide in elements.tendons[0].guides:
        points.append(to_world(pose_of(bodies[guide.body]), guide.at))
    return points


def test_names_beyond_three_phalanges_are_numbers():
    assert phalanx_names(4) == ("phalanx1", "phalanx2", "phalanx3", "phalanx4")
    assert hinge_names(4)[3] == "hinge4"


def test_mass_centre_and_inertia_of_a_phalanx():
    body = expand_finger(finger()).bodies[1]
    assert body.mass == 0.012
    assert body.centre == (0.0225, 0.0)
    assert body.inertia == pytest.approx(0.012 * (0.045**2 / 12 + 0.009**2 / 4))


def test_palm_above_is_the_mirror_image():
    start = ["20 deg", "30 deg", "10 deg"]
    below = expand_finger(finger(start=start))
    above = expand_finger(finger(start=start, palm="above"))
    mirrored = [(x, -y) for x, y in worlds(below)]
    assert worlds(above) == [pytest.approx(point) for point in mirrored]
    assert {j.positive for j in above.joints} == {"counterclockwise"}
    for one, two in zip(below.bodies[0].shapes, above.bodies[0].shapes, strict=True):
        assert two.at == pytest.approx((one.at[0], -one.at[1]))


@pytest.mark.parametrize("side", ["below", "above"])
def test_on_a_body_is_the_same_finger_in_that_bodys_frame(side):
    palm = Body(name="hand", at=(0.3, 0.1), angle=0.4, motion="fixed")
    start = [0.1, 0.2, 0.3]
    held = finger(on="hand", at=[0.02, 0.01], angle=0.5, start=start, palm=side)
    made = expand_finger(held, palm=palm)
    place = to_world((0.3, 0.1, 0.4), (0.02, 0.01))
    free = expand_finger(finger(at=list(place), angle=0.9, start=start, palm=side))
    assert worlds(made, palm=palm) == [pytest.approx(point) for point in worlds(free)]
    assert [b.name for b in made.bodies] == ["f.proximal", "f.middle", "f.distal"]
    # joint angle = sense * (angle of b - angle of a) - zero must be the start rotation
    sense = 1 if made.joints[0].positive == "counterclockwise" else -1
    turned = sense * (made.bodies[0].angle - palm.angle) - made.joints[0].zero
    assert turned == pytest.approx(0.1)
    assert ("f.*", "hand") in [rule.between for rule in made.contacts]


def test_limits_may_have_a_lowest_angle():
    made = expand_finger(finger(limits=["85 deg", ["-10 deg", "95 deg"], "75 deg"]))
    assert made.joints[0].limits == (0.0, pytest.approx(math.radians(85)))
    assert made.joints[1].limits == pytest.approx((math.radians(-10), math.radians(95)))


@pytest.mark.parametrize(("changes", "field", "words"), [
    ({"radii": [0.009]}, "radii", "expected 3 entries, got 1"),
    ({"guides": [[0, 0]] * 3}, "guides", "expected 4 entries, got 3"),
    ({"damping": [1, 2]}, "damping", "expected 1 or 3 entries, got 2"),
    ({"springs": {"stiffness": [1, 2], "from": [0, 0], "to": [0, 0]}}, "springs", "'stiffness'"),
    ({"masses": None}, None, "either 'masses' or 'density'"),
    ({"density": 1100}, None, "either 'masses' or 'density'"),
])
def test_wrong_counts_are_named_where_they_are(changes, field, words):
    with pytest.raises(ValidationError) as caught:
        finger(**changes)
    (error,) = caught.value.errors()
    assert error["loc"] == ((field,) if field else ())
    assert words in error["msg"]


# --- sections


PLAIN = {"type": "section", "name": "s", "at": [0.1, 0.2], "circle": "16 mm"}
SQUARE = {"square": "12 mm", "rod": ["10 mm", "36 mm"], "angle": "90 deg"}


def section(**changes):
    return expand_section(Section.model_validate(PLAIN | changes))


def test_the_square_is_held_equally_along_and_across_its_rod():
    made = section(**SQUARE, hold="5 N/m", damping=1)
    push, hold = made.springs
    assert (push.stiffness, push.rest_length) == (5, 0.036)
    assert hold.stiffness == pytest.approx(5 * 0.036**2)  # torque k r^2 phi = force k s at r
    pivot = next(j for j in made.joints if j.name == hold.joint)
    assert pivot.damping == pytest.approx(1 * 0.036**2)


def test_the_arm_weighs_and_turns_as_a_thin_rod_over_its_reach():
    """A fifth of the square's mass spread evenly over the reach: x^2 summed about its middle.

    Midpoints of n pieces miss the share 1 / n^2 of it.
    """
    for rod, reach in (("36 mm", 0.036), (["10 mm", "50 mm"], 0.05)):
        arm = next(b for b in section(**SQUARE | {"rod": rod}, mass="15 g").bodies
                   if b.name == "s.arm")
        pieces = (np.arange(1000) + 0.5) / 1000 * reach
        middle = pieces.mean()
        assert (arm.at, arm.angle) == ((0.1, 0.2), pytest.approx(math.pi / 2))
        assert arm.mass == pytest.approx(0.003, rel=1e-12)
        assert arm.centre == pytest.approx((middle, 0.0), rel=1e-12)
        assert arm.inertia == pytest.approx(
            0.003 * np.mean((pieces - middle) ** 2), rel=1.1e-6)


@pytest.mark.parametrize("changes", [
    {"square": "12 mm"}, {"rod": "30 mm"},
    {"square": "12 mm", "rod": ["30 mm", "20 mm"]}, {"circle": 0},
])
def test_wrong_sections(changes):
    with pytest.raises(ValidationError):
        section(**changes)


# --- differentials


def tree(kind, across, *, direction=math.pi, **options):
    """A tree of ``kind`` over point bodies that lie at ``across`` to the left of the pull."""
    c, s = round(math.cos(direction)), round(math.sin(direction))
    loads = tuple(
        Body(name=f"load{i + 1}", at=(-s * t, c * t), mass=1, inertia=1)
        for i, t in enumerate(across))
    spec = {"type": kind, "name": "t", "pulls": [b.name for b in loads], "direction": direction}
    model = PulleyTree if kind == "pulley_tree" else RockerTree
    return expand_tree(model.model_validate(spec | options), Known(Elements(bodies=loads), {}))


def tensions(made, pull=1.0):
    """Tension of every string by balance of moments about each pivot, from the elements alone."""
    found = {"t.tendon": pull}
    bodies = {b.name: b for b in made.bodies}
    below = {}
    for tendon in made.tendons:
        below.setdefault(tendon.guides[-1].body, []).append(tendon)
    rows = [t.guides[0].body for t in made.tendons if t.name == "t.tendon"]
    while rows:
        name = rows.pop()
        above = next(t.name for t in made.tendons if t.guides[0].body == name)
        arms = []
        for string in below[name]:
            end = string.guides[-1]
            x, y = to_world(pose_of(bodies[name]), end.at)
            dx, dy = x - bodies[name].at[0], y - bodies[name].at[1]
            arms.append(end.radius or math.hypot(dx, dy))
            if string.guides[0].body in below:
                rows.append(string.guides[0].body)
        (one, two), (a, b) = below[name], arms
        found[one.name] = found[above] * b / (a + b)
        found[two.name] = found[above] * a / (a + b)
    return found


@pytest.mark.parametrize("kind", ["rocker_tree", "pulley_tree"])
@pytest.mark.parametrize("count", [3, 8])
def test_every_leaf_gets_an_equal_part(kind, count):
    made = tree(kind, [0.03 * i for i in range(count)])
    found = tensions(made)
    for i in range(count):
        assert found[f"t.string{i + 1}"] == pytest.approx(1 / count)


@given(st.lists(st.tuples(st.floats(0.01, 0.2), st.floats(0.1, 5)), min_size=2, max_size=12))
def test_shares_are_kept_at_any_distances(leaves):
    across = [sum(gap for gap, _ in leaves[:i]) for i in range(len(leaves))]
    shares = [share for _, share in leaves]
    found = tensions(tree("rocker_tree", across, shares=shares))
    for i, share in enumerate(shares):
        assert found[f"t.string{i + 1}"] == pytest.approx(share / sum(shares))


@pytest.mark.parametrize("kind", ["rocker_tree", "pulley_tree"])
@pytest.mark.parametrize("direction", [0.0, -math.pi / 2])
def test_strings_are_parallel_to_the_pull(kind, direction):
    made = tree(kind, [0, 0.03, 0.07, 0.1, 0.16], direction=direction)
    bodies = {b.name: b for b in made.bodies}
    along = (math.cos(direction), math.sin(direction))
    for tendon in made.tendons:
        (x0, y0), (x1, y1) = (
            to_world(pose_of(bodies[g.body]), g.at) for g in (tendon.guides[0], tendon.guides[-1]))
        end = tendon.guides[-1]
        if end.radius:  # the string leaves the rim on the side opposite to the centre
            off = end.radius if end.side == "right" else -end.radius
            x1, y1 = x1 - off * along[1], y1 + off * along[0]
        assert (x1 - x0) * along[1] - (y1 - y0) * along[0] == pytest.approx(0, abs=1e-12)
        assert (x1 - x0) * along[0] + (y1 - y0) * along[1] > 0


def test_ropes_instead_of_tendons():
    made = tree("rocker_tree", [0, 0.03, 0.06, 0.09], links="rope", gap="50 mm", level="30 mm")
    ropes = {j.name: j for j in made.joints if j.type == "rope"}
    assert sorted(ropes) == ["t.link1", "t.link2", *(f"t.string{i}" for i in range(1, 5))]
    assert ropes["t.string1"].longest == pytest.approx(0.05)
    assert ropes["t.link1"].longest == pytest.approx(0.03)
    assert [t.name for t in made.tendons] == ["t.tendon"]


def lines(made):
    """Where the strings of the leaves run at last, across the pull along -x: y of the end."""
    bodies = {b.name: b for b in made.bodies}
    found = []
    for tendon in sorted((t for t in made.tendons if "string" in t.name), key=lambda t: t.name):
        end = tendon.guides[-1]
        y = to_world(pose_of(bodies[end.body]), end.at)[1]
        # a wheel's rim; the pull is along -x, so left of it is down
        found.append(y + (end.radius if end.side == "left" else -end.radius))
    return found


@pytest.mark.parametrize("kind", ["rocker_tree", "pulley_tree"])
def test_leaves_in_one_line_are_spread_by_the_travel(kind):
    """One after the other: arms of half the travel do not turn over before the slots end."""
    made = tree(kind, [0.03, 0.03, 0.03], travel="50 mm")
    assert sorted(lines(made)) == pytest.approx([-0.08, -0.03, 0.02])
    assert [tensions(made)[f"t.string{i}"] for i in (1, 2, 3)] == pytest.approx([1 / 3] * 3)


@pytest.mark.parametrize("kind", ["rocker_tree", "pulley_tree"])
def test_a_pitch_makes_wheels_as_small_as_wanted(kind):
    """A string goes straight from its leaf to an eye, across to the next, and straight on."""
    across, pitch, gap = [0.0, 0.06, 0.12, 0.18], 0.01, 0.03
    made = tree(kind, across, pitch=pitch, gap=gap)
    assert lines(made) == pytest.approx([-0.075, -0.085, -0.095, -0.105])
    frame = next(b for b in made.bodies if b.name == "t.frame")
    for leaf, string in enumerate(made.tendons[:4]):
        eyes = [to_world(pose_of(frame), g.at) for g in string.guides if g.body == "t.frame"]
        assert [x for x, _ in eyes] == pytest.approx([-gap, -gap])
        assert [y for _, y in eyes] == pytest.approx([-across[leaf], lines(made)[leaf]])
    wheels = [b for b in made.bodies if b.name.startswith("t.") and b is not frame]
    assert [to_body(pose_of(frame), b.at)[0] for b in wheels] == pytest.approx(
        [-0.04 - 1.5 * pitch] * 2 + [0] if kind == "pulley_tree" else [-0.04] * 2 + [0])
    assert wheels[0].at[0] == pytest.approx(-2 * gap - (pitch / 2 if kind == "pulley_tree" else 0))
