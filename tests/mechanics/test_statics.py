"""Underactuated statics against virtual work by differences, published balances and scipy."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.mechanics import chain, statics
from tests.support.reference import SET_G


@pytest.mark.parametrize("n", [2, 3, 5])
def test_closed_and_general_jacobian_agree_with_virtual_work(n: int) -> None:
    """J_cj = -n_c . d p_c / d theta_j by central differences (n pushes the phalanx, which closes
    clockwise). Step e = 1e-5 errs by e^2/6 times 0.2 m plus 1e-16/e: under 2e-11 m.
    """
    rng = np.random.default_rng(n)
    lengths, k = rng.uniform(0.02, 0.05, n), rng.uniform(0.005, 0.02, n)
    theta = rng.uniform(0, 1, n)
    local = np.stack([k, np.full(n, -0.008)], axis=1)
    frames = chain.transforms(theta, lengths)
    normals = frames[:, :2, 1]
    e = 1e-5
    slopes = np.stack([
        (chain.to_world(chain.transforms(theta + e * unit, lengths), local)
         - chain.to_world(chain.transforms(theta - e * unit, lengths), local)) / (2 * e)
        for unit in np.eye(n)], axis=-1)
    by_work = -np.einsum("cx,cxj->cj", normals, slopes)
    general = statics.point_jacobian(
        chain.to_world(frames, local), normals, chain.hinges(frames), np.arange(n))
    np.testing.assert_allclose(general, by_work, rtol=0, atol=2e-11)
    np.testing.assert_allclose(
        statics.contact_jacobian(theta, lengths, k), general, rtol=0, atol=1e-16)


# --- contacts that let go


def by_trial(J: np.ndarray, tau: np.ndarray, M: np.ndarray, stops: np.ndarray) -> tuple:
    """All sets of active contacts and stops tried in turn: the one whose forces push and whose idle
    partners part. Returns the pushes and the accelerations M^-1 (tau - G x).
    """
    G = np.concatenate([J, stops]).T
    inverse = np.linalg.inv(M)
    slack = 1e-9 * np.abs(inverse @ tau).max() * np.abs(G).max(initial=0.0)
    for active in product((False, True), repeat=G.shape[1]):
        on = np.array(active)
        x = np.zeros(G.shape[1])
        if on.any():
            A = G[:, on].T @ inverse @ G[:, on]
            if np.linalg.matrix_rank(A, tol=1e-9 * np.abs(A).max()) < on.sum():
                continue
            x[on] = np.linalg.solve(A, G[:, on].T @ inverse @ tau)
        away = inverse @ (tau - G @ x)
        if (x >= 0).all() and (-(G.T @ away) >= -slack).all():
            return x, away
    raise AssertionError("no set of active contacts fits")


@given(st.integers(0, 100_000), st.integers(0, 3), st.integers(0, 7))
def test_every_active_set_tried(seed: int, contacts: int, stopped: int) -> None:
    """Up to three contacts and three stops of a finger that moves or rests as it may: the motion is
    that of the one set of active contacts that fits, and so are the forces.
    """
    rng = np.random.default_rng(seed)
    n = 3
    frames = chain.transforms(rng.uniform(0, 1.2, n), SET_G.lengths)
    phalanx = rng.integers(0, n, contacts)
    local = np.stack([rng.uniform(.003, .02, contacts), np.full(contacts, -.008)], axis=-1)
    J = statics.point_jacobian(
        chain.to_world(frames[phalanx], local).reshape(-1, 2),
        frames[phalanx][..., :2, 1].reshape(-1, 2), chain.hinges(frames), phalanx)
    on = np.array([bool(stopped >> j & 1) for j in range(n)])
    low = on & (rng.random(n) < 0.5)
    tau, half = rng.normal(0, 0.02, n), rng.normal(0, 1e-3, (n, n))
    M = half @ half.T + 1e-6 * np.eye(n)
    stops = np.concatenate([-np.eye(n)[low], np.eye(n)[on & ~low]])
    x, away = by_trial(J, tau, M, stops)
    found = statics.unilateral_forces(J, tau, lower=low, upper=on & ~low, inertia=M)
    G = np.concatenate([J, stops]).T
    np.testing.assert_allclose(np.linalg.solve(M, found.residual), away,
                               rtol=0, atol=1e-7 * np.abs(np.linalg.solve(M, tau)).max())
    if np.linalg.matrix_rank(G, tol=1e-6) == G.shape[1]:
        scale = np.abs(tau).max() / 1e-3
        np.testing.assert_allclose(found.forces, x[:contacts], rtol=1e-5, atol=1e-8 * scale)
        np.testing.assert_allclose(found.stops, -(stops.T @ x[contacts:]), rtol=1e-5, atol=1e-9)


def test_a_contact_without_any_arm_carries_nothing() -> None:
    """Its normal passes through every hinge before it: the others push as if it were not there."""
    J, tau = np.array([[0.02, 0.0], [0.0, 0.0], [0.05, 0.01]]), np.array([0.3, 0.05])
    found = statics.unilateral_forces(J, tau)
    np.testing.assert_allclose(found.forces, [2.5, 0.0, 5.0], rtol=1e-12)
    np.testing.assert_allclose(found.residual, 0, atol=1e-15)


def test_two_contacts_on_one_phalanx_share() -> None:
    """Two contacts on the distal phalanx and its stop: only the first phalanx's force is certain.
    Without the second distal contact and the stop, all are.
    """
    theta = np.radians([20.0, 30.0])
    frames = chain.transforms(theta, (0.045, 0.03))
    at = chain.to_world(frames[[0, 1, 1]], np.array([[.02, -.009], [.01, -.008], [.02, -.008]]))
    J = statics.point_jacobian(at, frames[[0, 1, 1], :2, 1], chain.hinges(frames), [0, 1, 1])
    np.testing.assert_array_equal(statics.determined_forces(J[:2]), [True, True])
    np.testing.assert_array_equal(statics.determined_forces(J), [False, False, False])
    np.testing.assert_array_equal(
        statics.determined_forces(J[:2], upper=[False, True]), [False, False])
    beside = np.array([[0.02, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.02, 0.0]])
    np.testing.assert_array_equal(statics.determined_forces(beside), [True, False, False])
    assert statics.determined_forces(np.zeros((0, 3))).shape == (0,)
