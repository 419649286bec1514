"""References: each name of a mechanism leads somewhere, and to one thing only."""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.scene.check.references import check_references
from sandbox.scene.mechanism import Mechanism

DISC = {"name": "disc", "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}
WALL = {"name": "wall", "motion": "fixed", "shapes": [{"type": "box", "size": [1, 1]}]}
PIN = {"type": "pin", "name": "hinge", "a": "wall", "b": "disc", "on_a": [0, 0]}
COIL = {"type": "rotary", "name": "coil", "joint": "hinge", "stiffness": 1}
CORD = {"name": "cord", "guides": [{"body": "wall"}, {"body": "disc"}]}


def _built(**lists: Any) -> Mechanism:
    return Mechanism.model_validate({
        "bodies": [DISC, WALL], "joints": [PIN], "springs": [COIL], "tendons": [CORD], **lists})


def _check(**lists: Any) -> list[tuple[str, str]]:
    return [(problem.path, problem.message) for problem in check_references(_built(**lists))]


@pytest.mark.parametrize(("kind", "one", "path"), [
    ("pull", {"tendon": "cord"}, "$.drives[1].tendon"), ("radius", {"body": "disc"}, "$.drives[1]"),
    ("stiffness", {"spring": "coil"}, "$.drives[1].spring"),
    ("brake", {"joint": "hinge"}, "$.drives[1].joint"),
    ("motor", {"joint": "hinge", "torque": 1}, "$.drives[1].joint"),
])
def test_two_drives_of_one_thing(kind: str, one: dict[str, str], path: str) -> None:
    drives = [{"type": kind, "name": name, "value": 1, **one} for name in ("d", "e")]
    ((found, message),) = _check(drives=drives)
    assert found == path
    assert message.endswith("is set already, by 'd'")


@pytest.mark.parametrize(("type_", "on", "twin"), [
    ("servo", "piston", "length"), ("motor", "piston", "extend"), ("torque", "piston", "push"),
    ("length", "hinge", "servo"), ("extend", "hinge", "motor"), ("push", "hinge", "torque"),
    ("brake", "piston", "")])
def test_what_acts_on_a_hinge_and_not_on_an_actuator_is_told_its_twin(
        type_: str, on: str, twin: str) -> None:
    drive = {"type": type_, "name": "d", "joint": on, "value": 0.1}
    drive |= {"torque": 1} if type_ in ("servo", "motor") else {}
    drive |= {"force": 1} if type_ in ("length", "extend") else {}
    piston = {"type": "actuator", "name": "piston", "a": "wall", "b": "disc", "on_a": (0, -1)}
    (problem,) = check_references(_built(joints=[PIN, piston], drives=[drive]))
    assert problem.path == "$.drives[0].joint"
    assert problem.allowed == ("'hinge'" if on == "piston" else "'piston'")
    assert (f"'{twin}'" in problem.hint) if twin else not problem.hint


def test_a_joint_needs_a_body_that_moves() -> None:
    """Two fixed bodies are joined already; pymunk would refuse them with an assertion."""
    found = check_references(Mechanism.model_validate({
        "bodies": [{"name": "floor", "motion": "fixed"},
                   {"name": "wall", "motion": "scheduled", "path": {"x": 0.0}}],
        "joints": [{"type": "pin", "name": "p", "a": "floor", "b": "wall", "on_a": [0, 0]}],
    }))
    assert [(problem.path, problem.message) for problem in found] == [
        ("$.joints[0]", "neither 'floor' nor 'wall' can move freely")]
