"""Contact pairs: the same bodies, with the same friction, as the engine lets touch."""

from __future__ import annotations

import pytest

import sandbox
from sandbox.engine.contact_rules import make_filters
from sandbox.export.pairs import touching_pairs
from sandbox.model.compile import compile_mechanism
from sandbox.scene.mechanism import Mechanism

DISC = {"mass": 0.1, "shapes": [{"type": "circle", "radius": 0.01}]}
RULES = Mechanism.model_validate({
    "materials": {"rough": {"friction": 0.9}, "smooth": {"friction": 0.1}},
    "bodies": [{"name": f"hand.f{i}", "material": "rough", **DISC} for i in range(4)]
    + [{"name": "cup", "material": "smooth", **DISC}, {"name": "bare", "mass": 1, "inertia": 1},
       {"name": "wall", "motion": "fixed", "shapes": DISC["shapes"]},
       {"name": "floor", "motion": "fixed", "shapes": DISC["shapes"]}],
    "joints": [{"type": "pin", "name": "p", "a": "hand.f3", "b": "cup", "on_b": (0, 0)},
               {"type": "pin", "name": "q", "a": "hand.f2", "b": "cup", "on_b": (0, 0),
                "collide": True}],
    "contacts": [{"between": ("hand.*", "hand.*"), "collide": False},
                 {"between": ("hand.f1", "hand.f0"), "friction": 0.2},
                 {"between": ("cup", "hand.*"), "friction": 0.3},
                 {"between": ("cup", "wall"), "collide": False},
                 {"between": ("*", "cup"), "collide": True}]})


@pytest.mark.parametrize("name", ["RULES", "four_finger_opposed", "sliding_pulleys", "dominoes"])
def test_they_are_those_of_the_engine(name: str) -> None:
    mechanism = RULES if name == "RULES" else sandbox.expand(sandbox.load_scene(name))
    filters = make_filters(compile_mechanism(mechanism))
    number = {body.name: i for i, body in enumerate(mechanism.bodies)}
    found = {}
    for pair in touching_pairs(mechanism):
        found[number[pair.a.name], number[pair.b.name]] = pair.friction
    solid = [i for i, body in enumerate(mechanism.bodies) if body.shapes]
    wanted = {(i, j) for i in solid for j in solid if i < j and filters.allowed[i, j]}
    assert set(found) == wanted
    assert found == {pair: pytest.approx(filters.friction[pair], rel=1e-15) for pair in wanted}
