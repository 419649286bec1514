"""Hands that hold a free object: it follows from mechanics, not from one lucky setting.

That the scenes' own expectations hold is tested with all shipped scenes.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import verdicts
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.load import load_scene

HANDS = ("four_finger_opposed", "four_finger_thumb_movable", "four_finger_thumb_fixed",
         "prosthesis")
OBJECTS = ("disc", "square", "irregular")
WEIGHT = 0.1 * 9.81
HALF = 0.025
"""Of an object's height: as far below its origin its middle is, and all its sides from that [m]."""
GOES = 1.19
"""Just before the shelf goes; some grasps come to rest in the tenth before it [s]."""
HELD = 1e-4
"""How far an object that is held may go when a shelf lets it go, or when it is pushed [m]."""


ALONE = ("sliding_pulleys", "eigenposture", "antagonistic", "four_motor", "six_motor",
         "elastic_tendons", "linkage", "adaptive_linkage", "soft_synergy", "fluidic",
         "birglen_regions", "sdm")
"""Hands without a free object."""
DECIDED = ("adaptive_grasp", "shape_change", "single_finger", "pulley_differential",
           "rocker_differential")
"""Statics determines the forces of these, however fine the steps that lead to them."""
CHANGES: list[tuple[str, dict[str, Any]]] = [
    ("sliding_pulleys", {"parameters.object": 1, "parameters.blocked": 3}),
    ("elastic_tendons", {"parameters.object": 2, "parameters.blocked": 5}),
    ("four_motor", {"bodies[disc].at[1]": -0.0375}),
    ("six_motor", {"bodies[disc].at[1]": -0.039}),
    ("linkage", {"parameters.r": "29 mm", "parameters.torque": "0.2 N m"}),
    ("adaptive_linkage", {"parameters.r": "34 mm", "parameters.torque": "0.15 N m"}),
    ("soft_synergy", {"parameters.cord": "0.8 N/mm", "parameters.first": "4.4 mm"}),
    ("fluidic", {"parameters.pressure": "2.3 bar"}),
    ("birglen_regions", {"parameters.pull": "11 N", "parameters.rho1": "57 mm"}),
    ("sdm", {"parameters.r": "30 mm", "parameters.off": "-4 mm", "parameters.pull": "30 N"})]
"""Changes that the expectations follow: these are formulas, not numbers of one run."""


def run(hand: str, **overrides: Any) -> Recording:
    return simulate(load_scene(shipped_scenes()[hand], overrides={
        {"object": "parts[object].include", "step": "run.step",
         "duration": "run.duration", "shares": "parts[tree].shares"}.get(key, f"parameters.{key}"):
        value for key, value in overrides.items()}))


def gone(held: Recording, start: float, end: float) -> float:
    """The largest way of the object's middle, and of its sides about it, since ``start`` [m]."""
    window = (held.time >= start) & (held.time <= end)
    x, y, turned = (held[f"object.body.{name}"][window] for name in ("x", "y", "angle"))
    x, y = x + HALF * np.sin(turned), y - HALF * np.cos(turned)
    return float(np.max(np.hypot(x - x[0], y - y[0]) + HALF * np.abs(turned - turned[0])))


def failed(held: Recording) -> set[str]:
    return {verdict.quantity for verdict in verdicts(held) if not verdict.ok}


@pytest.mark.nightly
@pytest.mark.parametrize("thing", OBJECTS)
@pytest.mark.parametrize("hand", HANDS)
class TestEveryObjectInEveryHand:
    @pytest.mark.parametrize("setting", [
        {}, {"step": "0.5 ms"}, {"step": "2 ms"}, {"beside": "3 mm"}, {"beside": "-3 mm"},
        {"below": "2 mm"}, {"below": "7 mm"}, {"push": "-1 N"}], ids=str)
    def test_it_is_held_wherever_it_lay(
        self, hand: str, thing: str, setting: dict[str, Any]
    ) -> None:
        held = run(hand, object=f"object_{thing}", **setting)
        assert setting or not failed(held)
        assert gone(held, GOES, 3.1) < HELD
        end = held["object.body.contact.fy"][-1]
        assert end == pytest.approx(WEIGHT, rel=1e-3)


@pytest.mark.nightly
@pytest.mark.parametrize("hand", HANDS)
def test_ten_seconds_at_rest_without_a_jump_or_creep(hand: str) -> None:
    """What sticks does not move at all: 1 um is what ten thousand steps may leave of rounding."""
    held = run(hand, duration="13.1 s")
    assert gone(held, 3.1, 13.1) < 1e-6
    speeds = np.hypot(held["object.body.vx"], held["object.body.vy"])[held.time > 3.1]
    assert speeds.max() < 1e-5


# --- hands without a free object


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "step"), [
    *itertools.product(ALONE, ["1 ms", "2 ms"]),
    *itertools.product(DECIDED, ["0.25 ms", "0.4 ms", "1 ms"])])
def test_the_verdict_does_not_depend_on_the_step(name: str, step: str) -> None:
    assert not failed(simulate(load_scene(name, overrides={"run.step": step})))


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "overrides"), CHANGES, ids=str)
def test_expectations_follow_the_parameters(name: str, overrides: dict[str, Any]) -> None:
    assert not failed(simulate(load_scene(name, overrides=overrides)))
