"""Each joint keeps what it says it keeps, while forces do their best to the contrary.

Chipmunk solves joints on velocities; with the whole gap closed in the next step (error_bias 0), a
joint between bodies that move at speed v and turn at rate w is left with what the step's curvature
adds, about v w h^2: 1 m/s, 20 rad/s and 0.5 ms make 5 um, called GAP below.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.engine.world import RECOVERY
from sandbox.kinds.elements import STOP_SLOP
from sandbox.recording.recording import Recording

from .machines import G, H, fixed, mass, mechanism

GAP = 5e-6


def place(run: Recording, body: str, point: tuple[float, float]) -> np.ndarray:
    """World track of a point of a body, [n, 2]."""
    x, y, angle = (run[f"{body}.{q}"] for q in ("x", "y", "angle"))
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]], axis=1)


def bar(name: str, at: tuple[float, float], **more: Any) -> dict[str, Any]:
    """A slim bar of 0.1 m, its frame at one end, its mass in the middle."""
    return {"name": name, "mass": 0.05, "inertia": 4e-5, "at": at, "centre": (0.05, 0.0), **more}


def test_pin_keeps_its_anchors_together() -> None:
    """A double pendulum let go from the side."""
    run = simulate(mechanism(
        duration=0.5, gravity=(0.0, -G),
        bodies=[fixed("wall"), bar("a", (0, 0)), bar("b", (0.1, 0))],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "a", "on_a": (0, 0)},
                {"type": "pin", "name": "q", "a": "a", "b": "b", "on_b": (0, 0)}]))
    assert np.abs(place(run, "a", (0, 0))).max() < GAP
    np.testing.assert_allclose(place(run, "a", (0.1, 0)), place(run, "b", (0, 0)), atol=GAP)
    assert np.ptp(run["p.angle"]) > 1.0  # and it did swing
    np.testing.assert_allclose(
        run["q.angle"], run["b.angle"] - run["a.angle"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("positive", ["counterclockwise", "clockwise"])
@pytest.mark.parametrize("torque", [0.02, -0.02])
def test_stops(positive: str, torque: float) -> None:
    """Driven with tau against a stop, a hinge rests there: angle on the limit, stop torque -tau.

    Both in the hinge's positive sense, zero 0.1 rad off the frames'. The overrun goes with the
    time constant RECOVERY until STOP_SLOP is left, after which hinge and torque are steady.
    """
    run = simulate(mechanism(
        duration=0.3, bodies=[fixed("wall"), bar("a", (0, 0))],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "a", "on_a": (0, 0), "zero": 0.1,
                 "limits": (-0.5, 0.7), "positive": positive}],
        drives=[{"type": "torque", "name": "t", "joint": "p", "value": torque}]))
    limit = 0.7 if torque > 0 else -0.5
    beyond = (run["p.angle"][-100:] - limit) * np.sign(torque)
    assert (beyond > 0).all()
    assert (beyond < STOP_SLOP * 1.001).all()
    np.testing.assert_allclose(run["p.stop"][-100:], -torque, rtol=1e-6)
    assert run["p.angle"].min() > -0.5 - 1e-2
    assert run["p.angle"].max() < 0.7 + 1e-2
    free = np.abs(run["p.angle"] - 0.1) < 0.3
    assert (run["p.stop"][free] == 0).all()
    sign = 1.0 if positive == "counterclockwise" else -1.0
    assert run["a.angle"][-1] == pytest.approx(sign * (limit + 0.1), abs=1.001 * STOP_SLOP)


@pytest.mark.parametrize("turns", [True, False])
def test_slot(turns: bool) -> None:
    """A body's point runs along a slanted groove of a wall; a slider keeps its angle, too.

    Down the slope it gains g sin(30 deg) t: 0.5 s would be 0.6 m, but the groove ends after 0.3 m.
    Chipmunk projects the impulse of a groove after solving for both axes, so that it converges on
    a speed across it of v K_nt / K_tt, K = 1/m + (r x n)(r x t) / I, against a bias d / h: it runs
    d = h v r^2 m / (2 I) aside at most, r = 22 mm from its centre of mass, 0.175 mm at 1.4 m/s.
    """
    aside = H * 1.4 * (0.01**2 + 0.02**2) * 0.1 / (2 * 1e-4)
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
    arrived = int(np.argmax(along > 0.3))
    assert arrived > 0
    assert np.abs(across).max() < aside
    # it arrives with sqrt(2 g sin(30) 0.2) = 1.4 m/s: at most a step's way past the end, once
    assert along.max() < 0.3 + 1.5 * H
    if turns:
        assert np.ptp(run["a.angle"]) > 0.1
    else:
        np.testing.assert_allclose(run["a.angle"], 0.2, atol=1e-6)


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
    np.testing.assert_allclose(place(run, "a", (0.1, 0)), place(run, "b", (0, 0)), atol=GAP)
    np.testing.assert_allclose(run["b.angle"] - run["a.angle"], 0.5, atol=1e-6)
    np.testing.assert_allclose(run["a.omega"], 5.0, rtol=1e-3)
    middle = (place(run, "a", (0.05, 0.0)) + place(run, "b", (0.05, 0.0))) / 2
    np.testing.assert_allclose(
        middle - middle[0], np.outer(run.time - run.time[0], [0.5 - 2.5 * y, 2.5 * x]), atol=1e-9)


@pytest.mark.parametrize("length", [None, 0.25])
def test_rod(length: float | None) -> None:
    """A pendulum on a massless rod, as long as it stands, or as told and pulled in at once."""
    run = simulate(mechanism(
        duration=0.5, gravity=(0.0, -G), bodies=[fixed("wall"), mass("m", 0.1, (0.2, 0.0))],
        joints=[{"type": "rod", "name": "r", "a": "wall", "b": "m",
                 **({} if length is None else {"length": length})}]))
    distance = np.hypot(run["m.x"], run["m.y"])
    np.testing.assert_allclose(distance[2:], length or 0.2, atol=GAP if length is None else 1e-3)


def test_rod_of_its_own_length_is_not_fooled_by_speed() -> None:
    """Its length is that at t = 0, though bodies in motion enter pymunk half a step before."""
    run = simulate(mechanism(
        duration=0.2, bodies=[fixed("wall"), mass("m", 0.1, (0.2, 0.0), velocity=(0.0, 3.0))],
        joints=[{"type": "rod", "name": "r", "a": "wall", "b": "m"}]))
    # a step along the tangent stands off by (v h)^2 / (2 r)
    np.testing.assert_allclose(
        np.hypot(run["m.x"], run["m.y"]), 0.2, atol=1.1 * (3 * H)**2 / (2 * 0.2))
    assert run["r.reaction"][-1] == pytest.approx(0.1 * 9 / 0.2, rel=1e-3)  # m v^2 / r


def test_rope() -> None:
    """Free in between, no longer than its longest, no shorter than its shortest.

    Overrun by up to v h in one step, it brings that back within RECOVERY: what bounces back is
    v h / RECOVERY at most, whatever the instant of impact.
    """
    def hung(speed: float) -> Recording:
        return simulate(mechanism(
            duration=0.4, bodies=[fixed("wall"), mass("m", 0.1, (0.2, 0.0), velocity=(speed, 0.0))],
            joints=[{"type": "rope", "name": "r", "a": "wall", "b": "m", "longest": 0.3,
                     "shortest": 0.1}]))

    out, back = hung(1.0), hung(-1.0)
    # at most one step's way past its end, 1 m/s * h, until that step's impulse stops it
    assert 0.3 - 1e-9 < out["m.x"].max() < 0.3 + H
    assert 0.1 - H < back["m.x"].min() < 0.1 + 1e-9
    free = out.time < 0.09
    np.testing.assert_allclose(out["m.x"][free], 0.2 + out.time[free], atol=1e-12)
    assert (out["r.reaction"][free] == 0).all()
    most = 1.0 * H / RECOVERY
    assert -most <= out["m.vx"][-1] <= 0.0 <= back["m.vx"][-1] <= most


@pytest.mark.parametrize("start", np.linspace(0.2, 0.2 + 3 * H, 7))
def test_a_stop_gives_back_little_and_less_with_the_step(start: float) -> None:
    """A bar arrives at a stop with 10 rad/s, at seven instants within its steps.

    It overruns by up to omega h, which RECOVERY brings back at omega h / RECOVERY.
    """
    run = simulate(mechanism(
        duration=0.1, bodies=[fixed("wall"), {"name": "a", "mass": 0.05, "inertia": 4e-5,
                                              "angular_velocity": 10.0}],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "a", "on_a": (0, 0),
                 "limits": (-1.0, float(start))}]))
    assert -10 * H / RECOVERY <= run["p.rate"][-1] <= 1e-9
    assert run["p.angle"].max() < start + 10 * H


@pytest.mark.parametrize("torque", [1e-4, 3e-3, 0.02])
def test_leaning_on_a_stop_from_the_start_does_not_rattle(torque: float) -> None:
    """A hinge that stands on its limit and is pressed on rests, its stop's torque the drive's.

    From 0.2 s on, when exp(-0.2 / RECOVERY) = 4e-18 of the first overrun is left.

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
    late = run.time > 0.2
    np.testing.assert_allclose(run["p.stop"][late], torque, rtol=1e-9)
    assert np.abs(run["p.rate"][late]).max() < 1e-9
    assert np.abs(run["p.angle"][late]).max() < 1.001 * STOP_SLOP
