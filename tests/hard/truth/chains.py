"""Rods in a row, in the fewest coordinates: their angles a from the x axis, counter-clockwise.

With B the lengths along which a rod's centre is carried, c = B u, u_i = (cos a_i, sin a_i), and
K = B^T diag(m) B, the Lagrangian gives

    sum_j K_ij (cos(a_i - a_j) a_j'' + sin(a_i - a_j) a_j'^2) + I_i a_i'' = - g (B^T m)_i cos a_i
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.hard.truth.integrate import RTOL, motion

G = 9.81


@dataclass(frozen=True)
class Rods:
    """Uniform rods, pinned end to end, the first to the wall."""

    masses: tuple[float, ...]
    length: float
    start: tuple[float, ...]
    """Angles at t = 0 [rad]; they start at rest."""

    @property
    def inertias(self) -> np.ndarray:
        return np.array(self.masses) * self.length**2 / 12

    @property
    def carried(self) -> np.ndarray:
        n = len(self.masses)
        return self.length * (np.tril(np.ones((n, n)), -1) + np.eye(n) / 2)

    def acceleration(self, angle: np.ndarray, rate: np.ndarray) -> np.ndarray:
        B, m = self.carried, np.array(self.masses)
        K = B.T @ (m[:, None] * B)
        apart = angle[:, None] - angle
        weight = G * (B.T @ m) * np.cos(angle)
        return np.linalg.solve(K * np.cos(apart) + np.diag(self.inertias),
                               -(K * np.sin(apart)) @ rate**2 - weight)

    def angles(self, times: np.ndarray, rtol: float = RTOL) -> np.ndarray:
        """At ``times`` [s], shape [n, rods]."""
        start = np.array(self.start)
        return motion(times, self.acceleration, start, 0 * start, rtol=rtol)[0]

    def energy(self, angle: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Kinetic and of weight [J], for angles and rates of shape [n, rods]."""
        B, m = self.carried, np.array(self.masses)
        u = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        across = np.stack([-u[..., 1], u[..., 0]], axis=-1) * rate[..., None]
        speed = np.einsum("ij,njx->nix", B, across)
        kinetic = 0.5 * (speed**2).sum(axis=-1) @ m + 0.5 * rate**2 @ self.inertias
        return kinetic + G * (u[..., 1] @ B.T) @ m

    def tip(self, angle: np.ndarray) -> np.ndarray:
        """Of the last rod [m], shape [n, 2]."""
        return self.length * np.stack([np.cos(angle).sum(axis=1), np.sin(angle).sum(axis=1)], 1)
