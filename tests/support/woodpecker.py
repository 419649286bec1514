"""The woodpecker toy in three coordinates by Moreau's time stepping: height, sleeve, bird.

A step moves by half, finds which gaps are closed, and solves Newton's law of impact with Coulomb's
of friction for them, one mode after the other until one is consistent; then moves by half. Gaps
and arms are those of real corners, or of first order in the angles, as published.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from tests.support.mechanisms import G
from tests.verification.test_clearance_benchmarks import (
    ARM,
    BEAK,
    FRICTION,
    HALF,
    HOLE,
    PECK,
    POLE,
    RATE,
    SPEED,
    STIFFNESS,
    TAIL,
    TOY_INERTIAS,
    TOY_MASSES,
)

MODES = ("open", "stick", "left", "right")
BACK, UP = -BEAK[0], BEAK[1]
GIVES = np.array([PECK, 0.0, 0.0])


def arms(a: float, b: float, real: bool) -> tuple[np.ndarray, np.ndarray]:
    """Gaps of beak, lower and upper edge [m], and Jacobians of the points, complex [3, 3]."""
    if real:
        u, w = np.exp(1j * a), np.exp(1j * b)
        places = np.array([ARM * u + (TAIL - BACK + 1j * UP) * w,
                           (HOLE - 1j * HALF) * u, (HOLE + 1j * HALF) * u])
        J = 1j * np.array([[0, ARM * u, (TAIL - BACK + 1j * UP) * w],
                           [0, (HOLE - 1j * HALF) * u, 0], [0, (HOLE + 1j * HALF) * u, 0]])
        J[:, 0] = 1j
        return places.real - POLE, J
    gaps = np.array([ARM + TAIL - BACK - POLE - UP * b, HOLE - POLE + HALF * a,
                     HOLE - POLE - HALF * a])
    J = np.array([[1j, 1j * ARM, -UP + 1j * (TAIL - BACK)], [1j, HALF + 1j * HOLE, 0],
                  [1j, -HALF + 1j * HOLE, 0]])
    return gaps, J


def mass_and_force(q: np.ndarray, v: np.ndarray, real: bool) -> tuple[np.ndarray, np.ndarray]:
    """Of the centres x + i y and the angles, without contacts."""
    u, w = (np.exp(1j * q[1]), np.exp(1j * q[2])) if real else (1.0, 1.0)
    J = 1j * np.array([1.0, ARM * u, TAIL * w])
    M = TOY_MASSES[1] * (J.conj()[:, None] * J).real + np.diag([TOY_MASSES[0], *TOY_INERTIAS])
    turning = -ARM * u * v[1]**2 - TAIL * w * v[2]**2 if real else 0.0
    spring = STIFFNESS * (q[1] - q[2])
    force = (J.conj() * TOY_MASSES[1] * (-1j * G - turning)).real
    return M, force + np.array([-TOY_MASSES[0] * G, -spring, spring])


def taken(G_: np.ndarray, u: np.ndarray, want: np.ndarray,
          first: tuple[str, ...]) -> tuple[np.ndarray, tuple[str, ...]]:
    """Impulses (normal, tangential of each) with u + G p as Newton and Coulomb want, and modes."""
    n = len(want)
    for modes in (first, *product(MODES, repeat=n)):
        if len(modes) != n:
            continue
        A, rhs = np.eye(2 * n), np.zeros(2 * n)
        for i, mode in enumerate(modes):
            if mode != "open":
                A[i], rhs[i] = G_[i], want[i] - u[i]
            if mode == "stick":
                A[n + i], rhs[n + i] = G_[n + i], -u[n + i]
            elif mode != "open":
                A[n + i, i] = FRICTION if mode == "right" else -FRICTION
        p = np.linalg.solve(A, rhs)
        y = u + G_ @ p
        slack = 1e-12
        good = all(
            y[i] >= want[i] - slack if mode == "open" else
            p[i] >= 0 and (abs(p[n + i]) <= FRICTION * p[i] if mode == "stick" else
                           (y[n + i] >= -slack if mode == "right" else y[n + i] <= slack))
            for i, mode in enumerate(modes))
        if good:
            return p, modes
    raise ArithmeticError("no mode is consistent")


def course(until: float, step: float, start: tuple[float, float], *,
           real: bool) -> tuple[np.ndarray, np.ndarray]:
    """Instants [s], shape [n], and height, angle of the sleeve, of the bird, shape [n, 3]."""
    q, v = np.array([0.0, *start]), np.array([SPEED, 0.0, RATE])
    states, modes = [], ("stick",)
    for _ in range(round(until / step)):
        q = q + step / 2 * v
        gaps, J = arms(q[1], q[2], real)
        M, force = mass_and_force(q, v, real)
        free = v + step * np.linalg.solve(M, force)
        closed = np.flatnonzero(gaps <= 0)
        if len(closed):
            rows = np.concatenate([J[closed].real, J[closed].imag])
            W = np.linalg.solve(M, rows.T)
            before = rows[:len(closed)] @ v
            p, modes = taken(rows @ W, rows @ free,
                             -GIVES[closed] * np.minimum(before, 0.0), modes)
            free = free + W @ p
        v = free
        q = q + step / 2 * v
        states.append(q)
    return step * np.arange(1, len(states) + 1), np.array(states)
