"""Andrews' squeezer, from the numbers of its benchmark: its motion in the bodies' own angles."""

from __future__ import annotations

from functools import cache

import numpy as np

from sandbox.verification.benchmarks.squeezer import (
    DA,
    EA,
    FA,
    INERTIAS,
    MASSES,
    RA,
    REST,
    RR,
    SA,
    SB,
    SC,
    SD,
    SS,
    START,
    STIFFNESS,
    TA,
    TB,
    TORQUE,
    UA,
    UB,
    ZF,
    ZT,
    B,
    C,
    D,
    E,
    U,
)
from tests.hard.truth.linkages import Linkage


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
