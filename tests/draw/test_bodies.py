"""Shapes of bodies without seams, outlines, colours, pressures, rods."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.picture.elements.bodies import styles
from sandbox.picture.elements.forces import line_loads
from sandbox.picture.geometry import united
from sandbox.picture.palette import ROLES
from sandbox.scene.bodies import Body
from sandbox.scene.mechanism import Mechanism
from sandbox.values.appearance import COLOURS

from .conftest import recording

BOX = {"type": "box", "size": [0.2, 0.05]}
LEG = {"type": "box", "size": [0.05, 0.2], "at": [0.125, 0.075]}  # touches BOX along one side
APART = {"type": "box", "size": [0.02, 0.02], "at": [0.5, 0]}
BIG, SMALL = ({"type": "circle", "radius": r} for r in (0.09, 0.04))


def shapes(*written):
    return Body.model_validate({"name": "body", "mass": 1, "shapes": list(written)}).shapes


@pytest.mark.parametrize(("written", "together"), [
    ([BOX, LEG], [0, 1]),
    ([BOX, APART], [0, 1]),
    ([SMALL, BIG], []),
    ([BOX, LEG, {"type": "circle", "radius": 0.02}], [0, 1]),
    ([BOX, {"type": "polygon", "points": [[0.1, -0.01], [0.3, 0], [0.1, 0.01]]}], [0, 1]),
])
def test_shapes_are_united_but_those_inside_others(written, together):
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
    assert [style.fill for style in found] == [(16, 32, 48), COLOURS["teal"], ROLES["object"].fill]


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
