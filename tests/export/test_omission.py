"""Leaving elements out: what goes along, and names that fit nothing."""

from __future__ import annotations

import pytest

import sandbox
from sandbox.errors import SceneError
from sandbox.export.omission import leave_out, needs
from sandbox.scene.elements.bodies import Material
from sandbox.scene.mechanism import Mechanism


@pytest.fixture(scope="module")
def finger() -> Mechanism:
    return sandbox.expand(sandbox.load_scene("single_finger"))


def test_all_that_hangs_on_a_body_goes_with_it(finger: Mechanism) -> None:
    """Its hinge, the spring to its neighbour, the tendon through it, the pull on that tendon."""
    left, gone = leave_out(finger, ["finger.distal"])
    assert gone == ("finger.distal", "finger.dip", "finger.dip_spring", "finger.tendon",
                    "actuator")
    assert set(needs(left)).isdisjoint(gone)
    assert len(needs(left)) + len(gone) == len(needs(finger))


def test_a_rotary_spring_and_a_torque_go_with_their_hinge() -> None:
    mechanism = Mechanism.model_validate({
        "bodies": [{"name": "frame", "motion": "fixed"},
                   {"name": "arm", "mass": 0.1, "inertia": 1e-4}],
        "joints": [{"type": "pin", "name": "hinge", "a": "frame", "b": "arm", "on_b": (0, 0)}],
        "springs": [{"type": "rotary", "name": "spring", "joint": "hinge", "stiffness": 1}],
        "drives": [{"type": "torque", "name": "motor", "joint": "hinge", "value": 1},
                   {"type": "brake", "name": "brake", "joint": "hinge", "value": 1},
                   {"type": "motor", "name": "speed", "joint": "hinge", "value": 1, "torque": 1},
                   {"type": "stiffness", "name": "k", "spring": "spring"}]})
    assert leave_out(mechanism, ["hin*"])[1] == (
        "hinge", "spring", "motor", "brake", "speed", "k")
    assert leave_out(mechanism, ["spring"])[1] == ("spring", "k")


def test_a_material_loses_its_bounce_only() -> None:
    mechanism = Mechanism.model_validate(
        {"materials": {"rubber": {"friction": 0.7, "restitution": 0.5}}})
    left, gone = leave_out(mechanism, ["materials.rubber"])
    assert gone == ("materials.rubber",)
    assert left.materials["rubber"] == Material(friction=0.7, restitution=0.0)


def test_names_that_fit_nothing_are_all_told(finger: Mechanism) -> None:
    with pytest.raises(SceneError) as caught:
        leave_out(finger, ["finger.tendn", "disc", "x*"])
    assert [problem.hint for problem in caught.value.problems] == ["'finger.tendon'", ""]
    assert "x*" in caught.value.problems[1].message
