"""What numbers a scene may hold: the one table of ranges, by dimension, in SI.

They are far wider than any machine, and narrow enough that no product of a few of them leaves
the range of floating-point numbers: an area, a moment of inertia, the square of a lever over it.
docs/limits.md shows this table.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from sandbox.values.units import Measured, dimension_of, units_of
from sandbox.wording import WrongValueError


@dataclass(frozen=True)
class Range:
    """Of one dimension, in SI: the least that a size may be, and the most of anything."""

    least: float
    """Of what has to be greater than 0; other numbers may be smaller, and 0."""
    most: float
    """Of the magnitude."""


RANGES: dict[str, Range] = {
    "length": Range(1e-9, 1e6),
    "angle": Range(1e-12, 1e9),
    "mass": Range(1e-12, 1e12),
    "inertia": Range(1e-24, 1e24),
    "density": Range(1e-9, 1e12),
    "time": Range(1e-9, 1e9),
    "frequency": Range(1e-9, 1e9),
    "force": Range(1e-12, 1e12),
    "torque": Range(1e-12, 1e12),
    "energy": Range(1e-12, 1e18),
    "power": Range(1e-12, 1e18),
    "pressure": Range(1e-12, 1e15),
    "stiffness": Range(1e-12, 1e15),
    "rotary stiffness": Range(1e-12, 1e15),
    "damping": Range(1e-12, 1e15),
    "rotary damping": Range(1e-12, 1e15),
    "speed": Range(1e-12, 1e9),
    "angular speed": Range(1e-12, 1e9),
    "acceleration": Range(1e-12, 1e9),
    "area": Range(1e-18, 1e12),
    "volume": Range(1e-27, 1e18),
    "flow": Range(1e-24, 1e12),
    "displacement": Range(1e-24, 1e12),
    "flow resistance": Range(1e-12, 1e24),
    "ratio": Range(1e-12, 1e12),
}
ANY = Range(0.0, 1e18)
"""Of a number whose dimension is not known: a parameter, a gain."""


def range_of(dimension: str | None) -> Range:
    """The range of a dimension; of None that of any number."""
    return RANGES[dimension] if dimension else ANY


def in_range(value: float, dimension: str | None) -> float:
    """``value`` [SI], if its magnitude is finite and not beyond its dimension's range.

    A :class:`Measured` number whose field takes any unit has the range of its own unit.

    Raises:
        WrongValueError: it is; with what is allowed.
    """
    dimension = dimension or (dimension_of(value.unit) if isinstance(value, Measured) else None)
    most = range_of(dimension).most
    if not abs(value) <= most:  # nor is that of nan
        raise WrongValueError(
            "out-of-range", f"{float(value):.6g} is too large to be computed with",
            allowed=f"a magnitude of at most {with_unit(most, dimension)}")
    return value


def size_fault(value: float, dimension: str) -> str:
    """What keeps a number from being a size, such as a mass; empty if nothing does."""
    allowed = range_of(dimension)
    if allowed.least <= value <= allowed.most:
        return ""
    span = f"{allowed.least:g} to {with_unit(allowed.most, dimension)}"
    text = f"{value:.6g}" if math.isfinite(value) else "no finite number"
    return f"{text}, outside of {span}"


def with_unit(value: float, dimension: str | None) -> str:
    """A number with the SI unit of its dimension: ``1e+06 m``."""
    units = units_of(dimension) if dimension not in (None, "ratio") else []
    return f"{value:g} {units[0]}" if units else f"{value:g}"
