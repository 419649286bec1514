"""Sound runs with contacts of several points, none of which may raise an alarm."""

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
def vee(slope: float) -> dict[str, Any]:
    """One body of two slabs that meet in the origin and rise to either side by ``slope``."""
    c, s = np.cos(slope), np.sin(slope)
    right = [(0.0, 0.0), (0.1 * c, 0.1 * s), (0.1 * c, 0.1 * s - 0.02), (0.0, -0.02)]
    return {"name": "vee", "motion": "fixed", "material": "m", "shapes": [
        {"type": "polygon", "points": [(side * x, y) for x, y in right]} for side in (1, -1)]}


def run_of(bodies: Any, rate: float, restitution: float = 0.0,
           friction: float = 0.5, duration: float = 0.8) -> Recording:
    return simulate(Mechanism.model_validate({
        "run": {"duration": duration, "step": 5e-4, "sample_rate": rate}, "gravity": (0, -9.81),
        "materials": {"m": {"friction": friction, "restitution": restitution}},
        "bodies": bodies}))


def told(run: Recording) -> dict[str, str]:
    return {figure.name: figure.why for figure in audit(run)
            if figure.verdict == "look" and figure.name != "tendon.slack"}


@pytest.mark.parametrize(("restitution", "rate"), [(0.0, 500.0), (0.5, 2000.0)])
def test_a_pile_is_sound(restitution, rate):
    assert told(run_of([FLOOR, *PILE], rate, restitution=restitution)) == {}


@pytest.mark.parametrize(("slope", "friction", "rate"), [(0.8, 0.5, 2000.0), (1.3, 1.5, 500.0)])
def test_what_falls_into_a_vee_of_one_body_is_sound(slope, friction, rate):
    """One row for both sides: its place is on neither, and its friction has no one limit."""
    y = 0.04 / np.cos(slope) + 0.001
    for one in (ball("a", 0, y, velocity=(0.05, -0.5)), bar("a", 0, y + 0.05, 0.3),
                box("a", 0, y + 0.05, 0.6)):
        run = run_of([vee(slope), one], rate, friction=friction, duration=0.4)
        assert (run.arrays["contact_merged"] > 1).any() or one["shapes"][0]["type"] != "circle"
        assert told(run) == {}
