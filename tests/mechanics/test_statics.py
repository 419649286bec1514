"""Underactuated statics against virtual work by differences, published balances and scipy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import nnls, root

from sandbox.mechanics import chain, statics
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from sandbox.study.reference_fingers import SET_A, SET_G, FingerSet

TARGET = np.radians([5.0, 10.0, 15.0])


def torques(finger: FingerSet, theta: np.ndarray, tension: float, stiffness: object) -> np.ndarray:
    found, cord = spring_set(finger.before, finger.after), route(finger.guides, finger.lengths)
    return statics.joint_torques(tension, cord.arms(theta), stiffness, found.elongations(theta),
                                 found.arms(theta))


@pytest.mark.parametrize(("pull", "stiffness"), [
    (15.0, (16475, 9745, 4330)), (10.0, (10983, 6497, 2887))])
def test_set_a_controlled_stiffness(pull: float, stiffness: tuple) -> None:
    """Figures 19 and 20: the stiffnesses, given to 1 N/m, hold 5/10/15 deg at rest: the torque
    left is at most half a N/m times elongation times arm.
    """
    springs = spring_set(SET_A.before, SET_A.after)
    left = torques(SET_A, TARGET, pull, stiffness)
    allowed = 0.5 * springs.elongations(TARGET) * springs.arms(TARGET)
    assert (np.abs(left) <= allowed * 1.001).all()


def test_set_a_constant_stiffness() -> None:
    """Figure 18: shortening held at 2.971 mm and stiffness constant, rest is at T = 4.68 N and
    1.49/5.10/22.21 deg, to the digits given.
    """
    cord = route(SET_A.guides, SET_A.lengths)
    goal = cord.shortening(TARGET)

    def balance(z: np.ndarray) -> np.ndarray:
        left = torques(SET_A, z[:3], z[3], SET_A.stiffness)
        return np.append(left * 1e2, (cord.shortening(z[:3]) - goal) * 1e4)

    found = root(balance, [0.03, 0.09, 0.38, 4.5], tol=1e-12).x
    np.testing.assert_allclose(np.degrees(found[:3]), [1.49, 5.10, 22.21], rtol=0, atol=0.005)
    assert found[3] == pytest.approx(4.68, abs=0.005)


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


@given(st.integers(0, 10_000))
def test_unilateral_against_scipy(seed: int) -> None:
    """The same problem solved by scipy's nnls, in the norm of M^-1; and its conditions: no pull,
    no approach, nothing that both pushes and parts.
    """
    rng = np.random.default_rng(seed)
    J = statics.contact_jacobian(rng.uniform(0, 1.2, 3), SET_G.lengths, rng.uniform(.005, .02, 3))
    J = J[: rng.integers(1, 4)]
    tau = rng.normal(0, 0.02, 3)
    half = rng.normal(0, 1e-3, (3, 3))
    M = half @ half.T + 1e-6 * np.eye(3)
    found = statics.unilateral_forces(J, tau, inertia=M)
    root_ = np.linalg.cholesky(M)
    expected, _ = nnls(np.linalg.solve(root_, J.T), np.linalg.solve(root_, tau))
    scale = np.abs(tau).max() / np.abs(J).max()
    np.testing.assert_allclose(found.forces, expected, rtol=1e-6, atol=1e-6 * scale)
    parting = -J @ np.linalg.solve(M, found.residual)
    size = np.linalg.norm(J) * np.linalg.norm(np.linalg.solve(M, tau))
    assert (found.forces >= 0).all()
    assert (parting >= -1e-8 * size).all()
    assert np.abs(found.forces * parting).max() <= 1e-8 * size * max(1.0, found.forces.max())


def test_stop_takes_what_contacts_cannot() -> None:
    """A first joint pressed open onto its lower stop: the stop's torque closes the balance
    tau + stop = J^T f with the two contacts' forces as they are from joints 2 and 3.
    """
    theta, k = np.radians([0.0, 60.0, 50.0]), np.array([0.02, 0.012, 0.01])
    J = statics.contact_jacobian(theta, SET_G.lengths, k)[1:]
    tau = np.array([0.01, 0.02, 0.006])
    f = np.linalg.solve(J[:, 1:].T, tau[1:])
    needed = J[:, 0] @ f - tau[0]
    assert needed > 0
    assert (f > 0).all()
    found = statics.unilateral_forces(J, tau, lower=[True, False, False])
    np.testing.assert_allclose(found.forces, f, rtol=1e-9)
    np.testing.assert_allclose(found.stops, [needed, 0, 0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.residual, 0, atol=1e-12)
    on_upper = statics.unilateral_forces(np.zeros((0, 3)), tau, upper=[True, True, True])
    np.testing.assert_allclose(on_upper.stops, -tau, rtol=0, atol=1e-15)


@pytest.mark.parametrize(("call", "message"), [
    (lambda: statics.joint_torques(-1.0, [0.01], [1.0], [0.0], [0.0]), "tension .* got -1 N"),
    (lambda: statics.contact_forces(np.ones((2, 3)), [1, 1, 1]), "as many contacts as joints"),
    (lambda: statics.contact_forces(np.zeros((2, 2)), [1, 1]), "must not be singular"),
    (lambda: statics.point_jacobian([[0, 0]], [[0, 1]], [[0, 0]], [1]), r"phalanx .* got \[1\]"),
    (lambda: statics.unilateral_forces(np.ones((1, 2)), [1, 1], inertia=-np.eye(2)),
     "positive definite"),
])
def test_impossible_statics_are_refused(call: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
