"""Warnings about the reach of fingers and the travel of differentials."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sandbox.engine.inspect import inspect
from sandbox.engine.inspect_hands import reaches, ways
from sandbox.engine.simulate import simulate
from sandbox.model.compile import compile_mechanism
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

FINGER: dict[str, Any] = {
    "type": "finger", "lengths": [0.045, 0.026, 0.021], "radii": [0.009, 0.008, 0.0075],
    "masses": [0.012, 0.006, 0.004], "damping": [4e-3, 1.2e-3, 3e-4],
    "guides": [[-0.022, -0.014], [0.024, -0.008], [0.010, -0.003], [0.004, -0.001]],
    "limits": ["85 deg", "80 deg", "75 deg"]}


def hand(*objects: dict[str, Any], palm: bool = False, gravity: tuple[float, float] = (0.0, 0.0),
         **finger: Any) -> Mechanism:
    bodies: list[dict[str, Any]] = [
        {"name": f"object{i}", "motion": "fixed", "role": "object", **written}
        for i, written in enumerate(objects)]
    if palm:
        bodies.append({"name": "wrist", "mass": 1, "inertia": 1})
        finger["on"] = "wrist"
    return expand(load_scene({
        "gravity": gravity, "bodies": bodies, "parts": [{**FINGER, "name": "finger", **finger}]}))


def disc(x: float, y: float, radius: float = 0.01, **more: Any) -> dict[str, Any]:
    return {"at": [x, y], "shapes": [{"type": "circle", "radius": radius}], **more}


def reach_of(mechanism: Mechanism) -> list[tuple[str, str, str]]:
    return [(problem.element, problem.message, problem.advice) for problem in inspect(mechanism)
            if "reaches" in problem.message]


@pytest.mark.parametrize("mechanism", [
    hand(disc(0.12, -0.04), disc(-0.2, 0)),
    hand(disc(0.12, -0.04, motion="dynamic", mass=1))], ids=["fixed", "free"])
def test_a_finger_that_is_too_short_is_reported(mechanism: Mechanism) -> None:
    """45 + 26 + 21 + 7.5 mm from the hinge to the tip; to a disc of 10 mm at (120, -40): 116.5."""
    assert reach_of(mechanism) == [(
        "finger", "reaches 99.5 mm from its first hinge, and the nearest object that it may touch, "
        "'object0', is 116.5 mm from it", "move either by 16.99 mm or more, or make it longer")]


@pytest.mark.parametrize("mechanism", [
    hand(disc(0.1, 0)),
    hand(),
    hand(disc(0.12, -0.04), disc(0.02, -0.04)),
    hand(disc(0.12, -0.04, motion="dynamic", mass=1, velocity=[-0.1, 0])),
    hand(disc(0.12, -0.04, motion="dynamic", mass=1), disc(0.05, -0.04)),
    hand(disc(0.12, 0.2, motion="dynamic", mass=1), gravity=[-0.6, -1]),
    hand(disc(0.12, -0.04, motion="dynamic", mass=1), palm=True),
    hand(disc(0.12, -0.04, role="ground")),
    hand(disc(0.12, -0.04, plane=3)),
    hand(disc(0.12, -0.04), palm=True)],
    ids=["within reach", "no object", "another one", "it comes",
         "another one may push it", "it falls there", "its hand may come", "no object",
         "never touched", "the hand may come"])
def test_reachable_objects_are_not_reported(mechanism: Mechanism) -> None:
    assert not reach_of(mechanism)


def pair(travel: str, *, tree: str = "pulley_tree", **finger: Any) -> Mechanism:
    """Two fingers, the second scaled to 0.8, on one wheel or rocker; nothing to hold."""
    return expand(load_scene({
        "run": {"duration": "3 s", "step": "1 ms"},
        "parts": [{**FINGER, "name": "long", "at": [0, 0.15], **finger},
                  {"type": "assembly", "name": "small", "scale": 0.8,
                   "parts": [{**FINGER, "name": "short", **finger}]},
                  {"type": tree, "name": "tree", "pulls": ["long", "small.short"],
                   "travel": travel}],
        "drives": [{"type": "pull", "name": "pull", "tendon": "tree",
                    "value": {"ramp": {"to": "8 N", "over": "1 s"}}}]}))


def test_the_travel_of_a_hand_that_closes_on_nothing() -> None:
    """Run until all hinges are at their stops: the wheel's centre has gone the mean of both.

    The cords of 100 kN/m give by 4 N / 100 kN/m each, 40 um; the pull's own is not on the way.
    """
    mechanism = pair("80 mm")
    way = ways(compile_mechanism(mechanism), ("tree.pulley1",))["tree.pulley1"]
    run = simulate(mechanism)
    assert run["long.mcp.angle"][-1] == pytest.approx(1.4835, abs=1e-3)
    gone = run["tree.pulley1.x"][0] - run["tree.pulley1.x"][-1]
    assert gone == pytest.approx(way + 40e-6, abs=2e-6)


@pytest.mark.parametrize("tree", ["pulley_tree", "rocker_tree"])
def test_slots_that_are_too_short_are_reported(tree: str) -> None:
    (line,) = reaches(compile_mechanism(pair("30 mm", tree=tree)))
    name = "tree.pulley1" if tree == "pulley_tree" else "tree.rocker1"
    way = ways(compile_mechanism(pair("30 mm", tree=tree)), (name,))[name]
    assert line.endswith(f"'{name}' would have to move {1e3 * way:.4g} mm")
    for fits in (pair("45 mm", tree=tree), pair("10 mm", tree=tree, limits=None)):
        (enough,) = reaches(compile_mechanism(fits))
        assert "to close the empty hand" not in enough


def two_loads(held: int = 1, **tree: Any) -> Mechanism:
    """Loads 40 mm apart on slides along x, of which ``held`` stay, pulled along -x."""
    return expand(load_scene({
        "run": {"duration": 2.0},
        "bodies": [
            {"name": "rail", "motion": "fixed"},
            *({"name": f"load{i}", "mass": 0.02, "inertia": 1e-5, "at": [0, 0.04 * i]}
              if i >= held else {"name": f"load{i}", "motion": "fixed", "at": [0, 0.04 * i]}
              for i in range(2))],
        "joints": [{"type": "slot", "name": f"slide{i}", "a": "rail", "b": f"load{i}",
                    "start": [-0.2, 0.04 * i], "end": [0.1, 0.04 * i], "turns": False}
                   for i in range(held, 2)],
        "springs": [{"type": "linear", "name": f"back{i}", "a": "rail", "b": f"load{i}",
                     "on_a": [0.1, 0.04 * i], "stiffness": 20, "damping": 5}
                    for i in range(held, 2)],
        "parts": [{"type": "rocker_tree", "name": "tree", "pulls": ["load0", "load1"], **tree}],
        "drives": [{"type": "pull", "name": "pull", "tendon": "tree", "value": 20}]}))


@pytest.mark.parametrize("links", ["tendon", "rope"])
def test_a_rocker_turns_over_at_the_predicted_travel(links: str) -> None:
    """20 N against 20 N/m would draw load1 far on: it stops a + b = 40 mm on.

    The rocker then lies along its strings, which slant by 20 mm over 280 to 320: so far from the
    pull. A slanted string is short of sqrt(300^2 + 20^2) - 300 = 0.7 mm along it.
    """
    mechanism = two_loads(gap="300 mm", links=links)
    assert list(reaches(compile_mechanism(mechanism))) == [
        "tree: the shares of a rocker are 1 % off, and it turns over, where the displacements of "
        "its strings differ by 19.8 mm and 40 mm ('tree.rocker1'); its slots end after 60 mm along "
        "the pull and 150 mm against it"]
    run = simulate(mechanism)
    turned = abs(run["tree.rocker1.angle"][-1])
    assert turned == pytest.approx(math.pi / 2, rel=0, abs=math.asin(20 / 280))
    assert run["load1.x"][-1] == pytest.approx(-0.04, abs=0.7e-3)
