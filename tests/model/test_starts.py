"""Speeds of joints at t = 0 against where their bodies are a moment before and after."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sandbox.model.compile import compile_mechanism
from sandbox.model.starts import lengthening, sliding, turning
from sandbox.scene.mechanism import Mechanism

A = {"name": "a", "mass": 2, "inertia": 0.3, "at": [0.1, -0.2], "angle": 0.4,
     "centre": [0.03, 0.05], "velocity": [0.7, -0.3], "angular_velocity": 1.1}
B = {"name": "b", "mass": 1, "inertia": 0.1, "at": [0.5, 0.3], "angle": -0.9,
     "centre": [-0.02, 0.04], "velocity": [-0.2, 0.9], "angular_velocity": -2.3}
JOINTS: list[dict[str, Any]] = [
    {"type": "actuator", "name": "ram", "a": "a", "b": "b", "on_a": [0.06, -0.01],
     "on_b": [0.02, 0.07]},
    {"type": "slot", "name": "slot", "a": "a", "b": "b", "start": [0.1, 0.0], "end": [0.4, 0.2],
     "on_b": [0.02, 0.07]},
    {"type": "pin", "name": "pin", "a": "a", "b": "b", "on_a": [0.2, 0.1]},
]
MOMENT = 1e-4
"""[s]; the middle of two is off by its square times the third derivative, below 100 here."""


def placed(body: dict[str, Any], point: list[float], t: float) -> complex:
    """Where a body's point is at t, as the body moves freely: by complex numbers."""
    turn = complex(math.cos(body["angle"]), math.sin(body["angle"]))
    spun = turn * complex(math.cos(body["angular_velocity"] * t),
                          math.sin(body["angular_velocity"] * t))
    centre = complex(*body["at"]) + turn * complex(*body["centre"]) + t * complex(*body["velocity"])
    return centre + spun * (complex(*point) - complex(*body["centre"]))


def length(t: float) -> float:
    return abs(placed(B, [0.02, 0.07], t) - placed(A, [0.06, -0.01], t))


def way(t: float) -> float:
    start, end = placed(A, [0.1, 0.0], t), placed(A, [0.4, 0.2], t)
    groove = (end - start) / abs(end - start)
    return ((placed(B, [0.02, 0.07], t) - start) * groove.conjugate()).real


def test_joints_move_as_their_points_do() -> None:
    model = compile_mechanism(Mechanism.model_validate({"bodies": [A, B], "joints": JOINTS}))
    near = 100 * MOMENT**2
    for found, of in ((lengthening(model, 0), length), (sliding(model, 1), way)):
        assert found == pytest.approx((of(MOMENT) - of(-MOMENT)) / (2 * MOMENT), abs=near)
    assert turning(model, 2) == pytest.approx(-2.3 - 1.1)


def test_what_does_not_move_freely_stands() -> None:
    """A fixed body stays where it is, whatever velocity it was given."""
    still = {**{key: A[key] for key in ("name", "at", "angle")}, "motion": "fixed"}
    given = {**still, "velocity": A["velocity"], "angular_velocity": A["angular_velocity"]}
    models = [compile_mechanism(Mechanism.model_validate({"bodies": [one, B], "joints": JOINTS}))
              for one in (still, given)]
    for speed, joint in ((lengthening, 0), (sliding, 1), (turning, 2)):
        one, other = (speed(model, joint) for model in models)
        assert one == other
    assert turning(models[0], 2) == -2.3
