"""Plain pymunk: closed forms, both solvers side by side, scripts, and what it has none of."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.audit.audit import audit
from sandbox.elements.element import Element
from sandbox.elements.registry import KINDS
from sandbox.errors import SceneError, SimulationDiverged
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


WHEEL = {"name": "wheel", "mass": 0.2, "inertia": 2e-4, "at": (0.3, 0)}
AXLE = {**PIN, "name": "axle", "b": "wheel", "on_a": (0.3, 0)}
RAM = {"type": "actuator", "name": "ram", **{key: ROD[key] for key in ("a", "b", "on_a")}}


def drive(tag: str, **fields: Any) -> list[dict[str, Any]]:
    return [{"type": tag, "name": "d", **fields}]


@pytest.mark.parametrize("lists", [
    {"joints": [PIN], "drives": drive("motor", joint="pin", value=3.0, torque=1.0)},
    {"joints": [PIN], "drives": drive("motor", joint="pin", stall=0.1, no_load=5.0)},
    {"joints": [PIN], "drives": drive("servo", joint="pin", value=0.3, torque=0.5, speed=4.0)},
    {"joints": [{**PIN, "damping": 1e-3}], "drives": drive("torque", joint="pin", value=0.01)},
    {"joints": [{**PIN, "positive": "clockwise", "zero": 0.1, "limits": [-0.3, 0.2]}],
     "drives": drive("torque", joint="pin", value=0.005)},
    {"joints": [PIN, {**PIN, "name": "elbow", "a": "block", "b": "wheel", "on_a": (0.3, 0)}],
     "bodies": [GROUND, BLOCK, WHEEL], "drives": drive("torque", joint="elbow", value=0.01)},
    {"joints": [{**PIN, "friction": 0.02}], "gravity": (0, -9.81)},
    {"joints": [PIN], "drives": drive("brake", joint="pin", value=0.02),
     "springs": [{"type": "rotary", "name": "k", "joint": "pin", "stiffness": 1, "damping": 0.01,
                  "rest_angle": 0.4}]},
    {"joints": [SLIDE], "bodies": [GROUND, {**BLOCK, "at": (0.01, 0)}],
     "springs": [{"type": "linear", "name": "k", "a": "ground", "b": "block", "on_a": (-0.1, 0),
                  "stiffness": 200, "rest_length": 0.1}]},
    {"joints": [{"type": "weld", **ROD}], "gravity": (0, -9.81)},
    {"joints": [{"type": "rod", **ROD}], "gravity": (0, -9.81)},
    {"joints": [{"type": "rope", **ROD, "longest": 0.21}], "gravity": (0, -9.81)},
    {"joints": [SLIDE, RAM], "drives": drive("push", joint="ram", value=0.2)},
    {"joints": [SLIDE, RAM], "drives": drive("extend", joint="ram", value=0.2, force=5)},
    {"joints": [SLIDE, RAM], "drives": drive("length", joint="ram", value=0.23, force=50,
                                             speed=0.5)},
    {"joints": [SLIDE], "drives": drive("force", body="block", direction=(1, 1), frame="body",
                                        value={"table": [[0, 0], [0.1, 1], [0.2, 0]]})},
    {"joints": [PIN, AXLE, {"type": "gear", "name": "mesh", "a": "block", "b": "wheel",
                            "radius_a": 0.1, "radius_b": 0.2}],
     "bodies": [GROUND, BLOCK, WHEEL], "drives": drive("torque", joint="axle", value=0.01)},
    {"joints": [AXLE], "bodies": [GROUND, {**BLOCK, "at": (0.2, -0.1)}, WHEEL],
     "gravity": (0, -9.81), "tendons": [{
         "name": "cord", "stiffness": 2000, "damping": 5, "guides": [
             {"body": "block"}, {"body": "wheel", "radius": 0.1, "side": "right"}]}]},
    {"bodies": [GROUND, {**BLOCK, "at": (0.2, -0.1)}, {**WHEEL, "at": (0.4, -0.1)}],
     "gravity": (0, -9.81), "tendons": [{"name": "cord", "guides": [
         {"body": "block"}, {"body": "ground", "at": (0.3, 0), "radius": 0.1, "side": "right"},
         {"body": "wheel"}]}]},
    {"bodies": [GROUND, BLOCK, {"name": "cam", "motion": "scheduled", "path": {"x": "=sin(9*t)"}}],
     "joints": [{"type": "weld", "name": "w", "a": "cam", "b": "block", "on_b": (0, 0)}]},
])
def test_both_solvers_move_a_mechanism_alike(lists: dict[str, Any]) -> None:
    runs = []
    for solver in ("direct", "pymunk"):
        data = scene(**lists)
        data["run"] |= {"solver": solver, "step": 1e-4}
        runs.append(sandbox.simulate(data))
    one, other = runs
    moved = np.ptp(one.arrays["body_pose"], axis=0).max()
    assert moved > 1e-3 or lists["joints"][0].get("friction") or "weld" in str(lists)
    assert np.abs(one.arrays["body_pose"] - other.arrays["body_pose"]).max() < 0.01 * moved + 1e-4
    for name in ("spring_force", "tendon_tension", "joint_angle"):
        scale = np.abs(np.nan_to_num(one.arrays[name])).max(initial=1e-6)
        off = np.abs(one.arrays[name] - other.arrays[name])[-1]
        assert np.nan_to_num(off).max(initial=0.0) <= 0.03 * scale + 1e-9, name


def test_the_script_needs_pymunk_alone_and_has_the_same_forces(tmp_path: Path) -> None:
    hand = sandbox.load_scene("adaptive_grasp", overrides={"run.duration": 0.35})
    text = export_mechanism(sandbox.expand(hand), format="pymunk").text
    assert len(text.splitlines()) < 350
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


def test_a_run_that_diverges_keeps_its_samples() -> None:
    with pytest.raises(SimulationDiverged, match="block: its motion has run away") as caught:
        sandbox.simulate({**scene(), "run": {"solver": "pymunk"}, "springs": [{
            "type": "linear", "name": "k", "a": "ground", "b": "block", "on_a": (-0.1, 0),
            "stiffness": 1e8, "rest_length": 0.05}]})
    assert caught.value.recording is not None
    assert np.isfinite(caught.value.recording.arrays["body_pose"]).all()


def test_a_run_is_read_like_any_other(tmp_path: Path) -> None:
    """What pymunk does not have is absent, not zero; a run in steps is refused."""
    finger = sandbox.load_scene("single_finger", overrides={
        "run.solver": "pymunk", "run.duration": 0.6, "run.sample_rate": 200})
    sandbox.simulate(finger).save(tmp_path)
    run = sandbox.Recording.load(tmp_path)
    assert run["finger.distal/disc.normal"][-1] == pytest.approx(0.6454, rel=0.01)
    assert run["finger.tendon.tension"][-1] == pytest.approx(3.75)
    assert run["finger.mcp.reaction"][-1] > 1.0
    for absent in ("finger.mcp.reaction_x", "actuator.work", "finger.dip_spring.work"):
        assert np.isnan(run[absent]).all()
    assert any(note.startswith("computed by pymunk") for note in run.notes)
    figures = {figure.name: figure for figure in audit(run)}
    assert figures["clock"].verdict == figures["rest.contacts"].verdict == "pass"
    assert figures["joint.drift"].verdict == "look"
    assert figures["energy.created"].verdict == "not computed"
    with pytest.raises(SceneError, match="runs a scene in one go"):
        sandbox.Simulation(finger)
