"""Joint reactions by d'Alembert on subtrees: against (32)-(33), and on trees."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.mechanics import chain, dynamics
from sandbox.mechanics.motion import finger_motion, origin_acceleration
from sandbox.mechanics.reactions import gather_loads, joint_reactions, subtrees


@given(st.integers(0, 10_000), st.integers(1, 6))
def test_two_formulations_agree_to_rounding(seed: int, n: int) -> None:
    """Any motion, any loads, shape [time, n]: the recursion of action matrices in the links' frames
    and the sums over the world's own numbers give one set of reactions. Some hundred operations
    on the largest force that occurs: 1e-13 of it.
    """
    rng = np.random.default_rng(seed)
    times, g = 4, np.array([0.3, -9.81])
    pose = rng.uniform(-1, 1, (times, n, 3)) * [0.2, 0.2, 4]
    local, m = rng.uniform(-0.03, 0.03, (n, 2)), rng.uniform(1e-3, 0.1, n)
    inertia = rng.uniform(1e-7, 1e-5, n)
    a, alpha = rng.normal(0, 50, (times, n, 2)), rng.normal(0, 2000, (times, n))
    omega = rng.normal(0, 30, (times, n))
    force, couple = rng.normal(0, 5, (times, n, 2)), rng.normal(0, 0.05, (times, n))
    point = rng.uniform(-0.3, 0.3, (times, n, 2))

    frames = chain.pose(pose[..., 0], pose[..., 1], pose[..., 2])
    into = chain.inverse(frames)
    turn = into[..., :2, :2]
    own = origin_acceleration(np.einsum("...ij,...j->...i", turn, a), omega, alpha, local)
    star = dynamics.change_frame(
        dynamics.force_action(force, point) + dynamics.couple_action(couple), into)
    external = dynamics.external_action(
        dynamics.acceleration_matrix(omega, alpha, own),
        dynamics.inertia_matrix(m, local, inertia),
        gravity=dynamics.gravity_matrix(turn @ g), applied=star)
    first = dynamics.hinge_reactions(
        dynamics.transmitted_actions(external, chain.links_between(frames)), frames)

    centres = chain.to_world(frames, local)
    lever = point - centres
    moment = couple + lever[..., 0] * force[..., 1] - lever[..., 1] * force[..., 0]
    second = joint_reactions(pose[..., :2], centres, a, alpha, m, inertia,
                             force + m[:, None] * g, moment)
    size = np.abs(second.force).max()
    np.testing.assert_allclose(first.force, second.force, rtol=0, atol=1e-13 * size)
    np.testing.assert_allclose(first.moment, second.moment, rtol=0, atol=1e-13 * size)


def test_links_motion_by_differences() -> None:
    """Omega, alpha and a of the hinges of q(t) = q0 + v t + a t^2 / 2 at t = 0, by central second
    differences of (31): step 1e-4 s errs by e^2/12 times the fourth derivative (some 1e6 m/s^4,
    rates of 30 rad/s) plus rounding 1e-17 / e^2: under 2e-2 of some 50 m/s^2.
    """
    q, v, acc = np.array([[0.3, 0.7, 0.2], [9.0, -14.0, 6.0], [300.0, 500.0, -800.0]])
    lengths, e = (0.045, 0.026, 0.021), 1e-4
    before, now, after = (chain.hinges(chain.transforms(q + v * t + acc * t**2 / 2, lengths))
                          for t in (-e, 0.0, e))
    found = finger_motion(q, v, acc, lengths)
    frames = chain.transforms(q, lengths)
    world = np.einsum("nij,nj->ni", frames[:, :2, :2], found.acceleration)
    np.testing.assert_allclose(world, (after - 2 * now + before) / e**2, rtol=0, atol=2e-2)
    np.testing.assert_allclose(found.omega, -np.cumsum(v))
    np.testing.assert_allclose(found.alpha, -np.cumsum(acc))


def test_tree_hangs_on_its_trunk() -> None:
    """A trunk with two branches at rest under gravity: the trunk's joint holds all the weight, each
    branch's its own, and moments are weight times arm, by hand.
    """
    g, m = 9.81, np.array([0.2, 0.05, 0.03])
    joints = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.0]])
    centres = np.array([[0.05, 0.0], [0.15, 0.02], [0.08, -0.04]])
    weight = np.stack([np.zeros(3), -m * g], axis=-1)
    found = joint_reactions(joints, centres, np.zeros((3, 2)), np.zeros(3), m, np.zeros(3),
                            weight, np.zeros(3), parents=[-1, 0, 0])
    np.testing.assert_allclose(found.force, np.stack([[0, 0, 0], [m.sum(), m[1], m[2]]], -1) * g)
    arms = centres[:, 0] - joints[:, 0]
    np.testing.assert_allclose(found.moment[1:], m[1:] * g * arms[1:])
    assert found.moment[0] == pytest.approx(float(g * (m * centres[:, 0]).sum()))


def test_loads_are_gathered_by_body_and_sample() -> None:
    centres = np.array([[[0.0, 0.0], [1.0, 0.0]], [[0.0, 1.0], [1.0, 1.0]]])
    force, moment = gather_loads(
        centres, [0, 1, 1], [[0.1, 0.0], [1.0, 0.2], [1.0, 0.0]],
        [[0.0, 2.0], [3.0, 0.0], [5.0, 0.0]], sample=[0, 0, 1])
    np.testing.assert_allclose(force, [[[0, 2], [3, 0]], [[0, 0], [5, 0]]])
    np.testing.assert_allclose(moment, [[0.2, -0.6], [0, 5.0]])
    alone, _ = gather_loads(centres[0], [1], [[0.0, 0.0]], [[1.0, 1.0]])
    np.testing.assert_allclose(alone, [[0, 0], [1, 1]])


ONE = (np.zeros((1, 2)), np.zeros((1, 2)), np.zeros((1, 2)), [0.0], [1.0], [1.0],
       np.zeros((1, 2)), [0.0])


def _with(index: int, value: object) -> tuple:
    return (*ONE[:index], value, *ONE[index + 1:])


@pytest.mark.parametrize(("call", "message"), [
    (lambda: joint_reactions(*_with(1, np.zeros((2, 2)))), "centres must have 1 points .* in m"),
    (lambda: joint_reactions(*_with(4, [-1.0])), "masses must be 0 or more, got -1 kg"),
    (lambda: joint_reactions(*ONE, parents=[1]), r"parents must name -1 .* got \[1\]"),
    (lambda: subtrees([1, 0], 2), r"parents must not run in a ring, got \[1, 0\]"),
])
def test_impossible_reactions_are_refused(call: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
