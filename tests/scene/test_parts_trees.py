"""Differentials spelled out: shares, parallel strings, levels, any number of leaves."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from sandbox.scene.elements.bodies import Body
from sandbox.scene.elements.tendons import Guide, Tendon
from sandbox.scene.geometry import pose_of, to_body, to_world
from sandbox.scene.parts.expansion import Elements
from sandbox.scene.parts.trees import Known, PulleyTree, RockerTree, expand_tree


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


def test_wheels_do_not_overlap():
    made = tree("pulley_tree", [0.03 * i for i in range(8)])
    wheels = [b for b in made.bodies if b.role == "pulley"]
    assert len(wheels) == 7
    for i, one in enumerate(wheels):
        for two in wheels[:i]:
            reach = one.shapes[0].radius + two.shapes[0].radius
            assert math.dist(one.at, two.at) > reach - 1e-12


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


def test_a_string_that_passes_eyes_is_a_tendon_among_ropes():
    made = tree("rocker_tree", [0, 0.03, 0.06], links="rope", pitch=0.01)
    assert sorted(t.name for t in made.tendons) == ["t.string1", "t.string3", "t.tendon"]
    assert "t.link1" in {j.name for j in made.joints if j.type == "rope"}


def test_the_tendon_of_a_finger_is_led_over_the_eyes():
    rope = Tendon(name="cord", guides=(Guide(body="load1"), Guide(body="load1", at=(0.0, 0.01))))
    loads = tuple(Body(name=f"load{i}", at=(0, 0), mass=1, inertia=1) for i in (1, 2))
    spec = RockerTree.model_validate(
        {"type": "rocker_tree", "name": "t", "pulls": ["cord", "load2"], "pitch": 0.02})
    made = expand_tree(spec, Known(Elements(bodies=loads, tendons=(rope,)), {}))
    assert [g.body for g in made.tendons[0].guides] == [
        "load1", "load1", "t.frame", "t.frame", "t.rocker1"]


@pytest.mark.parametrize("pitch", [0, "0.1 um"])
def test_a_pitch_is_a_size(pitch):
    with pytest.raises(ValidationError, match="greater than"):
        tree("rocker_tree", [0, 0.03], pitch=pitch)
