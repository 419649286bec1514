"""The spring between a body and the hand that draws it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox import SceneError
from sandbox.engine.hand import EVERY, GRAVITY, QUICK, WEIGHTS, Hand
from sandbox.engine.live import Live
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene

from .machines import H, fixed, mass, mechanism


def drawn(hand: Hand, seconds: float) -> list[float]:
    """Distances from the place [m] that a hand draws to, each :data:`EVERY`."""
    left = []
    for _ in range(round(seconds / EVERY)):
        hand.draw()
        hand.live.step(hand.every)
        (x, y), _ = hand.point()
        left.append(math.hypot(hand.to[0] - x, hand.to[1] - y))
    return left


def test_a_free_mass_comes_as_a_critically_damped_spring_lets_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By a leapfrog with the force kept for T, to rounding; by the closed form to first order in T.

    The closed form is x = X (1 + w t) exp(-w t). What is late by T / 2 on the average changes it by
    a share of w T at most.
    """
    monkeypatch.setattr("sandbox.engine.hand.FINE", 1e-15)
    hand = Hand(Live(mechanism(bodies=[mass("block", 0.4, (0.0, 0.0))])))
    hand.hold("block", (0.0, 0.0), (0.03, 0.04))
    left = np.array(drawn(hand, 0.3))
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
    left = drawn(hand, 1.5)
    assert left[-1] < 1e-3
    assert max(left) <= 0.05 * 1.01


def test_it_draws_with_no_more_than_so_many_weights() -> None:
    hand = Hand(Live(mechanism(bodies=[mass("block", 0.4, (0.0, 0.0))])))
    hand.hold("block", (0.0, 0.0), (300.0, -400.0))
    hand.draw()
    assert hand.force == pytest.approx((0.6 * 50 * 9.81 * 0.4, -0.8 * 50 * 9.81 * 0.4))


@pytest.mark.parametrize("body", ["finger1.distal", "tree.rocker1", "section2.arm"])
def test_in_a_hand_it_stays_calm_and_within_its_cap(body: str) -> None:
    live = Live(expand(load_scene("adaptive_grasp")))
    live.step(1200)
    hand = Hand(live)
    hand.hold(body, (0.0, 0.0), (0.0, 0.3))
    whole = sum(each.mass or 0.0 for each in live.scene.bodies if each.motion == "dynamic")
    forces = []
    for _ in range(100):
        drawn(hand, EVERY)
        forces.append(hand.force)
    sizes = np.hypot(*np.array(forces).T)
    assert 0.1 < sizes[-1] <= WEIGHTS * GRAVITY * whole
    assert np.ptp(sizes[-20:]) < 0.05 * sizes[-1]
    hand.drop()
    assert hand.force == (0.0, 0.0)
    live.step(4)
    assert live["hand1.x.value"] == live["hand1.y.value"] == 0.0


def test_what_cannot_be_held_is_said() -> None:
    hand = Hand(Live(mechanism(bodies=[fixed("floor"), mass("block", 0.4, (0.0, 0.0))])))
    with pytest.raises(SceneError, match="moves freely"):
        hand.hold("floor", (0, 0), (1, 0))
    with pytest.raises(SceneError, match="no place"):
        hand.hold("block", (0, 0), (1, math.nan))
    for at, to in (((0, 0), (1e308, 0)), ((-1e308, 0), (0, 0))):
        with pytest.raises(SceneError, match=r"no place: .*e\+308 is too large") as told:
            hand.hold("block", at, to)
        assert told.value.problems[0].allowed == "a magnitude of at most 1e+06 m"
    assert hand.body is None
    assert hand.live.inputs == []


def test_what_is_held_still_takes_no_new_numbers() -> None:
    """Its force goes in steps of some millionth of the most: 50 times 0.4 kg x 9.81 m/s^2."""
    live = Live(mechanism(bodies=[mass("block", 0.4, (0.0, 0.0))]))
    hand = Hand(live)
    hand.hold("block", (0.0, 0.0), (0.03, 0.04))
    for _ in range(500):
        drawn(hand, EVERY)
        assert [round(force, 4) for force in hand.force] == list(hand.force)
    held = len(live.inputs)
    drawn(hand, 2.0)
    assert len(live.inputs) == held < 300
