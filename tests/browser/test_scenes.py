"""Shipped scenes: each kind of item is drawn without a fault, with all layers."""

import pytest

from sandbox.engine.simulate import simulate
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene
from sandbox.web.page import report

SCENES = ("planetary_gear", "hydraulic_lift", "pneumatic_hand", "floating", "fields", "conveyor",
          "release", "servo_arm", "capstan", "finger_joint_locks", "linear_actuator",
          "rope_differential", "finger_stiffness_10N", "motor_line", "dry_friction")
KINDS = {"path", "line", "mark", "span", "spiral", "taut", "sag", "arrows", "strips", "trail",
         "text"}
"""See :mod:`sandbox.picture.listing`."""


@pytest.mark.nightly
def test_scenes_with_every_kind_are_drawn_without_a_fault(opened):
    seen = set()
    for name in SCENES:
        run = simulate(expand(load_scene(
            name, overrides={} if name == "release" else {"run.duration": 0.05})))
        tab = opened(report([run]))
        for layer in tab.evaluate("sandbox.heads[0].layers.map((l) => l.name)"):
            tab.evaluate("(name) => sandbox.stages[0].layers.add(name)", layer)
        for share in (0.4, 1.0):
            tab.evaluate("(w) => sandbox.hold(w * sandbox.last)", share)
        seen |= set(tab.evaluate("sandbox.stages[0].list.items.map((item) => item.k)"))
    assert KINDS - seen <= {"sag"}  # no rope of these scenes is slack
