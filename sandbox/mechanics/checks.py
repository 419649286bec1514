"""Checks of the arguments of closed forms.

Each returns the value as a float array, or raises a ``ValueError`` that names the argument, what is
allowed, the value and its unit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sandbox.numeric import Array


def finite(name: str, value: ArrayLike, unit: str) -> Array:
    """Values that are neither nan nor infinite."""
    return _require(name, value, unit, np.isfinite, "finite")


def positive(name: str, value: ArrayLike, unit: str) -> Array:
    """Finite values above 0."""
    return _require(name, finite(name, value, unit), unit, lambda v: v > 0, "greater than 0")


def not_negative(name: str, value: ArrayLike, unit: str) -> Array:
    """Finite values of 0 or more."""
    return _require(name, finite(name, value, unit), unit, lambda v: v >= 0, "0 or more")


def vectors(
    name: str, value: ArrayLike, unit: str, count: int | None = None, kind: str = "vectors",
) -> Array:
    """Finite vectors (x, y), shape [..., 2], or [..., count, 2] with a ``count``."""
    array = finite(name, value, unit)
    if array.ndim < 1 or array.shape[-1] != 2:
        raise ValueError(f"{name} must be {kind} (x, y) in {unit}, got shape {array.shape}")
    if count is not None and (array.ndim < 2 or array.shape[-2] != count):
        raise ValueError(
            f"{name} must have {count} {kind} (x, y) in {unit}, got shape {array.shape}")
    return array


def points(name: str, value: ArrayLike, count: int | None = None) -> Array:
    """Finite points [m], shape [..., 2], or [..., count, 2] with a ``count``."""
    return vectors(name, value, "m", count, "points")


def per_phalanx(name: str, value: ArrayLike, count: int, unit: str) -> Array:
    """Finite values with one entry per phalanx (or tendon) on the last axis, shape [..., count]."""
    array = finite(name, value, unit)
    if array.ndim < 1 or array.shape[-1] != count:
        raise ValueError(
            f"{name} must have {count} values in {unit} on its last axis, got shape {array.shape}")
    return array


def homogeneous(name: str, value: ArrayLike) -> Array:
    """Finite matrices of the plane, shape [..., 3, 3]."""
    array = finite(name, value, "")
    if array.shape[-2:] != (3, 3):
        raise ValueError(f"{name} must be 3x3 matrices, got shape {array.shape}")
    return array


def together(**arrays: Array) -> tuple[int, ...]:
    """The shape that arrays broadcast to; the error names each with its shape."""
    try:
        return np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        names = " and ".join(arrays)
        shapes = " and ".join(str(array.shape) for array in arrays.values())
        raise ValueError(f"{names} must be of equal length, got shapes {shapes}") from None


def _require(name: str, value: ArrayLike, unit: str, test: Callable[[Array], Any],
             wanted: str) -> Array:
    array = np.asarray(value, dtype=np.float64)
    bad = ~np.asarray(test(array))
    if bad.any():
        first = float(array[bad].flat[0]) if array.ndim else float(array)
        raise ValueError(f"{name} must be {wanted}, got {first:.6g} {unit}".rstrip())
    return array
