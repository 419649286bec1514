"""Assemblies: a mechanism that is placed moves as the one that is not."""

from __future__ import annotations

import math
from typing import Any, get_args

import numpy as np
import pytest

from sandbox.elements.element import Placed
from sandbox.elements.loads import Load
from sandbox.elements.registry import Drive, Joint
from sandbox.elements.springs import Spring
from sandbox.elements.tendons import Tendon
from sandbox.engine.simulate import simulate
from sandbox.errors import SceneError
from sandbox.scene.bodies import Body
from sandbox.scene.expand import expand
from sandbox.scene.geometry import pose_of, to_world
from sandbox.scene.outlines.cams import DiscCam
from sandbox.scene.outlines.curves import SmoothCurve
from sandbox.scene.outlines.drawings import Drawing
from sandbox.scene.parts.expansion import Elements
from sandbox.scene.parts.placement import Mover
from sandbox.scene.read.load import load_scene
from sandbox.values.numbers import Dimension
from sandbox.values.signals import values
from sandbox.values.spec import Spec, mark_of

MACHINE: dict[str, Any] = {
    "bodies": [
        {"name": "arm", "at": [0.02, 0.01], "angle": 0.3, "mass": 0.1, "velocity": [0.01, 0.02],
         "angular_velocity": 0.5,
         "shapes": [{"type": "capsule", "end": [0.05, 0.01], "radius": 0.004},
                    {"type": "box", "size": [0.01, 0.004], "at": [0, 0.01], "angle": 0.2}]},
        {"name": "tip", "at": [0.08, 0.03], "mass": 0.05, "centre": [0.001, 0.002],
         "shapes": [{"type": "polygon", "points": [[0, 0], [0.01, 0], [0.004, 0.01]]}]},
        {"name": "wiper", "motion": "scheduled", "at": [0, 0.3], "shapes": [
            {"type": "circle", "radius": 0.01}],
         "path": {"x": {"ramp": {"to": 0.05, "over": 0.1}}, "y": "=0.3 + 0.01 * t",
                  "angle": "=t"}}],
    "joints": [
        {"type": "pin", "name": "root", "a": "ground", "b": "arm", "on_b": [0, 0], "zero": 0.1,
         "positive": "clockwise", "limits": [-0.4, 0.6], "damping": 1e-4},
        {"type": "pin", "name": "elbow", "a": "arm", "b": "tip", "on_b": [0, 0],
         "limits": ["-20 deg", "20 deg"]}],
    "springs": [
        {"type": "linear", "name": "pull", "a": "ground", "b": "tip", "on_a": [0.1, 0.1],
         "stiffness": 5},
        {"type": "rotary", "name": "twist", "joint": "elbow", "stiffness": 0.01,
         "rest_angle": 0.1}],
    "tendons": [{"name": "cord", "guides": [
        {"body": "tip", "at": [0.005, 0.002]}, {"body": "arm", "at": [0.03, 0.02], "radius": 0.004},
        {"body": "ground", "at": [-0.03, 0.02]}]}],
    "drives": [
        {"type": "pull", "name": "actuator", "tendon": "cord", "value": 0.5},
        {"type": "force", "name": "wind", "body": "tip", "direction": [1, 0.5], "value": 0.05},
        {"type": "force", "name": "jet", "body": "arm", "at": [0.05, 0], "direction": [0, 1],
         "frame": "body", "value": 0.02},
        {"type": "torque", "name": "servo", "joint": "elbow", "value": 0.002}],
    "meters": [{"name": "bend", "value": "=root.angle + elbow.angle"}],
}
GROUND = {"name": "ground", "motion": "fixed", "at": [0.01, -0.02], "angle": 0.4}
RUN = {"duration": 0.2}


def recording(**placing: Any) -> Any:
    return simulate(load_scene({"run": RUN, "bodies": [GROUND], "parts": [
        {"type": "assembly", "name": "m", **placing, **MACHINE}]}))


@pytest.fixture(scope="module")
def still() -> Any:
    """The machine written without an assembly."""
    return simulate(load_scene({"run": RUN, **MACHINE, "bodies": [GROUND, *MACHINE["bodies"]]}))


@pytest.mark.parametrize("placing", [
    {"at": [0.1, 0.2], "angle": "90 deg"}, {"mirror": "up-down"},
    {"mirror": "left-right", "angle": "-50 deg", "at": [0.05, 0.02]},
], ids=str)
def test_a_placed_mechanism_moves_like_the_original(still: Any, placing: dict[str, Any]):
    """Newton's laws know no place, direction or side: tips go where the placement takes them."""
    run = recording(**placing)
    placement = Mover(
        "m", Elements(), lambda _: None, tuple(placing.get("at", (0.0, 0.0))),
        {"90 deg": math.pi / 2, "-50 deg": math.radians(-50)}.get(
            placing.get("angle"), placing.get("angle", 0.0)), placing.get("mirror"))
    for body in ("arm", "tip", "wiper"):
        there = np.column_stack([run[f"m.{body}.{axis}"] for axis in "xy"])
        here = np.column_stack([still[f"{body}.{axis}"] for axis in "xy"])
        expected = np.array([placement.point(tuple(p)) for p in here])
        # rounding of poses below 1 m, 1e-16, times 400 steps, grows by the factor of 1e4 that lies
        # between the stiff cord's 1e5 N/m and the forces of 1 N that it carries over 0.1 m
        assert np.abs(there - expected).max() < 1e-9
    for quantity in ("root.angle", "elbow.angle", "cord.tension", "pull.force", "twist.torque",
                     "root.reaction", "root.stop", "elbow.stop", "bend"):
        size = np.abs(still[quantity]).max()
        assert np.abs(run[f"m.{quantity}"] - still[quantity]).max() < 1e-6 * max(size, 1e-3)


