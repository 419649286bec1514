"""Andrews' squeezing mechanism (Schiehlen 1990; IVP test set): seven bodies, 14.7 mm, 30 ms.

K1 turns about the origin under a constant torque, K2 leads from its end to E; K3 (about B),
K4 on K5 and K6 on K7 (both about A) hold E, and a spring leads from K3 to C. Angles here are the
bodies' own in the plane: beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from tests.hard.truth.linkages import Linkage

A, B, C = -0.06934 - 0.00227j, -0.03635 + 0.03273j, 0.014 + 0.072j
D, DA, E, EA = 28e-3, 115e-4, 2e-2, 1421e-5
RR, RA, SS, SA, SB, SC, SD = 7e-3, 92e-5, 35e-3, 1874e-5, 1043e-5, 18e-3, 2e-2
TA, TB, U, UA, UB, ZF, ZT, FA = 2308e-5, 916e-5, 4e-2, 1228e-5, 449e-5, 2e-2, 4e-2, 1421e-5
MASSES = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
INERTIAS = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
TORQUE, STIFFNESS, REST = 0.033, 4530.0, 0.07785
BETA, THETA, GAMMA, PHI, DELTA, OMEGA, EPSILON = (
    -0.0617138900142764496358948458001, 0.0, 0.455279819163070380255912382449,
    0.222668390165885884674473185609, 0.487364979543842550225598953530,
    -0.222668390165885884674473185609, 1.23054744454982119249735015568)
START = (BETA, BETA + THETA, GAMMA, PHI + DELTA, DELTA, OMEGA + EPSILON, EPSILON)

ENDS = ((RR, -D), (SD - 1j * SC,), (ZT,), (-1j * U,))
"""Of K1 and K2, of K3's spring, of K5 and of K7, each in its body's frame [m]."""
KEPT = np.array([1.581077119629904e1, -1.575637105984298e1, 4.082224013073101e-2,
                 -5.347301163226948e-1, 5.244099658805304e-1, 5.347301163226948e-1,
                 1.048080741042263])
"""Of the test set at 0.03 s: beta, theta, gamma, phi, delta, omega, epsilon [rad]."""


def spring(angle: np.ndarray, _: np.ndarray) -> np.ndarray:
    """Torques [N m] of the spring on K3 and of the motor on K1."""
    end = (SD - 1j * SC) * np.exp(1j * angle[2])
    line = C - B - end
    force = STIFFNESS * (abs(line) - REST) * line / abs(line)
    torques = np.zeros(7)
    torques[0] = TORQUE
    torques[2] = (end.conj() * force).imag
    return torques


def linkage() -> Linkage:
    """Frames sit at O, F, B, G, A, H and A."""
    def row(**at: complex) -> tuple[complex, ...]:
        return tuple(complex(at.get(f"k{i}", 0.0)) for i in range(1, 8))

    arms = (row(k1=RA), row(k1=RR, k2=-DA), row(k3=SB - 1j * SA),
            row(k5=ZT, k4=-1j * (E - EA)), row(k5=TB - 1j * TA),
            row(k7=-1j * U, k6=ZF - FA), row(k7=-UB - 1j * UA))
    loops = (row(k1=RR, k2=-D, k3=1j * SS), row(k1=RR, k2=-D, k5=-ZT, k4=1j * E),
             row(k1=RR, k2=-D, k7=1j * U, k6=-ZF))
    return Linkage(MASSES, INERTIAS, arms, loops, START, (0.0,) * 7, torques=spring)


def published(angles: np.ndarray) -> np.ndarray:
    """The test set's seven angles of the bodies' own, shape [n, 7]."""
    b, bt, g, pd, d, oe, e = np.atleast_2d(angles).T
    return np.stack([b, bt - b, g, pd - d, d, oe - e, e], axis=1)


@cache
def course(times: tuple[float, ...]) -> np.ndarray:
    """Angles at ``times`` [s], shape [n, 7]; kept, because all steps ask at their own."""
    return linkage().motion(np.array(times))[0]
