"""The equilibrium law by hand, and what it takes a finger for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from sandbox.elements.controllers.equilibrium import joint_model
from sandbox.elements.registry import Controller
from sandbox.engine.inspect_control import control_problems
from sandbox.errors import SceneError
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

GUIDES = [[-0.015, -0.005], [0.0225, -0.005], [0.013, -0.005]]
BEFORE, AFTER = [[-0.007, 0.008], [-0.007, 0.01]], [[0.007, 0.008], [0.006, 0.009]]
LENGTHS = [0.045, 0.026]
H = 1e-3
TARGETS = [0.1, 0.2]


def law_spec(**more: Any) -> dict[str, Any]:
    return {"type": "equilibrium", "name": "pose", "tendon": "finger.tendon",
            "joints": ["finger.mcp", "finger.pip"], "writes": ["k1", "k2"], "targets": TARGETS,
            "kp": [1.0, 0.5], **more}


def scene(law: dict[str, Any], **finger: Any) -> dict[str, Any]:
    return {
        "parts": [{"type": "finger", "name": "finger", "lengths": LENGTHS, "radii": [0.008, 0.007],
                   "masses": [0.012, 0.006], "guides": GUIDES,
                   "springs": {"stiffness": 1000, "from": BEFORE, "to": AFTER}, **finger}],
        "drives": [{"type": "pull", "name": "pull", "tendon": "finger", "value": 10},
                   {"type": "stiffness", "name": "k1", "spring": "finger.mcp_spring"},
                   {"type": "stiffness", "name": "k2", "spring": "finger.pip_spring"}],
        "controllers": [law]}


def mechanism(law: dict[str, Any], **finger: Any) -> Mechanism:
    return expand(load_scene(scene(law, **finger)))


def arm(theta: Any) -> np.ndarray:
    return route(GUIDES, LENGTHS).arms(theta)


def moment(theta: Any) -> np.ndarray:
    springs = spring_set(BEFORE, AFTER)
    return springs.elongations(theta) * springs.arms(theta)


@pytest.mark.parametrize("finger", [
    {"angle": 0.7, "at": [0.1, -0.2]}, {"start": [0.3, 0.1]}, {"palm": "above", "angle": -2.0}])
def test_arms_and_moments_are_those_of_the_closed_forms(finger):
    """However the finger lies, mirrored, turned or bent at the start; to rounding."""
    made = mechanism(law_spec(), **finger)
    joints = joint_model(made.controllers[0], made)
    for theta in ([0.0, 0.0], [0.3, 0.5], [1.2, 0.9]):
        assert [j.tendon_arm(a) for j, a in zip(joints, theta, strict=True)] == pytest.approx(
            arm(theta), rel=1e-12)
        assert [j.spring_moment(a) for j, a in zip(joints, theta, strict=True)] == pytest.approx(
            moment(theta), rel=1e-9, abs=1e-18)


def begun(law: dict[str, Any], readings: list[float], inputs: list[float]) -> Any:
    made = mechanism(law)
    ready = made.controllers[0].make_law(made, H)
    ready.begin(readings, TARGETS, inputs)
    return ready


def test_at_the_targets_the_stiffnesses_are_those_of_equilibrium():
    law = begun(law_spec(), [*TARGETS, 0.0, 0.0, 12.0], [1.0, 1.0])
    wanted = law.act(0.0, [*TARGETS, 0.0, 0.0, 12.0], TARGETS, [1.0, 1.0])
    assert wanted == pytest.approx(12.0 * arm(TARGETS) / moment(TARGETS), rel=1e-12)


def test_feedback_is_a_torque_over_the_present_moment():
    law = begun(law_spec(pull=10.0, kd=[0.02, 0.01]), [0.15, 0.18, 0.0, 0.0], [1.0, 1.0])
    at, rate = np.array([0.15, 0.18]), np.array([2.0, -3.0])
    wanted = law.act(0.0, [*at, *rate], TARGETS, [1.0, 1.0])
    torque = np.array([1.0, 0.5]) * (at - TARGETS) + np.array([0.02, 0.01]) * rate
    ahead = 10.0 * arm(TARGETS) / moment(TARGETS)
    assert wanted == pytest.approx(ahead + torque / moment(at), rel=1e-12)


def test_the_reference_rises_and_then_the_integral_begins():
    law = begun(law_spec(pull=10.0, ki=[30.0, 0.0], rise=2 * H), [0.0, 0.0, 0.0, 0.0], [1.0, 1.0])
    ahead = 10.0 * arm(TARGETS) / moment(TARGETS)
    at = [0.05, 0.2]
    torques = []
    applied = [1.0, 1.0]
    for n in range(5):
        wanted = law.act(n * H, [*at, 0.0, 0.0], TARGETS, applied)
        torques.append((wanted[0] - ahead[0]) * moment(at)[0])
        applied = wanted
    # references 0, 0.05, 0.1, 0.1, 0.1; the integral counts from the third act on
    assert torques == pytest.approx(
        [0.05, 0.0, -0.05, -0.05 - 30 * H * 0.05, -0.05 - 60 * H * 0.05], abs=1e-12)


def test_the_integral_is_held_while_the_drive_is_cut():
    law = begun(law_spec(pull=10.0, ki=[30.0, 30.0]), [0.15, 0.3, 0.0, 0.0], [1.0, 1.0])
    first = law.act(0.0, [0.15, 0.3, 0.0, 0.0], TARGETS, [1.0, 1.0])
    held = law.act(H, [0.15, 0.3, 0.0, 0.0], TARGETS, [first[0] - 5.0, first[1]])
    assert held[0] == first[0]
    assert held[1] == pytest.approx(first[1] + 30 * H * 0.1 / moment([0.15, 0.3])[1], rel=1e-12)
    # back inside it would go on, and it does so at once where the error has turned
    back = law.act(2 * H, [0.0, 0.3, 0.0, 0.0], TARGETS, [held[0] - 5.0, held[1]])
    assert back[0] < held[0]


@pytest.mark.parametrize("rise", [0.1, 0.0])
def test_a_law_switched_on_late_continues_from_the_drive_values(rise):
    law = begun(law_spec(pull=10.0, active=False, rise=rise, ki=[1.0, 1.0], kd=[0.02, 0.02]),
                [0.05, 0.3, 1.0, -1.0], [3000.0, 700.0])
    assert law.act(0.4, [0.05, 0.3, 1.0, -1.0], TARGETS, [3000.0, 700.0]) == pytest.approx(
        [3000.0, 700.0], rel=1e-12)


@pytest.mark.parametrize("more", [
    {"kp": [1.0]}, {"targets": [0.1]},
    {"geometry": {"lengths": LENGTHS, "guides": GUIDES[:2], "from": BEFORE, "to": AFTER}}])
def test_lists_that_do_not_fit_are_refused(more):
    with pytest.raises(ValidationError):
        TypeAdapter(Controller).validate_python(law_spec(**more))


@pytest.mark.parametrize(("more", "path", "word"), [
    ({"tendon": "finger.cord"}, ".tendon", "no tendon"),
    ({"joints": ["finger.mcp", "finger.hip"]}, ".joints[1]", "no pin joint"),
    ({"writes": ["k2", "k1"]}, ".writes[0]", "across"),
])
def test_wrong_references_are_refused(more, path, word):
    with pytest.raises(SceneError) as caught:
        load_scene(scene(law_spec(**more)))
    assert any(problem.path == f"$.controllers[0]{path}" and word in problem.message
               for problem in caught.value.problems)


def test_a_spring_that_can_hold_nothing_is_refused():
    turned = control_problems(mechanism(law_spec(guard=2 * np.pi)))
    assert {problem.path for problem in turned} == {"$.controllers[0].guard"}
    assert "has no moment" in turned[0].message
    central = {"stiffness": 1000, "from": BEFORE, "to": [[0, 0], AFTER[1]]}
    one = control_problems(mechanism(law_spec(), springs=central))
    assert [problem.path for problem in one] == ["$.controllers[0]"]
    assert control_problems(mechanism(law_spec())) == []
