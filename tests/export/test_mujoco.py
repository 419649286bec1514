"""Outlines for MuJoCo: a prism for each convex piece, a capsule for each segment."""

from __future__ import annotations

import math
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


# --- servos and actuators at rest


def at_rest(scene: str, without: str, duration: float) -> dict[str, float]:
    """Readings of all sensors of one number after ``duration`` [s]."""
    text = export_mechanism(expand(load_scene(scene)), without=[without]).text
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    while data.time < duration:
        mujoco.mj_step(model, data)
    return {model.sensor(i).name: float(data.sensordata[model.sensor(i).adr[0]])
            for i in range(model.nsensor)}


def test_a_servo_with_a_stiffness_sags_as_much() -> None:
    """k (60 deg - q) = m g l cos q; e^(-t k / c) of the way is left after 3 s."""
    found = at_rest("servo_arm", "stiff", 3.0)
    q = found["left.angle"]
    assert 40.0 * (math.pi / 3 - q) == pytest.approx(2.0 * 9.81 * 0.3 * math.cos(q), rel=1e-6)
    assert found["pd.torque"] == pytest.approx(2.0 * 9.81 * 0.3 * math.cos(q), rel=1e-6)


def test_actuators_are_pushed_and_told_a_length() -> None:
    """One is at its end of stroke, one m g / k short of its target."""
    found = at_rest("actuators", "extended", 1.2)
    assert found["rod_1.length"] == pytest.approx(0.5, abs=1e-6)
    assert found["rod_3.length"] == pytest.approx(0.5 - 4.0 * 9.81 / 2000.0, abs=1e-6)
    assert found["told.force"] == pytest.approx(4.0 * 9.81, rel=1e-5)


def test_what_goes_rigidly_to_a_place_has_no_counterpart() -> None:
    with pytest.raises(SceneError, match="rigid servo or length") as caught:
        export_mechanism(expand(load_scene("servo_arm")))
    assert [problem.path for problem in caught.value.problems] == ["stiff"]
