"""Interactive simulations: pushes and settings are recorded as drives and events."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from sandbox import SceneError
from sandbox.audit.audit import audit
from sandbox.engine.live import EVERY, QUICK, Hand, Live
from sandbox.engine.simulate import simulate
from sandbox.engine.solve import SETTLED
from sandbox.numeric import Array
from sandbox.scene.expand import expand, to_json
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.played import Nudge, Setting, played
from sandbox.scene.read.load import load_scene

from .machines import H, fixed, mass, mechanism


def poses_of(live: Live, steps: int) -> Array:
    """Poses of the steps that are made now, [steps, nb, 3]."""
    found = []
    for _ in range(0, steps, 100):
        live.step(min(100, steps - 100 * len(found)))
        found.append(live.latest()["body_pose"].copy())
    return np.concatenate(found)


def run_again(machine: Mechanism) -> Any:
    """A scene that was played, written, read and run, with every step recorded."""
    scene = load_scene(json.loads(to_json(machine)), overrides={
        "run.sample_rate": 1 / machine.run.step})
    return simulate(scene)


@pytest.mark.parametrize("scene", [
    "adaptive_grasp", "finger_dual_control", "conveyor",
    *(pytest.param(name, marks=pytest.mark.nightly) for name in (
        "dog_clutch", "hydraulic_press", "linear_actuator", "motor_line", "planetary", "servo_arm",
        "shape_change", "tendon_stiffness", "trebuchet"))])
def test_a_played_scene_gives_the_same_bytes_again(scene: str) -> None:
    machine = expand(load_scene(scene))
    live, rng = Live(machine), np.random.default_rng(4)
    free = [body.name for body in machine.bodies if body.motion == "dynamic"]
    kept = [poses_of(live, 120)]
    written = {name for each in machine.controllers for name in np.atleast_1d(each.writes)}
    drives = [drive.name for drive in machine.drives if drive.name not in written]
    targets = [f"{each.name}.target" for each in machine.controllers if hasattr(each, "target")]
    for _ in range(12):
        live.push(str(rng.choice(free)), rng.normal(0, 0.01, 2), rng.normal(0, 0.2, 2))
        kept.append(poses_of(live, int(rng.integers(1, 30))))
        if names := [*drives, *targets]:
            name = str(rng.choice(names))
            now = live[f"{name}.value"] if name in drives else 0.3
            live.give(name, now * float(rng.uniform(0.9, 1.1)))
        if rng.random() < 0.3:
            live.push(free[0], (0.0, 0.0), (0.0, 0.0))
    again = run_again(live.played())
    assert np.array_equal(np.concatenate(kept), again.arrays["body_pose"])
    assert [figure.name for figure in audit(again) if figure.verdict == "fail"] == []
    assert np.array_equal(live.copy().recording().arrays["body_pose"][-1], kept[-1][-1])


def test_a_push_at_rest_wakes_and_no_push_does_not() -> None:
    """At rest steps are repeated, not solved: that has to be so in both, or the last bits part."""
    live = Live(expand(load_scene("adaptive_grasp")))
    kept = [poses_of(live, 3000)]
    assert live._tables.state.standing[1] > SETTLED + 1
    for at, force in (((0.0, 0.0), (0.0, -0.0)), ((0.0, 0.0), (0.02, 0.0)),
                      ((0.005, 0.003), (0.02, 0.0))):
        live.push("finger1.distal", at, force)
        kept.append(poses_of(live, 3000))
    assert live._tables.state.standing[1] > SETTLED + 1
    assert np.array_equal(np.concatenate([one[-400:] for one in kept]), np.concatenate(
        [run[-400:] for run in np.split(run_again(live.played()).arrays["body_pose"], 4)]))


def test_pushes_are_drives_of_the_points_and_settings_events() -> None:
    inputs = [Nudge(2, "a", (0.1, 0.0), (1.0, 0.0)), Setting(3, "lift", 2.0),
              Nudge(4, "b", (0.0, 0.0), (0.0, 3.0)), Nudge(6, "a", (0.1, 0.0), (5.0, 0.0)),
              Nudge(9, "a", (0.1, 0.0), (7.0, 0.0))]
    machine = mechanism(
        bodies=[mass("a", 1.0, (0, 0)), mass("b", 1.0, (1, 0)), mass("hand1", 1.0, (2, 0))],
        drives=[{"type": "force", "name": "lift", "body": "a", "direction": (0, 1), "value": 1}],
        events=[{"name": "late", "at": 0.09, "set": {"lift": 0}}],
        expect=[{"final": "a.x", "above": 1}])
    made = played(machine, inputs, 8)
    run = run_again(made)
    assert [drive.name for drive in made.drives] == [
        "lift", "hand2.x", "hand2.y", "hand3.x", "hand3.y"]  # hand1 is a body
    assert run["hand2.x.value"].tolist() == [0, 0, 1, 1, 0, 0, 5, 5]
    assert run["hand3.y.value"].tolist() == [0, 0, 0, 0, 3, 3, 0, 0]
    assert run["lift.value"].tolist() == [1, 1, 1, 2, 2, 2, 2, 2]
    assert [event.name for event in made.events] == ["played1"]
    assert made.expect == ()


def test_a_live_simulation_keeps_only_its_last_steps() -> None:
    live = Live(mechanism(bodies=[mass("block", 0.4, (0.0, 0.0))]))
    for _ in range(40):
        live.step(100)
        last = live.recording()
        assert len(last) == 100
        assert last.time[-1] == pytest.approx(live.time - H / 2)
    live.step(2000)
    assert len(live.recording()) <= 512
    assert sum(array.nbytes for array in live.recording().arrays.values()) < 1_000_000


@pytest.mark.parametrize(("wrong", "words"), [
    (lambda live: live.give("lfit", 1.0), "lift"),
    (lambda live: live.give("lift", math.nan), "finite"),
    (lambda live: live.give("lift", 1e30), "value of 'lift'"),
    (lambda live: live.set("lift", None), "None is not a value for"),
    (lambda live: live.push("floor", (0, 0), (1, 0)), "moves freely"),
    (lambda live: live.push("a", (0, 0), (1, 0, 0)), "two finite numbers"),
])
def test_wrong_pushes_and_settings_are_refused(wrong: Any, words: str) -> None:
    live = Live(mechanism(
        bodies=[mass("a", 1.0, (0, 0)), fixed("floor")],
        drives=[{"type": "force", "name": "lift", "body": "a", "direction": (0, 1), "value": 1}]))
    with pytest.raises(SceneError, match=words):
        wrong(live)
    assert live.inputs == []


def distances_while_pulling(hand: Hand, seconds: float) -> list[float]:
    """Distances from the place [m] that a hand draws to, each :data:`EVERY`."""
    left = []
    for _ in range(round(seconds / EVERY)):
        hand.draw()
        hand.live.step(hand.every)
        (x, y), _ = hand.point()
        left.append(math.hypot(hand.to[0] - x, hand.to[1] - y))
    return left


def test_a_pulled_mass_moves_as_on_a_critically_damped_spring(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By a leapfrog with the force kept for T, to rounding; by the closed form to first order in T.

    The closed form is x = X (1 + w t) exp(-w t). What is late by T / 2 on the average changes it by
    a share of w T at most.
    """
    monkeypatch.setattr("sandbox.engine.live.FINE", 1e-15)
    hand = Hand(Live(mechanism(bodies=[mass("block", 0.4, (0.0, 0.0))])))
    hand.hold("block", (0.0, 0.0), (0.03, 0.04))
    left = np.array(distances_while_pulling(hand, 0.3))
    a, expected = -QUICK**2 * 0.05, []
    x, before, v = 0.05 + a * H * H / 8, 0.0, a * H  # of the first step: at h / 2, 0 and h
    for n in range(len(left)):
        a = -QUICK**2 * x - QUICK * (v + before) if n else a
        for _ in range(hand.every if n else hand.every - 1):
            x, before, v = x + H * v, v, v + H * a
        expected.append(x)
    assert left == pytest.approx(expected, abs=1e-12)
    t = EVERY * np.arange(1, len(left) + 1)
    assert np.abs(left - 0.05 * (1 + QUICK * t) * np.exp(-QUICK * t)).max() < 0.05 * QUICK * EVERY


