"""Checks of arguments: each returns the value as a float array or raises a ``ValueError``."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sandbox.numeric import Array, Flags


def finite(name: str, value: ArrayLike, unit: str) -> Array:
    """Values that are neither nan nor infinite."""
    array = np.asarray(value, dtype=np.float64)
    return _require(name, array, unit, np.isfinite(array), "finite")


def positive(name: str, value: ArrayLike, unit: str) -> Array:
    """Finite values above 0."""
    array = finite(name, value, unit)
    return _require(name, array, unit, array > 0, "greater than 0")


def not_negative(name: str, value: ArrayLike, unit: str) -> Array:
    """Finite values of 0 or more."""
    array = finite(name, value, unit)
    return _require(name, array, unit, array >= 0, "0 or more")


def points(name: str, value: ArrayLike, count: int | None = None, *, unit: str = "m") -> Array:
    """Finite points or vectors (x, y), shape [..., 2], or [..., count, 2] with a ``count``."""
    array = finite(name, value, unit)
    if array.shape[-1:] != (2,) or (count is not None and array.shape[-2:-1] != (count,)):
        many = "" if count is None else f"{count} "
        raise ValueError(f"{name} must have {many}points (x, y) in {unit}, got shape {array.shape}")
    return array


def per_phalanx(name: str, value: ArrayLike, count: int, unit: str) -> Array:
    """Finite values with one entry per phalanx (or tendon) on the last axis, shape [..., count]."""
    array = finite(name, value, unit)
    if array.shape[-1:] != (count,):
        raise ValueError(
            f"{name} must have {count} values in {unit} on its last axis, got shape {array.shape}")
    return array


def matrix(name: str, value: ArrayLike, unit: str) -> Array:
    """A finite matrix, shape [m, n]."""
    array = finite(name, value, unit)
    if array.ndim != 2:
        raise ValueError(f"{name} must be a matrix in {unit}, got shape {array.shape}")
    return array


def _require(name: str, array: Array, unit: str, good: Flags, wanted: str) -> Array:
    if not good.all():
        raise ValueError(f"{name} must be {wanted}, got {array[~good].flat[0]:.6g} {unit}".rstrip())
    return array
