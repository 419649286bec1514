"""The written model, element by element; no MuJoCo needed to read it."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any

import pytest

import sandbox
from sandbox.engine.world import make_filters
from sandbox.errors import SceneError
from sandbox.export import Export, export_mechanism
from sandbox.export.selection import contact_pairs
from sandbox.model.compile import compile_mechanism
from sandbox.scene.mechanism import Mechanism

FRAME = {"name": "frame", "motion": "fixed"}
LOAD = {"name": "load", "at": (0.1, 0.0), "mass": 0.2, "inertia": 1e-4}


def write(**scene: Any) -> tuple[ET.Element, Export]:
    mechanism = Mechanism.model_validate({"bodies": [FRAME, LOAD], **scene})
    export = export_mechanism(mechanism)
    return ET.fromstring(export.text), export


def one(root: ET.Element, path: str) -> dict[str, str]:
    found = root.findall(path)
    assert len(found) == 1, path
    return found[0].attrib


def has(found: dict[str, str], **wanted: str) -> bool:
    return {key: found.get(key) for key in wanted} == wanted


def cable(**more: Any) -> dict[str, Any]:
    return {"name": "cord", "guides": [{"body": "frame"}, {"body": "load"}], **more}


def test_an_elastic_tendon_only_pulls_and_takes_its_step() -> None:
    """omega^2 = k / m: 0.2 / sqrt(9e4 / 0.2) is 0.298 ms, below the scene's 0.5 ms."""
    root, export = write(tendons=[cable(stiffness=9e4, rest_length=0.08)])
    assert has(one(root, "tendon/spatial"), stiffness="90000", springlength="0 0.08")
    assert float(one(root, "option")["timestep"]) == pytest.approx(0.2 / (9e4 / 0.2) ** 0.5)
    assert "time step" in export.notes[-1]


def test_a_damped_tendon_is_an_actuator_that_never_pushes() -> None:
    root, _ = write(tendons=[cable(stiffness=100.0, damping=2.0)])
    assert has(one(root, "actuator/general"), gear="-1", biasprm="-10 -100 -2",
               forcerange="0 1000000")
    assert one(root, "keyframe/key")["ctrl"] == "0"


def test_a_brake_is_the_friction_of_its_hinge() -> None:
    """No actuator; one that lets go is nothing at all."""
    hinge = {"type": "pin", "name": "hinge", "a": "frame", "b": "load", "on_b": (0, 0)}
    brake = {"type": "brake", "name": "brake", "joint": "hinge"}
    root, export = write(joints=[hinge], drives=[{"value": 0.4, **brake}])
    assert has(one(root, "worldbody//joint"), frictionloss="0.4")
    assert root.findall("actuator/*") == []
    assert export.notes == ()
    root, _ = write(joints=[hinge], drives=[{"value": 0.0, **brake}])
    assert "frictionloss" not in one(root, "worldbody//joint")


def test_controllers_and_events_are_told_as_lost() -> None:
    _, export = write(
        drives=[{"type": "force", "name": "f", "body": "load", "direction": (1, 0), "value": 1}],
        controllers=[{"type": "schedule", "name": "c", "writes": "f", "value": 2}],
        events=[{"name": "e", "at": 0.1, "set": {"c.active": 0}}])
    assert [note.partition(":")[0] for note in export.notes] == ["c", "e"]


