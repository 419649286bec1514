"""Shapes of bodies without seams, outlines, colours, pressures, rods."""

from __future__ import annotations

import numpy as np
import pytest

import sandbox
from sandbox.errors import SceneError
from sandbox.picture.elements.bodies import styles
from sandbox.picture.elements.forces import line_loads, spread
from sandbox.picture.elements.joints import cylinder
from sandbox.picture.geometry import bare_outlines, united
from sandbox.picture.palette import ROLES
from sandbox.scene.bodies import Body
from sandbox.scene.mechanism import Mechanism
from sandbox.values.appearance import COLOURS, rgb

from .conftest import recording

BOX = {"type": "box", "size": [0.2, 0.05]}
LEG = {"type": "box", "size": [0.05, 0.2], "at": [0.125, 0.075]}  # touches BOX along one side
APART = {"type": "box", "size": [0.02, 0.02], "at": [0.5, 0]}
BIG, SMALL = ({"type": "circle", "radius": r} for r in (0.09, 0.04))


def shapes(*written):
    return Body.model_validate({"name": "body", "mass": 1, "shapes": list(written)}).shapes


@pytest.mark.parametrize(("written", "together"), [
    ([BOX, LEG], [0, 1]),
    ([BOX, APART], []),
    ([BIG, SMALL], []),
    ([SMALL, BIG], []),
    ([BIG, BIG], []),
    ([BOX, LEG, {"type": "circle", "radius": 0.02}], [0, 1]),
    ([BOX, {**BIG, "at": [0.1, 0]}], [0, 1]),
    ([{"type": "capsule", "end": [0.1, 0], "radius": 0.01}, {**SMALL, "at": [0.1, 0]}], [0, 1]),
    ([BOX, {"type": "polygon", "points": [[0.1, -0.01], [0.3, 0], [0.1, 0.01]]}], [0, 1]),
])
def test_what_touches_is_one_and_what_lies_inside_is_seen(written, together):
    assert united(shapes(*written), ()) == together


def still(bodies, **more):
    mechanism = Mechanism.model_validate({"bodies": bodies, **more})
    pose = np.zeros((1, len(bodies), 3))
    pose[0] = [[*b.at, b.angle] for b in mechanism.bodies]
    return mechanism, pose


def test_a_body_has_its_colour_else_that_of_its_material_else_that_of_its_role():
    mechanism, pose = still(
        [{"name": "own", "mass": 1, "shapes": [BOX], "colour": "#102030", "material": "rubber"},
         {"name": "of", "mass": 1, "shapes": [BOX], "material": "rubber"},
         {"name": "plain", "mass": 1, "shapes": [BOX], "role": "object"}],
        materials={"rubber": {"colour": "teal"}})
    found = styles(recording(mechanism, np.zeros(1), pose).model)
    assert [style.fill for style in found] == [
        (16, 32, 48), COLOURS["teal"], ROLES["object"].fill]


def test_colours_are_read_and_what_is_none_is_said():

    assert rgb("#fa3") == rgb("#ffaa33") == (255, 170, 51)
    with pytest.raises(SceneError) as caught:
        sandbox.load_scene({"bodies": [{"name": "b", "mass": 1, "shapes": [BOX],
                                        "colour": "oranje"}]})
    problem, = caught.value.problems
    assert problem.path == "$.bodies[0].colour"
    assert problem.hint == "'orange'"
    assert "#rrggbb" in problem.allowed


@pytest.mark.parametrize(("first", "second"), [
    (1.0, 1.0), (2.0, 1.0), (1.0, 2.0), (3.0, 1.0), (1.0, 9.0), (5.0, 0.1)])
def test_a_pressure_has_the_sum_and_the_moment_of_its_forces(first, second):
    """Integrated by Simpson's rule, exact for what is at most of the third degree."""
    length = 0.3
    start, end, q0, q1 = spread(first, second, length)
    assert 0 <= start < end <= 1
    assert min(q0, q1) >= 0
    a, b = start * length, end * length
    middle = (q0 + q1) / 2
    total = (b - a) / 6 * (q0 + 4 * middle + q1)
    moment = (b - a) / 6 * (q0 * a + 4 * middle * (a + b) / 2 + q1 * b)
    assert total == pytest.approx(first + second)
    assert moment == pytest.approx(second * length)


