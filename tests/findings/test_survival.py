"""Which grasp survives: its studies, its closed forms, and what is told of maps."""

import json

import numpy as np
import pytest

import sandbox
from sandbox.findings.survival import KEPT, MAPS, STAYS
from sandbox.mechanics.grasp_state import GraspState, TwoPhalanges, grasp_states
from sandbox.scene.library import shipped_studies
from sandbox.scene.values.expressions import parse_expression
from sandbox.search.closed_form import closed_form
from sandbox.search.criteria import conditions
from sandbox.search.question import asked

DEG = np.pi / 180
FINGER = {"l1": 0.05, "l2": 0.0333, "h1": 0.012, "h2": 0.006, "thick": 0.008, "d": 0.018}


def run(k2, second, mu):
    """The recording of the finger that begins there [mm], [deg]."""
    scene = json.loads(shipped_studies()["ejection"].read_text())["scene"]
    return sandbox.simulate(sandbox.load_scene(scene, overrides={
        "parameters.k2": f"{k2} mm", "parameters.second": f"{second} deg", "parameters.mu": mu}))


def value(text, **more):
    return parse_expression(text).evaluate({**FINGER, **more}, finite=False)


@pytest.mark.parametrize("each", MAPS, ids=lambda each: each.name)
def test_what_is_asked_can_be_asked(each):
    question = asked(str(shipped_studies()[each.study]))
    assert len(question.space.spans) == 2
    assert len(question.space.lists) == 1
    assert len(question.space.over[question.space.lists[0]]) == 3
    assert len(conditions(each.holds, question.kept)) == len(each.holds)
    if each.closed:
        assert closed_form(each.closed, question).names.keys() >= {"k2", "second", "mu"}


def test_without_friction_the_closed_form_is_the_grasp_state_plane():
    finger = TwoPhalanges((FINGER["l1"], FINGER["l2"]),
                          lambda theta: np.broadcast_to([0.12, 0.06], theta.shape),
                          (0.0, 0.0), (90 * DEG, 100 * DEG), apart=FINGER["d"])
    second, k2 = np.meshgrid(np.arange(3.5, 80, 3) * DEG, np.arange(2.3, 33, 1.5) * 1e-3)
    plane = grasp_states(finger, theta_1=40 * DEG, theta_2=second, k_1=0.025, k_2=k2)
    assert ((value(STAYS, k2=k2, second=second, mu=0.0) > 0)
            == (plane.state == GraspState.STABLE)).all()
    assert ((value(KEPT, k2=k2, second=second, mu=0.0) > 0)
            == (plane.state != GraspState.EJECTS)).all()


@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_the_pose_stays_from_the_curve_on(mu):
    second = 60 * DEG  # X = 1/2: l1 (cos - mu sin) - mu s
    edge = 1e3 * (0.05 * (np.cos(second) - mu * np.sin(second)) - mu * 0.008)
    for k2, stays in ((edge - 1.0, False), (edge + 1.0, True)):
        moved = abs(run(k2, 60, mu)["pip.angle"][-1] - second)
        assert (moved < 0.2 * DEG) == stays
        assert (value(STAYS, k2=1e-3 * k2, second=second, mu=mu) > 0) == stays


def test_the_peg_carries_what_moments_leave():
    held = run(30, 60, 0)  # (tau_1 - tau_2 / k_2 (k_2 + l_1 cos)) / k_1, in N mm and mm
    assert held["proximal/peg.normal"][-1] == pytest.approx((120 - 2 * (30 + 25)) / 25, rel=1e-3)


@pytest.mark.parametrize(("k2", "kept"), [(15, True), (27, False)])
def test_a_finger_ejects_beyond_the_curve_only(k2, kept):
    last = run(k2, 15, 0)
    angle, (x, y) = last["distal.angle"][-1], (
        last[f"disc.{way}"][-1] - last[f"distal.{way}"][-1] for way in "xy")
    reach = x * np.cos(angle) + y * np.sin(angle)
    assert (reach < FINGER["l2"]) == kept
    assert (last.time[-1] > 1.1) == kept
    assert (value(KEPT, k2=1e-3 * k2, second=15 * DEG, mu=0.0) > 0) == kept
