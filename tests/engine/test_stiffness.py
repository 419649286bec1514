"""Springs that are too stiff for the step are taken at its end: stable, damped, exact at rest."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.engine.stiffness import responses, too_stiff
from sandbox.model.compile import compile_mechanism
from sandbox.scene.mechanism import Mechanism

from .machines import G, H, fixed, mechanism

INERTIA, M, D = 2e-6, 0.01, 0.03
"""Of a body, and of its centre of mass from its hinge."""


def flap(k: float, *, duration: float = 0.05, **more: Any) -> Mechanism:
    """A body on a hinge to the ground, turned by 0.1 rad out of its spring's rest."""
    bodies = [fixed("ground"), {"name": "flap", "mass": M, "inertia": INERTIA, "centre": (D, 0.0),
                                "angle": 0.1}]
    spring = {"type": "rotary", "name": "s", "joint": "hinge", "stiffness": k}
    more.setdefault("springs", [spring])
    return mechanism(duration=duration, bodies=bodies, run={"sample_rate": 1 / H}, joints=[
        {"type": "pin", "name": "hinge", "a": "ground", "b": "flap", "on_b": (0, 0)}], **more)


ABOUT = INERTIA + M * D**2
"""Inertia about the hinge."""


def test_a_rotary_spring_is_at_the_step_s_end_from_h_w_of_1_on():
    for pace, stiff in ((0.99, False), (1.01, True)):
        model = compile_mechanism(flap(ABOUT * (pace / H) ** 2))
        assert too_stiff(model, H).tolist() == [stiff]
    assert responses(model) == pytest.approx([1 / ABOUT])


def test_between_two_bodies_that_move_both_count():
    scene = {"bodies": [{"name": "a", "mass": 1, "inertia": 0.1}, {"name": "b", "mass": 2,
                                                                   "inertia": 0.3, "at": (1, 0)}],
             "joints": [{"type": "pin", "name": "hinge", "a": "a", "b": "b", "at": (0.5, 0)}],
             "springs": [{"type": "rotary", "name": "r", "joint": "hinge", "stiffness": 1},
                         {"type": "linear", "name": "l", "a": "a", "b": "b", "on_a": (0, 0.2),
                          "on_b": (0.1, 0), "stiffness": 1}]}
    del scene["joints"][0]["at"]
    scene["joints"][0] |= {"on_a": (0.5, 0), "on_b": (-0.5, 0)}
    found = responses(compile_mechanism(Mechanism.model_validate(scene)))
    assert found == pytest.approx([1 / 0.1 + 1 / 0.3, 1 + 0.04 / 0.1 + 1 / 2 + 0.01 / 0.3])


@pytest.mark.parametrize("pace", [3.0, 30.0, 3e3])
def test_it_does_not_blow_up_and_shrinks_as_backward_euler_does(pace):
    """Of its amplitude 1 / sqrt(1 + (h w)^2) is left by a step; 10 are given it to get going."""
    run = simulate(flap(ABOUT * (pace / H) ** 2))
    swing = np.abs(run["hinge.angle"])
    assert swing.max() < 0.11
    assert swing[40:].max() < 0.1 / math.hypot(1, pace) ** 30 + 1e-12


def test_a_soft_one_rings_on():
    swing = np.abs(simulate(flap(ABOUT * (0.2 / H) ** 2))["hinge.angle"])
    assert swing[-30:].max() == pytest.approx(0.1, rel=0.02)


def test_what_it_carries_at_rest_is_recorded():
    """A weight at 30 mm: m g d cos(angle), whatever the stiffness."""
    run = simulate(flap(ABOUT * (30 / H) ** 2, gravity=(0.0, -G)))
    angle = run["hinge.angle"][-1]
    assert run["s.torque"][-1] == pytest.approx(-M * G * D * math.cos(angle), rel=1e-9)
    assert angle == pytest.approx(-M * G * D / (ABOUT * (30 / H) ** 2), rel=1e-3)


def test_one_that_a_drive_lets_go_carries_nothing():
    """Its stiffness falls to 0 and it is free: a constant rate without gravity."""
    k = ABOUT * (3 / H) ** 2
    run = simulate(flap(0.0, duration=0.06, gravity=(0.0, -G), drives=[
        {"type": "stiffness", "name": "drive", "spring": "s",
         "value": {"table": [[0, k], [0.03, k], [0.031, 0], [1, 0]]}}],
        springs=[{"type": "rotary", "name": "s", "joint": "hinge", "stiffness": k}]))
    late = run.time > 0.032
    assert np.isfinite(run["hinge.angle"]).all()
    assert run["s.torque"][late] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(np.diff(run["hinge.rate"][late])[:5] / H,
                               -M * G * D / ABOUT, rtol=1e-2)
