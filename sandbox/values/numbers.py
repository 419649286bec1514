"""The number types of scene fields: SI floats inside.

A JSON number is SI; a string is a quantity (``"12 mm"``) or an expression of the scene's parameters
(``"=pitch / 2"``), which pydantic's validation context has, ``{"parameters": {name: value}}``.
"""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, TypeVar

from annotated_types import Ge, Gt, Le
from pydantic import AfterValidator, Field, StrictBool, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from sandbox.values.expressions import Expression, is_expression, parse_expression, unknown_name
from sandbox.values.spec import ReadMark
from sandbox.values.units import RANGES, Measured, in_range, parse_quantity, units_of, with_unit
from sandbox.wording import WrongValueError, kind_of, quoted, refuse_if

T = TypeVar("T")
if TYPE_CHECKING:  # validation accepts more than the type of its result: "50 g", lists, arrays
    Written: TypeAlias = T | Any
    Items: TypeAlias = tuple[T, ...] | Any
    Pair: TypeAlias = tuple[T, T] | Any
else:
    class Written:  # noqa: D101
        def __class_getitem__(cls, kind: Any) -> Any:
            return kind

    Items = tuple[T, ...]
    Pair = tuple[T, T]
Float: TypeAlias = Written[float]
_PRODUCT = re.compile(r"^([0-9.]+)\s*([A-Za-z_])")


def number_from(value: Any, dimension: str | None, parameters: Mapping[str, float]) -> float:
    """The SI value of a literal, a quantity or an expression; any dimension if None."""
    if isinstance(value, bool) or not isinstance(value, (numbers.Real, str)):
        raise WrongValueError("wrong-type", f"expected {wanted(dimension)}, got {kind_of(value)}")
    if isinstance(value, str):
        if is_expression(value):
            return in_range(float(parse_expression(value).evaluate(parameters)), dimension)
        try:
            return in_range(parse_quantity(value, dimension), dimension)
        except WrongValueError as error:
            raise WrongValueError(error.code, error.message, allowed=error.allowed, hint=_meant(
                value, parameters) or error.hint) from None
    if isinstance(value, Measured) and dimension is None:  # read once already
        return in_range(value, None)
    try:
        number = float(value)
    except (OverflowError, ValueError):
        number = math.inf
    refuse_if(not math.isfinite(number), "must be finite (NaN and infinity are not numbers here)",
              "out-of-range")
    return in_range(number, dimension)


def _meant(text: str, parameters: Mapping[str, float]) -> str:
    """The expression of parameters that a text is without its equals sign or a ``*``."""
    for meant in (text.strip(), _PRODUCT.sub(r"\1 * \2", text.strip())):
        try:
            names = parse_expression(f"={meant}").names
        except ValueError:
            continue
        if names and all(isinstance(parameters.get(name), float) for name in names):
            return quoted(f"={meant}")
    return ""


def wanted(dimension: str | None) -> str:
    """Accepted values of a number field: ``"a number, or a string such as "12 mm""``."""
    units = units_of(dimension) if dimension else []
    return f'a number or a string with a unit such as "12 {units[0]}"' if units else "a number"


def parameters_of(info: ValidationInfo) -> Mapping[str, float]:
    """The scene's parameters (SI), which come as the context of a validation."""
    return (info.context or {}).get("parameters") or {}


def bound_expression(text: str, info: ValidationInfo) -> Expression:
    """The expression of a text with the scene's parameters put in; tables have to be known."""
    expression = parse_expression(text)
    if "parameters" in (info.context or {}):
        expression.check_tables(parameters_of(info))
    return expression.bind(parameters_of(info))


def law_of(text: str, own: Sequence[str], whose: str, info: ValidationInfo) -> str:
    """A law, ``"=..."``, with all names replaced except those of its element, ``own``."""
    parameters, bound = parameters_of(info), bound_expression(text, info)
    for name in sorted(parse_expression(text).names.intersection(own, parameters)):
        raise WrongValueError("duplicate-name", f"{quoted(name)} is a parameter, and here it would "
                              f"mean the {whose}'s own", allowed="another name for the parameter")
    for name in sorted(bound.names.difference(own)):
        raise unknown_name(name, {**dict.fromkeys(own), **parameters})
    return f"={bound.text}"


