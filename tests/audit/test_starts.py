"""Motors that start at speed: told with their cost, and nothing else asks for a look.

A slider-crank, whose slider is where x = r cos q + sqrt(l^2 - r^2 sin^2 q) says: its kinetic energy
is J(q) u^2 / 2, and out of rest that is what the start costs besides.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.audit.energy import starts
from sandbox.audit.evidence import Evidence, Figure
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from tests.engine.machines import G, fixed, mechanism

CRANK, ROD, SLIDER, LINKS, U, H = 0.1, 0.3, 0.2, 0.05, 20.0, 5e-4
ANGLES = [0.0, 2.5]
RATES = [2000.0, 100.0]


def bar(name: str, m: float, one: tuple[float, float], two: tuple[float, float]) -> dict[str, Any]:
    (x, y), (z, w) = one, two
    length = math.hypot(z - x, w - y)
    return {"name": name, "mass": m, "inertia": m * length**2 / 12,
            "at": ((x + z) / 2, (y + w) / 2), "angle": math.atan2(w - y, z - x)}


@cache
def crank(angle: float, rate: float, value: Any = U, *, gravity: float = 0.0) -> Recording:
    """Crank and rod of :data:`LINKS` kg each."""
    pin = CRANK * math.cos(angle), CRANK * math.sin(angle)
    end = pin[0] + math.sqrt(ROD**2 - pin[1]**2), 0.0
    bodies = [bar("crank", LINKS, (0.0, 0.0), pin), bar("rod", LINKS, pin, end),
              {"name": "slider", "mass": SLIDER, "inertia": 1e-5, "at": end}]
    return simulate(mechanism(
        duration=1.0, step=H, gravity=(0.0, -gravity), run={"sample_rate": rate},
        bodies=[fixed("ground"), *bodies],
        joints=[{"type": "pin", "name": "main", "a": "ground", "b": "crank", "on_a": (0, 0)},
                {"type": "pin", "name": "big", "a": "crank", "b": "rod", "on_a": (CRANK / 2, 0)},
                {"type": "pin", "name": "small", "a": "rod", "b": "slider", "on_b": (0, 0)},
                {"type": "slot", "name": "guide", "a": "ground", "b": "slider", "start": (0, 0),
                 "end": (0.6, 0), "turns": False}],
        drives=[{"type": "motor", "name": "motor", "joint": "main", "value": value,
                 "torque": 1e6}]))


def inertia(angle: float) -> float:
    """J of the slider-crank at a crank angle, 2 T / u^2."""
    c, s = math.cos(angle), math.sin(angle)
    lean = -CRANK * c / math.sqrt(ROD**2 - (CRANK * s)**2)  # of the rod, per turn of the crank
    pin = np.array([-CRANK * s, CRANK * c])
    foot = np.array([-CRANK * s + CRANK * s * lean, 0.0])
    middle = (pin + foot) / 2
    return (LINKS * CRANK**2 / 3 + LINKS * (middle @ middle + ROD**2 / 12 * lean**2)
            + SLIDER * foot @ foot)


def found(run: Recording) -> dict[str, Figure]:
    return {figure.name: figure for figure in audit(run)}


def looks(run: Recording) -> set[str]:
    return {name for name, figure in found(run).items() if figure.verdict == "look"}


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("angle", ANGLES)
def test_a_motor_that_starts_at_speed_is_told_and_nothing_else(angle, rate):
    run = crank(angle, rate, gravity=G)
    assert looks(run) == {"energy.start"}
    figure = found(run)["energy.start"]
    assert "motor accelerates its hinge from 0 to 20 rad/s" in figure.why


@pytest.mark.parametrize("rate", [2000.0, 1000.0])
@pytest.mark.parametrize("angle", ANGLES)
def test_it_costs_as_much_again_as_it_gives(angle, rate):
    """J u^2 / 2. Where the first step was not recorded half of the next one's work is in it."""
    _, cost, _ = starts(Evidence(crank(angle, rate)))
    truth = inertia(angle) * U**2 / 2
    later = inertia(angle + 2 * H * U) * U**2 / 2
    assert cost == pytest.approx(truth, abs=abs(later - truth) + (H * U)**2 * truth)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("value", ["=20 * sin(30 * t)", 0.0])
@pytest.mark.parametrize("angle", ANGLES[1:])
def test_a_motor_that_begins_with_its_hinges_rate_costs_nothing(angle, value, rate):
    run = crank(angle, rate, value)
    assert looks(run) == set()
    assert "every motor starts" in found(run)["energy.start"].why
