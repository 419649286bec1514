"""The law of cosines, for the triangles that tendons and springs make with their hinges."""

from __future__ import annotations

import numpy as np

from sandbox.numeric import Array


def third_side(a: Array, b: Array, angle: Array) -> Array:
    """Length sqrt(a^2 + b^2 - 2 a b cos(angle)) opposite ``angle`` [rad].

    As sqrt((a - b)^2 + 4 a b sin^2(angle / 2)), which loses no digits where
    the two sides nearly coincide.
    """
    return np.asarray(np.hypot(a - b, 2 * np.sqrt(a * b) * np.sin(angle / 2)))


def corner(a: Array, b: Array, opposite: Array) -> Array:
    """Angle between sides ``a`` and ``b`` [rad], acos((a^2 + b^2 - opposite^2) / (2 a b)).

    Raises:
        ValueError: three sides [m] that make no triangle.
    """
    cosine = np.asarray((a**2 + b**2 - opposite**2) / (2 * a * b))
    if (apart := np.abs(cosine) > 1 + 1e-12).any():
        sides = [float(side[apart].flat[0]) for side in np.broadcast_arrays(a, b, opposite)]
        raise ValueError("the sides must make a triangle, got "
                         + ", ".join(f"{side:.6g} m" for side in sides))
    return np.asarray(np.arccos(np.clip(cosine, -1, 1)))
