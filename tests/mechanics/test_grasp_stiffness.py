"""Stiffness of a grasp: published formula's numbers, energy, limits.

Pushes in the engine are a verification case (``grasp_stiffness``).
"""

import numpy as np
import pytest

from sandbox.mechanics.grasp_stiffness import grasp_map, grasp_stiffness, tip_jacobian

KQ, KC = 0.05, 2000.0
BASES = np.array([[-0.03, 0.0], [0.03, 0.0]])
TURNS = np.radians([[110, -60], [70, 60]])
LINKS = 0.04, 0.03
MOVES = [[True, True, False, False], [False, False, True, True]]


def hand():
    """Hinges [4, 2] finger by finger and tips [2, 2] of two mirrored fingers."""
    hinges, tips = [], []
    for base, (first, second) in zip(BASES, TURNS, strict=True):
        knee = base + LINKS[0] * np.array([np.cos(first), np.sin(first)])
        tip = knee + LINKS[1] * np.array([np.cos(first + second), np.sin(first + second)])
        hinges += [base, knee]
        tips.append(tip)
    return np.array(hinges), np.array(tips)


def stiffness(**more):
    hinges, tips = hand()
    return grasp_stiffness(grasp_map(tips, tips.mean(axis=0)), tip_jacobian(tips, hinges, MOVES),
                           np.full(4, KQ), **more)


def test_two_mirrored_fingers():
    """SynGrasp's quasi-static analysis without synergies, of this hand by an own program."""
    np.testing.assert_allclose(
        stiffness(contact_stiffness=KC),
        [[35.818082, 0, -1.596764], [0, 353.099848, 0], [-1.596764, 0, 0.210173]], atol=6e-7)


def test_it_is_the_least_energy_of_joints_and_contacts():
    """Of all joint angles q those that the body's motion u leaves: 2 E = u K u.

    2 E = q Kq q + (G^T u - J q) Kc (G^T u - J q), least over q by the normal equations.
    """
    hinges, tips = hand()
    G, J = grasp_map(tips, tips.mean(axis=0)), tip_jacobian(tips, hinges, MOVES)
    K = stiffness(contact_stiffness=KC)
    for u in np.random.default_rng(0).normal(size=(5, 3)) * [1e-3, 1e-3, 0.05]:
        w = G.T @ u
        q = np.linalg.solve(KQ * np.eye(4) + KC * J.T @ J, KC * J.T @ w)
        energy = KQ * q @ q + KC * (w - J @ q) @ (w - J @ q)
        assert u @ K @ u == pytest.approx(energy, rel=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_what_nothing_lets_give_way_is_told_whatever_rounding_leaves(seed):
    """Three joints for four directions: one value of J / Kq J^T is 0, or rounding."""
    J = np.random.default_rng(seed).normal(size=(4, 3))
    with pytest.raises(ValueError, match="3 joints for 4 directions"):
        grasp_stiffness(np.ones((3, 4)), J, np.ones(3))
