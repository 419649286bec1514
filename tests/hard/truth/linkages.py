"""Linkages of rigid bodies in the plane: KKT equations in the bodies' angles, loops as constraints.

The plane is that of complex numbers. Every centre is a sum of arms that turn with the bodies,
c_i = o_i + sum_j A_ij u_j with u_j = exp(i a_j), and so is what closes a loop,
0 = p_l + sum_j L_lj u_j. With the Jacobian J_ij = A_ij i u_j

    sum_i m_i Re(conj(J_ij) c_i'') + I_j a_j'' = sum_i Re(conj(J_ij) F_i) + tau_j + (loops)
    c_i'' = sum_j J_ij a_j'' - A_ij u_j a_j'^2,   and the same for the loops, which stay 0
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tests.hard.truth.integrate import RTOL, motion


def nothing(angle: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """No torques."""
    return np.zeros_like(angle)


@dataclass(frozen=True)
class Linkage:
    """Bodies that turn, their centres and loops as sums of turning arms [m]."""

    masses: tuple[float, ...]
    """Of the centres [kg]; a slider has one and no angle."""
    inertias: tuple[float, ...]
    """Of what turns, about its centre [kg m^2]."""
    arms: tuple[tuple[complex, ...], ...]
    """A, a row for each centre, a column for each angle."""
    loops: tuple[tuple[complex, ...], ...]
    """L, one row for each loop."""
    start: tuple[float, ...]
    """Angles [rad] at t = 0, with all loops closed."""
    rate: tuple[float, ...]
    slides: tuple[bool, ...] = ()
    """Of each loop whether only its imaginary part is kept 0: a slider along x."""
    gravity: float = 0.0
    torques: Callable[[np.ndarray, np.ndarray], np.ndarray] = nothing

    @cached_property
    def A(self) -> np.ndarray:  # noqa: N802
        return np.array(self.arms, dtype=complex)

    @cached_property
    def L(self) -> np.ndarray:  # noqa: N802
        return np.array(self.loops, dtype=complex).reshape(-1, len(self.start))

    def rows(self, loops: np.ndarray) -> np.ndarray:
        """Real equations of complex ones, in order of the loops."""
        slides = self.slides or (False,) * len(loops)
        parts = [loops[i:i + 1].imag if slide else np.stack([loops[i].real, loops[i].imag])
                 for i, slide in enumerate(slides)]
        return np.concatenate([np.zeros((0, loops.shape[1])), *parts])

    def acceleration(self, angle: np.ndarray, rate: np.ndarray) -> np.ndarray:
        m, u = np.array(self.masses), np.exp(1j * angle)
        J, G = self.A * (1j * u), self.rows(self.L * (1j * u))
        M = ((m[:, None] * J.conj()).T @ J).real + np.diag(self.inertias)
        force = m * (self.A @ (u * rate**2) - 1j * self.gravity)
        Q = (J.conj().T @ force).real + self.torques(angle, rate)
        bias = self.rows((self.L * (u * rate**2)).sum(axis=1, keepdims=True))[:, 0]
        n, k = len(angle), len(G)
        kkt = np.block([[M, G.T], [G, np.zeros((k, k))]])
        return np.linalg.solve(kkt, np.concatenate([Q, bias]))[:n]

    def motion(self, times: np.ndarray, rtol: float = RTOL) -> np.ndarray:
        """Angles and rates at ``times`` [s], shape [2, n, bodies]."""
        return motion(times, self.acceleration, np.array(self.start), np.array(self.rate),
                      rtol=rtol)

    def rates(self, first: float) -> np.ndarray:
        """Rates that keep all loops closed while the first body turns at ``first`` [rad/s]."""
        G = self.rows(self.L * (1j * np.exp(1j * np.array(self.start))))
        rest = np.linalg.solve(G[:, 1:], -G[:, 0] * first)
        return np.concatenate([[first], rest])

    def centres(self, angle: np.ndarray) -> np.ndarray:
        """Of the bodies as far as they move with the angles [m], complex, shape [n, bodies]."""
        return np.exp(1j * angle) @ self.A.T

    def open(self, angle: np.ndarray, closed: np.ndarray) -> np.ndarray:
        """By how much loops have opened since ``closed`` [m]: what an integration loses."""
        now, then = (np.exp(1j * one) @ self.L.T for one in (angle, closed))
        return np.abs(np.stack([self.rows(row[:, None])[:, 0] for row in np.atleast_2d(
            now - then)])).max(axis=1)

    def kinetic(self, angle: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """[J], for angles and rates of shape [n, bodies]."""
        speed = (np.exp(1j * angle) * 1j * rate) @ self.A.T
        return 0.5 * np.abs(speed)**2 @ np.array(self.masses) + 0.5 * rate**2 @ np.array(
            self.inertias)


def elbow(base: complex, reach: complex, near: float, far: float, side: float) -> complex:
    """Where rods of ``near`` from ``base`` and ``far`` from ``reach`` meet; side +1 is left."""
    apart = abs(reach - base)
    along = (near**2 - far**2 + apart**2) / (2 * apart)
    across = side * np.sqrt(near**2 - along**2)
    return complex(base + (reach - base) / apart * (along + 1j * across))