@dataclass(frozen=True)
class Dimension(ReadMark):
    """Marks a number of one dimension; one of no dimension takes any unit and keeps it."""

    name: str | None = None
    sign: Literal["", "> 0", "≥ 0"] = ""  # a size (> 0) has the minimum of its dimension

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        # pydantic's own check of a float drops the unit
        inner = handler(source) if self.name else core_schema.any_schema()
        return core_schema.with_info_before_validator_function(self.read, inner)

    def json_schema(self, schema: dict[str, Any]) -> dict[str, Any]:
        """A number or a text."""
        units = units_of(self.name) if self.name else []
        what = f"A {self.name} in {units[0]}" if self.name not in (None, "ratio") else "A number"
        return {
            "anyOf": [{"type": "number"}, {"type": "string"}],
            "description": f"{what}; or a string with a unit"
            + (f" ({', '.join(units)})" if units else "") + ', or an expression such as "=a / 2".'}

    def read(self, value: Any, info: ValidationInfo) -> float:
        """The value in SI, with its sign and size checked."""
        dimension = self.name
        if isinstance(value, str) and not is_expression(value):  # a text in a value over time
            dimension = dimension or (info.context or {}).get("dimension")
        number = number_from(value, dimension, parameters_of(info))
        minimum = RANGES[self.name].minimum if self.sign == "> 0" else 0.0
        allowed = "0 or more" if not minimum else "greater than 0" if number <= 0 else \
            f"at least {with_unit(minimum, self.name)}"
        refuse_if(self.sign and number < minimum, f"must be {allowed}, got {number:.6g}",
                  "out-of-range")
        return number


def _not_zero(value: float) -> float:
    refuse_if(abs(value) < 1e-24, f"must be other than 0, got {value:.6g}", "out-of-range")
    return value


POSITIVE, NOT_NEGATIVE, AT_MOST_ONE = Gt(0), Ge(0), Le(1)
NOT_ZERO = AfterValidator(_not_zero)

Quantity = Annotated[Float, Dimension()]
Number = Annotated[Float, Dimension("ratio")]
Ratio = Annotated[Float, Dimension("ratio", "≥ 0")]
Share = Annotated[Ratio, AT_MOST_ONE]
Coordinate = Annotated[Float, Dimension("length")]
Length = Annotated[Float, Dimension("length", "> 0")]
Distance = Annotated[Float, Dimension("length", "≥ 0")]
Angle = Annotated[Float, Dimension("angle")]
Mass = Annotated[Float, Dimension("mass", "> 0")]
Inertia = Annotated[Float, Dimension("inertia", "> 0")]
Density = Annotated[Float, Dimension("density", "> 0")]
Instant = Annotated[Float, Dimension("time", "≥ 0")]
Duration = Annotated[Float, Dimension("time", "> 0")]
Frequency = Annotated[Float, Dimension("frequency", "> 0")]
Force = Annotated[Float, Dimension("force")]
Torque = Annotated[Float, Dimension("torque")]
Stiffness = Annotated[Float, Dimension("stiffness", "≥ 0")]
RotaryStiffness = Annotated[Float, Dimension("rotary stiffness", "≥ 0")]
Damping = Annotated[Float, Dimension("damping", "≥ 0")]
RotaryDamping = Annotated[Float, Dimension("rotary damping", "≥ 0")]
Speed = Annotated[Float, Dimension("speed")]
AngularSpeed = Annotated[Float, Dimension("angular speed")]
Acceleration = Annotated[Float, Dimension("acceleration")]
Area = Annotated[Float, Dimension("area", "> 0")]
Volume = Annotated[Float, Dimension("volume", "> 0")]
Displacement = Annotated[Float, Dimension("displacement")]
Pressure = Annotated[Float, Dimension("pressure")]
Modulus = Annotated[Float, Dimension("pressure", "> 0")]
FlowResistance = Annotated[Float, Dimension("flow resistance", "≥ 0")]

Flag = StrictBool  # true or false and nothing else: "no" is a text, not a refusal
Point = Pair[Coordinate]
NAME = r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*$"
Name = Annotated[str, Field(pattern=NAME, max_length=100)]
