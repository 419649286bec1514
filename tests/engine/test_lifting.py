"""Cords that lift off their wheels and come back: against the shortest way, and themselves."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.audit.audit import audit
from sandbox.engine.inspect import inspect
from sandbox.model.compile import compile_mechanism
from sandbox.model.tendons import lifted_at_start
from sandbox.recording.recording import Recording


def _scene(tendon: dict[str, Any], bodies: list[dict[str, Any]], **keys: Any) -> dict[str, Any]:
    return {"bodies": [{"name": "ground", "motion": "fixed"}, *bodies], "tendons": [
        {"name": "cord", **tendon}], "run": {"duration": 1.0, "step": 1e-3, "sample_rate": 1000},
        "gravity": [0, -9.81], **keys}


def _wheel(name: str, x: str, y: str, at: tuple[float, float]) -> dict[str, Any]:
    return {"name": name, "motion": "scheduled", "at": at, "path": {"x": x, "y": y}}


def _load(x: float = 1.0) -> dict[str, Any]:
    return {"name": "load", "mass": 1.0, "inertia": 1e-3, "at": (x, -0.8)}


def _run(scene: dict[str, Any]) -> Recording:
    return sandbox.simulate(sandbox.expand(sandbox.load_scene(scene)))


def _tangent(a: complex, ra: float, b: complex, rb: float) -> tuple[complex, float]:
    """Direction and length from circle to circle; radii positive right of the way."""
    length = math.sqrt(abs(b - a)**2 - (ra - rb)**2)
    return (b - a) / (length + 1j * (ra - rb)), length


def _shortest(ends: tuple[complex, complex], wheels: list[tuple[complex, float]]) -> Any:
    """Length of the cord, and which wheels it is off: of all choices the one that holds."""
    fits = []
    for on in itertools.product((False, True), repeat=len(wheels)):
        path = [(ends[0], 0.0), *itertools.compress(wheels, on), (ends[1], 0.0)]
        ways = [_tangent(*one, *two) for one, two in itertools.pairwise(path)]
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
def test_three_wheels_are_taken_up_and_left_as_the_shortest_way_has_it(stiffness: float) -> None:
    """From above and below, so that they lay the cord on each other and lift it off."""
    phases, rates, radii = (0.3, 2.0, 4.1), (9.0, 7.0, 11.0), (0.05, 0.08, 0.06)
    signs, xs = (-1, 1, -1), (-0.4, 0.05, 0.45)
    names = ("a", "b", "c")
    heights = [0.06 * s for s in (1, -1, 1)]
    bodies = [_wheel(n, f"={x} + 0.03 * sin({p} - {w} * t)",
                     f"={y} + 0.12 * sin({p} + {w} * t)",
                     (x + 0.03 * math.sin(p), y + 0.12 * math.sin(p)))
              for n, x, y, p, w in zip(names, xs, heights, phases, rates, strict=True)]
    guides = [{"body": n, "radius": r, "side": "left" if s < 0 else "right"}
              for n, r, s in zip(names, radii, signs, strict=True)]
    run = _run(_scene({"stiffness": stiffness, "damping": 5.0, "guides": [
        {"body": "ground", "at": (-1.0, 0.0)}, *guides, {"body": "ground", "at": (1.0, 0.0)},
        {"body": "load"}]}, [*bodies, _load()]))
    down = -run["load.y"]
    seen = set()
    for k in range(len(run)):
        wheels = [(complex(run[f"{n}.x"][k], run[f"{n}.y"][k]), s * r)
                  for n, s, r in zip(names, signs, radii, strict=True)]
        (length, off), = _shortest((-1.0 + 0j, 1.0 + 0j), wheels)
        assert run["cord.length"][k] == pytest.approx(length + down[k], abs=1e-12)
        assert tuple(run[f"cord.lifted_{n}"][k] == 1 for n in (1, 2, 3)) == off
        seen.add(off)
    assert len(seen) >= 5
    assert all(figure.verdict != "look" for figure in audit(run) if figure.name != "tendon.slack")


def test_a_wheel_that_comes_round_an_end_of_the_cord_is_not_caught_from_its_other_side() -> None:
    """It begins above the cord, goes round its right end and up through it from below."""
    turn = "2 * pi * t"
    path = ("=0.7 + 0.6 * sin({0})", "=0.35 * cos({0})")
    run = _run(_scene({"guides": [
        {"body": "ground", "at": (-1.0, 0.0)}, {"body": "wheel", "radius": 0.05},
        {"body": "load"}]},
        [_wheel("wheel", *(each.format(turn) for each in path), (0.7, 0.35)),
         {"name": "load", "mass": 1.0, "inertia": 1e-3, "at": (1.0, 0.0)}], gravity=[0, 0],
        run={"duration": 0.9, "step": 1e-3, "sample_rate": 1000}))
    assert (run["cord.lifted_1"] == 1).all()
    np.testing.assert_allclose(run["cord.length"], 2.0, rtol=0, atol=1e-12)


def _pegged(h: float = 5e-4, **guide: Any) -> dict[str, Any]:
    return {"gravity": [0, -9.81], "run": {"duration": 1.25, "step": h, "sample_rate": 1 / h},
            "bodies": [{"name": "ground", "motion": "fixed"}, {
                "name": "bob", "mass": 1.0, "inertia": 1e-3, "at": (0.3, -0.4)}],
            "tendons": [{"name": "cord", "guides": [
                {"body": "ground"},
                {"body": "ground", "at": (-0.01, -0.3), "radius": 0.01, "side": "right", **guide},
                {"body": "bob"}]}]}


@pytest.mark.parametrize("guide", [{"turns": 1}, {"friction": 0.2}, {"radius": 0.0}])
def test_whole_turns_wheels_that_grip_and_eyes_are_never_left(guide: dict[str, Any]) -> None:
    mechanism = sandbox.expand(sandbox.load_scene(_pegged(**guide)))
    assert mechanism.tendons[0].lifting == ()
    assert not lifted_at_start(compile_mechanism(mechanism)).any()


def test_a_loop_begins_on_its_wheels() -> None:
    scene = _pegged()
    scene["tendons"][0] |= {"closed": True, "pretension": 1.0}
    assert not lifted_at_start(compile_mechanism(
        sandbox.expand(sandbox.load_scene(scene)))).any()


@pytest.mark.parametrize(("side", "off"), [("right", True), ("left", False)])
def test_a_cord_begins_off_a_wheel_that_is_clear_of_it_on_its_side(side: str, off: bool) -> None:
    mechanism = sandbox.expand(sandbox.load_scene(_pegged(side=side)))
    assert lifted_at_start(compile_mechanism(mechanism)).tolist() == [False, off, False]
    problems = [p for p in inspect(mechanism) if "off its wheel" in p.message]
    assert [p.path for p in problems] == ["$.tendons[0].guides[1]"] * off
    # the cord's line is 3/5 x + 4/5 y = 0 turned: the peg's centre lies so far from it
    assert all("178 mm away" in p.message for p in problems)


def test_what_is_said_of_where_a_cord_begins() -> None:
    """Told to begin off a clear wheel nothing is said; off one in its way is an error; so is on."""
    def said(**guide: Any) -> list[tuple[str, str, str]]:
        mechanism = sandbox.expand(sandbox.load_scene(_pegged(**guide)))
        return [(p.path, p.severity, p.message) for p in inspect(mechanism)
                if p.path.startswith("$.tendons[0].guides")]

    assert said(begins="off") == said(begins="on") == []
    (path, severity, message), = said(begins="off", side="left")
    assert (path, severity) == ("$.tendons[0].guides[1].begins", "error")
    assert "198 mm deep" in message  # its far side: 2 r beyond what it is clear by on the right
    (path, severity, message), = said(begins="off", turns=1)
    assert (path, severity) == ("$.tendons[0].guides[1].begins", "warning")


def test_a_cord_told_to_begin_on_a_wheel_goes_round_it_and_crosses_itself() -> None:
    scene = sandbox.load_scene(_pegged(begins="on", radius=0.05))
    run = sandbox.simulate(sandbox.expand(scene))
    assert run["cord.lifted_1"][0] == 0
    a, c, b = 0j, complex(-0.01, -0.3), complex(0.3, -0.4)
    on, off = _tangent(a, 0.0, c, 0.05), _tangent(c, 0.05, b, 0.0)
    bend = float(np.angle(on[0] / off[0])) % (2 * math.pi)
    assert bend > math.pi
    assert run.arrays["tendon_initial"][0] == pytest.approx(on[1] + off[1] + 0.05 * bend, abs=1e-14)
