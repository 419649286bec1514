"""Warnings about springs that snap over centre, and about ringing tendons."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

from sandbox.engine.inspect import inspect
from sandbox.engine.inspect_springs import over_centre, ringing_problems
from sandbox.engine.simulate import simulate
from sandbox.model.compile import compile_mechanism
from sandbox.scene.mechanism import Mechanism
from tests.support.mechanisms import cable, pin

from .machines import G, fixed, mechanism


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


def at(degrees: float) -> tuple[float, float]:
    """A point 10 mm from the hinge, in a direction [deg]."""
    return 0.01 * math.cos(math.radians(degrees)), 0.01 * math.sin(math.radians(degrees))


@pytest.mark.parametrize(("positive", "limits", "expected"), [
    ("counterclockwise", None, 160), ("clockwise", (-250, 100), -160),
    ("counterclockwise", (-250, 100), -200), ("clockwise", (-150, 150), None),
])
@pytest.mark.parametrize("first", [170, 20, -5, -180])
def test_the_over_centre_angle_is_the_nearest_within_the_limits(first, positive, limits, expected):
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


@pytest.mark.parametrize("from_bar", [False, True])
def test_a_spring_over_centre_is_reported_with_its_angle(from_bar):
    """Between the ends of Set A's springs."""
    (finding,) = inspect(spring_across({"positive": "clockwise", "limits": (0, 1.8)},
                                       (-0.007, 0.008), (0.007, 0.008), from_bar=from_bar))
    degrees = math.degrees(2 * math.atan2(8, 7))
    assert (finding.severity, finding.element) == ("warning", "s")
    assert f"snaps over the centre of 'hinge' at {degrees:.4g} deg" in finding.message


K = 1e5
BEAM = {"name": "beam", "motion": "fixed"}


def weight(name: str, mass: float, at: tuple[float, float] = (0.0, -0.1), **more: Any) -> Any:
    return {"name": name, "mass": mass, "inertia": 1e-4 * mass, "at": at, **more}


def hanging(mass: float, *, step: float = 5e-4, duration: float = 0.1, **more: Any) -> Any:
    """A weight on a cord of 1e5 N/m, released where the cord is not stretched."""
    cable = {"name": "cord", "guides": [{"body": "weight"}, {"body": "beam"}], **more}
    return mechanism(duration=duration, step=step, gravity=(0.0, -G),
                     bodies=[BEAM, weight("weight", mass)], tendons=[cable])


def ringing_of(machine: Any) -> list[tuple[float, float, float, float]]:
    """Hz, periods, seconds and the damping advised, of every cord that is named."""
    numbers = r"[\d.e+-]+"
    found = []
    for one in ringing_problems(compile_mechanism(machine)):
        assert (one.severity, one.blocks) == ("warning", False)
        match = re.search(rf"vibrates at ({numbers}) Hz(?: once all tendons are taut)?: .* in "
                          rf"({numbers}) periods, ({numbers}) s; with 'damping' ({numbers}) N s/m",
                          str(one))
        assert match is not None, str(one)
        found.append(tuple(float(each) for each in match.groups()))
    return found


@pytest.mark.parametrize("step", [1e-3, 1e-4])
@pytest.mark.parametrize("damping", [0.0, 10.0])
def test_the_step_adds_the_damping_h_k(step, damping):
    """zeta = (c + h k) w / (2 k); to 1 % in ln(100) / (2 pi zeta); 5 % asks for c = 0.1 k / w."""
    omega = math.sqrt(K / 20.0)
    zeta = (damping + step * K) * omega / (2 * K)
    (hertz, periods, seconds, advised), = ringing_of(hanging(20.0, step=step, damping=damping))
    assert hertz == pytest.approx(omega / (2 * math.pi), rel=5e-3)
    assert periods == pytest.approx(math.log(100) / (2 * math.pi * zeta), rel=5e-3)
    assert seconds == pytest.approx(math.log(100) / (zeta * omega), rel=5e-2)
    enough = math.log(100) / (2 * math.pi * 15)
    assert advised == pytest.approx(2 * enough * K / omega - step * K, rel=1e-2)


def test_a_tendon_rings_as_long_as_predicted():
    (hertz, _, seconds, advised), = ringing_of(hanging(20.0, step=1e-3))
    for damping, wanted in ((0.0, seconds), (advised, 15 / hertz)):
        run = simulate(hanging(20.0, step=1e-3, duration=2.5, damping=damping))
        off = np.abs(run["cord.tension"] / (20.0 * G) - 1)
        died = run.time[np.flatnonzero(off > 0.01)[-1]]
        assert died == pytest.approx(wanted, abs=0.6 / hertz)  # a zero is never far from a peak


@pytest.mark.parametrize(("mass", "more"), [
    (0.5, {}),  # 0.11 of what is critical, by the step alone
    (20.0, {"stiffness": 0.9e5}),  # a spring that is to ring
    (20.0, {"slack": 0.01, "damping": 200.0}),
])
def test_damped_tendons_are_not_reported(mass, more):
    assert ringing_of(hanging(mass, **more)) == []


@pytest.mark.parametrize(("more", "slack"), [
    ({"rest_length": 0.1}, False), ({"rest_length": 0.09, "slack": 0.01}, False),
    ({"slack": 1e-6}, True), ({"rest_length": 0.11}, True),
    ({"rest_length": 0.09, "slack": 0.011}, True)])
def test_a_slack_tendon_rings_once_it_is_taut_as_if_it_were_from_the_start(more, slack):
    assert not slack or ringing_of(hanging(20.0, **more)) == ringing_of(hanging(20.0))
    found, = ringing_problems(compile_mechanism(hanging(20.0, **more)))
    assert (" Hz once all tendons are taut: it decays" if slack else " Hz: it decays") in str(found)


@pytest.mark.parametrize(("make", "square"), [
    # a movable pulley: two stretches lift it
    (lambda: {"bodies": [BEAM, weight("load", 100.0, (0.0, -0.5))],
              "tendons": [cable("cord", ("beam", (-0.05, 0.0)), ("load", (0, 0), 0.05),
                                ("beam", (0.05, 0.0)))]},
     4 * K / 100.0),
    # wound on a wheel that turns: r^2 / I
    (lambda: {"bodies": [BEAM, {"name": "wheel", "mass": 1.0, "inertia": 0.5}],
              "joints": [pin("axle", "beam", "wheel")],
              "tendons": [cable("cord", ("wheel", (0, 0), 0.1), ("beam", (1.0, 0.0)))]},
     0.01 * K / 0.5),
    # two cords in a row: half as stiff
    (lambda: {"bodies": [BEAM, weight("knot", 1e-3), weight("load", 30.0, (0.0, -0.2))],
              "tendons": [cable("cord", ("knot",), ("beam",)),
                          cable("other", ("load",), ("knot",), stiffness=1.01 * K)]},
     K / 30.0 / (1 + 1 / 1.01)),
])
def test_the_frequency_counts_all_connected_masses(make, square):
    found = ringing_of(mechanism(duration=0.1, step=1e-4, **make()))
    assert [hertz for hertz, *_ in found] == [
        pytest.approx(math.sqrt(square) / (2 * math.pi), rel=5e-3)]