def test_a_pin_that_closes_a_loop_acts_on_the_sum_of_other_hinges() -> None:
    """d's angle is -(b - a) = c - b here, 0.3 at the start; its numbers move by that offset."""
    def pin(name: str, a: str, b: str, **more: Any) -> dict[str, Any]:
        return {"type": "pin", "name": name, "a": a, "b": b, "on_b": (0, 0), **more}

    root, _ = write(
        bodies=[FRAME, LOAD | {"at": (0, 0)}, LOAD | {"name": "other", "at": (0, 0),
                                                      "angle": -0.3}],
        joints=[pin("b", "frame", "other"), pin("c", "frame", "load"),
                pin("d", "load", "other", positive="clockwise", limits=(-1, 2), zero=0.1,
                    damping=0.5)],
        springs=[{"type": "rotary", "name": "s", "joint": "d", "stiffness": 2,
                  "rest_angle": 0.4}],
        drives=[{"type": "torque", "name": "m", "joint": "d", "value": 1}])
    assert has(one(root, "equality/connect"), name="d", site1="d.a", site2="d.b")
    # angle = -b + c - 0.1: zero goes into the offset
    assert has(one(root, "tendon/fixed"), name="d", stiffness="2", springlength="0.5",
               damping="0.5", range="-0.9 2.1")
    assert {j.attrib["joint"]: j.attrib["coef"] for j in root.findall("tendon/fixed/joint")} == {
        "b": "-1", "c": "1"}
    assert has(one(root, "actuator/motor"), tendon="d")


# --- springs with laws


def spring_text(**spring: Any) -> str:
    ball = {"name": "m", "at": [1.1, 0], "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}
    scene = {"bodies": [{"name": "frame", "motion": "fixed"}, ball], "springs": [
        {"type": "linear", "name": "s", "a": "frame", "b": "m", "rest_length": 1, **spring}]}
    return export_mechanism(sandbox.expand(sandbox.load_scene(scene))).text


@pytest.mark.parametrize(("only", "free"), [("pull", "0 1"), ("push", "1 1000000")])
def test_a_one_sided_spring_has_lengths_at_which_it_gives_no_force(only: str, free: str) -> None:
    assert f'springlength="{free}"' in spring_text(stiffness=300, only=only)


@pytest.mark.parametrize(("given", "what"), [
    ({"force": "=stretch ** 3"}, "a spring with a force law"),
    ({"stiffness": 300, "only": "pull", "damping": 1}, "a damper that acts on one side only"),
])
def test_others_have_no_counterpart(given: dict[str, Any], what: str) -> None:
    with pytest.raises(SceneError, match=what):
        spring_text(**given)


# --- contact pairs


DISC = {"mass": 0.1, "shapes": [{"type": "circle", "radius": 0.01}]}
RULES = Mechanism.model_validate({
    "materials": {"rough": {"friction": 0.9}, "smooth": {"friction": 0.1}},
    "bodies": [{"name": f"hand.f{i}", "material": "rough", **DISC} for i in range(4)]
    + [{"name": "cup", "material": "smooth", **DISC}, {"name": "bare", "mass": 1, "inertia": 1},
       {"name": "wall", "motion": "fixed", "shapes": DISC["shapes"]},
       {"name": "floor", "motion": "fixed", "shapes": DISC["shapes"]}],
    "joints": [{"type": "pin", "name": "p", "a": "hand.f3", "b": "cup", "on_b": (0, 0)},
               {"type": "pin", "name": "q", "a": "hand.f2", "b": "cup", "on_b": (0, 0),
                "collide": True}],
    "contacts": [{"between": ("hand.*", "hand.*"), "collide": False},
                 {"between": ("hand.f1", "hand.f0"), "friction": 0.2},
                 {"between": ("cup", "hand.*"), "friction": 0.3},
                 {"between": ("cup", "wall"), "collide": False},
                 {"between": ("*", "cup"), "collide": True}]})


@pytest.mark.parametrize("name", ["RULES", "four_finger_opposed", "sliding_pulleys", "dominoes"])
def test_they_are_those_of_the_engine(name: str) -> None:
    mechanism = RULES if name == "RULES" else sandbox.expand(sandbox.load_scene(name))
    model = compile_mechanism(mechanism)
    filters = make_filters(model)
    found = {(a, b): friction for a, b, friction in contact_pairs(model)}
    solid = [i for i, body in enumerate(mechanism.bodies) if body.shapes]
    wanted = {(i, j) for i in solid for j in solid if i < j and filters.allowed[i, j]}
    assert found == {pair: pytest.approx(filters.friction[pair], rel=1e-15) for pair in wanted}
