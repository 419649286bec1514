"""Relay tuning against exact relay cycles, and those against the ultimate gain and period."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.elements.controllers.pid import RULES, Relay, RelayController

from .loops import Plant, closed

A = np.array([[-1.0, 0, 0], [1, -1, 0], [0, 1, -1]])
B, C = np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
"""1/(s+1)^3: phase -180 deg at sqrt(3) rad/s, where |G| = 1/8. So Ku = 8, Tu = 2 pi/sqrt(3)."""
H = 4e-3


def relay(period: float = H, **more: Any) -> Relay:
    spec = {"type": "relay", "name": "tuner", "reads": "x.y", "writes": "u", "target": 0.0,
            "amplitude": 1.0, "bias": 0.0, **more}
    return Relay(RelayController.model_validate(spec), period)


def lags(sign: float = 1.0) -> Plant:
    plant = Plant(A, sign * B, C, H)
    plant.x[2] = -0.05
    return plant


@pytest.mark.parametrize(("late", "hysteresis"), [(20, 0.0), (0, 0.25), (0, 0.5)])
def test_the_relay_cycle_of_an_integrator_is_exact(late: int, hysteresis: float) -> None:
    """y' = u after ``late`` acts. The relay sees a crossing one act after it, so the reading goes
    late + 1 acts beyond +-hysteresis: a triangle of that amplitude a and the period 4 a.
    """
    h = 2.0**-10
    law = relay(h, cycles=3, hysteresis=hysteresis)
    y, queue, applied = (5 * h if late else 0.0), [0.0] * late, 0.0
    for k in range(16_000):
        if k == 0:
            law.begin([y], [0.0], [0.0])
        applied = law.act(k * h, [y], [0.0], [applied])[0]
        if law.report()["tuned"]:
            break
        queue.append(applied)
        y += h * queue.pop(0)
    found, a = law.report(), hysteresis + (late + 1) * h
    assert found["reading_amplitude"] == a
    assert found["ultimate_period_s"] == 4 * a
    assert found["ultimate_gain"] == pytest.approx(
        4 / (math.pi * math.sqrt(a**2 - hysteresis**2)), rel=1e-14)
    assert found["bias"] == 0.0


@pytest.mark.parametrize("rule", RULES)
def test_it_hands_over_at_the_mean_input_and_the_loop_settles(rule):
    """The target 0.2 needs an input of 0.2; the PID begins with the mean of the cycles, between
    the relay's two values, and ends at the target."""
    law = relay(rule=rule, bias=0.1)
    y, u = closed(law, lags(), lambda k: 0.2, 20_000, h=H)
    found = law.report()
    at = round(found["tuned_at_s"] / H)
    assert u[at - 1] in (0.1 + 1.0, 0.1 - 1.0)
    assert u[at] == pytest.approx(found["bias"], abs=1e-14)
    assert found["bias"] == pytest.approx(0.2, abs=0.02)
    assert abs(y[-1] - 0.2) < 1e-3
    assert np.abs(y[-900:] - 0.2).max() < np.abs(y[at - 900:at] - 0.2).max() / 20


def test_a_reading_without_cycles_is_reported():
    law = relay()
    assert law.report() == {"tuned": False, "why": "it was never switched on"}
    closed(law, lags(), lambda k: 50.0, 5000, h=H)
    report = law.report()
    assert report["tuned"] is False
    assert "0 times of 4" in report["why"]