@pytest.mark.parametrize("path", [
    {"x": {"table": [[0, 0], [1, 1]]}, "y": {"table": [[0.5, 2], [2, 0]]}}, {"x": 1, "y": "=t"},
    {"x": {"ramp": {"to": 1, "over": 0}}, "y": {"ramp": {"to": 2, "start": 1, "over": 1}}},
], ids=["tables", "constant", "ramps"])
def test_paths_are_turned(path: dict[str, Any]):
    body = {"name": "b", "motion": "scheduled", "path": path}
    made = expand(load_scene({"parts": [{"type": "assembly", "name": "a", "angle": 0.3,
                                         "at": [1, 2], "bodies": [body]}]})).bodies[0].path
    plain = load_scene({"bodies": [body]}).bodies[0].path
    t = np.linspace(0, 3, 50)
    x, y = values(plain.x, t), values(plain.y, t)
    c, s = math.cos(0.3), math.sin(0.3)
    assert values(made.x, t) == pytest.approx(1 + c * x - s * y, abs=1e-12)
    assert values(made.y, t) == pytest.approx(2 + s * x + c * y, abs=1e-12)


def test_a_path_that_cannot_be_turned():
    body = {"name": "b", "motion": "scheduled",
            "path": {"x": {"table": [[0, 0], [1, 1]]}, "y": "=t"}}
    part = {"type": "assembly", "name": "a", "angle": 0.3, "bodies": [body]}
    with pytest.raises(SceneError, match="cannot be turned"):
        load_scene({"parts": [part]})
    assert load_scene({"parts": [{**part, "angle": "90 deg"}]})


def records() -> set[type[Spec]]:
    """Every record of an assembly's elements; cams, drawings and curves are polygons then."""
    found: set[type[Spec]] = set()
    waiting: list[Any] = [Body, Tendon, Joint, Spring, Load, Drive]
    while waiting:
        kind = waiting.pop()
        if isinstance(kind, type) and issubclass(kind, Spec):
            if kind in found or kind in (DiscCam, Drawing, SmoothCurve):
                continue
            found.add(kind)
            waiting += [field.annotation for field in kind.model_fields.values()]
        else:
            waiting += list(get_args(kind))
    return found


def test_every_angle_side_and_vector_is_marked():
    """A field that a turn or a mirror changes has a mark, Placed."""
    def dimension(marked):
        number = mark_of(getattr(marked, "metadata", getattr(marked, "__metadata__", ())),
                         Dimension)
        return number.name if number else ""

    missing = []
    for kind in records():
        for name, field in kind.model_fields.items():
            parts = get_args(field.annotation)
            choices = set(parts)
            numbers = [part for part in parts if dimension(part) in ("speed", "ratio")]
            turned = dimension(field) in ("angle", "angular speed") or any(
                dimension(part) == "angle" for option in (field.annotation, *parts)
                for part in get_args(option))
            marked = any(isinstance(mark, Placed) for mark in field.metadata)
            if (turned or len(numbers) == 2 or choices & {"left", "clockwise"}) and not marked:
                missing.append((kind.__name__, name))
    assert missing == []


def test_outlines_are_mirrored_and_scaled_with_their_holes():
    """Mirrored, turned by a quarter and moved by (1, 2): (x, y) goes to (1 - 2 y, 2 - 2 x)."""
    ring, hole = [[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [2, 1], [2, 3]]
    body = {"name": "b", "motion": "fixed", "shapes": [
        {"type": "polygon", "points": ring, "holes": [hole]},
        {"type": "polyline", "points": hole, "radius": 0.1},
        {"type": "box", "size": [1, 2], "angle": 0.3}]}
    (placed,) = expand(load_scene({"parts": [{
        "type": "assembly", "name": "a", "at": [1, 2], "angle": "90 deg", "scale": 2,
        "mirror": "left-right", "bodies": [body]}]})).bodies
    plate, line, box = placed.shapes
    for points, meant in ((plate.points, ring), (plate.holes[0], hole), (line.points, hole)):
        x, y = np.array(meant, dtype=float).T
        assert np.array([to_world(pose_of(placed), point) for point in points]) == pytest.approx(
            np.stack([1 - 2 * y, 2 - 2 * x], axis=1))
    assert (line.radius, box.size, box.angle) == (
        pytest.approx(0.2), pytest.approx((2, 4)), pytest.approx(-0.3))
