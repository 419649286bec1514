"""Sound runs of many kinds, none of which may ask for a look: piles, rolling, cords, limits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

FLOOR = {"name": "floor", "motion": "fixed", "material": "m",
         "shapes": [{"type": "box", "size": (6, 0.2), "at": (0, -0.1)}]}


def box(name: str, x: float, y: float, angle: float = 0.0, **more: Any) -> dict[str, Any]:
    return {"name": name, "mass": 0.3, "at": (x, y), "angle": angle, "material": "m",
            "shapes": [{"type": "box", "size": (0.1, 0.06)}], **more}


def ball(name: str, x: float, y: float, **more: Any) -> dict[str, Any]:
    return {"name": name, "mass": 0.2, "at": (x, y), "material": "m",
            "shapes": [{"type": "circle", "radius": 0.04}], **more}


def bar(name: str, x: float, y: float, angle: float = 0.0, **more: Any) -> dict[str, Any]:
    return {"name": name, "mass": 0.2, "at": (x, y), "angle": angle, "material": "m", "shapes": [
        {"type": "capsule", "start": (-0.06, 0), "end": (0.06, 0), "radius": 0.02}], **more}


WEDGE = {"name": "wedge", "mass": 0.2, "at": (0, 0.75), "angle": 0.2, "material": "m", "shapes": [
    {"type": "polygon", "points": [(-0.05, -0.03), (0.05, -0.03), (0.02, 0.05)]}]}
PILE = [box("a", 0, 0.2, 0.3), box("b", 0.02, 0.35, -0.5), ball("c", -0.03, 0.5),
        bar("d", 0.05, 0.6, 0.4), WEDGE]
ROLLING = [ball("a", -1, 0.0401, velocity=(1, 0)), box("b", -0.2, 0.03, velocity=(0.5, 0)),
           bar("c", 0.4, 0.5, 1.0, velocity=(-0.2, 0), angular_velocity=8.0)]
TABLE = [box("a", 0.4, 0.03), {
    "name": "table", "mass": 0.4, "at": (0, 0.2), "angle": 0.3, "material": "m", "shapes": [
        {"type": "circle", "radius": 0.05, "at": (-0.1, 0)}, {"type": "box", "size": (0.2, 0.02)},
        {"type": "polygon", "points": [(0.08, -0.04), (0.16, 0), (0.08, 0.04)]}]}]
PUSHED = [box("a", 0.1, 0.03), box("b", 0.15, 0.09), {
    "name": "pusher", "motion": "scheduled", "material": "m", "at": (-0.1, 0.05),
    "path": {"x": "=-0.1 + 0.2 * t"}, "shapes": [{"type": "circle", "radius": 0.03}]}]
HUNG = [{"name": "wheel", "mass": 0.2, "inertia": 1e-4, "at": (0, 1.0)},
        ball("one", -0.1, 0.5), ball("two", 0.1, 0.5), ball("three", 0.5, 0.6)]
HANGING: dict[str, Any] = {
    "joints": [
        {"type": "pin", "name": "axle", "a": "floor", "b": "wheel", "on_b": (0, 0)},
        {"type": "rope", "name": "rope", "a": "floor", "b": "three", "on_a": (0.5, 1.0),
         "longest": 0.45},
        {"type": "slot", "name": "guide", "a": "floor", "b": "two", "start": (0.1, 0.1),
         "end": (0.1, 0.55), "turns": False}],
    "tendons": [
        {"name": "over", "guides": [{"body": "one"}, {"body": "wheel", "radius": 0.1,
                                                      "side": "left"}, {"body": "two"}]},
        {"name": "soft", "guides": [{"body": "floor", "at": (0.7, 1)}, {"body": "three"}],
         "stiffness": 30, "damping": 0.5}],
    "drives": [{"type": "brake", "name": "brake", "joint": "axle", "value": 0.05}]}
def vee(slope: float) -> dict[str, Any]:
    """One body of two slabs that meet in the origin and rise to either side by ``slope``."""
    c, s = np.cos(slope), np.sin(slope)
    right = [(0.0, 0.0), (0.1 * c, 0.1 * s), (0.1 * c, 0.1 * s - 0.02), (0.0, -0.02)]
    return {"name": "vee", "motion": "fixed", "material": "m", "shapes": [
        {"type": "polygon", "points": [(side * x, y) for x, y in right]} for side in (1, -1)]}


LINKED: dict[str, Any] = {
    "joints": [{"type": "pin", "name": f"j{i}", "a": a, "b": b, "on_b": (-0.06, 0), **more}
               for i, (a, b, more) in enumerate((
                   ("floor", "a", {"limits": (-1, 1)}),
                   ("a", "b", {"limits": (-0.5, 0.5), "damping": 1e-3}), ("b", "c", {})))],
    "springs": [{"type": "rotary", "name": "coil", "joint": "j2", "stiffness": 0.5,
                 "damping": 0.01}]}
SWELLING = {"drives": [{"type": "radius", "name": "swell", "body": "a", "value": "=0.04 + 0.02*t"}]}


def run_of(bodies: Any, rate: float, step: float = 5e-4, restitution: float = 0.0,
           friction: float = 0.5, duration: float = 0.8, **more: Any) -> Recording:
    return simulate(Mechanism.model_validate({
        "run": {"duration": duration, "step": step, "sample_rate": rate}, "gravity": (0, -9.81),
        "materials": {"m": {"friction": friction, "restitution": restitution}},
        "bodies": bodies, **more}))


def looks(bodies: Any, *settings: float, **more: Any) -> dict[str, str]:
    return told(run_of([FLOOR, *bodies], *settings, **more))


def told(run: Recording) -> dict[str, str]:
    return {figure.name: figure.why for figure in audit(run)
            if figure.verdict == "look" and figure.name != "tendon.slack"}


@pytest.mark.parametrize("rate", [2000.0, 500.0])
@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.parametrize("bodies", [PILE, ROLLING, TABLE], ids=["pile", "rolling", "table"])
def test_what_falls_rolls_and_piles_up_is_sound(bodies, restitution, rate):
    assert looks(bodies, rate, restitution=restitution) == {}


@pytest.mark.parametrize("rate", [2000.0, 500.0])
def test_what_is_pushed_and_swells_is_sound(rate):
    assert looks(PUSHED, rate) == {}
    assert looks([ball("a", 0, 0.04), ball("b", 0.03, 0.2)], rate, **SWELLING) == {}


@pytest.mark.parametrize("rate", [2000.0, 500.0])
def test_what_hangs_on_cords_and_ropes_is_sound(rate):
    assert looks(HUNG, rate, **HANGING) == {}


@pytest.mark.parametrize("rate", [2000.0, 500.0])
@pytest.mark.parametrize(("slope", "friction"), [(0.8, 0.0), (0.8, 0.5), (1.1, 0.3), (1.3, 1.5)])
def test_what_falls_into_a_vee_of_one_body_is_sound(slope, friction, rate):
    """One row for both sides: its place is on neither, and its friction has no one limit."""
    y = 0.04 / np.cos(slope) + 0.001
    for one in (ball("a", 0, y, velocity=(0.05, -0.5)), bar("a", 0, y + 0.05, 0.3),
                box("a", 0, y + 0.05, 0.6)):
        run = run_of([vee(slope), one], rate, friction=friction, duration=0.4)
        assert (run.arrays["contact_merged"] > 1).any() or one["shapes"][0]["type"] != "circle"
        assert told(run) == {}


@pytest.mark.parametrize("step", [1e-4, 5e-4, 2e-3])
def test_a_chain_that_hits_its_stops_and_the_floor_is_sound_at_any_step(step):
    bodies = [bar(name, x, 0.25) for name, x in (("a", 0.06), ("b", 0.18), ("c", 0.30))]
    for rate in (1 / step, 500.0):
        assert looks(bodies, rate, step, **LINKED) == {}