def box_on_floor(at, merged=2.0):
    """A box 0.2 m wide on a floor, its weight of 9.81 N so far right of its middle."""
    mechanism, pose = still([
        {"name": "floor", "motion": "fixed", "at": [0, -0.5],
         "shapes": [{"type": "box", "size": [3, 1]}]},
        {"name": "box", "mass": 1, "at": [0.4, 0.05], "shapes": [
            {"type": "box", "size": [0.2, 0.1]}]}])
    return recording(
        mechanism, np.zeros(1), pose, contact_sample=np.zeros(1, int),
        contact_body=np.ones(1, int), contact_other=np.zeros(1, int),
        contact_point=np.array([[0.4 + at, 0.0]]), contact_force=np.array([[2.0, 9.81]]),
        contact_normal=np.array([[0.0, 1.0]]), contact_gap=np.zeros(1),
        contact_merged=np.array([merged]))


@pytest.mark.parametrize(("at", "ends", "sizes"), [
    (0.0, (0.3, 0.5), (49.05, 49.05)),
    (0.05, (0.35, 0.5), (0.0, 2 * 9.81 / 0.15)),
    (-0.08, (0.3, 0.36), (2 * 9.81 / 0.06, 0.0)),
])
def test_a_box_presses_where_it_stands(at, ends, sizes):
    """Evenly below its middle; beyond the middle third a triangle to three times the distance
    from the edge. What is downwards of it is out of the box, on which the force is shown."""
    loads = line_loads(box_on_floor(at), [1])
    (one, two), (q0, q1), way = loads.ends[0], loads.load[0], loads.way[0]
    found = sorted([(one[0], q0), (two[0], q1)])
    assert [x for x, _ in found] == pytest.approx(ends)
    assert [q for _, q in found] == pytest.approx(sizes, abs=1e-9)
    assert (one[1], two[1], *way) == (0.0, 0.0, 0.0, -1.0)


BLOCK = {"type": "box", "size": [0.2, 0.1]}
ELL = {"type": "polygon", "points": [
    [-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [0, 0.05], [0, 0.15], [-0.1, 0.15]]}


def length(shapes):
    body = Body.model_validate({"name": "b", "mass": 1, "shapes": shapes})
    return sum(np.hypot(*np.diff(line, axis=0).T).sum()
               for line in bare_outlines(body.shapes, 1e-6, turns=False))


@pytest.mark.parametrize(("shapes", "around"), [
    ([BLOCK], 0.6), ([ELL], 0.8),
    # beside each other, with a seam
    ([BLOCK, {**BLOCK, "at": [0.2, 0]}], 1.0),
    # apart; one in the other
    ([BLOCK, {**BLOCK, "at": [0.5, 0]}], 1.2), ([BLOCK, {"type": "box", "size": [0.1, 0.05]}], 0.9),
    # two discs whose centres are a radius apart: of either two thirds are seen
    ([{"type": "circle", "radius": 0.1}, {"type": "circle", "radius": 0.1, "at": [0.1, 0]}],
     2 * 2 / 3 * 2 * np.pi * 0.1)])
def test_the_outline_is_as_long_as_the_outline_of_all(shapes, around):
    assert length(shapes) == pytest.approx(around, rel=2e-3)


@pytest.mark.parametrize(("low", "high"), [(100, 107), (100, 100), (100, 140), (100, 185)])
def test_a_rod_keeps_its_length(low: float, high: float) -> None:
    """As it is of steel: the piston goes as far as the actuator grows, within its cylinder."""
    made = cylinder(np.linspace(low, high, 7), low, high, 12)
    found = list(zip(*(each.tolist() for each in made), strict=True))
    rods = [length - piston for length, (_, piston) in
            zip(np.linspace(low, high, 7), found, strict=True)]
    assert rods == pytest.approx([rods[0]] * 7, rel=1e-12)
    tubes = {tube for tube, _ in found}
    assert len(tubes) == 1
    assert all(0 <= piston <= tube < low for tube, piston in found)
