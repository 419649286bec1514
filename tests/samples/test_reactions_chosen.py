"""Reactions chosen first: bodies are given the accelerations they make, and they must come back.

Poses, loads and reactions are drawn at random; nothing moves as an engine would have it, which
the balance of bodies does not ask for.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.samples.loads import Loads
from sandbox.samples.reactions import Reactions, solve
from sandbox.scene.mechanism import Mechanism
from tests.audit.still import block, machine, still

N = 5
GROOVE = np.array([[0.02, 0.01], [0.32, 0.41]])
"""In the frame of ``a``, along (3, 4) / 5."""


def joint(kind: str, a: str, b: str, **more: Any) -> dict[str, Any]:
    """A joint between two points that depend on its name and on nothing else."""
    name = f"{a}_{b}{more.pop('again', '')}"
    drawn = np.random.default_rng(list(name.encode()))
    on = {end: drawn.uniform(-0.1, 0.1, 2) for end in (a, b)}
    spec: dict[str, Any] = {"type": kind.replace("slider", "slot"), "name": name, "a": a, "b": b,
                            "on_b": on[b].tolist(), **more}
    if spec["type"] == "slot":
        spec |= {"start": GROOVE[0].tolist(), "end": GROOVE[1].tolist(), "turns": kind == "slot"}
    else:
        spec["on_a"] = on[a].tolist()
    if spec["type"] == "rope":
        spec["longest"] = 9.0
    return spec


def turned(angle: float, point: np.ndarray) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])


def chosen(
    joints: list[dict[str, Any]], *, seed: int = 1, at_end: int | None = None, **more: Any,
) -> tuple[Reactions, np.ndarray, np.ndarray]:
    """What is found, and the forces [2, nj, N] and couples [nj, N] on ``b`` that were put in."""
    names = sorted({each[end] for each in joints for end in "ab"} - {"wall"})
    machine_ = machine(
        *(block(name, centre=(0.02, -0.03), mass=0.1 + 0.2 * i, inertia=1e-3 * (i + 1))
          for i, name in enumerate(names)),
        joints=joints, gravity=(0.4, -9.0), **more)
    random = np.random.default_rng(seed)
    number = {body.name: i for i, body in enumerate(machine_.bodies)}
    force, couple = np.zeros((2, len(joints), N)), np.zeros((len(joints), N))

    def change(a: dict[str, np.ndarray]) -> None:
        pose = a["body_pose"]
        pose[:, 1:] = random.uniform(-1, 1, (N, len(names), 3))
        _onto_grooves(machine_, pose, number, at_end, random)
        total = np.zeros((N, len(number), 3))
        total[:, 1:, :2] = a["body_mass"][None, 1:, None] * np.array([0.4, -9.0])
        for j, spec in enumerate(joints):
            for n in range(N):
                one, two = number[spec["a"]], number[spec["b"]]
                put, twist = _some(spec, pose[n, one], pose[n, two], random)
                force[:, j, n], couple[j, n] = put, twist
                hold = pose[n, two, :2] + turned(pose[n, two, 2], np.array(spec["on_b"]))
                held = hold if spec["type"] == "slot" else pose[n, one, :2] + turned(
                    pose[n, one, 2], np.array(spec["on_a"]))
                for body, at, sign in ((one, held, -1), (two, hold, 1)):
                    centre = pose[n, body, :2] + turned(pose[n, body, 2], a["body_centre"][body])
                    arm = at - centre
                    total[n, body] += sign * np.array(
                        [*put, arm[0] * put[1] - arm[1] * put[0] + twist])
        weight = np.stack([a["body_mass"], a["body_mass"], a["body_inertia"]], axis=1)
        a["body_acceleration"][:, 1:] = total[:, 1:] / weight[1:]
    return solve(Loads(still(machine_, change, n=N))), force, couple


def _onto_grooves(
    machine_: Mechanism, pose: np.ndarray, number: dict[str, int], at_end: int | None,
    random: np.random.Generator,
) -> None:
    """Put the bodies that slide somewhere on their grooves; in sample ``at_end`` at its end."""
    for spec in machine_.joints:
        if spec.type != "slot":
            continue
        for n in range(N):
            one, two = pose[n, number[spec.a]], pose[n, number[spec.b]]
            share = 1.0 if n == at_end else random.uniform(0.1, 0.9)
            at = one[:2] + turned(one[2], GROOVE[0] + share * (GROOVE[1] - GROOVE[0]))
            two[:2] = at - turned(two[2], np.array(spec.on_b))


def _some(
    spec: dict[str, Any], one: np.ndarray, two: np.ndarray, random: np.random.Generator,
) -> tuple[np.ndarray, float]:
    """A reaction that the joint can give: any force, one along its line, one across its groove."""
    size = random.uniform(1.0, 5.0)
    twist = random.uniform(0.1, 0.5)
    match spec["type"]:
        case "pin":
            return random.uniform(-5, 5, 2), 0.0
        case "weld":
            return random.uniform(-5, 5, 2), twist
        case "slot":
            along = turned(one[2], GROOVE[1] - GROOVE[0]) / 0.5
            return size * np.array([-along[1], along[0]]), 0.0 if spec["turns"] else twist
        case _:
            ends = [body[:2] + turned(body[2], np.array(spec[on]))
                    for body, on in ((one, "on_a"), (two, "on_b"))]
            return size * (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0]), 0.0


RING = [joint("pin", "wall", "crank"), joint("pin", "crank", "rod"), joint("pin", "slide", "rod")]


@pytest.mark.parametrize(("joints", "ways"), [
    ([joint("pin", "wall", "one"), joint("pin", "two", "one"), joint("pin", "two", "tri")],
     {"single"}),
    ([joint("weld", "wall", "one"), joint("weld", "two", "one"), joint("pin", "two", "tri")],
     {"single"}),
    ([joint("pin", "wall", "one"), joint("rod", "one", "two"), joint("rope", "tri", "one")],
     {"single"}),
    ([joint("pin", "wall", "one"), joint("slot", "one", "two"), joint("slider", "one", "tri")],
     {"single"}),
    ([joint("slider", "wall", "one"), joint("weld", "one", "wally")], {"single"}),
    ([joint("rod", "wall", "one"), joint("slot", "wall", "one", again=2),
      joint("rope", "one", "two"), joint("pin", "two", "tri")], {"single", "small"}),
    ([joint("rod", "one", "wall"), joint("slider", "wall", "one", again=2)], {"small"}),
    ([joint("rope", "wall", "one"), joint("rod", "one", "two")], {"single"}),
    ([joint("slot", "one", "two"), joint("rod", "wall", "one"), joint("pin", "one", "tri")],
     {"single"}),
    ([*RING, joint("slider", "wall", "slide")], {"loop"}),
    ([*RING, joint("pin", "wall", "slide"), joint("rod", "rod", "tip"), joint("pin", "tip", "x")],
     {"single", "loop"}),
    ([*RING, joint("slider", "wall", "base"), joint("slot", "base", "slide")],
     {"single", "small"}),
    ([*RING, joint("rod", "slide", "wall"), joint("slot", "rod", "slide", again=2)], {"loop"}),
], ids=["pins", "welds", "lines", "grooves", "slider", "three unknowns", "rod and slider",
        "one behind the other", "slot first", "crank and slider", "four bars and more",
        "two slots", "a ring of all"])
def test_reactions_that_were_put_in_come_back(joints, ways):
    for seed in (1, 2):
        found, force, couple = chosen(joints, seed=seed)
        assert found.why == {}
        assert set(found.how.values()) == ways
        assert not found.open.any()
        assert found.force == pytest.approx(force, abs=1e-9)
        assert found.couple == pytest.approx(couple, abs=1e-9)
        assert found.left[:, 1:] == pytest.approx(np.zeros_like(found.left[:, 1:]), abs=1e-9)


def test_a_slot_at_the_end_of_its_groove_leaves_its_body_open_in_that_sample():
    """And what hangs on it further in; the tip, which is known before, is not."""
    joints = [joint("rod", "wall", "one"), joint("slot", "wall", "one", again=2),
              joint("pin", "one", "tip")]
    found, force, _ = chosen(joints, at_end=3)
    assert found.open.tolist() == [[n == 3 for n in range(N)]] * 2 + [[False] * N]
    assert np.isnan(found.force[:, :2, 3]).all()
    assert found.force[:, 2] == pytest.approx(force[:, 2])
    rest = [n for n in range(N) if n != 3]
    assert found.force[:, :, rest] == pytest.approx(force[:, :, rest])


def test_what_is_open_of_a_ring_is_open_of_all_its_joints():
    found, force, _ = chosen([*RING, joint("slider", "wall", "slide")], at_end=0)
    assert found.open.tolist() == [[n == 0 for n in range(N)]] * 4
    assert found.force[:, :, 1:] == pytest.approx(force[:, :, 1:], abs=1e-9)


def test_a_joint_further_in_knows_as_little_as_the_body_it_carries():
    """The slot's body hangs on a carriage that hangs on the wall: its pin is open there, too."""
    joints = [joint("pin", "wall", "cart"), joint("rod", "cart", "one"),
              joint("slot", "cart", "one", again=2)]
    found, force, _ = chosen(joints, at_end=2)
    assert found.how == {0: "single", 1: "small", 2: "small"}
    assert found.open.tolist() == [[n == 2 for n in range(N)]] * 3
    assert found.force[:, 0, :2] == pytest.approx(force[:, 0, :2])


@pytest.mark.parametrize(("joints", "reason", "which"), [
    ([joint("weld", "wall", "one"), joint("weld", "wall", "one", again=2)],
     "its ring has more unknown forces than equations", {0, 1}),
    ([joint("pin", "wall", "one"), joint("pin", "one", "two"), joint("pin", "two", "wall"),
      joint("rod", "wall", "two", again=2)],
     "its ring has more unknown forces than equations", {0, 1, 2, 3}),
])
def test_more_supports_than_equations_decide_nothing(joints, reason, which):
    found, _, _ = chosen(joints)
    assert found.why == dict.fromkeys(which, reason)
    assert np.isnan(found.force).all()
    assert found.how == {}


def test_joints_between_what_does_not_move_are_not_asked_for():
    machine_ = machine(block("one"), {"name": "post", "motion": "fixed"}, joints=[
        {"type": "weld", "name": "weld", "a": "wall", "b": "post", "on_b": (0, 0)},
        {"type": "pin", "name": "pin", "a": "post", "b": "one", "on_b": (0, 0)}])
    found = solve(Loads(still(machine_)))
    assert found.why == {0: "neither of its bodies moves freely"}
    assert found.how == {1: "single"}
