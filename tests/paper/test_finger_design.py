"""The linear-quadratic design, and that the shipped scene carries it."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.paper.finger_design import PULL, WEIGHTS, lqr
from sandbox.paper.finger_plant import TARGET, Plant
from sandbox.scene.elements.controllers import StateFeedbackController
from sandbox.scene.expand import expand
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.load import load_scene


def test_the_shipped_gains_are_the_design():
    """Five digits are shipped."""
    mechanism = expand(load_scene(shipped_scenes()["finger_lqr_control"]))
    (law,) = mechanism.controllers
    assert isinstance(law, StateFeedbackController)
    design = lqr()
    assert np.array(law.gains) == pytest.approx(design.gains, rel=5.1e-5)
    assert np.array(law.integral_gains)[:, :3] == pytest.approx(design.integral_gains, rel=5.1e-5)
    assert not np.array(law.integral_gains)[:, 3:].any()
    assert law.bias == pytest.approx(design.bias, rel=5.1e-5)


def cost_of(gains, a, b, q, r, x):
    """Sum over all acts from a state x, simulated."""
    total = 0.0
    for _ in range(4000):
        u = -gains @ x
        total += x @ q @ x + u @ r @ u
        x = a @ x + b @ u
    return total


def test_no_other_gains_cost_less():
    """The optimum: neighbours in any direction cost more, from any start. A model of its own."""
    from scipy.linalg import expm

    plant, design = Plant(), lqr()
    a, b = plant.linear(PULL, design.bias, TARGET).state_space()
    whole = np.zeros((12, 12))  # angles, rates, integrals, inputs, in continuous time
    whole[:6, :6], whole[:6, 9:] = a, b
    held = expm(1e-3 * whole)
    a, b = held[:6, :6], held[:6, 9:]
    trapezoid = 5e-4 * np.eye(3, 6)
    a = np.block([[a, np.zeros((6, 3))], [trapezoid + trapezoid @ a, np.eye(3)]])
    b = np.vstack([b, trapezoid @ b])
    error = WEIGHTS.error * TARGET
    q = np.diag(np.concatenate([
        error, error / WEIGHTS.rate, error * np.array(WEIGHTS.integral)]) ** -2.0)
    r = np.diag(np.array(plant.finger.stiffness) ** -2.0)
    gains = np.hstack([design.gains, design.integral_gains])
    rng = np.random.default_rng(1)
    for _ in range(3):
        start = rng.normal(size=9) * np.concatenate([error, error / WEIGHTS.rate, error * 0.01])
        best = cost_of(gains, a, b, q, r, start)
        for _ in range(3):
            near = gains * (1 + 0.03 * rng.normal(size=gains.shape))
            assert cost_of(near, a, b, q, r, start) > best
