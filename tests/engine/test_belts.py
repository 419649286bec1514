"""Surfaces that run, against closed forms of dry friction."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.errors import SceneError
from sandbox.scene.read.load import load_scene

G, MU, V, M = 9.81, 0.4, 1.0, 2.0


def scene(belt: dict[str, Any], body: dict[str, Any], *, value: Any = V, end: float = 0.6,
          ground: bool = False, **more: Any) -> Any:
    named = {"material": "rubber"}
    still = [{"name": "ground", "motion": "fixed"}] if ground else []
    return load_scene({
        "run": {"duration": end, "step": 1e-3, "sample_rate": 1000}, "gravity": [0, -G],
        "materials": {"rubber": {"friction": MU}},
        "bodies": [*still, {"name": "belt", "motion": "fixed", **named, **belt},
                   {"name": "load", "mass": M, **named, **body}],
        "drives": [{"type": "surface", "name": "run", "body": "belt", "value": value}], **more})


FLAT = {"shapes": [{"type": "box", "size": [4, 0.1]}]}
BOX = {"at": [0, 0.1], "shapes": [{"type": "box", "size": [0.2, 0.1]}]}


def unlooked(run: Any) -> list[str]:
    return [f"{figure.name}: {figure.why}" for figure in audit(run) if figure.verdict == "look"]


def test_the_surface_of_a_free_body_pushes_it_back() -> None:
    """Momentum: a sled without friction below and its load go apart, m v + m' v' = 0."""
    sled = {"at": [0, 0], "motion": "dynamic", "mass": 3.0, "shapes": [{"type": "box",
                                                                        "size": [4, 0.1]}]}
    run = simulate(scene(sled, BOX, ground=True, joints=[
        {"type": "slot", "name": "rail", "a": "ground", "b": "belt", "start": [-5, 0],
         "end": [5, 0], "turns": False}]))
    assert np.abs(M * run["load.vx"] + 3 * run["belt.vx"]).max() < 1e-9
    assert run["load.vx"][-1] - run["belt.vx"][-1] == pytest.approx(-V, abs=1e-9)
    assert unlooked(run) == []


def test_what_bounces_on_a_belt_is_pushed_with_mu_times_the_blow() -> None:
    """Falling at u it leaves with e u up and mu (1 + e) u along, as long as that is less than V."""
    ball = {"at": [0, 0.25], "inertia": 1e6, "shapes": [{"type": "circle", "radius": 0.1}]}
    scene_ = scene(FLAT, ball, value=5.0, end=0.2, materials={
        "rubber": {"friction": MU, "restitution": 0.5}})
    run = simulate(scene_)
    fall = np.sqrt(2 * G * 0.1)
    assert run["load.vx"][-1] == pytest.approx(-MU * 1.5 * fall, rel=G * 1e-3 / fall * 2)


def test_a_box_held_on_a_running_belt_goes_on_costing_power() -> None:
    """At rest nothing is worked out again, but for what the belt does: mu m g v for ever."""
    rod = {"type": "rod", "name": "stay", "a": "belt", "b": "load", "on_a": [1.9, 0.1],
           "collide": True}
    run = simulate(scene(FLAT, BOX, end=1.0, joints=[rod]))
    assert run["run.work"][-1] == pytest.approx(MU * M * G * V * run.time[-1], rel=1e-3)
    assert run["stay.reaction"][-1] == pytest.approx(MU * M * G, rel=1e-9)


def test_a_surface_has_one_drive_and_a_body() -> None:
    more = [{"type": "surface", "name": name, "body": body, "value": 1}
            for name, body in (("one", "belt"), ("two", "belt"), ("three", "belts"))]
    with pytest.raises(SceneError) as raised:
        scene(FLAT, BOX, drives=more)
    found = [str(problem) for problem in raised.value.problems]
    assert any("the surface of 'belt' is set already, by 'one'" in text for text in found), found
    assert any("no body named 'belts'" in text and "'belt'" in text for text in found), found
