"""Tendons: lengths, friction at guides, lift-off from pulleys, driven stiffness."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.engine.inspect import inspect
from sandbox.engine.simulate import simulate
from sandbox.model.compile import compile_mechanism
from sandbox.recording.recording import Recording
from sandbox.samples.cables import lifted_at_start
from tests.support.mechanisms import guide

from .machines import G, H, cable, fixed, mass, mechanism, sound

FAR, RADIUS = 0.1, 0.02


def measure(*guides: tuple[Any, ...], bodies: tuple[Any, ...] = (), duration: float = 1e-3,
            step: float = 1e-3) -> Recording:
    """The run of a tendon over guides (body, point, radius, side, more)."""
    written = [{"body": body, "at": at, "radius": radius, "side": side, **(more[0] if more else {})}
               for body, at, radius, side, *more in guides]
    return simulate(mechanism(
        duration=duration, step=step, bodies=[fixed("wall"), *bodies],
        tendons=[{"name": "cord", "guides": written, "stiffness": 1.0}]))


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_tendon_that_grazes_its_wheel_does_not_go_round_it(side: str) -> None:
    """Three points in line: the wrap is 0, not 2 pi, however the rounding falls."""
    for angle in np.linspace(0, 2 * math.pi, 24):
        u = np.array([math.cos(angle), math.sin(angle)])
        centre = 0.05 * u + (1 if side == "right" else -1) * 0.01 * np.array([u[1], -u[0]])
        run = measure(("wall", (0, 0), 0, "left"), ("wall", tuple(centre), 0.01, side),
                      ("wall", tuple(0.1 * u), 0, "left"))
        assert run["cord.length"][0] == pytest.approx(0.1, abs=1e-9)


def test_the_wrap_is_continuous_for_more_than_a_turn() -> None:
    """A point circles a wheel twice: the length grows by r dphi in each step."""
    eye = {"name": "eye", "motion": "scheduled", "at": (FAR, 0.0), "path": {
        "x": f"={FAR} * cos(4 * pi * t)", "y": f"=-{FAR} * sin(4 * pi * t)"}}
    run = measure(("wall", (-FAR, 0), 0, "left"), ("wall", (0, 0), RADIUS, "right", {"turns": 1}),
                  ("eye", (0, 0), 0, "left"), bodies=(eye,), duration=1.0)
    per_step = RADIUS * 4 * math.pi * 1e-3
    np.testing.assert_allclose(np.diff(run["cord.length"])[1:], per_step, rtol=1e-9)


@pytest.mark.parametrize(("path", "response"), [
    ([("beam",), ("m",)], 1), ([("beam",), ("m",), ("beam",)], 4)])
def test_a_tendon_too_stiff_for_the_step_is_damped(path: list[Any], response: float) -> None:
    """From h^2 k response / m = 1 on, where a tendon folded at the load counts four times."""
    for share, rings in ((0.9, True), (1.1, False)):
        run = simulate(mechanism(
            duration=0.1, gravity=(0.0, -G), bodies=[fixed("beam"), mass("m", 0.01, (0.0, -0.1))],
            tendons=[cable("cord", *path, stiffness=share * 0.01 / (H**2 * response))]))
        assert (np.ptp(run["cord.tension"][-20:]) > 0.01) == rings


@pytest.mark.parametrize("stiffness", [100.0, 1e9])
@pytest.mark.parametrize("damping", [0.0, 1.0])
def test_a_spring_of_no_length_exerts_no_force(stiffness: float, damping: float) -> None:
    run = simulate(mechanism(
        duration=0.01, bodies=[fixed("wall"), mass("b", 0.1, (0.0, 0.0))],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "b", "stiffness": stiffness,
                  "damping": damping, "rest_length": 0.1}]))
    np.testing.assert_array_equal(run.arrays["body_velocity"], 0.0)


@pytest.mark.parametrize("most", [70.0, 1e7])
def test_a_tendon_without_stiffness_carries_nothing(most: float) -> None:
    """With 0, below which nothing counts: soft by the pose, or as a row at the step's end.

    Taken up again at the depth that it has fallen to it pulls with what it is then stretched by.
    """
    weight, values = 0.1 * G, [(0.0, 40.0), (0.1, -5.0), (0.2, 40.0), (0.35, most)]
    run = simulate(mechanism(
        duration=0.4, gravity=(0.0, -G), bodies=[fixed("wall"), mass("m", 0.1, (0.0, -0.5))],
        tendons=[cable("c", ("wall",), ("m",), stiffness=40.0, pretension=weight)],
        drives=[{"type": "stiffness", "name": "k", "tendon": "c",
                 "value": {"table": values, "between": "step"}}]))
    falls = (run.time > 0.1) & (run.time < 0.2)
    assert (run["k.value"][falls] == 0).all()
    assert (run["c.tension"][falls] == 0).all()
    assert np.diff(run["m.vy"][falls]) == pytest.approx(-G * H, abs=1e-12)
    assert run["c.tension"][np.flatnonzero(run.time > 0.2)[0]] > weight


def test_a_released_pull_leaves_no_tension_behind_a_guide() -> None:
    """A pull that ends leaves no stretch behind a guide that would still hold some."""
    run = sound(simulate(mechanism(
        duration=0.3, step=H, bodies=[fixed("ground"), mass("load", 1.0, (-0.5, 0.0))],
        joints=[{"type": "weld", "name": "held", "a": "ground", "b": "load",
                 "on_b": (0.0, 0.0)}],
        tendons=[{"name": "cord", "stiffness": 1e4, "guides": [
            guide("load"), guide("ground", friction=0.3), guide("ground", (0.0, -0.5))]}],
        drives=[{"type": "pull", "name": "pull", "tendon": "cord",
                 "value": "=20 if abs(t - 0.15) > 0.05 else 0"}])), "tendon.slack")
    pulls = np.isclose(run["pull.value"], 20.0)
    holds = math.exp(0.3 * math.pi / 2)
    assert run["cord.tension_0"][~pulls] == pytest.approx(np.zeros((~pulls).sum()), abs=1e-9)
    # 20 N e^(-mu phi) again, after just the slip that stretches 0.5 m by it; what slides in the one
    # step makes the span stiffer by the strain, 1.25e-3
    assert run["cord.tension_0"][-1] == pytest.approx(20 / holds, rel=1.3e-3)
    stretched = 20 / holds / (1e4 * 1.0) * 0.5
    assert run["cord.slip_1"][-1] == pytest.approx(stretched, rel=1.3e-3)
    assert run["cord.slip_1"][~pulls][-1] == pytest.approx(0.0, abs=1e-3 * stretched)


def scene(tendon: dict[str, Any], bodies: list[dict[str, Any]], **keys: Any) -> dict[str, Any]:
    return {"bodies": [{"name": "ground", "motion": "fixed"}, *bodies], "tendons": [
        {"name": "cord", **tendon}], "run": {"duration": 1.0, "step": 1e-3, "sample_rate": 1000},
        "gravity": [0, -9.81], **keys}


def moving_pulley(name: str, x: str, y: str, at: tuple[float, float]) -> dict[str, Any]:
    return {"name": name, "motion": "scheduled", "at": at, "path": {"x": x, "y": y}}


def hanging_load(x: float = 1.0) -> dict[str, Any]:
    return {"name": "load", "mass": 1.0, "inertia": 1e-3, "at": (x, -0.8)}


def run_of(scene: dict[str, Any]) -> Recording:
    return sandbox.simulate(sandbox.expand(sandbox.load_scene(scene)))


def tangent(a: complex, ra: float, b: complex, rb: float) -> tuple[complex, float]:
    """Direction and length from circle to circle; radii positive right of the way."""
    length = math.sqrt(abs(b - a)**2 - (ra - rb)**2)
    return (b - a) / (length + 1j * (ra - rb)), length


def shortest_paths(ends: tuple[complex, complex], wheels: list[tuple[complex, float]]) -> Any:
    """Length of the cord, and which wheels it is off: of all choices the one that holds."""
    fits = []
    for on in itertools.product((False, True), repeat=len(wheels)):
        path = [(ends[0], 0.0), *itertools.compress(wheels, on), (ends[1], 0.0)]
        ways = [tangent(*one, *two) for one, two in itertools.pairwise(path)]
        bends = [float(np.angle(before[0] / after[0])) * np.sign(radius) for before, after, (
            _, radius) in zip(ways[:-1], ways[1:], path[1:-1], strict=True)]
        clear = True
        for (centre, radius), is_on in zip(wheels, on, strict=True):
            for (u, length), (start, own) in zip(ways, path[:-1], strict=False):
                place = (centre - start - 1j * own * u) / u
                beside = 0 < place.real < length
                clear &= is_on or not beside or -np.sign(radius) * place.imag >= abs(radius)
        if clear and all(bend >= 0 for bend in bends):
            length = sum(way[1] for way in ways) + sum(
                bend * abs(radius) for bend, (_, radius) in zip(bends, path[1:-1], strict=True))
            fits.append((length, tuple(not one for one in on)))
    return fits


@pytest.mark.parametrize("stiffness", [500.0, 1e5])
def test_a_cable_over_three_moving_pulleys_takes_the_shortest_path(stiffness: float) -> None:
    """From above and below, so that they lay the cord on each other and lift it off."""
    phases, rates, radii = (0.3, 2.0, 4.1), (9.0, 7.0, 11.0), (0.05, 0.08, 0.06)
    signs, xs = (-1, 1, -1), (-0.4, 0.05, 0.45)
    names = ("a", "b", "c")
    heights = [0.06 * s for s in (1, -1, 1)]
    bodies = [moving_pulley(n, f"={x} + 0.03 * sin({p} - {w} * t)",
                            f"={y} + 0.12 * sin({p} + {w} * t)",
                            (x + 0.03 * math.sin(p), y + 0.12 * math.sin(p)))
              for n, x, y, p, w in zip(names, xs, heights, phases, rates, strict=True)]
    guides = [{"body": n, "radius": r, "side": "left" if s < 0 else "right"}
              for n, r, s in zip(names, radii, signs, strict=True)]
    run = run_of(scene({"stiffness": stiffness, "damping": 5.0, "guides": [
        {"body": "ground", "at": (-1.0, 0.0)}, *guides, {"body": "ground", "at": (1.0, 0.0)},
        {"body": "load"}]}, [*bodies, hanging_load()]))
    down = -run["load.y"]
    seen = set()
    for k in range(len(run)):
        wheels = [(complex(run[f"{n}.x"][k], run[f"{n}.y"][k]), s * r)
                  for n, s, r in zip(names, signs, radii, strict=True)]
        (length, off), = shortest_paths((-1.0 + 0j, 1.0 + 0j), wheels)
        assert run["cord.length"][k] == pytest.approx(length + down[k], abs=1e-12)
        assert tuple(run[f"cord.lifted_{n}"][k] == 1 for n in (1, 2, 3)) == off
        seen.add(off)
    assert len(seen) >= 5
    sound(run, "tendon.slack")


def test_a_wheel_that_comes_round_an_end_of_the_cable_is_not_caught_from_its_other_side() -> None:
    """It begins above the cord, goes round its right end and up through it from below."""
    turn = "2 * pi * t"
    path = ("=0.7 + 0.6 * sin({0})", "=0.35 * cos({0})")
    run = run_of(scene({"guides": [
        {"body": "ground", "at": (-1.0, 0.0)}, {"body": "wheel", "radius": 0.05},
        {"body": "load"}]},
        [moving_pulley("wheel", *(each.format(turn) for each in path), (0.7, 0.35)),
         {"name": "load", "mass": 1.0, "inertia": 1e-3, "at": (1.0, 0.0)}], gravity=[0, 0],
        run={"duration": 0.9, "step": 1e-3, "sample_rate": 1000}))
    assert (run["cord.lifted_1"] == 1).all()
    np.testing.assert_allclose(run["cord.length"], 2.0, rtol=0, atol=1e-12)


def pendulum_with_peg(h: float = 5e-4, **guide: Any) -> dict[str, Any]:
    return {"gravity": [0, -9.81], "run": {"duration": 1.25, "step": h, "sample_rate": 1 / h},
            "bodies": [{"name": "ground", "motion": "fixed"}, {
                "name": "bob", "mass": 1.0, "inertia": 1e-3, "at": (0.3, -0.4)}],
            "tendons": [{"name": "cord", "guides": [
                {"body": "ground"},
                {"body": "ground", "at": (-0.01, -0.3), "radius": 0.01, "side": "right", **guide},
                {"body": "bob"}]}]}


@pytest.mark.parametrize(("guide", "tendon"), [
    ({"turns": 1}, {}), ({"friction": 0.2}, {}), ({"radius": 0.0}, {}),
    ({}, {"closed": True, "pretension": 1.0})])
def test_whole_turns_wheels_that_grip_eyes_and_loops_are_never_left(
    guide: dict[str, Any], tendon: dict[str, Any],
) -> None:
    scene = pendulum_with_peg(**guide)
    scene["tendons"][0] |= tendon
    mechanism = sandbox.expand(sandbox.load_scene(scene))
    assert not lifted_at_start(compile_mechanism(mechanism)).any()


@pytest.mark.parametrize(("side", "off"), [("right", True), ("left", False)])
def test_a_cable_begins_off_a_wheel_that_is_clear_of_it_on_its_side(side: str, off: bool) -> None:
    mechanism = sandbox.expand(sandbox.load_scene(pendulum_with_peg(side=side)))
    assert lifted_at_start(compile_mechanism(mechanism)).tolist() == [False, off, False]
    problems = [p for p in inspect(mechanism) if "off its wheel" in p.message]
    assert [p.path for p in problems] == ["$.tendons[0].guides[1]"] * off
    # the cord's line is 3/5 x + 4/5 y = 0 turned: the peg's centre lies so far from it
    assert all("178 mm away" in p.message for p in problems)


def test_wrong_starts_on_a_pulley_are_reported() -> None:
    """Told to begin off a clear wheel nothing is said; off one in its way is an error; so is on."""
    def words(**guide: Any) -> list[tuple[str, str, str]]:
        mechanism = sandbox.expand(sandbox.load_scene(pendulum_with_peg(**guide)))
        return [(p.path, p.severity, p.message) for p in inspect(mechanism)
                if p.path.startswith("$.tendons[0].guides")]

    assert words(begins="off") == words(begins="on") == []
    (path, severity, message), = words(begins="off", side="left")
    assert (path, severity) == ("$.tendons[0].guides[1].begins", "error")
    assert "198 mm inside" in message  # its far side: 2 r beyond what it is clear by on the right
    (path, severity, message), = words(begins="off", turns=1)
    assert (path, severity) == ("$.tendons[0].guides[1].begins", "warning")


def test_a_cable_that_begins_on_a_pulley_may_cross_itself() -> None:
    scene = sandbox.load_scene(pendulum_with_peg(begins="on", radius=0.05))
    run = sandbox.simulate(sandbox.expand(scene))
    assert run["cord.lifted_1"][0] == 0
    a, c, b = 0j, complex(-0.01, -0.3), complex(0.3, -0.4)
    on, off = tangent(a, 0.0, c, 0.05), tangent(c, 0.05, b, 0.0)
    bend = float(np.angle(on[0] / off[0])) % (2 * math.pi)
    assert bend > math.pi
    assert run.arrays["tendon_initial"][0] == pytest.approx(on[1] + off[1] + 0.05 * bend, abs=1e-14)
