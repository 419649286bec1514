"""Set A and Set G: two reference fingers as plain numbers, and an integration of their motion.

Lengths are those of digit III, rounded (Buryanov and Kotiuk 2010); masses, radii, guides and
springs are assumptions within the range of comparable public hands. Nothing here uses sandbox.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
Points = tuple[tuple[float, float], ...]
MM = 1e-3


@dataclass(frozen=True)
class FingerSet:
    """Phalanges from the palm outwards; straight along +x, palmar side -y, closing clockwise."""

    guides: Points
    """Of the tendon: on the palm, from the first hinge, then in each phalanx's frame [m]."""
    before: Points
    """Where each spring is attached to the phalanx before its hinge, from the hinge [m]."""
    after: Points
    """Where it is attached to the phalanx after its hinge, from the hinge [m]."""
    stiffness: tuple[float, ...]
    """[N/m]; relaxed at 0."""
    damping: tuple[float, ...]
    """Of the joints [N m s/rad]."""
    lengths: tuple[float, ...] = (45 * MM, 26 * MM, 21 * MM)
    masses: tuple[float, ...] = (12e-3, 6e-3, 4e-3)
    radii: tuple[float, ...] = (9 * MM, 8 * MM, 7.5 * MM)
    limits: tuple[float, ...] = tuple(np.radians([85.0, 95.0, 75.0]).tolist())
    """Upper limits [rad]; the lower ones are 0."""

    @property
    def inertias(self) -> tuple[float, ...]:
        """About the centres, at L/2: m (L^2/12 + r^2/4) [kg m^2]."""
        return tuple(m * (length**2 / 12 + r**2 / 4) for m, length, r in
                     zip(self.masses, self.lengths, self.radii, strict=True))


def _points(*pairs: tuple[float, float]) -> Points:
    return tuple((x * MM, y * MM) for x, y in pairs)


SET_A = FingerSet(
    guides=_points((-15, -5), (22.5, -5), (13, -5), (10.5, -5)),
    before=_points((-7, 8), (-7, 8), (-7, 10)), after=_points((7, 8), (7, 8), (7, 10)),
    stiffness=(15000.0, 5000.0, 1100.0), damping=(6e-3, 2.5e-3, 6e-4))
SET_G = FingerSet(
    guides=_points((-22, -14), (24, -8), (10, -3), (4, -1)),
    before=_points((-8, 8), (-8, 8), (-8, 8)), after=_points((8, 8), (8, 8), (8, 8)),
    stiffness=(300.0, 300.0, 300.0), damping=(4e-3, 1.2e-3, 3e-4))


@dataclass(frozen=True)
class DiscRow:
    """Row of the Set G table: pose and contact forces of a frictionless finger on a fixed disc."""

    disc_radius: float
    centre: tuple[float, float]
    tension: float
    degrees: tuple[float, float, float]
    forces: tuple[float, float, float]


SET_G_TABLE = (
    DiscRow(16 * MM, (11.0543 * MM, -38.2597 * MM), 3.75, (35.0, 62.361, 49.276),
            (0.5839, 0.9175, 0.6454)),
    DiscRow(16 * MM, (11.0543 * MM, -38.2597 * MM), 5.0, (35.0, 62.361, 49.276),
            (1.0409, 1.0009, 1.0399)),
    DiscRow(20 * MM, (8.7600 * MM, -41.5363 * MM), 5.0, (35.0, 55.369, 42.315),
            (0.6696, 0.9111, 0.9172)),
)


