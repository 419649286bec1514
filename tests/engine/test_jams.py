"""What a schedule drives against something that cannot give way ends the run, in one sentence."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.errors import SimulationDiverged
from sandbox.samples.outcome import Status

from .machines import G, fixed, mechanism

BOX = [{"type": "box", "size": (0.1, 0.1)}]
WALL = fixed("wall", at=(0.5, 0.0), shapes=BOX)


def block(name: str, x: float, kilograms: float = 1.0, **more: Any) -> dict[str, Any]:
    return {"name": name, "mass": kilograms, "at": (x, 0.0), "shapes": BOX, **more}


def ram(speed: float, start: float = 0.0, *, name: str = "ram", shapes: Any = BOX,
        ) -> dict[str, Any]:
    return {"name": name, "motion": "scheduled", "at": (start, 0.0), "shapes": shapes,
            "path": {"x": f"={start} + {speed} * t"}}


ROPES = [{"type": "rope", "name": "near", "a": "wall", "b": "bead", "on_a": (0, 0), "on_b": (0, 0),
          "longest": 0.2},
         {"type": "rope", "name": "far", "a": "bead", "b": "ram", "on_a": (0, 0), "on_b": (0, 0),
          "longest": 0.2}]
LEVER = [{"type": "pin", "name": "pivot", "a": "frame", "b": "lever", "on_a": (0, 0),
          "limits": ("-20 deg", "20 deg")},
         {"type": "rod", "name": "link", "a": "ram", "b": "lever", "on_b": (0, 0.3)}]


@pytest.mark.parametrize(("bodies", "joints", "jams", "one", "other"), [
    # faces meet once the gaps are closed: 0.3 m; 0.3 mm
    ([WALL, block("crate", 0.2), ram(0.5)], [], 0.6, "crate", "wall"),
    ([WALL, block("crate", 0.3999, 1e-5), ram(2e-3, 0.2997)], [], 0.15, "crate", "wall"),
    ([WALL, *(block(f"c{i}", 0.2 + 0.1 * i) for i in range(3)), ram(0.5, 0.05)], [], 0.1, "c2",
     "wall"),
    ([block("crate", 0.2), ram(0.5), ram(-0.5, 0.4, name="other")], [], 0.2, "crate", "other"),
    ([WALL, block("crate", 0.2), block("tool", 0.0), ram(0.5, shapes=[])], [
        {"type": "weld", "name": "fix", "a": "ram", "b": "tool", "on_a": (0, 0)}], 0.6, "crate",
     "wall"),
    # two ropes in line, 0.4 m in all; a lever of 0.3 m whose stop is 0.3 tan(20°) away
    ([fixed("wall"), {"name": "bead", "mass": 0.2, "inertia": 1e-3, "at": (0.2, 0)},
      ram(0.5, 0.35, shapes=[])], ROPES, 0.1, "bead", "wall"),
    ([fixed("frame"), {"name": "lever", "mass": 1.0, "inertia": 0.01},
      {**ram(-0.5, 0.4, shapes=[]), "at": (0.4, 0.3),
       "path": {"x": "=0.4 - 0.5 * t", "y": 0.3}}], LEVER, None, "lever", "frame"),
])
def test_a_jam_ends_the_run_with_both_bodies_and_the_instant(
    bodies: list[Any], joints: list[Any], jams: float | None, one: str, other: str,
) -> None:
    with pytest.raises(SimulationDiverged) as caught:
        simulate(mechanism(duration=1.0, step=1e-3, bodies=bodies, joints=joints))
    error = caught.value
    assert str(error) == (f"the mechanism jammed at t = {error.time:.6g} s: ram, which moves on a "
                          f"schedule, drives {one} against {other}, and neither can move away")
    assert jams is None or error.time == pytest.approx(jams, abs=2e-3)
    recording = error.recording
    assert recording is not None
    assert recording.info.status is Status.DIVERGED
    assert recording.time[-1] < error.time
    for name in (one, other):  # the step that jams is not recorded
        assert recording[f"{name}.contact.normal"].max() < 1e5


@pytest.mark.parametrize("machine", [
    # a crate of 1 g against a stiff spring: 1e6 N/m
    {"bodies": [fixed("base"), block("anvil", 0.3), block("crate", 0.15, 1e-3), ram(0.5)],
     "joints": [{"type": "slot", "name": "s", "a": "base", "b": "anvil", "start": (0, 0),
                 "end": (2, 0), "turns": False}],
     "springs": [{"type": "linear", "name": "k", "a": "base", "b": "anvil", "on_a": (1.3, 0),
                  "stiffness": 1e6, "rest_length": 1}]},
    # ten tons at 10 m/s strike a pin of 1 g, while something else moves on a schedule
    {"bodies": [WALL, block("pin", 0.4, 1e-3), block("hammer", 0.0, 1e4, velocity=(10, 0)),
                ram(0.1, 9.0)]},
    # a schedule that comes to rest where the faces meet
    {"bodies": [WALL, block("crate", 0.2), {**ram(0.0), "path": {"x": "=0.3 * min(2 * t, 1)"}}]},
    # a press whose schedule takes it away again
    {"bodies": [WALL, block("crate", 0.2), {**ram(0.0), "path": {"x": "=0.3 * sin(4 * t) ** 2"}}]},
])
def test_what_can_give_way_does_not_jam(machine: dict[str, Any]) -> None:
    assert simulate(mechanism(duration=0.7, gravity=(0.0, 0.0), **machine)).complete


def test_a_schedule_that_leads_beyond_reach_is_named() -> None:
    """A crank and a rod, 0.3 m in all, and a slider that goes on from 0.28 m."""
    y = 0.3 / 2 * float(np.sqrt(1 - (0.28 / 0.3) ** 2))
    with pytest.raises(SimulationDiverged, match="slider, which moves on a schedule: past a dead"):
        simulate(mechanism(duration=1.0, gravity=(0.0, -G), bodies=[
            fixed("frame"), {"name": "crank", "mass": 0.2, "inertia": 1e-3, "at": (0.14, y)},
            {"name": "rod", "mass": 0.2, "inertia": 1e-3, "at": (0.14, y)},
            {"name": "slider", "motion": "scheduled", "at": (0.28, 0),
             "path": {"x": "=0.28 + 0.1 * t"}}], joints=[
            {"type": "pin", "name": "o", "a": "frame", "b": "crank", "on_a": (0, 0)},
            {"type": "pin", "name": "p", "a": "crank", "b": "rod", "on_b": (0, 0)},
            {"type": "pin", "name": "q", "a": "rod", "b": "slider", "on_b": (0, 0)}]))
