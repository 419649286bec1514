"""What crosses a hinge, against where the points of a mechanism are in the world."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.scene.crossings import Fingers
from sandbox.scene.mechanism import Mechanism

A_AT, A_TURN = np.array([0.13, -0.07]), 0.6
HINGE_A, HINGE_B = np.array([0.04, 0.01]), np.array([-0.006, 0.002])
GUIDE_A, GUIDE_B = np.array([0.028, -0.005]), np.array([0.009, -0.004])
SPRING_A, SPRING_B = np.array([0.031, 0.017]), np.array([0.004, 0.012])


def turn(angle: float, point: np.ndarray) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])


def bodies_at(angle: float, zero: float, sense: float) -> tuple[tuple[np.ndarray, float], ...]:
    """Poses of the two with the hinge at ``angle`` = sense (turn of b - turn of a) - zero."""
    b_turn = A_TURN + sense * (angle + zero)
    hinge = A_AT + turn(A_TURN, HINGE_A)
    return (A_AT, A_TURN), (hinge - turn(b_turn, HINGE_B), b_turn)


def hinged(zero: float, positive: str, start: float, **spring: float) -> Mechanism:
    sense = 1.0 if positive == "counterclockwise" else -1.0
    (a_at, a_turn), (b_at, b_turn) = bodies_at(start, zero, sense)
    return Mechanism.model_validate({
        "bodies": [{"name": "a", "motion": "fixed", "at": a_at, "angle": a_turn},
                   {"name": "b", "mass": 0.01, "inertia": 1e-6, "at": b_at, "angle": b_turn}],
        "joints": [{"type": "pin", "name": "hinge", "a": "a", "b": "b", "on_a": HINGE_A,
                    "on_b": HINGE_B, "zero": zero, "positive": positive}],
        "springs": [{"type": "linear", "name": "band", "a": "b", "b": "a", "on_a": SPRING_B,
                     "on_b": SPRING_A, "stiffness": 100, **spring}],
        "tendons": [{"name": "cord", "guides": [{"body": "a", "at": GUIDE_A},
                                                {"body": "b", "at": GUIDE_B}]}],
        "drives": [{"type": "stiffness", "name": "k", "spring": "band"}],
        "controllers": [{"type": "equilibrium", "name": "law", "tendon": "cord",
                         "joints": ["hinge"], "writes": ["k"], "targets": [0.1], "kp": [1.0]}]})


@pytest.mark.parametrize("positive", ["clockwise", "counterclockwise"])
@pytest.mark.parametrize("zero", [0.35])
def test_points_across_a_hinge_are_as_far_apart_as_in_the_world(zero, positive):
    """Before and after, turned clockwise by the rotation, as section 4 has it: for any rotation."""
    machine = hinged(zero, positive, start=0.2)
    sense = 1.0 if positive == "counterclockwise" else -1.0
    crossing, = Fingers(machine).crossings(machine.controllers[0])
    seen = ((crossing.guide_before, crossing.guide_after, GUIDE_A, GUIDE_B),
            (crossing.spring_before, crossing.spring_after, SPRING_A, SPRING_B))
    for rotation in (-0.4, 0.0, 0.3, 1.1):
        (a_at, a_turn), (b_at, b_turn) = bodies_at(rotation, zero, sense)
        for before, after, on_a, on_b in seen:
            distance = np.linalg.norm(a_at + turn(a_turn, on_a) - b_at - turn(b_turn, on_b))
            assert np.linalg.norm(np.array(before) - turn(-rotation, np.array(after))) == (
                pytest.approx(distance, rel=1e-12))


def test_a_spring_without_a_rest_length_is_slack_as_the_scene_begins():
    machine = hinged(0.35, "clockwise", start=0.2)
    (a_at, a_turn), (b_at, b_turn) = bodies_at(0.2, 0.35, -1.0)
    length = np.linalg.norm(a_at + turn(a_turn, SPRING_A) - b_at - turn(b_turn, SPRING_B))
    crossing, = Fingers(machine).crossings(machine.controllers[0])
    assert crossing.rest == pytest.approx(length, rel=1e-12)
    given = hinged(0.35, "clockwise", start=0.2, rest_length=0.011)
    assert Fingers(given).crossings(given.controllers[0])[0].rest == 0.011
