"""Rods, ropes, cylinders, grooves in the ground, and lines to points beside bodies."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.model.compile import compile_mechanism
from sandbox.picture.elements.bodies import beside, far_feet, stalks
from sandbox.picture.elements.links import cylinder


@pytest.mark.parametrize(("low", "high"), [(100, 107), (100, 100), (100, 140), (100, 185)])
def test_a_rod_keeps_its_length(low: float, high: float) -> None:
    """As it is of steel: the piston goes as far as the actuator grows, within its cylinder."""
    made = cylinder(np.linspace(low, high, 7), low, high, 12)
    found = list(zip(*(each.tolist() for each in made), strict=True))
    rods = [length - piston for length, (_, piston) in
            zip(np.linspace(low, high, 7), found, strict=True)]
    assert rods == pytest.approx([rods[0]] * 7, rel=1e-12)
    tubes = {tube for tube, _ in found}
    assert len(tubes) == 1
    assert all(0 <= piston <= tube < low for tube, piston in found)


def _beside(**field: Any) -> Any:
    return compile_mechanism(sandbox.expand(sandbox.load_scene({
        "bodies": [{"name": "frame", "motion": "fixed",
                    "shapes": [{"type": "box", "size": [0.2, 0.1]}]},
                   {"name": "arm", "mass": 1, "at": [1, 0],
                    "shapes": [{"type": "capsule", "end": [1, 0], "radius": 0.1}]}],
        "joints": [{"type": "actuator", "name": "c", "a": "frame", "b": "arm",
                    "on_a": [0, -0.5], "on_b": [0.5, 0.35]}], **field})))


def test_a_point_beside_a_body_has_a_line_to_where_the_body_is_nearest() -> None:
    """Straight down 0.25 m to a capsule's side, 0.45 m to that of a box."""
    model = _beside()
    found = stalks(model)
    assert len(found[0]) == len(found[1]) == 1
    assert found[1][0][0] == (0.5, 0.35)
    assert found[1][0][1] == pytest.approx((0.5, 0.1), abs=1e-12)
    assert math.dist(*found[0][0]) == pytest.approx(0.45)
    assert beside(model, 1, (0.5, 0.05)) is None
    assert far_feet(model, 0.44) == {0: [(0.0, -0.5)]}
    assert far_feet(model, 0.46) == {0: []}
