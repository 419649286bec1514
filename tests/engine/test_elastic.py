"""Soft tendons: springs that only pull, second order in the step."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

MASS, STIFFNESS, GRAVITY = 0.1, 200.0, 9.81


def hanging(h: float, damping: float, **tendon: float) -> Recording:
    return simulate(Mechanism.model_validate({
        "run": {"duration": 0.3, "step": h, "sample_rate": 1 / h},
        "gravity": [0, -GRAVITY],
        "bodies": [
            {"name": "frame", "motion": "fixed"},
            {"name": "load", "mass": MASS, "at": [0, -0.1],
             "shapes": [{"type": "circle", "radius": 0.01}]},
        ],
        "tendons": [{"name": "cord", "guides": [{"body": "frame"}, {"body": "load"}],
                     "stiffness": STIFFNESS, "damping": damping, **tendon}],
    }))


def error(h: float, damping: float) -> float:
    """Largest distance from the damped oscillation about y0 = m g / k, as a share of y0."""
    run = hanging(h, damping)
    w, z = np.sqrt(STIFFNESS / MASS), damping / (2 * MASS)
    wd, t, y0 = np.sqrt(w**2 - z**2), run.time, MASS * GRAVITY / STIFFNESS
    exact = -0.1 - y0 + y0 * np.exp(-z * t) * (np.cos(wd * t) + z / wd * np.sin(wd * t))
    return float(np.abs(run["load.y"] - exact).max() / y0)


@pytest.mark.parametrize("damping", [0.0, 0.5])
def test_second_order(damping: float):
    """Leapfrog: the phase is off by w^3 h^2 t / 24 and the start by h^2 g / 8."""
    w = np.sqrt(STIFFNESS / MASS)
    errors = [error(h, damping) for h in (1e-3, 5e-4, 2.5e-4)]
    for h, found in zip((1e-3, 5e-4, 2.5e-4), errors, strict=True):
        assert found < (w**3 * 0.3 / 24 + w**2 / 8) * h**2 * 1.2
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.abs(orders - 2).max() < 0.1


def test_never_pushes_and_hangs_at_its_stretch():
    """Slack by 20 mm: free fall for sqrt(2 s / g) first, then it pulls, and never pushes."""
    run = hanging(5e-4, 2.0, slack=0.02)
    tension = run["cord.tension"]
    falling = run.time < np.sqrt(2 * 0.02 / GRAVITY) - 1e-3
    assert not tension[falling].any()
    assert not tension[run["cord.length"] <= run.arrays["tendon_rest"][0]].any()
    assert (tension >= 0).all()
    assert tension.max() > MASS * GRAVITY
