"""Contacts: orientation, forces at rest, friction, restitution."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording

from .machines import G, disc, fixed, mechanism, sound

BALL = disc("thing", 0.01, (0.0, 0.0205))
CRATE = {"name": "thing", "mass": 0.1, "at": (0.0, 0.0205),
         "shapes": [{"type": "box", "size": (0.02, 0.02)}]}
PRISM = {**CRATE, "centre": (0.0, 0.0), "shapes": [
    {"type": "polygon", "points": [(-0.01, -0.01), (0.01, -0.01), (0.0, 0.01)]}]}
ROLL = {**CRATE, "shapes": [
    {"type": "capsule", "start": (-0.01, 0.0), "end": (0.01, 0.0), "radius": 0.01}]}
TABLE: dict[str, list[dict[str, Any]]] = {
    "box": [{"type": "box", "size": (1.0, 0.02)}],
    "capsule": [{"type": "capsule", "start": (-0.5, 0.0), "end": (0.5, 0.0), "radius": 0.01}],
    "polygon": [{"type": "polygon", "points": [(-0.5, 0.01), (0.5, 0.01), (0.0, -0.1)]}],
    "disc": [{"type": "circle", "radius": 0.5, "at": (0.0, -0.49)}],
}


@pytest.mark.parametrize("table", TABLE)
@pytest.mark.parametrize(
    "thing", [BALL, CRATE, PRISM, ROLL], ids=["ball", "crate", "prism", "roll"])
@pytest.mark.parametrize("moving_first", [True, False])
def test_what_lies_is_carried(thing: dict[str, Any], table: str, moving_first: bool) -> None:
    """The force on the moving body by the fixed one is m g upward, whatever the order of the two in
    the scene and of their shapes in pymunk; normal up, sunk by nothing.

    Flat on a disc of 0.5 m the normal stays within 1e-9 of up as nothing tips it.
    """
    bodies = [thing, fixed("table", shapes=TABLE[table])]
    run = simulate(mechanism(
        duration=0.4, gravity=(0.0, -G), bodies=bodies if moving_first else bodies[::-1]))
    rows = run.arrays["contact_sample"] == len(run.time) - 1
    assert rows.sum() == 1
    last = {key: run.arrays[f"contact_{key}"][rows][0]
            for key in ("body", "other", "force", "normal", "gap", "point")}
    names = [body["name"] for body in (bodies if moving_first else bodies[::-1])]
    assert (names[last["body"]], names[last["other"]]) == ("thing", "table")
    np.testing.assert_allclose(last["force"], [0.0, 0.1 * G], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(last["normal"], [0.0, 1.0], atol=1e-9)
    assert abs(last["gap"]) < 1e-9
    np.testing.assert_allclose(last["point"], [0.0, 0.01], atol=1e-6)


# -- friction --------------------------------------------------------------------------


def incline(angle: float, *, of_block: float, of_plane: float, rule: float | None = None,
            ) -> Recording:
    """A block on a plane tilted by ``angle``, by tilting gravity."""
    return simulate(mechanism(
        duration=0.3, gravity=(G * np.sin(angle), -G * np.cos(angle)),
        materials={"block": {"friction": of_block}, "plane": {"friction": of_plane}},
        bodies=[fixed("plane", material="plane", shapes=[{"type": "box", "size": (4.0, 0.02)}]),
                {"name": "block", "mass": 0.1, "at": (0.0, 0.02), "material": "block",
                 "shapes": [{"type": "box", "size": (0.06, 0.02)}]}],
        contacts=[] if rule is None else [{"between": ("block", "plane"), "friction": rule}]))


SLOPE = np.radians(25.0)
MU = np.tan(SLOPE)


@pytest.mark.parametrize(("excess", "slides"), [(1.01, False), (0.99, True)])
@pytest.mark.parametrize("share", [1.0, 0.25])
def test_friction_is_the_geometric_mean(excess: float, slides: bool, share: float) -> None:
    """sqrt(mu1 mu2) a hundredth above tan(angle) holds, a hundredth below slides with
    g (sin - mu cos): in 0.3 s with 0.04 m/s^2 that is 1.9 mm.
    """
    run = incline(SLOPE, of_block=excess * MU * share, of_plane=excess * MU / share)
    expected = 0.01 * np.sin(SLOPE) * G * 0.3**2 / 2 if slides else 0.0
    # begins 3 steps late (fall into contact) at most: 1 % of the way, and 3 um
    assert run["block.x"][-1] == pytest.approx(expected, rel=0.02, abs=5e-6)


def test_a_rule_concerns_its_pair_only() -> None:
    """Of two like blocks on one plane, one slippery by rule, only that one slides."""
    block = {"mass": 0.1, "material": "rough", "shapes": [{"type": "box", "size": (0.06, 0.02)}]}
    run = simulate(mechanism(
        duration=0.2, gravity=(G * np.sin(SLOPE), -G * np.cos(SLOPE)),
        materials={"rough": {"friction": 0.9}},
        bodies=[fixed("plane", material="rough", shapes=[{"type": "box", "size": (4.0, 0.02)}]),
                {"name": "one", "at": (0.0, 0.02), **block},
                {"name": "two", "at": (-1.0, 0.02), **block}],
        contacts=[{"between": ("one", "plane"), "friction": 0.0}]))
    # without friction: g sin(angle) t^2 / 2; the scheme is off by a h^2 / 8 and one step's v h
    assert run["one.x"][-1] == pytest.approx(G * np.sin(SLOPE) * 0.2**2 / 2, rel=5e-3)
    assert run["two.x"][-1] == pytest.approx(-1.0, abs=5e-6)
    assert run["one/plane.tangential"][-1] == 0.0


@pytest.mark.parametrize(("tangent", "rolls"), [(0.89, True), (0.91, False)])
def test_what_rolls_is_held_by_static_friction(tangent: float, rolls: bool) -> None:
    """A disc on a slope needs tan / 3 to roll; else it slides with g (sin - mu cos) at once."""
    slope = np.arctan(tangent)
    run = sound(simulate(mechanism(
        duration=0.2, gravity=(G * np.sin(slope), -G * np.cos(slope)),
        materials={"rough": {"friction": 0.2, "static": 1.5}},
        bodies=[fixed("plane", material="rough", shapes=[{"type": "box", "size": (4.0, 0.02)}]),
                disc("disc", 0.02, (0.0, 0.03), material="rough")])))
    gains = 2 / 3 * G * np.sin(slope) if rolls else G * (np.sin(slope) - 0.2 * np.cos(slope))
    assert run["disc.vx"] == pytest.approx(gains * run.time, abs=1e-9)


def test_what_lands_sliding_is_not_held_by_static_friction() -> None:
    """It loses mu times its blow, and then mu g t."""
    fall, mu = 1.0, 0.2
    run = sound(simulate(mechanism(
        duration=0.1, gravity=(0.0, -G), materials={"rough": {"friction": mu, "static": 2.0}},
        bodies=[fixed("plane", material="rough", shapes=[{"type": "box", "size": (4.0, 0.02)}]),
                {"name": "block", "mass": 1.0, "at": (0.0, 0.0205), "velocity": (1.0, -fall),
                 "material": "rough", "shapes": [{"type": "box", "size": (0.3, 0.02)}]}])))
    # all of its speed downwards is gone at the first step that it ends on the plane
    assert run["block.vx"][-1] == pytest.approx(1.0 - mu * (fall + G * run.time[-1]), abs=1e-9)


def test_restitution() -> None:
    """sqrt(e1 e2) of the speed comes back: 0.5 m/s in free space against a fixed box."""
    run = simulate(mechanism(
        duration=0.05, materials={"a": {"restitution": 0.64}, "b": {"restitution": 1.0}},
        bodies=[fixed("wall", material="b", shapes=[{"type": "box", "size": (0.02, 1.0)}]),
                disc("ball", 0.01, (0.03, 0.0), velocity=(-0.5, 0.0), material="a")]))
    assert run["ball.vx"][-1] == pytest.approx(0.5 * 0.8, rel=1e-9)


def test_pairs_at_rest_leave_no_rows() -> None:
    """A scheduled body inside a fixed one, and another: pymunk lists them, nobody feels them."""
    shape = [{"type": "circle", "radius": 0.01}]
    path = {"x": {"expression": "=0.01 * t"}}
    run = simulate(mechanism(duration=0.02, bodies=[
        fixed("wall", shapes=shape),
        {"name": "m", "motion": "scheduled", "path": path, "shapes": shape},
        {"name": "n", "motion": "scheduled", "path": path, "shapes": shape}]))
    assert len(run.arrays["contact_body"]) == 0
    assert run["m.x"][-1] == pytest.approx(0.01 * run.time[-1], rel=1e-9)


@pytest.mark.parametrize("count", [3, 5])
def test_a_bar_on_feet_in_line_stays_put(count: int) -> None:
    """Pushed aside by less than friction holds: it does not move at all, and carries its weight."""
    x = np.linspace(-0.1, 0.1, count)
    run = simulate(mechanism(
        duration=0.5, gravity=(1.0, -G),
        bodies=[fixed("floor", shapes=[{"type": "box", "size": (2.0, 0.02)}]),
                {"name": "bar", "mass": 0.2, "inertia": 5e-4, "at": (0.0, 0.02), "shapes": [
                    {"type": "circle", "radius": 0.01, "at": (float(at), 0.0)} for at in x]}],
        contacts=[{"between": ("bar", "floor"), "friction": 0.5}]))
    late = run.time > 0.05
    for name in ("bar.x", "bar.y", "bar.angle"):
        assert np.ptp(run[name][late]) == 0.0
    np.testing.assert_allclose(run["bar/floor.normal"][late], 0.2 * G, rtol=1e-9)
    np.testing.assert_allclose(np.abs(run["bar/floor.tangential"][late]), 0.2, rtol=1e-6)
