"""Quantities with units: ``"12 mm"`` to ``0.012``. SI is all that leaves here.

Factors are exact by definition (SI Brochure, 9th edition; the inch is 25.4 mm and the pound
0.45359237 kg by the agreement of 1959, the pound-force is its weight at 9.80665 m/s^2).
"""

from __future__ import annotations

import math
import re
from functools import lru_cache
from typing import NamedTuple, Self

from sandbox.wording import WrongValueError, near, quoted

POUND = 0.45359237  # [kg]
POUND_FORCE = 4.4482216152605  # [N], POUND * 9.80665 m/s^2
INCH = 0.0254  # [m]


class Range(NamedTuple):
    """Of one dimension, in SI: the minimum of a positive size, and the maximum of any magnitude."""

    minimum: float
    maximum: float


_DIMENSIONS: dict[str, tuple[float, float, dict[str, float]]] = {
    "length": (1e-9, 1e6, {"m": 1.0, "dm": 0.1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6,
                           "in": INCH}),
    "angle": (1e-12, 1e9, {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180, "°": math.pi / 180,
                           "turn": 2 * math.pi}),
    "mass": (1e-12, 1e12, {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "lb": POUND}),
    "time": (1e-9, 1e9, {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0}),
    "force": (1e-12, 1e12, {"N": 1.0, "mN": 1e-3, "kN": 1e3, "MN": 1e6, "lbf": POUND_FORCE}),
    "torque": (1e-12, 1e12, {"N m": 1.0, "N mm": 1e-3, "mN m": 1e-3, "N cm": 1e-2, "kN m": 1e3,
                             "kN mm": 1.0, "kN cm": 10.0, "MN m": 1e6}),
    "energy": (1e-12, 1e18, {"J": 1.0, "mJ": 1e-3, "kJ": 1e3, "MJ": 1e6}),
    "power": (1e-12, 1e18, {"W": 1.0, "mW": 1e-3, "kW": 1e3, "MW": 1e6}),
    "pressure": (1e-12, 1e15, {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5,
                               "mbar": 1e2, "psi": POUND_FORCE / INCH**2}),
    "stiffness": (1e-12, 1e15, {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3, "N/cm": 1e2, "kN/mm": 1e6,
                                "MN/m": 1e6}),
    "rotary stiffness": (1e-12, 1e15, {"N m/rad": 1.0, "N mm/rad": 1e-3, "kN m/rad": 1e3,
                                       "N m/deg": 180 / math.pi}),
    "damping": (1e-12, 1e15, {"N s/m": 1.0, "N s/mm": 1e3, "kN s/m": 1e3}),
    "rotary damping": (1e-12, 1e15, {"N m s/rad": 1.0, "N mm s/rad": 1e-3, "kN m s/rad": 1e3}),
    "density": (1e-9, 1e12, {"kg/m^3": 1.0, "g/cm^3": 1e3}),
    "inertia": (1e-24, 1e24, {"kg m^2": 1.0, "g mm^2": 1e-9, "kg mm^2": 1e-6}),
    "frequency": (1e-9, 1e9, {"Hz": 1.0, "kHz": 1e3, "1/s": 1.0}),
    "speed": (1e-12, 1e9, {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2}),
    "angular speed": (1e-12, 1e9, {"rad/s": 1.0, "deg/s": math.pi / 180, "rpm": math.pi / 30}),
    "acceleration": (1e-12, 1e9, {"m/s^2": 1.0, "mm/s^2": 1e-3}),
    "area": (1e-18, 1e12, {"m^2": 1.0, "cm^2": 1e-4, "mm^2": 1e-6}),
    "volume": (1e-27, 1e18, {"m^3": 1.0, "l": 1e-3, "ml": 1e-6, "cm^3": 1e-6, "mm^3": 1e-9}),
    "flow": (1e-24, 1e12, {"m^3/s": 1.0, "l/s": 1e-3, "l/min": 1e-3 / 60, "ml/s": 1e-6,
                           "ml/min": 1e-6 / 60, "cm^3/s": 1e-6, "mm^3/s": 1e-9}),
    "displacement": (1e-24, 1e12, {"m^3/rad": 1.0, "ml/rad": 1e-6, "cm^3/rad": 1e-6,
                                   "ml/turn": 1e-6 / (2 * math.pi)}),
    "flow resistance": (1e-12, 1e24, {"Pa s/m^3": 1.0, "bar s/l": 1e8, "bar s/ml": 1e11,
                                      "kPa s/ml": 1e9}),
    "ratio": (1e-12, 1e12, {"%": 0.01}),
}
"""Of each dimension its range in SI, and the factors to SI of its units, the SI unit first."""
UNITS = {unit: (factor, dimension) for dimension, (_, _, units) in _DIMENSIONS.items()
         for unit, factor in units.items()}  # the factor to SI and the dimension of each unit
RANGES: dict[str | None, Range] = {
    dimension: Range(*span) for dimension, (*span, _) in _DIMENSIONS.items()}
RANGES[None] = Range(0.0, 1e18)  # of a number whose dimension is not known: a parameter, a gain

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*((?:1\s*/\s*)?[^0-9.\s].*)?")
_NEWTONS = re.compile(r"\b([mkM]?N)(m|mm|cm)?(s)?\b")
_DOTS = str.maketrans({"·": " ", "⋅": " ", "*": " ", "²": "^2", "³": "^3", "μ": "µ"})
_PREFIX = re.compile(r"\b[pnuµmcdhkKMGT](?=[^\W\d])")
MAX_LENGTH = 100


