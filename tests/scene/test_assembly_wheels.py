"""Gears, racks and rolling circles in assemblies: mirrored, turned and scaled they run the same."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.scene.expand import expand
from sandbox.scene.parts.placement import Placement
from sandbox.scene.read.load import load_scene

GROUND = {"name": "ground", "motion": "fixed", "at": [0.01, -0.02], "angle": 0.4}
"""A body of the scene, turned, on which the train has a rack and the middle of a rolling disc."""


def on_ground(x: float, y: float) -> list[float]:
    c, s = np.cos(0.4), np.sin(0.4)
    return [float(c * (x - 0.01) + s * (y + 0.02)), float(c * (y + 0.02) - s * (x - 0.01))]


def pin(name: str, body: str, x: float, y: float, *, on: str = "ground") -> dict[str, Any]:
    where = on_ground(x, y) if on == "ground" else [x, y]
    return {"type": "pin", "name": name, "a": on, "b": body, "on_a": where, "on_b": [0, 0]}


def wheel(name: str, x: float, y: float, **more: Any) -> dict[str, Any]:
    return {"name": name, "at": [x, y], "mass": 0.2, "inertia": 4e-5, **more}


TRAIN: dict[str, Any] = {
    "bodies": [
        wheel("pinion", 0, 0, angular_velocity=20.0), wheel("big", 0.05, 0),
        wheel("ring", 0, 0), wheel("slide", 0.05, -0.015, angle=0.2),
        # rolls up a rack of the ground, driven by nothing but its own spin
        wheel("climber", -0.2, 0.1, velocity=[-0.12 * 0.6, 0.12 * 0.8], angular_velocity=-6.0),
        wheel("disc", 0.2, 0.15, velocity=[-0.5, 0], angular_velocity=50.0)],
    "joints": [
        pin("on_pinion", "pinion", 0, 0), pin("on_big", "big", 0.05, 0),
        pin("on_ring", "ring", 0, 0),
        {"type": "slot", "name": "rail", "a": "ground", "b": "slide", "turns": False,
         "start": on_ground(0, -0.015), "end": on_ground(0.1, -0.015)},
        {"type": "gear", "name": "mesh", "a": "pinion", "b": "big", "radius_a": 0.02,
         "radius_b": 0.03, "pressure_angle": "25 deg"},
        {"type": "gear", "name": "within", "a": "ring", "b": "big", "radius_a": 0.08,
         "radius_b": 0.03, "inside": True, "backlash": "0.3 mm"},
        {"type": "rack", "name": "push", "a": "big", "b": "slide", "radius": 0.015,
         "along": [float(np.cos(0.2)), float(-np.sin(0.2))]},
        {"type": "rack", "name": "climb", "a": "climber", "b": "ground", "radius": 0.02,
         "along": [float(v) for v in np.array(on_ground(-0.6, 0.8)) - on_ground(0, 0)],
         "on_b": on_ground(-0.2 + 0.02 * 0.8, 0.1 + 0.02 * 0.6)},
        {"type": "slot", "name": "lane", "a": "ground", "b": "climber",
         "start": on_ground(-0.2 + 0.06, 0.1 - 0.08), "end": on_ground(-0.2 - 0.06, 0.1 + 0.08)},
        {"type": "roll", "name": "around", "a": "ground", "b": "disc", "radius_a": 0.04,
         "radius_b": 0.01, "on_a": on_ground(0.2, 0.1)}],
}


def recording(parts: list[dict[str, Any]], **elements: Any) -> Any:
    return simulate(load_scene({
        "gravity": [0, 0], "run": {"duration": 0.2}, "bodies": [GROUND], "parts": parts}
        if parts else {"gravity": [0, 0], "run": {"duration": 0.2}, **elements}))


@pytest.fixture(scope="module")
def still() -> Any:
    """The train written without an assembly; all of it turns."""
    run = recording([], **TRAIN | {"bodies": [GROUND, *TRAIN["bodies"]]})
    assert abs(run["push.tangential"]).max() > 0.1
    assert np.isclose(run["on_big.rate"][-1] * 0.03, -run["on_pinion.rate"][-1] * 0.02, rtol=1e-6)
    assert np.isclose(run["on_ring.rate"][-1] * 0.08, run["on_big.rate"][-1] * 0.03, rtol=1e-3)
    assert np.isclose(run["climber.omega"][-1] * 0.02, -0.12, rtol=1e-3)
    assert run["disc.y"][-1] < 0.1  # a quarter round the ground's circle, and more
    return run


@pytest.mark.parametrize("placing", [
    {"mirror": "left-right"}, {"mirror": "up-down", "at": [0.3, -0.1]},
    {"mirror": "left-right", "angle": 0.7, "at": [0.05, 0.02]}, {"scale": 2.5},
    {"scale": 0.5, "mirror": "up-down", "angle": -1.1},
], ids=str)
def test_a_train_runs_as_the_one_that_is_not_placed(still: Any, placing: dict[str, Any]) -> None:
    """Angles stay what they were, ways are scaled; forces too, as masses stay.

    Positions are those of the placement to rounding, and what stiff teeth make of it.
    """
    run = recording([{"type": "assembly", "name": "m", **placing, **TRAIN}])
    placement = Placement(placing.get("at", (0.0, 0.0)), placing.get("angle", 0.0),
                          placing.get("mirror"), placing.get("scale", 1.0))
    for body in ("slide", "climber", "disc"):
        there = np.column_stack([run[f"m.{body}.{axis}"] for axis in "xy"])
        here = np.column_stack([still[f"{body}.{axis}"] for axis in "xy"])
        assert np.abs(there - [placement.point(tuple(p)) for p in here]).max() < 1e-9
    for name in ("on_pinion.angle", "on_big.angle", "on_ring.angle"):
        assert np.abs(run[f"m.{name}"] - still[name]).max() < 1e-7
    for name in ("mesh", "within", "push", "climb", "around"):
        size = max(np.abs(still[f"{name}.reaction"]).max() * placement.scale, 1.0)
        for quantity, sign in (("reaction", 1), ("radial", 1), ("tangential", placement.sign)):
            here = still[f"{name}.{quantity}"] * placement.scale * sign
            there = run[f"m.{name}.{quantity}"]
            # a step ends closing gaps at 1e-6 m/s^2 of acceleration, of 0.2 kg
            assert np.abs(there - here).max() < 1e-6 * size, name


def test_what_is_written() -> None:
    scene = {"bodies": [GROUND], "parts": [
        {"type": "assembly", "name": "m", "scale": 2, "mirror": "left-right", **TRAIN}]}
    joints = {joint.name: joint for joint in expand(load_scene(scene)).joints}
    mesh, within, push = (joints[f"m.{name}"] for name in ("mesh", "within", "push"))
    assert (mesh.radius_a, mesh.radius_b, mesh.stiffness) == (0.04, 0.06, 1e9)
    assert mesh.pressure_angle == pytest.approx(np.radians(25))
    assert (within.inside, within.backlash) == (True, pytest.approx(6e-4))
    assert push.along == pytest.approx((-np.cos(0.2), -np.sin(0.2)))
