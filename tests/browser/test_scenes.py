"""Shipped scenes with what the made-up ones lack: each kind of part is drawn, without a fault."""

import pytest

from sandbox.engine.simulate import simulate
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene
from sandbox.web.words import drawing
from sandbox.web.page import report
from tests.web.test_parts import kinds_of_python

SCENES = ("planetary_gear", "hydraulic_lift", "pneumatic_hand", "floating", "fields", "conveyor",
          "release", "servo_arm", "capstan", "finger_joint_locks", "linear_actuator",
          "rope_differential", "finger_stiffness_10N", "motor_line", "dry_friction")
NOT_HERE = {"bar", "weld", "disc", "groove", "stop", "spiral", "drive", "trace", "roller", "rod"}
"""Kinds that the made-up recordings have, or most scenes."""


@pytest.mark.nightly
def test_scenes_with_every_kind_are_drawn_without_a_fault(opened):
    seen = set()
    for name in SCENES:
        run = simulate(expand(load_scene(
            name, overrides={} if name == "release" else {"run.duration": 0.05})))
        seen |= {part["k"] for part in drawing(run)["parts"]}
        tab = opened(report([run]))
        for share in (0.4, 1.0):
            tab.evaluate("(w) => sandbox.hold(w * sandbox.last)", share)
    assert kinds_of_python() - seen <= NOT_HERE
