"""Rest against closed forms, against simulations, and what can not rest."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.equilibria.branches import rest_along
from sandbox.equilibria.rest import AtRest, rest
from sandbox.errors import SceneError
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import read_scene

G = 9.81
RUN = {"duration": 1.0, "step": 1e-3}
WALL = {"name": "wall", "motion": "fixed"}
MASS, ARM, RADIUS = 0.2, 0.1, 0.01


def pendulum(stiffness: float, *, rest_angle: float = 0.0) -> dict[str, Any]:
    """A bob on a hinge, straight up at 0, held there by a rotary spring."""
    return {
        "format": 1, "run": RUN, "gravity": [0, -G],
        "bodies": [WALL, {"name": "bob", "at": [0, ARM], "mass": MASS,
                          "shapes": [{"type": "circle", "radius": RADIUS}]}],
        "joints": [{"type": "pin", "name": "hinge", "a": "wall", "b": "bob", "on_a": [0, 0],
                    "on_b": [0, -ARM]}],
        "springs": [{"type": "rotary", "name": "spring", "joint": "hinge", "stiffness": stiffness,
                     "rest_angle": rest_angle}]}


def hanging(stiffness: float, mass: float, **spring: float) -> dict[str, Any]:
    """A weight on a spring that is 0.2 m long without it."""
    return {
        "format": 1, "run": RUN, "gravity": [0, -G],
        "bodies": [WALL, {"name": "weight", "at": [0, -0.2], "mass": mass,
                          "shapes": [{"type": "circle", "radius": 0.01}]}],
        "springs": [{"type": "linear", "name": "spring", "a": "wall", "b": "weight",
                     "on_a": [0, 0], "on_b": [0, 0], "stiffness": stiffness, **spring}]}


def on_slope(friction: float, slope: float) -> dict[str, Any]:
    """A box on a plane that falls to the right."""
    x, y = math.cos(slope), math.sin(slope)
    return {
        "format": 1, "run": RUN, "gravity": [0, -G], "materials": {"m": {"friction": friction}},
        "bodies": [{"name": "plane", "motion": "fixed", "angle": -slope, "material": "m",
                    "shapes": [{"type": "box", "size": [1, 0.1], "at": [0, -0.05]}]},
                   {"name": "box", "mass": 0.5, "angle": -slope, "material": "m",
                    "at": [0.02 * y, 0.02 * x],
                    "shapes": [{"type": "box", "size": [0.06, 0.04]}]}]}


def only(scene: object, **options: object) -> AtRest:
    found = rest(scene, **options)  # type: ignore[arg-type]
    assert len(found.rests) == 1
    return found.rests[0]


def test_a_weight_on_a_spring():
    found = only(hanging(50.0, 0.3))
    assert found["weight.y"] == pytest.approx(-0.2 - 0.3 * G / 50, abs=1e-11)
    assert found["spring.force"] == pytest.approx(0.3 * G, rel=1e-10)
    assert found.stability == "neutral"  # it hangs, and nothing turns it back about its middle
    assert found.loose == ("weight",)
    stiff = found.stiffness("weight").stiffness()
    assert stiff[1] == pytest.approx(50, rel=1e-9)
    # sideways it is a pendulum: F / x = m g / length
    assert stiff[0] == pytest.approx(0.3 * G / (0.2 + 0.3 * G / 50), rel=1e-6)


@pytest.mark.parametrize("stiffness", [20.0, 2e6, 5e6])
def test_a_spring_that_is_soft_or_too_stiff_for_the_step(stiffness: float):
    """Newton's method has to know what the step's end took off the force of a stiff spring."""
    found = only(hanging(stiffness, 0.3, damping=3.0))
    assert found["weight.y"] == pytest.approx(-0.2 - 0.3 * G / stiffness, abs=2e-11)
    assert found.balance is not None
    assert sorted(found.modes)[-1] == pytest.approx(stiffness / 0.3, rel=1e-6)


# --- against simulations of shipped scenes that come to rest


@pytest.mark.parametrize("name", [
    "single_finger", "pulley_differential", "servo_arm", "jaw", "toggle_press", "pneumatic_hand",
    pytest.param("hydraulic_press", marks=pytest.mark.nightly),
    pytest.param("elastic_tendons", marks=pytest.mark.nightly)])
def test_where_a_shipped_scene_comes_to_rest(name: str):
    """Poses within 1e-6 m and rad, forces within 1e-4 of the largest: what is left of the run's
    own motion at its end is some tenth of that, of 'hydraulic_press' and 'jaw' most."""
    run, found = sandbox.simulate(name), only(name)
    a, b = found.recording.arrays, run.arrays
    off = np.abs(a["body_pose"][0] - b["body_pose"][-1])
    assert off.max() < 1e-6
    forces, last = _forces(found.recording), _forces(run)
    assert forces.keys() == last.keys()
    scale = max(map(abs, last.values()), default=0.0)
    for key, value in last.items():
        assert forces[key] == pytest.approx(value, abs=1e-4 * scale), key


def _forces(run: Recording) -> dict[object, float]:
    a, last = run.arrays, len(run) - 1
    found: dict[object, float] = {}
    for kind in ("tendon_tension", "spring_force", "joint_reaction"):
        for i, value in enumerate(a[kind][last].tolist()):
            if math.isfinite(value):
                found[kind, i] = value
    rows = np.flatnonzero(a["contact_sample"] == last)
    for row in rows[run.contacts.normal[rows] > 1e-6].tolist():
        pair = int(a["contact_body"][row]), int(a["contact_other"][row])
        found[pair] = float(run.contacts.normal[row])
    return found


# --- friction: it holds, or it does not


def test_a_box_that_friction_holds_on_a_slope():
    found = only(on_slope(0.5, math.atan(0.4)))
    assert found.sticking == ("box/plane",)
    assert found["box/plane.tangential"] == pytest.approx(0.5 * G * math.sin(math.atan(0.4)),
                                                          rel=1e-9)
    assert found.stability == "stable"
    assert found.left < 1e-9


# --- what is refused, or said


@pytest.mark.parametrize(("scene", "options", "words"), [
    ("finger_stiffness_10N", {}, "the controller 'mcp_loop' needs time"),
    ("release", {}, r"the event 'catch' acts at t = 0\.1 s"),
    ("four_bar", {}, "the drive 'motor' goes on for ever"),
    ({"bodies": [{"name": "wall", "motion": "fixed"}]}, {}, "nothing moves freely"),
    (pendulum(1.0), {"starts": [{"hing.angle": 1.0}]}, r"Did you mean 'hinge\.angle'"),
    (pendulum(1.0), {"at": 2.0}, "2 s is not within the run"),
    (on_slope(0.3, math.atan(0.4)), {}, r"nothing holds 'box': it has gone .* m and goes on"),
])
def test_scenes_without_an_equilibrium_are_refused(scene, options, words):
    with pytest.raises(SceneError, match=words):
        rest(scene, **options)


def test_a_drive_has_its_value_at_the_given_time():
    scene = hanging(50.0, 0.3)
    scene["drives"] = [{"type": "force", "name": "push", "body": "weight", "direction": [0, -1],
                        "value": {"ramp": {"to": 2.0, "over": 1.0}}}]
    half = only(scene, at=0.5)
    assert half["weight.y"] == pytest.approx(-0.2 - (0.3 * G + 1.0) / 50, abs=3e-5)


@pytest.mark.parametrize("starts", [(), ({"weight.y": -0.3},)])
def test_what_a_schedule_has_carried_away(starts: tuple[dict[str, float], ...]):
    scene = hanging(50.0, 0.3)
    scene["bodies"][0] = {"name": "wall", "motion": "scheduled",
                          "path": {"y": {"ramp": {"to": 0.01, "over": 0.5}}}}
    found = only(scene, starts=starts)
    assert found["weight.y"] == pytest.approx(0.01 - 0.2 - 0.3 * G / 50, abs=1e-10)


# --- branches


def test_along_a_stiffness_and_not_a_load():
    """k a = m g l sin a of a pendulum with its spring at rest at 0.1 rad."""
    def make(k: float) -> Mechanism:
        # the command line writes the value as text
        return read_scene(pendulum(float(repr(k)), rest_angle=0.1)).mechanism

    branch, = rest_along(make, 0.5, 0.15, 6)
    for stop in branch.stops:
        angle = stop.rest["hinge.angle"]
        assert stop.value * (angle - 0.1) == pytest.approx(
            MASS * G * ARM * math.sin(angle), abs=1e-9)
        assert stop.rest.stability == "stable"
