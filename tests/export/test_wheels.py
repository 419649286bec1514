"""A cord round a wheel: tangent points, angle and length against geometry and the engine."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.export.mjcf_cords import path_length, yielding
from sandbox.export.mjcf_document import Draft
from sandbox.export.tree import grow
from sandbox.export.wheels import wrap_round
from sandbox.model.compile import compile_mechanism
from sandbox.scene.mechanism import Mechanism


def test_a_touch_is_not_once_round() -> None:
    wrap = wrap_round((-1.0, 0.5), (0.0, 0.0), (1.0, 0.5), 0.5)
    assert wrap is not None
    assert wrap.angle == pytest.approx(0.0, abs=1e-9)


def test_a_point_in_the_wheel_has_no_tangent() -> None:
    assert wrap_round((0.04, 0.0), (0.0, 0.0), (1.0, 0.0), -0.05) is None


@pytest.mark.parametrize(("radius", "middle"), [(0.05, math.pi / 2), (-0.05, -math.pi / 2)])
def test_a_cord_that_goes_straight_past_its_wheel_is_nearest_where_it_comes_on(
    radius: float, middle: float,
) -> None:
    y = math.copysign(0.08, radius)  # a wheel right of the cord lies below it
    wrap = wrap_round((-1.0, y), (0.0, 0.0), (1.0, y), radius, past=True)
    assert wrap is not None
    assert wrap.on == wrap.off == pytest.approx((0.0, y), abs=1e-15)
    assert (wrap.angle, wrap.crosses) == (0.0, False)
    assert wrap.middle == pytest.approx(middle, rel=1e-15)


def draft_of(mechanism: Mechanism) -> Draft:
    model = compile_mechanism(mechanism)
    return Draft(model, grow(model))


def cords(*guides: dict[str, Any]) -> Mechanism:
    return Mechanism.model_validate({
        "run": {"duration": 1e-3},
        "bodies": [{"name": "frame", "motion": "fixed"},
                   {"name": "load", "at": (0.3, -0.1), "angle": 0.4, "mass": 0.2, "inertia": 1e-4,
                    "centre": (0.01, 0.02)}],
        "tendons": [{"name": "cord", "stiffness": 100, "guides": guides}]})


def test_a_path_is_as_long_as_the_engine_s() -> None:
    mechanism = cords(
        {"body": "frame", "at": (-0.1, 0.0)}, {"body": "load", "at": (0.02, 0.0), "radius": 0.03},
        {"body": "frame", "at": (0.5, 0.1)},
        {"body": "frame", "at": (0.6, 0.2), "radius": 0.05, "side": "right"},
        {"body": "frame", "at": (0.7, 0.0)})
    run = simulate(mechanism)
    length = path_length(draft_of(mechanism), 0)
    assert length == pytest.approx(float(run.arrays["tendon_initial"][0]), rel=1e-12)


def test_yielding_of_one_free_body() -> None:
    """J M^-1 J^T = 1/m + (r x u)^2 / I for a cord tied to a body at r, direction u."""
    mechanism = cords({"body": "frame"}, {"body": "load", "at": (0.05, 0.0)})
    tie = np.array([0.3, -0.1]) + 0.05 * np.array([math.cos(0.4), math.sin(0.4)])
    turn = np.array([[math.cos(0.4), -math.sin(0.4)], [math.sin(0.4), math.cos(0.4)]])
    arm = tie - (np.array([0.3, -0.1]) + turn @ np.array([0.01, 0.02]))
    u = tie / np.linalg.norm(tie)
    wanted = 1 / 0.2 + (arm[0] * u[1] - arm[1] * u[0]) ** 2 / 1e-4
    assert yielding(draft_of(mechanism), 0) == pytest.approx(wanted, rel=1e-12)
