"""The audit knows that a seam between the pieces of an outline is nothing to touch."""

from __future__ import annotations

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.outlines import contact_geometry
from sandbox.engine import world
from sandbox.engine.simulate import simulate
from sandbox.scene.geometry import solids
from sandbox.scene.read.load import load_scene

SCENE = {
    "run": {"duration": 0.1, "step": 1e-3, "sample_rate": 1000}, "gravity": [0, -9.81],
    "bodies": [
        {"name": "ground", "motion": "fixed", "shapes": [
            {"type": "polyline", "points": [[-1, 0], [0, 0], [1, 0]]}]},
        {"name": "b", "mass": 1, "at": [-0.07, 0.02], "velocity": [1, 0],
         "shapes": [{"type": "box", "size": [0.1, 0.04]}]}]}


def figure(run):
    return contact_geometry(Evidence(run))


def test_contacts_beside_a_joint_are_where_the_outline_is():
    assert figure(simulate(load_scene(SCENE))).verdict == "pass"


def test_a_contact_on_a_seam_is_told(monkeypatch):
    """Where the engine takes the ends of all segments for surface, the box is caught at one."""
    monkeypatch.setattr(world, "solids",
                        lambda shape: tuple((solid, None) for solid, _ in solids(shape)))
    floating = {**SCENE, "gravity": [0, 0]}
    floating["bodies"] = [SCENE["bodies"][0], {**SCENE["bodies"][1], "at": [-0.07, 0.0201]}]
    run = simulate(load_scene(floating))
    assert run["b.vx"].min() < 0.6
    assert np.abs(run.arrays["contact_normal"][:, 0]).max() > 0.5
    assert figure(run).verdict != "pass"


