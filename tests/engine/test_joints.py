"""Joints keep their constraints; kinematic loops; mechanisms that jam."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.errors import SandboxError, SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Status

from .machines import G, H, fixed, mass, mechanism

GAP = 2e-10
ROUNDING = 1e-11


def place(run: Recording, body: str, point: tuple[float, float]) -> np.ndarray:
    """World track of a point of a body, [n, 2]."""
    x, y, angle = (run[f"{body}.{q}"] for q in ("x", "y", "angle"))
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]], axis=1)


def bar(name: str, at: tuple[float, float], **more: Any) -> dict[str, Any]:
    """A slim bar of 0.1 m, its frame at one end, its mass in the middle."""
    return {"name": name, "mass": 0.05, "inertia": 4e-5, "at": at, "centre": (0.05, 0.0), **more}


@pytest.mark.parametrize("positive", ["counterclockwise", "clockwise"])
@pytest.mark.parametrize("torque", [0.02, -0.02])
def test_stops(positive: str, torque: float) -> None:
    """Driven with tau against a stop, a hinge rests there: angle on the limit, stop torque -tau.

    Both in the hinge's positive sense, zero 0.1 rad off the frames'.
    """
    run = simulate(mechanism(
        duration=0.3, bodies=[fixed("wall"), bar("a", (0, 0))],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "a", "on_a": (0, 0), "zero": 0.1,
                 "limits": (-0.5, 0.7), "positive": positive}],
        drives=[{"type": "torque", "name": "t", "joint": "p", "value": torque}]))
    limit = 0.7 if torque > 0 else -0.5
    np.testing.assert_allclose(run["p.angle"][-100:], limit, atol=ROUNDING)
    np.testing.assert_allclose(run["p.stop"][-100:], -torque, rtol=1e-9)
    assert run["p.angle"].min() > -0.5 - ROUNDING
    assert run["p.angle"].max() < 0.7 + ROUNDING
    free = np.abs(run["p.angle"] - 0.1) < 0.3
    assert (run["p.stop"][free] == 0).all()
    sign = 1.0 if positive == "counterclockwise" else -1.0
    assert run["a.angle"][-1] == pytest.approx(sign * (limit + 0.1), abs=ROUNDING)


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


@pytest.mark.parametrize("turns", [True, False])
def test_slot(turns: bool) -> None:
    """A body's point runs along a slanted groove of a wall; a slider keeps its angle, too.

    Down the slope it gains g sin(30 deg) t: 0.5 s would be 0.6 m, but the groove ends after 0.3 m.
    """
    c, s = math.cos(math.radians(-30)), math.sin(math.radians(-30))
    run = simulate(mechanism(
        duration=0.6, gravity=(0.0, -G),
        bodies=[fixed("wall", angle=math.radians(-30)),
                {**mass("a", 0.1, (0.1 * c, 0.1 * s)), "inertia": 1e-4, "angle": 0.2,
                 "centre": (0.01, 0.02)}],
        joints=[{"type": "slot", "name": "j", "a": "wall", "b": "a", "start": (0.0, 0.0),
                 "end": (0.3, 0.0), "turns": turns}]))
    track = place(run, "a", (0.0, 0.0))
    along, across = track @ [c, s], track @ [-s, c]
    arrived = int(np.argmax(along > 0.2999))
    assert arrived > 0
    assert np.abs(across).max() < GAP
    # of a point that goes round the centre of mass the row knows the tangent: omega^2 r h^2 / 2
    assert along.max() < 0.3 + np.abs(run["a.omega"]).max()**2 * 0.0224 * H**2 / 2 + ROUNDING
    if turns:
        assert np.ptp(run["a.angle"]) > 0.1
    else:
        np.testing.assert_allclose(along[arrived + 1:], 0.3, atol=ROUNDING)
        np.testing.assert_allclose(run["a.angle"], 0.2, atol=ROUNDING)


def test_weld() -> None:
    """Two bars thrown in a spin stay one: gap and angle; the pair keeps its spin and its course.

    Velocities of the centres of mass are those of one rigid body: v_b = v_a + omega x r.
    """
    x, y = 0.05 + 0.05 * math.cos(0.5), 0.05 * math.sin(0.5)
    run = simulate(mechanism(
        duration=0.5,
        bodies=[bar("a", (0, 0), velocity=(0.5, 0.0), angular_velocity=5.0),
                bar("b", (0.1, 0), angle=0.5, velocity=(0.5 - 5 * y, 5 * x), angular_velocity=5.0)],
        joints=[{"type": "weld", "name": "w", "a": "a", "b": "b", "on_b": (0, 0)}]))
    # the first pose is on the path to the third order of the half step
    gap = place(run, "a", (0.1, 0)) - place(run, "b", (0, 0))
    assert np.abs(gap[0]).max() < (5 * H / 2)**3 * 0.1
    np.testing.assert_allclose(gap[1:], 0.0, atol=GAP)
    np.testing.assert_allclose(run["b.angle"] - run["a.angle"], 0.5, atol=ROUNDING)
    # the weld closes over chords: the pair turns on as one body does, to (omega h)^2
    np.testing.assert_allclose(run["a.omega"], 5.0, rtol=(5 * H)**2)
    middle = (place(run, "a", (0.05, 0.0)) + place(run, "b", (0.05, 0.0))) / 2
    np.testing.assert_allclose(
        middle - middle[0], np.outer(run.time - run.time[0], [0.5 - 2.5 * y, 2.5 * x]), atol=1e-9)


def test_rope() -> None:
    """Free in between, no longer than its longest, no shorter than its shortest, and no throw."""
    def hung(speed: float) -> Recording:
        return simulate(mechanism(
            duration=0.4, bodies=[fixed("wall"), mass("m", 0.1, (0.2, 0.0), velocity=(speed, 0.0))],
            joints=[{"type": "rope", "name": "r", "a": "wall", "b": "m", "longest": 0.3,
                     "shortest": 0.1}]))

    out, back = hung(1.0), hung(-1.0)
    assert out["m.x"].max() == pytest.approx(0.3, abs=ROUNDING)
    assert back["m.x"].min() == pytest.approx(0.1, abs=ROUNDING)
    free = out.time < 0.09
    np.testing.assert_allclose(out["m.x"][free], 0.2 + out.time[free], atol=1e-12)
    assert (out["r.reaction"][free] == 0).all()
    for run in (out, back):
        assert run["m.vx"][-1] == pytest.approx(0.0, abs=1e-9)


def test_a_rope_that_swings_is_as_long_as_it_is() -> None:
    """A limit's row knows the tangent: taut, it is too long by (v h)^2 / (2 r), and no more."""
    run = simulate(mechanism(
        duration=0.3, bodies=[fixed("wall"), mass("m", 0.1, (0.2, 0.0), velocity=(0.0, 3.0))],
        joints=[{"type": "rope", "name": "r", "a": "wall", "b": "m", "longest": 0.2}]))
    over = np.hypot(run["m.x"], run["m.y"]) - 0.2
    assert 0 <= over[1:].min() <= over.max() < 1.01 * (3 * H)**2 / 0.4
    assert run["r.reaction"][-1] == pytest.approx(0.1 * 9 / 0.2, rel=1e-3)


@pytest.mark.parametrize("start", np.linspace(0.2, 0.2 + 3 * H, 7))
def test_a_stop_gives_nothing_back(start: float) -> None:
    """A bar arrives at a stop with 10 rad/s, at seven instants within its steps.

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
