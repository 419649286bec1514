"""Equations (32)-(33): pendulums, a rotating bar, the finger in motion and on a disc."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.mechanics import chain, dynamics, grasp, springs, statics, tendon
from sandbox.mechanics.motion import finger_motion
from sandbox.study.independent import Chain, integrate
from sandbox.study.reference_fingers import SET_G, SET_G_TABLE, DiscRow, FingerSet


def loads(finger: FingerSet, frames: np.ndarray, tension: np.ndarray) -> np.ndarray:
    """Phi_star of tendon and springs on every phalanx, in its frame, shape [..., n, 3, 3]."""
    n = len(finger.lengths)
    palm = np.broadcast_to(np.eye(3), (*frames.shape[:-3], 1, 3, 3))
    links = np.concatenate([palm, frames], axis=-3)
    guides = chain.to_world(links, np.array(finger.guides))
    hinge = np.concatenate([np.zeros((1, 2)), [[x, 0.0] for x in finger.lengths[:-1]]])
    near = chain.to_world(links[..., :-1, :, :], hinge + np.array(finger.before))
    far = chain.to_world(frames, np.array(finger.after))
    length = np.linalg.norm(far - near, axis=-1)
    rest = np.linalg.norm(hinge * [1, 0] + np.array(finger.after) - hinge - finger.before, axis=-1)
    on_near, on_far = springs.end_forces(near, far, np.array(finger.stiffness) * (length - rest))
    pulled = tendon.guide_forces(guides, np.asarray(tension)[..., None])
    total = (dynamics.force_action(pulled[..., 1:, :], guides[..., 1:, :])
             + dynamics.force_action(on_far, far))
    total[..., :n - 1, :, :] += dynamics.force_action(on_near[..., 1:, :], near[..., 1:, :])
    return dynamics.change_frame(total, chain.inverse(frames))


def actions(
    finger: FingerSet, q: np.ndarray, v: np.ndarray, acc: np.ndarray, *,
    applied: np.ndarray | None = None, gravity: tuple = (0.0, 0.0),
) -> tuple[np.ndarray, np.ndarray]:
    """Phi_i [..., n, 3, 3] of a finger of uniform phalanges, and its frames."""
    frames = chain.transforms(q, finger.lengths)
    moved = finger_motion(q, v, acc, finger.lengths)
    W = dynamics.acceleration_matrix(*moved)
    centre = np.stack([np.array(finger.lengths) / 2, np.zeros(len(finger.lengths))], axis=-1)
    Y = dynamics.inertia_matrix(finger.masses, centre, finger.inertias)
    own_g = np.einsum("...ji,j->...i", frames[..., :2, :2], np.array(gravity))
    external = dynamics.external_action(
        W, Y, gravity=dynamics.gravity_matrix(own_g), applied=applied)
    links = chain.link_transforms(q, finger.lengths)
    return dynamics.transmitted_actions(external, links), frames


def test_matrices_move_and_fall_points() -> None:
    """W p = a + alpha z x r - omega^2 r, W_g p = g, and Y is the sum of dm p p^T over a bar."""
    omega, alpha, a, r = 3.0, -40.0, np.array([2.0, 5.0]), np.array([0.02, -0.01])
    W = dynamics.acceleration_matrix(omega, alpha, a)
    across = np.array([-r[1], r[0]])
    np.testing.assert_allclose(
        (W @ [*r, 1])[:2], a + alpha * across - omega**2 * r, rtol=1e-15)
    np.testing.assert_array_equal(dynamics.gravity_matrix([1.0, -9.81]) @ [*r, 1], [1, -9.81, 0])
    n, L, m = 4000, 0.04, 0.012
    x = (np.arange(n) + 0.5) * L / n  # midpoints miss m L^2/12 by its n^-2
    p = np.stack([x, np.full(n, 0.003), np.ones(n)])
    Y = dynamics.inertia_matrix(m, [L / 2, 0.003], m * L**2 / 12)
    summed = (p * m / n) @ p.T
    np.testing.assert_allclose(Y[2], summed[2], rtol=1e-12)
    np.testing.assert_allclose(np.trace(Y[:2, :2]), np.trace(summed[:2, :2]), rtol=2 / n**2)


def test_actions_of_forces_and_couples() -> None:
    """f P^T - P f^T carries f and x f_y - y f_x; A Phi A^T is the same force seen elsewhere."""
    f, p = np.array([3.0, -2.0]), np.array([0.04, 0.01])
    phi = dynamics.force_action(f, p)
    np.testing.assert_array_equal(phi, np.outer([*f, 0], [*p, 1]) - np.outer([*p, 1], [*f, 0]))
    np.testing.assert_array_equal(dynamics.action_force(phi), f)
    assert dynamics.action_moment(phi) == pytest.approx(p[0] * f[1] - p[1] * f[0], rel=1e-15)
    frame = chain.pose(0.1, -0.2, 0.7)
    seen = dynamics.change_frame(phi, frame)
    turned = frame[:2, :2] @ f
    np.testing.assert_allclose(
        seen, dynamics.force_action(turned, frame[:2, :2] @ p + frame[:2, 2]), rtol=0, atol=1e-15)
    couple = dynamics.couple_action(0.3)
    np.testing.assert_allclose(dynamics.change_frame(couple, frame), couple, rtol=0, atol=1e-16)


@pytest.mark.parametrize(("swing", "omega"), [(0.5, -3.0), (-1.2, 11.0)])
def test_pendulum(swing: float, omega: float) -> None:
    """A body on a pin, its centre l below it at ``swing`` from the vertical, closed form:
    along the rod m (g cos(swing) + omega^2 l), across it m g sin(swing) I / (I + m l^2).
    """
    m, arm, inertia, g = 0.012, 0.0225, 2.27e-6, 9.81
    alpha = -m * g * arm * np.sin(swing) / (inertia + m * arm**2)
    angle = swing - np.pi / 2  # of the rod in the world
    frame = chain.pose(0.3, 0.1, angle)
    external = dynamics.external_action(
        dynamics.acceleration_matrix(omega, alpha, [0, 0]),
        dynamics.inertia_matrix(m, [arm, 0], inertia),
        gravity=dynamics.gravity_matrix(frame[:2, :2].T @ [0, -g]))
    found = dynamics.hinge_reactions(
        dynamics.transmitted_actions(external[None], frame[None]), frame[None])
    along = -m * (g * np.cos(swing) + omega**2 * arm)
    across = m * g * np.sin(swing) * inertia / (inertia + m * arm**2)
    scale = m * (g + omega**2 * arm)
    np.testing.assert_allclose(found.force_own[0], [along, across], rtol=0, atol=1e-15 * scale * 4)
    np.testing.assert_allclose(
        found.force[0], frame[:2, :2] @ [along, across], rtol=0, atol=1e-15 * scale * 4)
    assert abs(found.moment[0]) < 4e-15 * scale * arm


def test_closing_finger_by_lagrange() -> None:
    """Set G pulled shut at 3 N, its accelerations from Lagrange's equations with the generalised
    forces of tendon and springs: actions with T (u + u') at every guide and both spring ends
    leave the dampers' couples d q' at the hinges, and nothing else.
    """
    times, g = np.linspace(0.0, 0.06, 25)[1:], (1.0, -9.81)
    run = integrate(SET_G, times, pull=3.0, gravity=g)
    lagrange = Chain(SET_G, lambda _: 3.0, g)
    acc = np.array([lagrange.acceleration(t, q, v) for t, q, v in
                    zip(times, run.angle, run.rate, strict=True)])
    frames = chain.transforms(run.angle, SET_G.lengths)
    phi, _ = actions(SET_G, run.angle, run.rate, acc, gravity=g,
                     applied=loads(SET_G, frames, np.full(len(times), 3.0)))
    found = dynamics.hinge_reactions(phi, frames)
    damped = np.array(SET_G.damping) * run.rate  # opens, so counter-clockwise on the phalanx
    assert np.abs(damped).max() > 1e-3
    np.testing.assert_allclose(found.moment, damped, rtol=0, atol=2e-15)


@pytest.mark.parametrize("row", [SET_G_TABLE[0], SET_G_TABLE[-1]])
def test_finger_on_a_disc(row: DiscRow) -> None:
    """At rest every hinge is free of moment, and what the palm gives (its hinge, the tendon's first
    segment and spring) balances the three contact forces of f = J^-T tau.
    """
    at = grasp.disc_centre(np.radians(35.0), 0.031, row.disc_radius, SET_G.radii[0])
    held = grasp.disc_grasp(at, row.disc_radius, SET_G.lengths, SET_G.radii)
    elastic, cord = springs.spring_set(SET_G.before, SET_G.after), tendon.route(
        SET_G.guides, SET_G.lengths)
    tau = statics.joint_torques(row.tension, cord.arms(held.theta), SET_G.stiffness,
                                elastic.elongations(held.theta), elastic.arms(held.theta))
    J = statics.contact_jacobian(held.theta, SET_G.lengths, held.distances)
    forces = statics.contact_forces(J, tau)[:, None] * held.normals
    frames = chain.transforms(held.theta, SET_G.lengths)
    contact = dynamics.change_frame(
        dynamics.force_action(forces, held.contacts), chain.inverse(frames))
    rest = np.zeros(3)
    phi, _ = actions(SET_G, held.theta, rest, rest,
                     applied=contact + loads(SET_G, frames, np.float64(row.tension)))
    found = dynamics.hinge_reactions(phi, frames)
    np.testing.assert_allclose(found.moment, 0, atol=1e-15)  # tens of roundings of 0.1 N m
    v0, v1 = np.array(SET_G.guides[0]), chain.to_world(frames[0], SET_G.guides[1])
    m0, m1 = np.array(SET_G.before[0]), chain.to_world(frames[0], SET_G.after[0])
    pull = row.tension * (v0 - v1) / np.linalg.norm(v0 - v1)
    spring = SET_G.stiffness[0] * elastic.elongations(held.theta)[0]
    back = spring * (m0 - m1) / np.linalg.norm(m0 - m1)
    np.testing.assert_allclose(found.force[0] + pull + back + forces.sum(axis=0), 0, atol=1e-14)


@pytest.mark.parametrize(("call", "message"), [
    (lambda: dynamics.acceleration_matrix([1.0, 2.0], 0.0, np.zeros((3, 2))),
     r"omega and alpha and acceleration must be of equal length, got shapes \(2,\)"),
    (lambda: dynamics.inertia_matrix(-1.0, [0, 0], 0.0), "mass must be 0 or more, got -1 kg"),
    (lambda: dynamics.transmitted_actions(np.zeros((3, 3, 3)), np.zeros((2, 3, 3))),
     "external and links must have a matrix for every phalanx"),
])
def test_impossible_dynamics_are_refused(call: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