class Measured(float):
    """A number in SI with the unit in which it was written, of :data:`UNITS`.

    Fields that take any unit keep it until the required one is known. Arithmetic drops it.
    """

    unit: str

    def __new__(cls, value: float, unit: str) -> Self:
        """A number ``value`` [SI] that was written in ``unit``."""
        number = super().__new__(cls, value)
        number.unit = unit
        return number

    def __reduce__(self) -> tuple[type[Measured], tuple[float, str]]:
        return Measured, (float(self), self.unit)


def units_of(dimension: str) -> list[str]:
    """The unit names that measure ``dimension``, the SI unit first."""
    return list(_DIMENSIONS[dimension][2]) if dimension in _DIMENSIONS else []


def si_unit(dimension: str) -> str:
    """The SI unit of a dimension, ``1`` of a ratio; empty if it is unknown."""
    return "1" if dimension == "ratio" else next(iter(units_of(dimension)), "")


def dimension_of(unit: str) -> str:
    """The dimension of a unit, such as ``"length"``."""
    return UNITS[unit][1]


def unfit(value: float, unit: str) -> str:
    """The fault of a number in a unit of another dimension than ``unit``; empty without one."""
    if not isinstance(value, Measured) or (unit not in UNITS and unit != "1"):
        return ""
    given, wanted = dimension_of(value.unit), "ratio" if unit == "1" else dimension_of(unit)
    return "" if given == wanted else f"{quoted(value.unit)} is a unit of {given}"


def normal_unit(text: str) -> str:
    """One spelling of a unit: ``N·m``, ``N*m``, ``N  m`` and ``Nm`` are all ``N m``."""
    text = re.sub(r"\s*([/^])\s*", r"\1", re.sub(r"\s+", " ", text.translate(_DOTS)).strip())
    text = _NEWTONS.sub(lambda found: " ".join(filter(None, found.groups())), text)
    return text.replace("°/s", "deg/s")


@lru_cache(maxsize=4096)
def parse_quantity(text: str, dimension: str | None) -> float:
    """The SI value of ``"<number> <unit>"``; of any dimension (None) it is :class:`Measured`."""
    plain = text.replace("−", "-").strip()
    match = _QUANTITY.fullmatch(plain) if len(plain) <= MAX_LENGTH else None
    if match is None:
        names = units_of(dimension) if dimension else ["m", "N", "rad", "s", "kg"]
        raise WrongValueError(
            "wrong-unit", f"{quoted(text)} is not a number with a unit",
            allowed=f'a number, a string with a unit such as "12 {names[0]}" ({", ".join(names)}), '
            'or an expression such as "=pull / 2"')
    unit = normal_unit(match.group(2) or "")
    value = scaled(float(match.group(1)), factor_of(unit, dimension) if unit else 1.0)
    if not math.isfinite(value):
        raise WrongValueError("out-of-range", f"{quoted(text)} is too large a number")
    return Measured(value, unit) if unit and dimension is None else value


def unit_in(value: object) -> str:
    """The unit of a written value; empty for none."""
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
    this = str(dimension)
    if not this.endswith(("damping", "stiffness", "inertia")):
        this = f"{'an' if this[0] in 'aeiou' else 'a'} {this}"
    raise WrongValueError(
        "wrong-unit", f"{quoted(unit)} is a unit of {UNITS[unit][1]}, but this is {this}",
        allowed=allowed, hint=near(unit, names, cutoff=0.75))


def _other_prefix(unit: str, other: str) -> bool:
    """Whether two units differ in a prefix, and so by a power of ten: not to be suggested."""
    (one, first), (two, second) = (
        (_PREFIX.sub("", each).lower(), _PREFIX.findall(each.replace("K", "k").replace("u", "µ")))
        for each in (unit, other))
    return one == two and first != second


def in_range(value: float, dimension: str | None) -> float:
    """``value`` [SI], if its magnitude is within the range of its dimension, or of its unit."""
    dimension = dimension or (dimension_of(value.unit) if isinstance(value, Measured) else None)
    maximum = RANGES[dimension].maximum
    if not abs(value) <= maximum:  # nor is that of nan
        raise WrongValueError(
            "out-of-range", f"{float(value):.6g} is too large to be computed with",
            allowed=f"a magnitude of at most {with_unit(maximum, dimension)}")
    return value


def size_fault(value: float, dimension: str) -> str:
    """The fault of a number that cannot be a size, such as a mass; empty without one."""
    allowed = RANGES[dimension]
    if allowed.minimum <= value <= allowed.maximum:
        return ""
    span = f"{allowed.minimum:g} to {with_unit(allowed.maximum, dimension)}"
    text = f"{value:.6g}" if math.isfinite(value) else "no finite number"
    return f"{text}, outside of {span}"


def with_unit(value: float, dimension: str | None) -> str:
    """A number with the SI unit of its dimension: ``1e+06 m``."""
    units = units_of(dimension) if dimension not in (None, "ratio") else []
    return f"{value:g} {units[0]}" if units else f"{value:g}"
