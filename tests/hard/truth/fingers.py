"""A finger whose tendon is shortened by a given length, at rest: least energy of its springs.

Lengths of tendon and springs over each hinge follow from where their ends are; nothing else is
needed. With q the angles, l(q) the tendon's length, s_i(q_i) the springs' and k a tendon's
stiffness, rest is where sum k_i (s_i - s_i0)^2 / 2 + T^2 / (2 k), T = k (l(q) - l(0) + shortening),
is least.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

SAFE = np.radians(40.0)
"""Up to here a spring across the back of a hinge gains moment as it is turned [rad]."""

Points = Sequence[tuple[float, float]]


def across(near: np.ndarray, far: np.ndarray, angle: float) -> float:
    """Distance of points before and after a hinge at the origin, closed clockwise by an angle."""
    return float(abs(complex(*far) * np.exp(-1j * angle) - complex(*near)))


def slope(near: np.ndarray, far: np.ndarray, angle: float) -> float:
    """Its derivative: Re(conj(d) d'), with d' = -i far exp(-i angle)."""
    turned = complex(*far) * np.exp(-1j * angle)
    line = turned - complex(*near)
    return float((line.conjugate() * -1j * turned).real / abs(line))


def rest(guides: Points, lengths: Sequence[float], before: Points, after: Points,
         stiffness: Sequence[float], shortening: float, cord: float) -> tuple[float, np.ndarray]:
    """Tension [N] and angles [rad] of a finger whose tendon is ``shortening`` [m] shorter.

    The first hinge gives the tension, which need not rise with its angle: the length is given,
    not the pull. The others, whose arms are shorter, stay where their springs still gain moment.
    """
    near = np.array(guides[:-1], dtype=float)
    near[1:, 0] -= np.array(lengths[:-1])
    hinges = [(near[i], np.array(guides[i + 1]), np.array(before[i]), np.array(after[i]), k)
              for i, k in enumerate(stiffness)]

    def spring(i: int, angle: float) -> float:
        _, _, c, d, k = hinges[i]
        return float(k * (across(c, d, angle) - across(c, d, 0.0)) * slope(c, d, angle))

    def pose(first: float) -> tuple[float, np.ndarray]:
        tension = -spring(0, first) / slope(*hinges[0][:2], first)
        others = [brentq(lambda q, i=i: spring(i, q) + tension * slope(*hinges[i][:2], q),
                         0.0, SAFE, xtol=1e-14) for i in range(1, len(hinges))]
        return tension, np.array([first, *others])

    def left(first: float) -> float:
        tension, angles = pose(first)
        pulled = sum(across(a, b, 0.0) - across(a, b, q)
                     for (a, b, *_), q in zip(hinges, angles, strict=True))
        return float(pulled + tension / cord - shortening)

    return pose(brentq(left, 1e-6, np.pi / 3, xtol=1e-14))
