"""Scenes run in MuJoCo too, from what ``sandbox export`` writes: two programs, one mechanics.

Bounds are the project's: rotations within 0.05 deg, forces and tensions within
0.5 %, and 0.5 % of the travel for what moves along a line. Only frictionless
scenes are compared: with friction a pose depends on its history, contacts share
what statics leaves open, and MuJoCo's contacts creep. MuJoCo takes the step that
is written beside each case; where nothing but its first-order rule differs, the
error of a travel by an acceleration a is a h t / 2.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.engine.simulate import simulate
from sandbox.export import export_mechanism
from sandbox.mechanics.grasp import disc_centre
from sandbox.recording.recording import Recording
from sandbox.scene.library import shipped_scenes
from sandbox.scene.mechanism import Mechanism
from tests.support.mechanisms import BODIES, HINGES, finger, fixed, mass, mechanism
from tests.support.reference import SET_G, SET_G_TABLE, DiscRow

mujoco = pytest.importorskip(
    "mujoco", reason="compares with MuJoCo, which is not installed: pip install mujoco")

DEGREES = 0.05
SHARE = 5e-3
GRAVITY = (0.0, -9.81)


class Second:
    """A mechanism in MuJoCo, where its export says it starts."""

    def __init__(self, scene: Mechanism, *, step: float) -> None:
        self.model = mujoco.MjModel.from_xml_string(export_mechanism(scene).text)
        self.model.opt.timestep = step
        self.data = mujoco.MjData(self.model)
        if self.model.nkey:
            mujoco.mj_resetDataKeyframe(self.model, self.data, 0)

    def settle(self, duration: float, *, ramp: float) -> Second:
        """Drive from nothing to the last values in ``ramp`` [s], then wait."""
        last = self.data.ctrl.copy()
        while self.data.time < duration:
            self.data.ctrl[:] = last * min(1.0, self.data.time / ramp)
            mujoco.mj_step(self.model, self.data)
        mujoco.mj_forward(self.model, self.data)
        assert np.abs(self.data.qvel).max() < 1e-6  # at rest: m/s, rad/s
        return self

    def __getitem__(self, sensor: str) -> float:
        return float(self.data.sensor(sensor).data[0])

    def follow(self, sensors: list[str], times: np.ndarray) -> np.ndarray:
        """Sensors at ``times`` [s] of a motion from the start, shape [times, sensors]."""
        at, rows = [], []
        while not at or at[-1] < times[-1]:
            mujoco.mj_forward(self.model, self.data)
            at.append(self.data.time)
            rows.append([self[name] for name in sensors])
            mujoco.mj_step(self.model, self.data)
        table = np.array(rows)
        return np.stack([np.interp(times, at, column) for column in table.T], axis=1)


def agree_on_the_grasp(run: Recording, second: Second) -> None:
    for hinge in HINGES:
        angles = np.degrees([run[f"{hinge}.angle"][-1], second[f"{hinge}.angle"]])
        assert angles[1] == pytest.approx(angles[0], abs=DEGREES)
    for body in BODIES:
        wanted = run[f"{body}.contact.normal"][-1]
        assert second[f"{body}.contact.normal"] == pytest.approx(wanted, rel=SHARE)
        assert wanted > 0.1  # there is something to agree on


@pytest.mark.parametrize("row", SET_G_TABLE)
def test_set_g_on_a_disc(row: DiscRow) -> None:
    """f = J^-T tau in two programs and in closed form; the pose is the disc's.

    The radii's place in the table is rounded; exact is k_1 = 31 mm at 35 deg.
    """
    centre = disc_centre(np.radians(35.0), 0.031, row.disc_radius, SET_G.radii[0])
    scene = finger(SET_G, pull={"to": row.tension, "over": 0.3}, duration=1.5, step=5e-4,
                   disc=replace(row, centre=(float(centre[0]), float(centre[1]))))
    run, second = simulate(scene), Second(scene, step=1e-4).settle(1.5, ramp=0.3)
    agree_on_the_grasp(run, second)
    assert second["finger.tendon.tension"] == pytest.approx(row.tension, rel=1e-12)
    for i, (body, hinge) in enumerate(zip(BODIES, HINGES, strict=True)):
        assert np.degrees(second[f"{hinge}.angle"]) == pytest.approx(row.degrees[i], abs=DEGREES)
        assert second[f"{body}.contact.normal"] == pytest.approx(row.forces[i], rel=SHARE)


@pytest.mark.parametrize("name", ["rocker_differential", "rope_differential"])
def test_a_tree_of_rockers(name: str) -> None:
    """T = F / 4 on every string and x = T / k for every load, as tendons and as ropes."""
    scene = sandbox.expand(sandbox.load_scene(name))
    second = Second(scene, step=5e-4).settle(1.5, ramp=0.5)
    quantity = "tension" if name == "rocker_differential" else "reaction"
    for i, stiffness in enumerate((1000, 500, 333, 250), start=1):
        assert second[f"tree.string{i}.{quantity}"] == pytest.approx(5.0, rel=SHARE)
        assert second[f"load{i}.position"] == pytest.approx(-5.0 / stiffness, rel=SHARE)
    run = simulate(scene)
    for i in range(1, 5):
        assert second[f"tree.string{i}.{quantity}"] == pytest.approx(
            run[f"tree.string{i}.{quantity}"][-1], rel=SHARE)
        assert second[f"load{i}.position"] == pytest.approx(run[f"load{i}.x"][-1], rel=SHARE)
    for i in range(1, 4):
        assert second[f"tree.rocker{i}.position"] == pytest.approx(
            run[f"tree.rocker{i}.x"][-1], rel=SHARE)


def motion(scene: Mechanism, step: float, **sensors: str) -> tuple[np.ndarray, np.ndarray]:
    """The same quantities over time in both; ``sensors`` gives the name that MuJoCo has."""
    run = simulate(scene)
    second = Second(scene, step=step).follow(list(sensors.values()), run.time)
    return np.stack([run[name.replace("__", ".")] for name in sensors], axis=1), second


def test_a_double_pendulum_with_everything_on_it() -> None:
    """Gravity, rotary and linear springs and dampers, torques, forces; hinges written both ways.

    Smooth, swung by more than 40 and 100 deg; MuJoCo's first-order rule at h = 10 us is off by
    alpha h t / 2 with alpha of some 400 rad/s^2: 0.02 deg.
    """
    elbow = (0.1 + 0.1 * np.cos(0.3), 0.2 + 0.1 * np.sin(0.3))
    scene = mechanism(
        duration=0.2, step=1e-4, gravity=GRAVITY,
        bodies=[fixed("frame", at=(0.1, 0.2), angle=0.4),
                mass("upper", 0.1, (0.1, 0.2), angle=0.3, centre=(0.05, 0.01), inertia=2e-4),
                mass("lower", 0.05, elbow, angle=-0.5, centre=(0.03, 0.0), inertia=5e-5)],
        joints=[{"type": "pin", "name": "top", "a": "upper", "b": "frame", "on_a": (0, 0),
                 "positive": "clockwise", "zero": 0.1, "damping": 1e-3},
                {"type": "pin", "name": "mid", "a": "upper", "b": "lower", "on_b": (0, 0)}],
        springs=[{"type": "rotary", "name": "s1", "joint": "mid", "stiffness": 0.03,
                  "damping": 5e-5, "rest_angle": 0.1},
                 {"type": "rotary", "name": "s4", "joint": "mid", "stiffness": 0.02,
                  "rest_angle": 0.35, "damping": 5e-5},
                 {"type": "rotary", "name": "s2", "joint": "top", "stiffness": 0.05,
                  "rest_angle": 0.2},
                 {"type": "linear", "name": "s3", "a": "frame", "b": "lower",
                  "on_a": (0.1, -0.2), "on_b": (0.04, 0), "stiffness": 20, "damping": 0.05}],
        drives=[{"type": "torque", "name": "m1", "joint": "mid", "value": 0.02},
                {"type": "torque", "name": "m2", "joint": "top", "value": 0.01},
                {"type": "force", "name": "f1", "body": "lower", "at": (0.02, 0.01),
                 "direction": (1, 2), "value": 0.3},
                {"type": "force", "name": "f2", "body": "lower", "at": (0.02, 0.01),
                 "direction": (-1, 2), "frame": "body", "value": 0.2}])
    first, second = motion(scene, 1e-5, top__angle="top.angle", mid__angle="mid.angle")
    assert (np.degrees(np.ptp(first, axis=0)) > 40).all()
    np.testing.assert_allclose(np.degrees(second), np.degrees(first), atol=DEGREES)


def test_a_cable_round_a_wheel() -> None:
    """Atwood's machine, half a turn of wrap: a = g / 3, T = 2 m1 m2 g / (m1 + m2) = 1.308 N."""
    scene = mechanism(
        duration=0.2, step=5e-4, gravity=GRAVITY,
        bodies=[fixed("frame"), mass("left", 0.1, (-0.05, 0)), mass("right", 0.2, (0.05, 0))],
        tendons=[{"name": "cord", "guides": [
            {"body": "left"}, {"body": "frame", "at": (0, 0.3), "radius": 0.05, "side": "right"},
            {"body": "right"}]}])
    run, second = simulate(scene), Second(scene, step=5e-5)
    second.follow(["cord.tension"], run.time[-1:])
    assert second["cord.tension"] == pytest.approx(2 * 0.1 * 0.2 / 0.3 * 9.81, rel=SHARE)
    assert second["cord.tension"] == pytest.approx(run["cord.tension"][-1], rel=SHARE)
    fall = run["right.y"][-1]
    assert fall == pytest.approx(-9.81 / 3 * run.time[-1] ** 2 / 2, rel=SHARE)
    at = float(np.asarray(second.data.body("right").xpos)[1])
    # it is one step of 50 us ahead at most, at 0.65 m/s: 0.05 % of 65 mm
    assert at == pytest.approx(fall, rel=SHARE)


