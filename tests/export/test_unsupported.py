"""What has no counterpart is named, and only that; leaving elements out."""

from __future__ import annotations

from typing import Any

import pytest

import sandbox
from sandbox.elements.drives import DriveSpec
from sandbox.elements.registry import KINDS
from sandbox.engine.pymunk_draft import to_pymunk
from sandbox.errors import SceneError
from sandbox.export import export_mechanism
from sandbox.export.mjcf import write_mjcf
from sandbox.export.selection import ACTING, leave_out
from sandbox.scene.bodies import Material
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


def cable(
    *guides: tuple[str, float, float, float], side: str = "left", **keys: Any,
) -> list[dict[str, Any]]:
    return [{"name": "cord", "guides": [
        {"body": body, "at": (x, y), "radius": r, "side": side, **keys}
        for body, x, y, r in guides]}]


@pytest.mark.parametrize(("scene", "names"), [
    ({"bodies": [FRAME, {"name": "cam", "motion": "scheduled", "path": {"x": "=0.1 * t"}}]},
     ["cam"]),
    ({"joints": [HINGE], "springs": [COIL],
      "drives": [{"type": "stiffness", "name": "k", "spring": "coil"}]}, ["k"]),
    ({"joints": [HINGE], "drives": [
        {"type": "brake", "name": "b", "joint": "hinge", "value": {"to": 1.0, "over": 1.0}}]},
     ["b"]),
    ({"joints": [HINGE], "drives": [
        {"type": "brake", "name": "b", "joint": "hinge", "value": 1.0}]}, []),
    ({"joints": [{"name": "one", **GROOVE}, {"name": "two", **GROOVE}]}, ["two"]),
    ({"tendons": cable(("frame", 0, 0, 0), ("block", 0, 0, 0.01))}, ["cord"]),
    ({"tendons": cable(("frame", 0, 0, 0), ("block", 0, 0, 0.01), ("frame", 0.1, 0, 0))}, []),
    ({"tendons": cable(("frame", 0, 0, 0), ("block", 0, 0, 0.01), ("frame", 0.1, 0, 0.01),
                      ("frame", 0.2, 0, 0))}, ["cord"]),
    ({"tendons": cable(("frame", 0, 0, 0), ("block", 0, 0, 0.01), ("frame", 0.1, 0, 0),
                      side="right", begins="on")}, ["cord"]),
    ({"materials": {"ball": {"restitution": 0.5}, "floor": {"restitution": 0.5}},
      "bodies": [{"name": "ground", "motion": "fixed", "material": "floor",
                  "shapes": [{"type": "circle", "radius": 0.1}]}, BLOCK | {"material": "ball"}]},
     ["materials.ball", "materials.floor"]),
    ({"materials": {"rough": {"static": 1.5}, "ball": {"static": 1.5}},
      "contacts": [{"between": ["block", "*"], "static": 2}],
      "bodies": [{"name": "ground", "motion": "fixed", "material": "rough",
                  "shapes": [{"type": "circle", "radius": 0.1}]},
                 BLOCK | {"shapes": [{"type": "circle", "radius": 0.1}]}]},
     ["materials.rough", "contacts.block/*"]),
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


# --- leaving elements out


@pytest.fixture(scope="module")
def finger() -> Mechanism:
    return sandbox.expand(sandbox.load_scene("single_finger"))


def test_all_that_hangs_on_a_body_goes_with_it(finger: Mechanism) -> None:
    """Its hinge, the spring to its neighbour, the tendon through it, the pull on that tendon."""
    left, gone = leave_out(finger, ["finger.distal"])
    assert gone == ("finger.distal", "finger.dip", "finger.dip_spring", "finger.tendon", "actuator")
    before, after = ({element.name for kind in ACTING for element in getattr(mechanism, kind)}
                     for mechanism in (finger, left))
    assert before - after == set(gone)


def test_a_material_loses_its_bounce_and_its_static_friction_only() -> None:
    mechanism = Mechanism.model_validate(
        {"materials": {"rubber": {"friction": 0.7, "static": 1.5, "restitution": 0.5}},
         "contacts": [{"between": ["a", "b*"], "friction": 0.2, "static": 1.5}]})
    left, gone = leave_out(mechanism, ["materials.rubber", "contacts.a/b*"])
    assert gone == ("materials.rubber", "contacts.a/b*")
    assert left.materials["rubber"] == Material(friction=0.7, restitution=0.0)
    assert left.contacts[0].static == 1.0


def test_names_that_fit_nothing_are_all_told(finger: Mechanism) -> None:
    with pytest.raises(SceneError) as caught:
        leave_out(finger, ["finger.tendn", "disc", "x*"])
    assert [problem.hint for problem in caught.value.problems] == ["'finger.tendon'", ""]
    assert "x*" in caught.value.problems[1].message


@pytest.mark.parametrize("write", [write_mjcf, to_pymunk])
@pytest.mark.parametrize(("scene", "name"), [("curved_slot", "track"),
                                             ("soft_grasp", "materials.skin")])
def test_paths_and_soft_skin_have_no_counterpart(write, scene, name) -> None:
    with pytest.raises(SceneError) as caught:
        write(sandbox.expand(sandbox.load_scene(scene)))
    assert name in {problem.path for problem in caught.value.problems}
    assert {problem.code for problem in caught.value.problems} == {"no-counterpart"}


def test_every_drive_with_a_counterpart_is_written() -> None:
    drives = KINDS["drives"]
    assert [tag for tag, kind in drives.items() if issubclass(kind, DriveSpec)
            and bool(kind.facts.mujoco) == (kind.write_mujoco is not DriveSpec.write_mujoco)] == []
