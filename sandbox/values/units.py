"""Quantities with units: ``"12 mm"`` to ``0.012``. SI is all that leaves here.

Factors are exact by definition (SI Brochure, 9th edition; the inch is 25.4 mm and the pound
0.45359237 kg by the agreement of 1959, the pound-force is its weight at 9.80665 m/s^2).
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Self

from sandbox.wording import WrongValueError, near, quoted

POUND = 0.45359237  # [kg]
POUND_FORCE = 4.4482216152605  # [N], POUND * 9.80665 m/s^2
INCH = 0.0254  # [m]

# unit -> (factor to SI, dimension); one unit belongs to one dimension
UNITS: dict[str, tuple[float, str]] = {
    "m": (1.0, "length"), "dm": (0.1, "length"), "cm": (1e-2, "length"), "mm": (1e-3, "length"),
    "um": (1e-6, "length"), "µm": (1e-6, "length"), "in": (INCH, "length"),
    "rad": (1.0, "angle"), "mrad": (1e-3, "angle"), "deg": (math.pi / 180, "angle"),
    "°": (math.pi / 180, "angle"), "turn": (2 * math.pi, "angle"),
    "kg": (1.0, "mass"), "g": (1e-3, "mass"), "mg": (1e-6, "mass"),
    "lb": (POUND, "mass"),
    "s": (1.0, "time"), "ms": (1e-3, "time"), "us": (1e-6, "time"), "µs": (1e-6, "time"),
    "min": (60.0, "time"),
    "N": (1.0, "force"), "mN": (1e-3, "force"), "kN": (1e3, "force"),
    "MN": (1e6, "force"), "lbf": (POUND_FORCE, "force"),
    "N m": (1.0, "torque"), "N mm": (1e-3, "torque"), "mN m": (1e-3, "torque"),
    "N cm": (1e-2, "torque"), "kN m": (1e3, "torque"), "kN mm": (1.0, "torque"),
    "kN cm": (10.0, "torque"), "MN m": (1e6, "torque"),
    "J": (1.0, "energy"), "mJ": (1e-3, "energy"), "kJ": (1e3, "energy"), "MJ": (1e6, "energy"),
    "W": (1.0, "power"), "mW": (1e-3, "power"), "kW": (1e3, "power"),
    "MW": (1e6, "power"),
    "Pa": (1.0, "pressure"), "kPa": (1e3, "pressure"), "MPa": (1e6, "pressure"),
    "GPa": (1e9, "pressure"), "bar": (1e5, "pressure"), "mbar": (1e2, "pressure"),
    "psi": (POUND_FORCE / INCH**2, "pressure"),
    "N/m": (1.0, "stiffness"), "N/mm": (1e3, "stiffness"), "kN/m": (1e3, "stiffness"),
    "N/cm": (1e2, "stiffness"), "kN/mm": (1e6, "stiffness"), "MN/m": (1e6, "stiffness"),
    "N m/rad": (1.0, "rotary stiffness"), "N mm/rad": (1e-3, "rotary stiffness"),
    "kN m/rad": (1e3, "rotary stiffness"), "N m/deg": (180 / math.pi, "rotary stiffness"),
    "N s/m": (1.0, "damping"), "N s/mm": (1e3, "damping"),
    "kN s/m": (1e3, "damping"),
    "N m s/rad": (1.0, "rotary damping"), "N mm s/rad": (1e-3, "rotary damping"),
    "kN m s/rad": (1e3, "rotary damping"),
    "kg/m^3": (1.0, "density"), "g/cm^3": (1e3, "density"),
    "kg m^2": (1.0, "inertia"), "g mm^2": (1e-9, "inertia"), "kg mm^2": (1e-6, "inertia"),
    "Hz": (1.0, "frequency"), "kHz": (1e3, "frequency"), "1/s": (1.0, "frequency"),
    "m/s": (1.0, "speed"), "mm/s": (1e-3, "speed"), "cm/s": (1e-2, "speed"),
    "rad/s": (1.0, "angular speed"), "deg/s": (math.pi / 180, "angular speed"),
    "rpm": (math.pi / 30, "angular speed"),
    "m/s^2": (1.0, "acceleration"), "mm/s^2": (1e-3, "acceleration"),
    "m^2": (1.0, "area"), "cm^2": (1e-4, "area"), "mm^2": (1e-6, "area"),
    "m^3": (1.0, "volume"), "l": (1e-3, "volume"), "ml": (1e-6, "volume"),
    "cm^3": (1e-6, "volume"), "mm^3": (1e-9, "volume"),
    "m^3/s": (1.0, "flow"), "l/s": (1e-3, "flow"), "l/min": (1e-3 / 60, "flow"),
    "ml/s": (1e-6, "flow"), "ml/min": (1e-6 / 60, "flow"), "cm^3/s": (1e-6, "flow"),
    "mm^3/s": (1e-9, "flow"),
    "m^3/rad": (1.0, "displacement"), "ml/rad": (1e-6, "displacement"),
    "cm^3/rad": (1e-6, "displacement"), "ml/turn": (1e-6 / (2 * math.pi), "displacement"),
    "Pa s/m^3": (1.0, "flow resistance"), "bar s/l": (1e8, "flow resistance"),
    "bar s/ml": (1e11, "flow resistance"), "kPa s/ml": (1e9, "flow resistance"),
    "%": (0.01, "ratio"),
}

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*((?:1\s*/\s*)?[^0-9.\s].*)?")
_NEWTONS = re.compile(r"\b([mkM]?N)(m|mm|cm)?(s)?\b")
_DOTS = str.maketrans({"·": " ", "⋅": " ", "*": " ", "²": "^2", "³": "^3", "μ": "µ"})
_WORDS = re.compile(r"[^\W\d]+|\d+|%|°")
_PREFIXES = frozenset("pnuµmcdhkKMGT")
MAX_LENGTH = 100


class Measured(float):
    """A number in SI with the unit in which it was written.

    So is every quantity whose field takes any unit, until it is known which one is
    right. Results of arithmetic are plain floats.
    """

    unit: str  # as UNITS spells it

    def __new__(cls, value: float, unit: str) -> Self:
        """A number ``value`` [SI] that was written in ``unit``."""
        number = super().__new__(cls, value)
        number.unit = unit
        return number

    def __reduce__(self) -> tuple[type[Measured], tuple[float, str]]:
        return Measured, (float(self), self.unit)


def units_of(dimension: str) -> list[str]:
    """The unit names that measure ``dimension``, the SI unit first."""
    return [name for name, (_, kind) in UNITS.items() if kind == dimension]


def dimension_of(unit: str) -> str:
    """The dimension of a unit of :data:`UNITS`, such as ``"length"``."""
    return UNITS[unit][1]


def unfit(value: float, unit: str) -> str:
    """The fault of a number that has a unit of another dimension than ``unit``, or nothing.

    >>> unfit(Measured(1e-3, "mm"), "N")
    "'mm' is a unit of length"
    """
    if not isinstance(value, Measured) or (unit not in UNITS and unit != "1"):
        return ""
    measures, asked = dimension_of(value.unit), "ratio" if unit == "1" else dimension_of(unit)
    return "" if measures == asked else f"{quoted(value.unit)} is a unit of {measures}"


def normal_unit(text: str) -> str:
    """One spelling of a unit: ``N·m``, ``N*m``, ``N  m`` and ``Nm`` are all ``N m``."""
    text = re.sub(r"\s*([/^])\s*", r"\1", re.sub(r"\s+", " ", text.translate(_DOTS)).strip())
    text = _NEWTONS.sub(lambda found: " ".join(filter(None, found.groups())), text)
    return text.replace("°/s", "deg/s")


@lru_cache(maxsize=4096)
def parse_quantity(text: str, dimension: str | None) -> float:
    """The SI value of ``"<number> <unit>"``.

    ``dimension`` is the expected one (such as ``"length"``), or None for
    any: then the value is :class:`Measured`. A bare number is taken as SI.
    """
    plain = text.replace("−", "-").strip()
    match = _QUANTITY.fullmatch(plain) if len(plain) <= MAX_LENGTH else None
    if match is None:
        raise WrongValueError("wrong-unit", f"{quoted(text)} is not a number with a unit",
                              allowed=_example(dimension))
    unit = normal_unit(match.group(2) or "")
    value = scaled(float(match.group(1)), factor_of(unit, dimension) if unit else 1.0)
    if not math.isfinite(value):
        raise WrongValueError("out-of-range", f"{quoted(text)} is too large a number")
    return Measured(value, unit) if unit and dimension is None else value


def unit_in(value: object) -> str:
    """The unit that a value was written with, as :data:`UNITS` spells it; empty for none."""
    try:
        found = parse_quantity(value, None) if isinstance(value, str) else None
    except ValueError:
        return ""
    return found.unit if isinstance(found, Measured) else ""


def scaled(value: float, factor: float) -> float:
    """``value * factor``, rounded once: ``"16.1 mm"`` is exactly the literal 0.0161."""
    inverse = round(1 / factor)
    return value / inverse if inverse > 1 and 1 / inverse == factor else value * factor


def factor_of(unit: str, dimension: str | None) -> float:
    """The factor from ``unit`` to SI."""
    if unit in UNITS and dimension in (None, UNITS[unit][1]):
        return UNITS[unit][0]
    names = units_of(dimension) if dimension else list(UNITS)
    allowed = ", ".join(names) if names else "a number without a unit"
    if unit not in UNITS:
        hint = near(unit, names, cutoff=0.55)
        if not hint and not any(_other_prefix(unit, name) for name in names):
            hint = near(unit, UNITS, cutoff=0.75)
        raise WrongValueError("wrong-unit", f"unknown unit {quoted(unit)}", allowed=allowed,
                              hint="" if _other_prefix(unit, hint.strip("'")) else hint)
    raise WrongValueError(
        "wrong-unit", f"{quoted(unit)} is a unit of {UNITS[unit][1]}, but this is "
        f"{_with_article(str(dimension))}", allowed=allowed, hint=near(unit, names, cutoff=0.75))


def _other_prefix(unit: str, other: str) -> bool:
    """Whether two units differ in a prefix, and so by a power of ten: no slip that can be mended.

    Signs between and letter case count for nothing, but that of the prefix itself.
    """
    ones, others = _WORDS.findall(unit), _WORDS.findall(other)
    pairs = [("".join(ones), "".join(others))]
    if len(ones) == len(others):
        pairs += zip(ones, others, strict=True)
    return any(rest and rest == same and first != second
               for a, b in pairs for first, rest in _cuts(a) for second, same in _cuts(b))


def _cuts(word: str) -> list[tuple[str, str]]:
    """A unit as prefix and rest, in lower case: without a prefix, and with one if it may be one."""
    whole = [("", word.lower())]
    if word[:1] in _PREFIXES:
        whole.append((word[0].replace("K", "k").replace("u", "µ"), word[1:].lower()))
    return whole


def _with_article(dimension: str) -> str:
    if dimension in ("damping", "rotary damping", "stiffness", "rotary stiffness", "inertia"):
        return dimension
    return f"an {dimension}" if dimension[0] in "aeiou" else f"a {dimension}"


def _example(dimension: str | None) -> str:
    names = units_of(dimension) if dimension else ["m", "N", "rad", "s", "kg"]
    unit = f', a string with a unit such as "12 {names[0]}" ({", ".join(names)})' if names else ""
    return f'a number{unit}, or an expression such as "=pull / 2"'


@dataclass(frozen=True)
class Range:
    """Of one dimension, in SI: the least that a size may be, and the most of anything."""

    least: float  # of what has to be greater than 0; other numbers may be smaller, and 0
    most: float  # of the magnitude


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
ANY = Range(0.0, 1e18)  # of a number whose dimension is not known: a parameter, a gain


def range_of(dimension: str | None) -> Range:
    """The range of a dimension; of None that of any number."""
    return RANGES[dimension] if dimension else ANY


def in_range(value: float, dimension: str | None) -> float:
    """``value`` [SI], if its magnitude is finite and not beyond its dimension's range.

    A :class:`Measured` number whose field takes any unit has the range of its own unit.
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