LEVEL = {"type": "box", "size": (1, 0.1), "at": (0, -0.05)}


@pytest.mark.parametrize(("ground", "shape"), [
    (LEVEL, {"type": "box", "size": (0.04, 0.02)}),
    ({"type": "capsule", "start": (-0.5, -0.05), "end": (0.5, -0.05), "radius": 0.05},
     {"type": "polygon", "points": [(-0.02, -0.01), (0.02, -0.01), (0.0, 0.02)]}),
    ({"type": "polygon", "points": [(-0.5, -0.1), (0.5, -0.1), (0.5, 0), (-0.5, 0)]},
     {"type": "capsule", "start": (-0.01, 0), "end": (0.01, 0), "radius": 0.01}),
    (LEVEL, {"type": "circle", "radius": 0.01})])
def test_shapes_slide_down_a_plane(ground: dict[str, Any], shape: dict[str, Any]) -> None:
    """Without friction N = m g cos(a) and x = g sin(a) t^2 / 2, in both."""
    slope = 0.3
    scene = mechanism(
        duration=0.2, step=5e-4, materials={"ice": {"friction": 0}},
        gravity=(9.81 * np.sin(slope), -9.81 * np.cos(slope)),
        bodies=[fixed("plane", shapes=[ground], material="ice"),
                {"name": "block", "at": (0, 0.01), "mass": 0.1, "shapes": [shape],
                 "material": "ice"}])
    run, second = simulate(scene), Second(scene, step=5e-4)
    x = second.follow(["block.position"], run.time)[:, 0]
    assert second["block.contact.normal"] == pytest.approx(0.981 * np.cos(slope), rel=SHARE)
    assert second["block.contact.normal"] == pytest.approx(
        run["block.contact.normal"][-1], rel=SHARE)
    np.testing.assert_allclose(x, run["block.x"], atol=SHARE * float(run["block.x"][-1]))


@pytest.mark.nightly
@pytest.mark.parametrize("name", sorted(set(shipped_scenes()) - {"shelf"}))
def test_every_shipped_scene_loads_and_runs(name: str) -> None:
    """Without what has no counterpart; a tenth of a second at the scene's own step.

    On a shelf by itself nothing is free.
    """
    scene, left_out = sandbox.expand(sandbox.load_scene(name)), []
    try:
        text = export_mechanism(scene).text
    except sandbox.SceneError as error:
        left_out = [problem.path for problem in error.problems]
        text = export_mechanism(scene, without=left_out).text
    model = mujoco.MjModel.from_xml_string(text)
    assert model.nv > 0
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    while data.time < 0.1:
        mujoco.mj_step(model, data)
    assert np.isfinite(data.qpos).all()
    assert [warning.number for warning in data.warning] == [0] * len(data.warning)
