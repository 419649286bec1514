"""Plain pymunk: closed forms, both solvers side by side, scripts, and what it has none of."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import sandbox
from sandbox.elements.element import Element
from sandbox.elements.registry import KINDS
from sandbox.errors import SceneError
from sandbox.export import export_mechanism

GROUND = {"name": "ground", "motion": "fixed"}
BLOCK = {"name": "block", "mass": 0.1, "inertia": 1e-4}
PIN = {"type": "pin", "name": "pin", "a": "ground", "b": "block", "on_a": (0, 0), "on_b": (0, 0)}
SLIDE = {"type": "slot", "name": "slide", "a": "ground", "b": "block", "start": (-1, 0),
         "end": (1, 0), "turns": False}
ROD = {"name": "rod", "a": "ground", "b": "block", "on_a": (-0.2, 0.0)}


def scene(duration: float = 0.2, **lists: Any) -> dict[str, Any]:
    return {"run": {"duration": duration}, "bodies": [GROUND, BLOCK], **lists}


@pytest.mark.parametrize("kind", [kind for kinds in KINDS.values() for kind in kinds.values()])
def test_each_kind_is_written_or_says_why_not(kind: type[Element]) -> None:
    assert bool(kind.PYMUNK) == (kind.write_pymunk is Element.write_pymunk)


def test_a_pendulum_swings_as_its_closed_form() -> None:
    """Phase errors: leapfrog w^3 h^2 t / 24, amplitude a^2 w t / 16."""
    a, h, length, inertia = 0.05, 5e-4, 0.2, 1e-4
    made = sandbox.to_pymunk(scene(gravity=(0, -9.81), joints=[{**PIN, "on_b": (0, length)}],
                                   bodies=[GROUND, {**BLOCK, "angle": a, "at": (
                                       length * math.sin(a), -length * math.cos(a))}]))
    w = math.sqrt(0.1 * 9.81 * length / (inertia + 0.1 * length**2))
    for _ in range(4000):
        made.step()
    t = (made.steps - 0.5) * h
    tolerance = a * (w**3 * h**2 * t / 24 + a**2 * w * t / 16)
    assert made.bodies["block"].angle == pytest.approx(a * math.cos(w * t), abs=tolerance)
    assert made.constraints["pin"].impulse / h == pytest.approx(
        0.1 * 9.81, rel=2 * a**2)  # up to the centrifugal force


def test_a_spring_swings_as_its_closed_form() -> None:
    h, x, w = 5e-4, 0.01, math.sqrt(200 / 0.1)
    made = sandbox.to_pymunk(scene(
        joints=[SLIDE], bodies=[GROUND, {**BLOCK, "at": (x, 0)}],
        springs=[{"type": "linear", "name": "k", "a": "ground", "b": "block", "on_a": (-0.1, 0),
                  "stiffness": 200, "rest_length": 0.1}]))
    for _ in range(400):
        made.step()
    t = (made.steps - 0.5) * h
    assert made.bodies["block"].position.x == pytest.approx(
        x * math.cos(w * t), abs=2 * x * w**3 * h**2 * t / 24)


def test_the_script_needs_pymunk_alone_and_has_the_same_forces(tmp_path: Path) -> None:
    hand = sandbox.load_scene("adaptive_grasp", overrides={"run.duration": 0.35})
    text = export_mechanism(sandbox.expand(hand), format="pymunk").text
    assert len(text.splitlines()) < 300
    assert "import sandbox" not in text
    (tmp_path / "hand.py").write_text(text)
    said = subprocess.run([sys.executable, "-I", "hand.py"], cwd=tmp_path, text=True,
                          capture_output=True, check=True).stdout.splitlines()
    printed = {name: [*map(float, numbers)] for name, *numbers in map(str.split, said)}
    made = sandbox.to_pymunk(hand)
    while made.steps < round(0.35 / made.h):
        made.step()
    contacts = made.contacts()
    assert len(contacts) > 10
    for (one, other), force in contacts.items():
        assert printed[f"{one}/{other}"] == [*force]
    assert printed["finger1.tendon"] == [made.tendons["finger1.tendon"].tension]


def test_what_has_no_counterpart_is_named(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SceneError, match="pymunk has no counterpart of a controller") as caught:
        sandbox.to_pymunk("finger_force_control")
    assert len(caught.value.problems) == 1
