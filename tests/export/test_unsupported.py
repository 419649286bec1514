"""What has no counterpart is named, and only that."""

from __future__ import annotations

from typing import Any

import pytest

import sandbox
from sandbox.errors import SceneError
from sandbox.export import export_mechanism
from sandbox.scene.library import shipped_scenes
from sandbox.scene.mechanism import Mechanism

FRAME = {"name": "frame", "motion": "fixed"}
BLOCK = {"name": "block", "at": (0.0, -0.2), "mass": 0.1,
         "shapes": [{"type": "circle", "radius": 0.01}]}
HINGE = {"type": "pin", "name": "hinge", "a": "frame", "b": "block", "on_b": (0, 0)}
COIL = {"type": "rotary", "name": "coil", "joint": "hinge", "stiffness": 1.0}
GROOVE = {"type": "slot", "a": "frame", "b": "block", "start": (0, -0.2), "end": (0.1, -0.2)}


def named(**scene: Any) -> list[str]:
    """The elements that an export refuses; empty if it doesn't."""
    mechanism = Mechanism.model_validate({"bodies": [FRAME, BLOCK], **scene})
    try:
        export_mechanism(mechanism)
    except SceneError as error:
        return [problem.path for problem in error.problems]
    return []


def cord(
    *guides: tuple[str, float, float, float], side: str = "left", **keys: Any,
) -> list[dict[str, Any]]:
    return [{"name": "cord", "guides": [
        {"body": body, "at": (x, y), "radius": r, "side": side, **keys}
        for body, x, y, r in guides]}]


@pytest.mark.parametrize(("scene", "names"), [
    ({"bodies": [FRAME, {"name": "cam", "motion": "scheduled", "path": {"x": "=0.1 * t"}}]},
     ["cam"]),
    ({"drives": [{"type": "radius", "name": "swell", "body": "block", "value": 0.02}]},
     ["swell"]),
    ({"joints": [HINGE], "springs": [COIL],
      "drives": [{"type": "stiffness", "name": "k", "spring": "coil"}]}, ["k"]),
    ({"joints": [HINGE], "drives": [
        {"type": "motor", "name": "m", "joint": "hinge", "value": 1.0, "torque": 1.0}]}, ["m"]),
    ({"joints": [HINGE], "drives": [
        {"type": "brake", "name": "b", "joint": "hinge", "value": {"to": 1.0, "over": 1.0}}]},
     ["b"]),
    ({"joints": [HINGE], "drives": [
        {"type": "brake", "name": "b", "joint": "hinge", "value": 1.0}]}, []),
    ({"joints": [{"name": "one", **GROOVE}, {"name": "two", **GROOVE}]}, ["two"]),
    ({"tendons": cord(("frame", 0, 0, 0), ("block", 0, 0, 0.01))}, ["cord"]),
    ({"tendons": cord(("frame", 0, 0, 0), ("block", 0, 0, 0.01), ("frame", 0.1, 0, 0))}, []),
    ({"tendons": cord(("frame", 0, 0, 0), ("block", 0, 0, 0.01), ("frame", 0.1, 0, 0.01),
                      ("frame", 0.2, 0, 0))}, ["cord"]),
    ({"tendons": cord(("frame", 0, 0, 0), ("frame", 0.01, 0, 0.02), ("block", 0, 0, 0))},
     ["cord"]),
    ({"tendons": cord(("frame", 0, 0, 0), ("block", 0, 0, 0.01), ("frame", 0.1, 0, 0),
                      side="right", begins="on")}, ["cord"]),
    ({"tendons": cord(("frame", 0, 0, 0), ("block", 0, 0, 0.01), ("frame", 0.1, 0, 0),
                      side="right")}, []),
    ({"materials": {"ball": {"restitution": 0.5}, "floor": {"restitution": 0.5}},
      "bodies": [{"name": "ground", "motion": "fixed", "material": "floor",
                  "shapes": [{"type": "circle", "radius": 0.1}]}, BLOCK | {"material": "ball"}]},
     ["materials.ball", "materials.floor"]),
    ({"materials": {"ball": {"restitution": 0.5}}, "bodies": [FRAME, BLOCK | {"material": "ball"}]},
     []),
])
def test_exactly_these_elements_are_named(scene: dict[str, Any], names: list[str]) -> None:
    assert named(**scene) == names


def test_every_problem_says_how_to_go_on() -> None:
    mechanism = sandbox.expand(sandbox.load_scene("pulley_differential"))
    with pytest.raises(SceneError) as caught:
        export_mechanism(mechanism)
    problems = caught.value.problems
    assert [problem.path for problem in problems] == [
        "tree.string1", "tree.string2", "tree.string3", "tree.string4", "tree.link1", "tree.link2"]
    for problem in problems:
        assert f"--without {problem.path} " in problem.message
    export = export_mechanism(mechanism, without=[problem.path for problem in problems])
    assert export.left_out == tuple(problem.path for problem in problems)


@pytest.mark.nightly
def test_the_shipped_scenes_that_can_be_written_are_these() -> None:
    refused = {}
    for name, path in shipped_scenes().items():
        try:
            export_mechanism(sandbox.expand(sandbox.load_scene(path)))
        except SceneError as error:
            refused[name] = {problem.message.partition(",")[0] for problem in error.problems}
    assert {name for name in refused if "wound" in str(refused[name])} >= {"pulley_differential"}
    assert {name for name in refused if "radius" in str(refused[name])} >= {"shape_change"}
    assert not {"single_finger", "rocker_differential", "rope_differential",
                "adaptive_grasp"} & set(refused)