class Chain:
    """Equations of motion of a finger in its joint angles q, closing (clockwise) positive.

    With the world angle a_i = -(q_1 + ... + q_i) of phalanx i and u_i = (cos a_i, sin a_i),

        c_i = sum_(m<i) L_m u_m + s_i u_i,   J_i = d c_i / d q
        M = sum m_i J_i^T J_i + I_i w_i^T w_i
        M q'' = Q - sum m_i J_i^T b_i,   b_i = acceleration of c_i at q'' = 0

    and Q the generalised forces of tendon, springs and joint damping.
    """

    def __init__(self, finger: FingerSet) -> None:
        self.finger, self.n = finger, len(finger.lengths)
        self.m, self.k = np.array(finger.masses), np.array(finger.stiffness)
        self.damping = np.array(finger.damping)
        lengths = np.array(finger.lengths)
        below = np.tril(np.ones((self.n, self.n)))
        self.reach = (below - np.eye(self.n)) * lengths + np.diag(lengths / 2)
        self.spin = -below
        self.near = np.array(finger.guides)[:-1].copy()
        self.near[1:, 0] -= lengths[:-1]
        self.rest = self.spring(np.zeros(self.n))[0]

    @staticmethod
    def across(near: Array, far: Array, q: Array) -> tuple[Array, Array]:
        """Lengths of straight lines over the hinges and d/dq; points from the hinge [m]."""
        c, s = np.cos(q), np.sin(q)
        x, y = far.T
        line = np.stack([c * x + s * y, -s * x + c * y], axis=1) - near
        slope = np.stack([-s * x + c * y, -c * x - s * y], axis=1)
        length = np.hypot(*line.T)
        return length, (line * slope).sum(axis=1) / length

    def tendon(self, q: Array) -> tuple[Array, Array]:
        """Lengths of the tendon's segments [m], and d/dq of each by its own joint."""
        return self.across(self.near, np.array(self.finger.guides[1:]), q)

    def spring(self, q: Array) -> tuple[Array, Array]:
        """Lengths of the springs [m], and d/dq of each by its own joint."""
        return self.across(np.array(self.finger.before), np.array(self.finger.after), q)

    def inertia(self, q: Array) -> tuple[Array, Array, Array]:
        """Directions u [n, 2], Jacobians of the centres [n, 2, n], and the mass matrix M."""
        a = self.spin @ q
        u = np.stack([np.cos(a), np.sin(a)], axis=1)
        turned = np.stack([-np.sin(a), np.cos(a)], axis=1)
        J = np.einsum("im,mx,mj->ixj", self.reach, turned, self.spin)
        M = (np.einsum("i,ixj,ixk->jk", self.m, J, J)
             + self.spin.T @ np.diag(self.finger.inertias) @ self.spin)
        return u, J, M

    def derivative(self, pull: float, state: Array) -> Array:
        """Derivatives of angles and rates [2 n] under a tension [N]."""
        q, v = state[:self.n], state[self.n:]
        u, J, M = self.inertia(q)
        bias = self.reach @ (-((self.spin @ v)**2)[:, None] * u)
        length, arm = self.spring(q)
        Q = (-pull * self.tendon(q)[1] - self.k * (length - self.rest) * arm - self.damping * v
             - np.einsum("i,ixj,ix->j", self.m, J, bias))
        return np.concatenate([v, np.linalg.solve(M, Q)])

    def integrate(self, times: Array, pull: float) -> Array:
        """States [n_times, 2 n] of the motion from straight at rest under a tension [N]."""
        return integrate(lambda _, y: self.derivative(pull, y), np.zeros(2 * self.n), times)


def integrate(derivative: Callable[[float, Array], Any], start: Any, times: Array) -> Array:
    """States at ``times`` [s] by an integration of order 8, shape [n_times, n]."""
    found = solve_ivp(derivative, (0.0, float(times[-1])), start, method="DOP853", t_eval=times,
                      rtol=1e-11, atol=1e-13)
    assert found.success, found.message
    return np.asarray(found.y.T)


def stick_slip(t: Array, mass: float, stiffness: float, speed: float, static: float,
               sliding: float) -> Array:
    """Position x(t) [m] of a block dragged by a spring whose other end moves at ``speed``.

    At t = 0 the block is at rest and the spring relaxed. It sticks until the spring's force is
    ``static`` [N]. It then slips against ``sliding`` [N] for 2 (pi - atan(d w / v)) / w, with
    w^2 = k / m and d = (static - sliding) / k; the stretch that is left is sliding / k - d.
    """
    omega, more = np.sqrt(stiffness / mass), (static - sliding) / stiffness
    slips = 2 * (np.pi - np.arctan2(more * omega, speed)) / omega
    period, first = slips + 2 * more / speed, static / stiffness / speed
    u = np.where(t < first, 0.0, (t - first) % period)
    start, slip = np.where(t < first, first, t - u), np.minimum(u, slips)
    stretch = (sliding / stiffness + more * np.cos(omega * slip)
               + speed / omega * np.sin(omega * slip))
    return np.asarray(speed * (start + slip) - stretch)