def test_a_point_far_out_on_a_light_rod_is_drawn_without_swinging() -> None:
    """There a rod answers with a quarter of its mass: the spring is still stable, and it comes."""
    rod = {"name": "rod", "at": (0, 0), "mass": 0.01, "inertia": 0.01 * 0.2**2 / 12}
    hand = Hand(Live(mechanism(bodies=[fixed("base"), rod, mass("heavy", 5.0, (-0.1, 0.0))],
                               joints=[{"type": "pin", "name": "hinge", "a": "heavy", "b": "rod",
                                        "on_a": (0, 0)}])))
    hand.hold("rod", (0.1, 0.0), (-0.1 + 0.2 * math.cos(0.25), 0.2 * math.sin(0.25)))
    left = distances_while_pulling(hand, 1.5)
    assert left[-1] < 1e-3
    assert max(left) <= 0.05 * 1.01


def test_the_pulling_force_is_limited() -> None:
    hand = Hand(Live(mechanism(bodies=[mass("block", 0.4, (0.0, 0.0))])))
    hand.hold("block", (0.0, 0.0), (300.0, -400.0))
    hand.draw()
    assert hand.force == pytest.approx((0.6 * 50 * 9.81 * 0.4, -0.8 * 50 * 9.81 * 0.4))


def test_a_body_held_still_records_no_new_inputs() -> None:
    """Its force goes in steps of some millionth of the most: 50 times 0.4 kg x 9.81 m/s^2."""
    live = Live(mechanism(bodies=[mass("block", 0.4, (0.0, 0.0))]))
    hand = Hand(live)
    hand.hold("block", (0.0, 0.0), (0.03, 0.04))
    for _ in range(500):
        distances_while_pulling(hand, EVERY)
        assert [round(force, 4) for force in hand.force] == list(hand.force)
    held = len(live.inputs)
    distances_while_pulling(hand, 2.0)
    assert len(live.inputs) == held < 300
