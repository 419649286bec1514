"""The kinematic tree: who carries whom, and where."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sandbox.export.tree import Freedom, Link, Tree, freedoms, grow
from sandbox.model.compile import compile_mechanism
from sandbox.model.model import NONE, Model
from sandbox.scene.mechanism import Mechanism


def body(name: str, *, at: tuple[float, float] = (0.0, 0.0), **more: Any) -> dict[str, Any]:
    return {"name": name, "at": at, "mass": 0.1, "inertia": 1e-4, **more}


FRAME = {"name": "frame", "motion": "fixed"}


def pin(name: str, a: str, b: str, **more: Any) -> dict[str, Any]:
    return {"type": "pin", "name": name, "a": a, "b": b,
            **({"on_b": (0.0, 0.0)} if "on_a" not in more else {}), **more}


def machine(bodies: list[dict[str, Any]], joints: list[dict[str, Any]]) -> Model:
    return compile_mechanism(Mechanism.model_validate({"bodies": bodies, "joints": joints}))


def parents(model: Model, tree: Tree) -> dict[str, str]:
    name = model.bodies.name
    return {name[body]: "" if link.parent == NONE else name[link.parent]
            for body, link in tree.links.items()}


def link_of(model: Model, body: str) -> Link:
    return grow(model).links[model.names.body[body]]


def move_of(model: Model, body: str) -> Freedom:
    move, = freedoms(model, link_of(model, body))
    return move


def test_grooves_come_before_welds_before_pins() -> None:
    groove = {"type": "slot", "name": "groove", "a": "frame", "b": "block",
              "start": (0.0, 0.0), "end": (0.1, 0.0)}
    weld = {"type": "weld", "name": "weld", "a": "block", "b": "crank", "on_b": (0.0, 0.0)}
    model = machine(
        [FRAME, body("crank"), body("block")],
        [pin("axle", "frame", "crank"), pin("joint", "crank", "block"), weld, groove])
    tree = grow(model)
    assert parents(model, tree) == {"frame": "", "block": "frame", "crank": "block"}
    assert [model.joints.name[joint] for joint in tree.loops] == ["axle", "joint"]


def test_a_gap_in_a_joint_is_closed() -> None:
    """A child stands where its anchor lies on its parent's, at the angle that the scene gives."""
    model = machine(
        [FRAME, body("arm", at=(0.3, 0.1), angle=math.pi / 2)],
        [pin("p", "frame", "arm", on_a=(0.1, 0.0), on_b=(0.05, 0.0))])
    assert link_of(model, "arm").pose == pytest.approx((0.1, -0.05, math.pi / 2), abs=1e-15)


@pytest.mark.parametrize("backwards", [False, True])
def test_a_groove_counts_from_its_start(backwards: bool) -> None:
    """Groove of 0.2 m along x of ``a``, entered at 0.05 m; b moves along it at 0.3 m/s."""
    names = ("frame", "block")
    parts = [FRAME, body("block", at=(0.05, 0.0), angle=0.3, velocity=(0.3, 0.0))]
    joint = {"type": "slot", "name": "groove", "a": names[0], "b": names[1],
             "start": (0.0, 0.0), "end": (0.2, 0.0), "turns": False}
    if backwards:  # the groove is in the moving body, whose motion is the other way
        parts[1] |= {"at": (-0.05, 0.0), "angle": 0.0, "velocity": (-0.3, 0.0)}
        joint |= {"a": names[1], "b": names[0]}
    move = move_of(machine(parts, [joint]), "block")
    assert move.start == pytest.approx(0.05, abs=1e-15)
    assert move.rate == pytest.approx(0.3, abs=1e-15)
    assert move.limits == pytest.approx((0.0, 0.2))
    ahead = (-1.0, 0.0) if backwards else (math.cos(0.3), -math.sin(0.3))
    assert move.axis[:2] == pytest.approx(ahead, abs=1e-15)
