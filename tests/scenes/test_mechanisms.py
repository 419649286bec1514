"""Ordinary mechanisms: their expectations are of what they show, and a planted fault breaks them.

That they hold, are audited and run twice alike is tested with all shipped scenes.
"""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.engine.simulate import simulate
from sandbox.samples.expectations import verdicts
from sandbox.scene.library import folder_of, shipped_scenes
from sandbox.scene.read.load import load_scene

SCENES = {name: path for name, path in shipped_scenes().items()
          if folder_of(path) == "mechanisms"}
FAULTS: dict[str, tuple[dict[str, Any], set[str]]] = {
    "slider_crank": ({"bodies[rod].at": [0.0295, 0]}, {"error", "piston.x"}),
    "coupler_curve": ({"bodies[rocker].at": [0.0405, 0]}, {"error.x", "straight"}),
    "valve_cam": ({"springs[spring].stiffness": "0.55 N/mm"}, {"cam/plate.normal"}),
    "geneva_drive": ({"bodies[wheel].shapes[0].repeat.count": 3}, {"error", "wheel.angle"}),
    "planetary_gear": ({"joints[inner{i}].radius_b": 0.0135, "joints[inner{i}].radius_a": 0.0255},
                       {"slip", "carrier.omega", "motor.torque"}),
    "winch": ({"tendons[cord].guides[1].radius": 0.061}, {"cord.shortening", "motor.torque"}),
    "atwood": ({"bodies[heavy].mass": 1.21}, {"cord.tension", "heavy.ay"}),
    "toggle_press": ({"joints[guide].start": [0, 0.0605]}, {"ram/workpiece.normal"}),
    "truss": ({"drives[load].body": "low3"}, {"abutment.reaction_y", "roof1.tension"}),
    "curved_track": ({"materials.rubber.friction": 0}, {"disc.vx", "disc/track.normal"}),
    "newtons_cradle": ({"materials.steel.restitution": 0.98}, {"ball4.y", "ball4.vx"}),
    "dominoes": ({"bodies[shy].angular_velocity": -2.5}, {"shy.angle"}),
    "car_on_bumps": ({"bodies[rear_wheel].shapes": [{"type": "circle", "radius": 0.301}]},
                     {"chassis.vx"}),
    "projectile": ({"loads[oil].linear": 0.505, "loads[wind].density": 1.21},
                   {"off.x", "off.y", "fall", "dropped.vy"}),
    "trebuchet": ({"contacts[1].friction": 0.3}, {"energy"}),
    "escapement": ({"bodies[pendulum].inertia": 1e-3}, {"axis.angle"}),
}
"""For each scene: a fault, and some of the quantities that are no longer as expected."""


def test_each_mechanism_has_its_fault() -> None:
    assert set(FAULTS) == set(SCENES)


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found(name: str) -> None:
    overrides, broken = FAULTS[name]
    run = simulate(load_scene(SCENES[name], overrides=overrides))
    assert broken <= {verdict.quantity for verdict in verdicts(run) if not verdict.ok}
