"""Joints keep their constraints; kinematic loops; mechanisms that jam."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.errors import SandboxError, SimulationDiverged
from sandbox.samples.outcome import Status

from .machines import G, H, fixed, mass, mechanism

ROUNDING = 1e-11


def bar(name: str, at: tuple[float, float], **more: Any) -> dict[str, Any]:
    """A slim bar of 0.1 m, its frame at one end, its mass in the middle."""
    return {"name": name, "mass": 0.05, "inertia": 4e-5, "at": at, "centre": (0.05, 0.0), **more}


def test_path_ends_and_release() -> None:
    """A bead in a valley is let go, caught again and then stopped by an end of its path."""
    points = [(x, 4 * x**2) for x in np.linspace(-0.2, 0.14, 35)]
    run = simulate(mechanism(
        duration=0.8, gravity=(0.0, -G), run={"sample_rate": 1 / H},
        bodies=[fixed("wall"), mass("a", 0.1, (-0.2, 0.16))],
        joints=[{"type": "slot", "name": "j", "a": "wall", "b": "a", "path": points}],
        events=[{"name": "go", "at": 0.1, "release": ["j"]},
                {"name": "back", "at": 0.12, "take_up": ["j"]}]))
    across = np.abs(run["a.y"] - 4 * run["a.x"]**2)
    assert across[run.time < 0.1].max() < 1e-6
    assert 1e-3 < across[run["j.held"] == 0].max() < 2e-2
    assert across[run.time > 0.5].max() < 1e-6
    arrived = int(np.argmax(run["a.x"]))
    assert run["a.x"][arrived] == pytest.approx(0.14, abs=1e-6)
    assert run["j.speed"][arrived - 2] > 0.4
    assert run["j.speed"][arrived + 2] == pytest.approx(0.0, abs=0.05)


def test_a_rope_that_swings_is_as_long_as_it_is() -> None:
    """A limit's row knows the tangent: taut, it is too long by (v h)^2 / (2 r), and no more."""
    run = simulate(mechanism(
        duration=0.3, bodies=[fixed("wall"), mass("m", 0.1, (0.2, 0.0), velocity=(0.0, 3.0))],
        joints=[{"type": "rope", "name": "r", "a": "wall", "b": "m", "longest": 0.2}]))
    over = np.hypot(run["m.x"], run["m.y"]) - 0.2
    assert 0 <= over[1:].min() <= over.max() < 1.01 * (3 * H)**2 / 0.4
    assert run["r.reaction"][-1] == pytest.approx(0.1 * 9 / 0.2, rel=1e-3)


@pytest.mark.parametrize("start", np.linspace(0.2, 0.2 + 3 * H, 4))
def test_a_stop_gives_nothing_back(start: float) -> None:
    """A bar arrives at a stop with 10 rad/s, at four instants within its steps.

    It leaves with the share HOLD = 1e-10 of that by which impulses are held to their last, once
    for what stops it before the limit and once for what lands it there.
    """
    run = simulate(mechanism(
        duration=0.1, bodies=[fixed("wall"), {"name": "a", "mass": 0.05, "inertia": 4e-5,
                                              "angular_velocity": 10.0}],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "a", "on_a": (0, 0),
                 "limits": (-1.0, float(start))}]))
    assert run["p.angle"][-1] == pytest.approx(start, abs=2e-10 * 10 * 0.1)
    assert run["p.angle"].max() < start + ROUNDING
    assert run["p.rate"][-1] == pytest.approx(0.0, abs=2e-10 * 10)


@pytest.mark.parametrize("torque", [1e-4, 3e-3, 0.02])
def test_leaning_on_a_stop_from_the_start_does_not_rattle(torque: float) -> None:
    """A hinge that stands on its limit and is pressed on rests, its stop's torque the drive's.

    Its base turns evenly, so that each step rounds the hinge's angle anew: a stop that is let go
    of when overrun by nothing would be, every few steps.
    """
    run = simulate(mechanism(
        duration=0.5, bodies=[
            {"name": "base", "motion": "scheduled", "path": {"angle": {"expression": "=0.7 * t"}}},
            {"name": "a", "mass": 0.01, "inertia": 2e-6, "angular_velocity": 0.7}],
        joints=[{"type": "pin", "name": "p", "a": "base", "b": "a", "on_a": (0, 0),
                 "limits": (0.0, 1.0)}],
        drives=[{"type": "torque", "name": "t", "joint": "p", "value": -torque}]))
    late = run.time > 0.01
    # speeds are differences of rounded angles, over h: 1e-16 / 5e-4 of rad/s, over h again of I
    np.testing.assert_allclose(run["p.stop"][late], torque, rtol=0, atol=2e-6 * 5e-13 / H + 1e-12)
    assert np.abs(run["p.rate"][late]).max() < 1e-9
    assert np.abs(run["p.angle"][late]).max() < ROUNDING


def test_a_stop_of_a_hinge_that_stands_beyond_it_comes_back_slowly() -> None:
    """An overrun is undone at 1 rad/s at most: nothing is thrown, nothing is left."""
    run = simulate(mechanism(
        duration=0.3, bodies=[fixed("wall"), bar("a", (0, 0), angle=0.25)],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "a", "on_a": (0, 0),
                 "limits": (-1.0, 0.1)}]))
    coming = run.time < 0.14
    np.testing.assert_allclose(run["p.rate"][coming][1:], -1.0, atol=1e-9)
    # it arrives with that speed and goes on: a stop holds from one side only
    assert run["p.angle"][-1] <= 0.1 + ROUNDING


def test_a_mechanism_too_large_to_factor_is_refused() -> None:
    """Sixty bodies, every two of them pinned together."""
    joints = [{"type": "pin", "name": f"p{i}_{j}", "a": f"b{i}", "b": f"b{j}", "on_a": (0, 0)}
              for i, j in combinations(range(60), 2)]
    with pytest.raises(SandboxError, match="form too many loops"):
        simulate(mechanism(bodies=[mass(f"b{i}", 1.0, (0, 0)) for i in range(60)], joints=joints))


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
    # faces meet once the gaps are closed: 0.3 m
    ([WALL, block("crate", 0.2), ram(0.5)], [], 0.6, "crate", "wall"),
    ([WALL, *(block(f"c{i}", 0.2 + 0.1 * i) for i in range(3)), ram(0.5, 0.05)], [], 0.1, "c2",
     "wall"),
    ([block("crate", 0.2), ram(0.5), ram(-0.5, 0.4, name="other")], [], 0.2, "crate", "other"),
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
    # a press whose schedule takes it away again
    {"bodies": [WALL, block("crate", 0.2), {**ram(0.0), "path": {"x": "=0.3 * sin(4 * t) ** 2"}}]},
])
def test_mechanisms_that_can_yield_do_not_jam(machine: dict[str, Any]) -> None:
    assert simulate(mechanism(duration=0.7, gravity=(0.0, 0.0), **machine)).complete


def test_a_schedule_beyond_the_reach_of_a_mechanism_is_an_error() -> None:
    """A crank and a rod, 0.3 m in all, and a slider that moves out from 0.28 m."""
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
