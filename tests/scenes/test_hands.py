"""Hands that hold a free object: it follows from mechanics, not from one lucky setting.

That the scenes' own expectations hold is tested with all shipped scenes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.inspect import inspect
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import verdicts
from sandbox.scene.expand import expand
from sandbox.scene.library import shipped_scenes, wholes
from sandbox.scene.read.load import load_scene

HANDS = ("four_finger_opposed", "four_finger_thumb_movable", "four_finger_thumb_fixed",
         "prosthesis")
OBJECTS = ("disc", "square", "irregular")
WEIGHT = 0.1 * 9.81
HALF = 0.025
"""Of an object's height: as far below its origin its middle is, and all its sides from that [m]."""
GOES = 1.19
"""Just before the shelf goes; some grasps come to rest in the tenth before it [s]."""
LOST = {"object.body.held", "object.body.contact.fy"}
"""What is no longer as expected of an object that falls: the shelf carries it no more."""
HELD = 1e-4
"""How far an object that is held may go when a shelf lets it go, or when it is pushed [m]."""


FAULTS: tuple[tuple[str, dict[str, Any], set[str]], ...] = (
    ("four_finger_opposed", {"shares": [1, 1, 1, 1.01]}, {"left1.finger.tendon.tension"}),
    ("four_finger_opposed", {"pull": "1 N"}, LOST),
    ("four_finger_opposed", {"wheel": "50 g"}, set()),
    ("four_finger_thumb_movable", {"shares": [1.01, 1, 1, 1]}, {"thumb.finger.tendon.tension"}),
    ("four_finger_thumb_movable", {"pull": "1 N"}, LOST),
    ("four_finger_thumb_fixed", {"shares": [1, 1, 1.01]}, {"finger3.finger.tendon.tension"}),
    ("four_finger_thumb_fixed", {"pull": "1 N"}, LOST),
    ("prosthesis", {"shares": [1, 1, 1, 1, 1.01]}, {"thumb.finger.tendon.tension"}),
    ("prosthesis", {"pull": "2 N"}, LOST),
    ("objects", {"arm": "20 mm"}, {"naill.angle"}))
"""A hand, a fault, and some of the quantities that are no longer as expected."""


OTHERS: dict[str, tuple[dict[str, Any], set[str]]] = {
    "sliding_pulleys": ({"tendons[cord].guides[2].friction": 0.01},
                        {"finger1.tendon.tension", "work"}),
    "eigenposture": ({"tendons[cord3].guides[0].radius": 0.0202},
                     {"x3", "finger3.tendon.tension", "off3"}),
    "antagonistic": ({"tendons[cord_f1].guides[2].radius": 0.0081}, {"mcp.angle", "moved"}),
    "four_motor": ({"parts[tree].shares": [1, 1, 1.01]}, {"middle.tendon.tension"}),
    "six_motor": ({"parts[2].tendon_to[0].radius": 0.00605}, {"ring.tendon.tension"}),
    "elastic_tendons": ({"springs[elastic{i + 1}].stiffness": "=1.01 * k"}, {"off1"}),
    "linkage": ({"templates.finger.joints[horn1].on_b": [0, -0.0091]},
                {"off.x", "share", "on_palm"}),
    "adaptive_linkage": ({"templates.finger.joints[shaft].damping": 0.001,
                          "templates.finger.joints[horn].on_b": [0, -0.0121]},
                         {"right.shaft.angle", "right.distal/disc.normal"}),
    "soft_synergy": ({"templates.finger.springs[back2].on_a": [0.0091, 0.026]},
                     {"right.y2", "moment2"}),
    "fluidic": ({"templates.two.lines[bellows2].chambers[0].displacement": 0.121e-6},
                {"middle.pip.angle", "index.distal/disc.normal"}),
    "birglen_regions": ({"templates.finger.tendons[tendon].guides[0].radius": 0.00605},
                        {"finger1.pip.angle", "finger2.distal/finger2.disc.normal"}),
    "sdm": ({"templates.finger.springs[flexure2].rest_angle": "46 deg"},
            {"right.pip.angle", "left.distal/disc.normal", "left.proximal/disc.normal"}),
}
"""Other hands: a fault, and some of the quantities that are no longer as expected."""
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


def called(value: object) -> str:
    """As a part of a test's name: the same in every process, sets too."""
    return str(sorted(value)) if isinstance(value, set) else str(value)


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
    def test_it_is_held(self, hand: str, thing: str) -> None:
        held = run(hand, object=f"object_{thing}")
        assert not failed(held)
        assert gone(held, GOES, 3.1) < HELD

    @pytest.mark.parametrize("setting", [
        {"step": "0.5 ms"}, {"step": "2 ms"}, {"beside": "3 mm"}, {"beside": "-3 mm"},
        {"below": "2 mm"}, {"below": "7 mm"}, {"push": "-1 N"}], ids=called)
    def test_it_is_held_wherever_it_lay(
        self, hand: str, thing: str, setting: dict[str, Any]
    ) -> None:
        held = run(hand, object=f"object_{thing}", **setting)
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


@pytest.mark.nightly
@pytest.mark.parametrize(("hand", "fault", "broken"), FAULTS, ids=called)
def test_a_planted_fault_is_found(hand: str, fault: dict[str, Any], broken: set[str]) -> None:
    found = failed(run(hand, **fault))
    assert broken <= found
    assert bool(broken) == bool(found)


def test_an_object_that_overlaps_a_finger_is_reported() -> None:
    scene = load_scene(shipped_scenes()["four_finger_opposed"],
                       overrides={"parameters.beside": 0.01})
    text = [problem.message for problem in inspect(expand(scene))]
    assert any("'object.body'" in message and "at t = 0" in message for message in text)


# --- hands without a free object


def unexpected(name: str, **overrides: Any) -> set[str]:
    """The quantities of a scene that are not as expected."""
    return failed(simulate(load_scene(name, overrides=overrides)))


def test_every_hand_has_a_fault_that_is_found() -> None:
    broken = {hand for hand, _, quantities in FAULTS if quantities}
    assert broken | set(OTHERS) == set(wholes("hands"))


@pytest.mark.nightly
@pytest.mark.parametrize("name", OTHERS)
def test_a_planted_fault_of_other_hands_is_found(name: str) -> None:
    overrides, broken = OTHERS[name]
    assert broken <= unexpected(name, **overrides)


@pytest.mark.nightly
@pytest.mark.parametrize("step", ["1 ms", "2 ms"])
@pytest.mark.parametrize("name", OTHERS)
def test_the_verdict_does_not_depend_on_the_step(name: str, step: str) -> None:
    assert not unexpected(name, **{"run.step": step})


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "overrides"), CHANGES, ids=called)
def test_expectations_follow_the_parameters(name: str, overrides: dict[str, Any]) -> None:
    assert not unexpected(name, **overrides)
