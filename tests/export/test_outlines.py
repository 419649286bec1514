"""Outlines for MuJoCo: a prism for each convex piece, a capsule for each segment."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pytest

from sandbox.errors import SceneError
from sandbox.export import export_mechanism
from sandbox.scene.expand import expand
from sandbox.scene.geometry import count_solids, mass_properties
from sandbox.scene.read.load import load_scene

FRAME = {"type": "polygon", "points": [[-1, -1], [1, -1], [1, 1], [-1, 1]],
         "holes": [[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]]}


def mechanism(shape, **keys):
    return expand(load_scene({
        "run": {"duration": "0.1 s", "step": "1 ms"}, "gravity": [0, -9.81],
        "bodies": [{"name": "b", "density": 1000, "shapes": [shape], **keys},
                   {"name": "ground", "motion": "fixed", "at": [0, -5], "shapes": [
                       {"type": "polyline", "points": [[-2, 0], [0, 0], [2, 1]],
                        "radius": 0.01}]}]}))


def test_pieces_become_prisms_with_the_mass_of_the_outline():
    machine = mechanism(FRAME)
    text = export_mechanism(machine).text
    model = mujoco.MjModel.from_xml_string(text)
    meshes = ET.fromstring(text).findall("asset/mesh")
    assert len(meshes) == count_solids(machine.bodies[0]) > 1
    weight = mass_properties(machine.bodies[0])
    body = model.body("b")
    assert body.mass[0] == pytest.approx(weight.mass)
    assert body.inertia[2] == pytest.approx(weight.inertia)
    assert body.ipos[:2] == pytest.approx(weight.centre)
    assert sum(model.geom_type == mujoco.mjtGeom.mjGEOM_CAPSULE) == 2
    prisms = np.array([model.mesh_vert[:, 2].max(), -model.mesh_vert[:, 2].min()])
    assert (prisms > 0).all()


def test_a_polyline_without_a_radius_has_no_counterpart():
    machine = expand(load_scene({"bodies": [{"name": "ground", "motion": "fixed", "shapes": [
        {"type": "polyline", "points": [[0, 0], [1, 0]]}]}]}))
    with pytest.raises(SceneError, match="ground: MuJoCo has no counterpart of a polyline without"):
        export_mechanism(machine)
