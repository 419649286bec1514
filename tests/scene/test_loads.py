"""Loads as scenes write them: numbers with units, patterns, assemblies."""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.scene.elements.loads import BuoyancyLoad, DragLoad, LawLoad
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

BALLS: list[dict[str, Any]] = [
    {"name": name, "mass": 1, "at": [i, 0], "shapes": [{"type": "circle", "radius": 0.1}]}
    for i, name in enumerate(("ball1", "ball2", "box"))]
WALL = {"name": "ballast", "motion": "fixed"}


def _mechanism(*loads: dict[str, Any], **more: Any) -> Mechanism:
    return expand(load_scene({"gravity": [0, -9.81], "bodies": [*BALLS, WALL], "loads": list(loads),
                              **more}))


def test_numbers_have_units_and_parameters_are_put_in() -> None:
    load = _mechanism({"type": "law", "name": "f", "force": ["2 kN", "=-c * vx + 1"],
                       "torque": 3}, parameters={"c": "2 N s/m"}).loads[0]
    assert isinstance(load, LawLoad)
    assert load.force == ("=2000.0", "=-2.0 * vx + 1")
    assert load.torque == "=3.0"


@pytest.mark.parametrize(("bodies", "found"), [
    (None, [0, 1, 2]), ("ball*", [0, 1]), (["box", "ball[2]"], [1, 2]),
    (["ball1", "ball*"], [0, 1])])
def test_patterns_find_what_moves_freely(bodies: Any, found: list[int]) -> None:
    load = {"type": "drag", "name": "d", "linear": 1} | ({"bodies": bodies} if bodies else {})
    assert [body for _, body in _mechanism(load).loaded] == found


def test_an_assembly_takes_its_loads_along() -> None:
    part = {"type": "assembly", "name": "a", "at": [1, 2], "angle": "90 deg", "scale": 2,
            "mirror": "left-right", "bodies": BALLS, "loads": [
                {"type": "law", "name": "f", "bodies": "*", "at": [0.1, 0.2],
                 "force": ["=-x", "=y"]},
                {"type": "drag", "name": "d", "bodies": ["ball1"], "linear": 1, "flow": [3, 0]},
                {"type": "buoyancy", "name": "w", "bodies": "ball?", "level": 0.5}]}
    other = {"name": "other", "mass": 1, "shapes": [{"type": "circle", "radius": 0.1}]}
    made = expand(load_scene({"gravity": [0, -9.81], "bodies": [other], "parts": [part]}))
    law, drag, water = made.loads
    assert isinstance(law, LawLoad)
    assert isinstance(drag, DragLoad)
    assert isinstance(water, BuoyancyLoad)
    assert [(load.name, load.bodies) for load in made.loads] == [
        ("a.f", ("a.*",)), ("a.d", ("a.ball1",)), ("a.w", ("a.ball?",))]
    assert law.at == (-0.2, 0.4)
    assert law.force == ("=-x", "=y")
    assert (drag.flow, water.level) == ((3.0, 0.0), 0.5)
    on = [(made.loads[i].name, made.bodies[body].name) for i, body in made.loaded]
    assert on == [("a.f", "a.ball1"), ("a.f", "a.ball2"), ("a.f", "a.box"), ("a.d", "a.ball1"),
                  ("a.w", "a.ball1"), ("a.w", "a.ball2")]
