"""How far a differential can go: told before, held against a run that goes there."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sandbox.engine.inspect_hands import reaches
from sandbox.engine.simulate import simulate
from sandbox.model.compile import compile_mechanism
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene


def pulled(held: int = 1, pull: Any = 20, **tree: Any) -> Mechanism:
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
        "drives": [{"type": "pull", "name": "pull", "tendon": "tree", "value": pull}]}))


def told(mechanism: Mechanism) -> list[str]:
    return list(reaches(compile_mechanism(mechanism)))


@pytest.mark.parametrize("links", ["tendon", "rope"])
def test_a_rocker_turns_over_where_it_is_told(links: str) -> None:
    """20 N against 20 N/m would draw load1 far on: it stops a + b = 40 mm on.

    The rocker then lies along its strings, which slant by 20 mm over 280 to 320: so far from the
    pull. A slanted string is short of sqrt(300^2 + 20^2) - 300 = 0.7 mm along it.
    """
    mechanism = pulled(gap="300 mm", links=links)
    assert told(mechanism) == [
        "tree: the shares of a rocker are 1 % off, and it turns over, where the displacements of "
        "its strings differ by 19.8 mm and 40 mm ('tree.rocker1'); its slots end after 60 mm along "
        "the pull and 150 mm against it"]
    run = simulate(mechanism)
    turned = abs(run["tree.rocker1.angle"][-1])
    assert turned == pytest.approx(math.pi / 2, rel=0, abs=math.asin(20 / 280))
    assert run["load1.x"][-1] == pytest.approx(-0.04, abs=0.7e-3)


def test_a_slot_ends_where_it_is_told() -> None:
    """Nothing held: both loads are drawn on until the pivot's slot ends."""
    mechanism = pulled(held=0, travel="50 mm")
    assert "its slots end after 50 mm along the pull and 30 mm against it" in told(mechanism)[0]
    run = simulate(mechanism)
    start = mechanism.bodies[[b.name for b in mechanism.bodies].index("tree.rocker1")].at[0]
    assert run["tree.rocker1.x"][-1] == pytest.approx(start - 0.05, abs=1e-6)
