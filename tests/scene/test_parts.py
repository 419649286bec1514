"""A finger spelled out: frames, names, mirror, springs and tendon as mechanics places them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from sandbox.errors import SceneError
from sandbox.scene.bodies import Body
from sandbox.scene.document import Scene
from sandbox.scene.expand import expand
from sandbox.scene.geometry import anchors, pose_of, to_world
from sandbox.scene.parts.expansion import Elements
from sandbox.scene.parts.finger import Finger, expand_finger
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


# --- expansion


def scene_of(*parts, **more):
    return Scene.model_validate({"parts": list(parts), **more})


def fingers(count):
    return [SET_G | {"name": f"f{i + 1}", "at": [0, 0.13 * i]} for i in range(count)]


def tree_of(*pulls, **more):
    return {"type": "rocker_tree", "name": "tree", "pulls": list(pulls), **more}


def problems(*parts, **more):
    with pytest.raises(SceneError) as caught:
        expand(scene_of(*parts, **more))
    return {problem.path: problem for problem in caught.value.problems}


def test_only_the_cause_is_reported_of_dependent_parts():
    """The cause alone: neither the tree that pulls the broken finger nor the tree that pulls it."""
    broken = SET_G | {"name": "g", "on": "plam"}
    trees = tree_of("f1", "g"), tree_of("tree", "f2") | {"name": "two"}
    assert set(problems(*fingers(2), broken, *trees)) == {"$.parts[2].on"}
    within = {"type": "assembly", "name": "hand", "parts": [broken]}
    assert set(problems(*fingers(1), within, tree_of("f1", "hand.g"))) == {
        "$.parts[1].parts[0].on"}
    assert set(problems(*fingers(1), broken, tree_of("f1", "g.tendon", "gg"))) == {
        "$.parts[1].on", "$.parts[2].pulls[2]"}


def test_a_finger_cannot_be_pulled_twice():
    two = tree_of("f2.tendon", "f3") | {"name": "two"}
    found = problems(*fingers(3), tree_of("f1", "f2"), two)
    assert list(found) == ["$.parts[4].pulls[0]"]
    assert "already" in found["$.parts[4].pulls[0]"].message
