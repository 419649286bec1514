"""Springs that can snap over the centre of the hinge that they cross."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sandbox.engine.inspect import inspect
from sandbox.engine.inspect_springs import over_centre
from sandbox.model.compile import compile_mechanism
from sandbox.scene.mechanism import Mechanism
from tests.engine.machines import fixed

M_BEFORE, M_AFTER = (-0.007, 0.008), (0.007, 0.008)
"""The ends of Set A's springs from the hinge [m]."""


def spring_across(
    hinge: dict[str, Any], on_ground: tuple[float, float], on_bar: tuple[float, float], *,
    from_bar: bool = False,
) -> Mechanism:
    """A bar pinned to the ground at the origin, and a spring between the two."""
    ends = [("ground", on_ground), ("bar", on_bar)]
    (a, on_a), (b, on_b) = reversed(ends) if from_bar else ends
    return Mechanism.model_validate({
        "bodies": [fixed("ground"), {"name": "bar", "mass": 0.01, "shapes": [
            {"type": "capsule", "start": [0, 0], "end": [0.04, 0], "radius": 0.005}]}],
        "joints": [{"type": "pin", "name": "hinge", "a": "ground", "b": "bar", "on_a": (0, 0),
                    **hinge}],
        "springs": [{"type": "linear", "name": "s", "a": a, "b": b, "on_a": on_a, "on_b": on_b,
                     "stiffness": 100.0}]})


def snaps_at(machine: Mechanism) -> float | None:
    return over_centre(compile_mechanism(machine), 0, 0)


@pytest.mark.parametrize(("positive", "limits", "expected"), [
    ("clockwise", None, 2 * math.atan2(8, 7)),
    ("clockwise", (0.0, 1.8), 2 * math.atan2(8, 7)),
    ("clockwise", (0.0, 1.6), None),
    ("counterclockwise", (-1.8, 0.0), -2 * math.atan2(8, 7)),
    ("counterclockwise", (0.0, 1.8), None),
])
def test_a_spring_over_centre(positive, limits, expected):
    """Set A: M'' = (-7, 8), M' = (7, 8) mm about the hinge, closing clockwise.

    rho_0 = w_0 = atan2(8, 7), the angles of the two ends over the hinge's
    line, so the ends are in line with the hinge at theta = rho_0 + w_0.
    """
    angle = snaps_at(spring_across({"positive": positive, "limits": limits}, M_BEFORE, M_AFTER))
    assert angle == (None if expected is None else pytest.approx(expected, abs=1e-12))


def at(degrees: float) -> tuple[float, float]:
    """A point 10 mm from the hinge, in a direction [deg]."""
    return 0.01 * math.cos(math.radians(degrees)), 0.01 * math.sin(math.radians(degrees))


@pytest.mark.parametrize(("positive", "limits", "expected"), [
    ("counterclockwise", None, 160), ("clockwise", None, -160),
    ("counterclockwise", (-100, 250), 160), ("clockwise", (-250, 100), -160),
    ("counterclockwise", (-250, 100), -200), ("clockwise", (-100, 250), 200),
    ("counterclockwise", (-150, 150), None), ("clockwise", (-150, 150), None),
])
@pytest.mark.parametrize("first", [170, 160, 20, 0, -5, -15, -180])
def test_the_way_over_centre_is_the_nearest_that_the_limits_leave(
    first, positive, limits, expected,
):
    """The bar's end lies 20 degrees ahead, wherever the angles of the two jump by a turn.

    A turn of 160 degrees ahead or of 200 back brings it opposite. Mirrored, the signs change.
    """
    for side in (1, -1):
        hinge: dict[str, Any] = {"positive": positive}
        if limits is not None:
            hinge["limits"] = sorted(math.radians(side * limit) for limit in limits)
        found = snaps_at(spring_across(hinge, at(side * first), at(side * (first + 20))))
        assert found == (None if expected is None else pytest.approx(
            math.radians(side * expected), abs=1e-12))


@pytest.mark.parametrize("positive", ["clockwise", "counterclockwise"])
def test_of_two_ways_that_are_as_long_the_lower_one_is_told(positive):
    """Both ends in one direction from the hinge: half a turn either way."""
    machine = spring_across({"positive": positive}, (0.0, 0.01), (0.0, 0.02))
    assert snaps_at(machine) == -math.pi


@pytest.mark.parametrize("from_bar", [False, True])
def test_a_spring_over_centre_is_told_with_its_angle(from_bar):
    (finding,) = inspect(spring_across(
        {"positive": "clockwise", "limits": (0, 1.8)}, M_BEFORE, M_AFTER, from_bar=from_bar))
    degrees = math.degrees(2 * math.atan2(8, 7))
    assert (finding.severity, finding.element) == ("warning", "s")
    assert f"snaps over the centre of 'hinge' at {degrees:.4g} deg" in finding.message
