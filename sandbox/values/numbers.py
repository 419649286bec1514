"""The number types of scene fields: what an author may write, SI floats inside.

Every field of a model below is one of these types. A JSON number is SI; a
string is a quantity (``"12 mm"``) or an expression of the scene's parameters
(``"=pitch / 2"``). The parameters arrive as pydantic's validation context,
``{"parameters": {name: value}}``.
"""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, TypeVar

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    StrictBool,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
    WrapValidator,
)
from pydantic_core import ErrorDetails, PydanticCustomError

from sandbox.values.expressions import Expression, parse_expression, unknown_name
from sandbox.values.units import Measured, in_range, parse_quantity, range_of, units_of, with_unit
from sandbox.wording import WrongValueError, kind_of, quoted

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
    """The SI value of a literal, a quantity or an expression.

    A quantity of any dimension (None) is :class:`Measured`, and keeps its unit.

    Raises:
        WrongValueError: none of the three, a wrong unit, not finite, or beyond the range of
            its dimension (:mod:`sandbox.values.units`).
    """
    return in_range(_number(value, dimension, parameters), dimension)


def _number(value: Any, dimension: str | None, parameters: Mapping[str, float]) -> float:
    if isinstance(value, bool) or not isinstance(value, (numbers.Real, str)):
        raise WrongValueError("wrong-type", f"expected {wanted(dimension)}, got {kind_of(value)}")
    if isinstance(value, str):
        if value.lstrip().startswith("="):
            return _computed(value, parameters)
        try:
            return parse_quantity(value, dimension)
        except WrongValueError as error:
            raise WrongValueError(error.code, error.message, allowed=error.allowed, hint=_meant(
                value, parameters) or error.hint) from None
    if isinstance(value, Measured) and dimension is None:  # read once already
        return value
    try:
        number = float(value)
    except (OverflowError, ValueError):
        number = math.inf
    if not math.isfinite(number):
        raise WrongValueError("out-of-range",
                              "must be finite (NaN and infinity are not numbers here)")
    return number


def _meant(text: str, parameters: Mapping[str, float]) -> str:
    """The expression of parameters that a text is but for its equals sign, or for a ``*``, too."""
    for meant in (text.strip(), _PRODUCT.sub(r"\1 * \2", text.strip())):
        try:
            names = parse_expression(f"={meant}").names
        except ValueError:
            continue
        if names and all(isinstance(parameters.get(name), float) for name in names):
            return quoted(f"={meant}")
    return ""


def _computed(text: str, parameters: Mapping[str, float]) -> float:
    expression = parse_expression(text)
    expression.check_tables(parameters)
    for name in sorted(expression.names):
        if name not in parameters:
            raise unknown_name(name, parameters)
    return float(expression.evaluate(parameters))


def wanted(dimension: str | None) -> str:
    """What a number field takes, in words: ``"a number, or a string such as "12 mm""``."""
    units = units_of(dimension) if dimension else []
    return f'a number or a string with a unit such as "12 {units[0]}"' if units else "a number"


def parameters_of(info: ValidationInfo) -> Mapping[str, float]:
    """The scene's parameters (SI), which come as the context of a validation."""
    return (info.context or {}).get("parameters") or {}


def checked_expression(text: str, info: ValidationInfo) -> Expression:
    """The expression of a text, if all tables that it calls are the scene's.

    Of what is validated by itself, without its scene, the tables are checked with the whole.

    Raises:
        WrongValueError: not an expression, or a function that is not known.
    """
    expression = parse_expression(text)
    if info.context is not None:
        expression.check_tables(parameters_of(info))
    return expression


def law_of(text: str, own: Sequence[str], whose: str, info: ValidationInfo) -> str:
    """A law, ``"=..."``, with all names replaced except those of its element, ``own``.

    Raises:
        WrongValueError: not an expression, one that reads something else, or one in which a
            parameter has the name of the element's own; ``whose`` is the owner in the message.
    """
    parameters = parameters_of(info)
    expression = checked_expression(text, info)
    for name in sorted(expression.names.intersection(own)):
        if name in parameters:
            raise WrongValueError("duplicate-name", f"{quoted(name)} is a parameter, and here "
                                  f"it would mean the {whose}'s own", allowed="another name "
                                  "for the parameter")
    bound = expression.bind(parameters)
    for name in sorted(bound.names.difference(own)):
        raise unknown_name(name, {**dict.fromkeys(own), **parameters})
    return f"={bound.text}"


def refusal(error: ValueError) -> PydanticCustomError:
    """A wrong value as pydantic's own type of error, for use outside validators."""
    if not isinstance(error, WrongValueError):
        error = WrongValueError("wrong-type", str(error))
    return PydanticCustomError(error.code, "{reason}", {
        "reason": error.message, "allowed": error.allowed, "hint": error.hint})


def message_of(error: ErrorDetails) -> str:
    """The message of a validation error, without pydantic's prefix or the allowed values."""
    wrong = error.get("ctx", {}).get("error")
    return wrong.message if isinstance(wrong, WrongValueError) else str(wrong or error["msg"])


_DIMENSIONS: dict[BeforeValidator, str] = {}


def _reader(dimension: str) -> BeforeValidator:
    reader = BeforeValidator(
        lambda value, info: number_from(value, dimension, parameters_of(info)))
    _DIMENSIONS[reader] = dimension
    return reader


def dimension_read(metadata: Iterable[Any]) -> str:
    """The dimension of a number from the annotations of its type; empty if there is none."""
    return next((_DIMENSIONS[each] for each in metadata
                 if isinstance(each, BeforeValidator) and each in _DIMENSIONS), "")


def _read_any(value: Any, check: ValidatorFunctionWrapHandler, info: ValidationInfo) -> float:
    """A number of any dimension; pydantic's own check of a float would take its unit away."""
    number = number_from(value, None, parameters_of(info))
    plain: float = check(number)
    return number if isinstance(number, Measured) else plain


def _schema(dimension: str | None) -> WithJsonSchema:
    units = units_of(dimension) if dimension else []
    what = f"A {dimension} in {units[0]}" if dimension not in (None, "ratio") else "A number"
    return WithJsonSchema({
        "anyOf": [{"type": "number"}, {"type": "string"}],
        "description": f"{what}; or a string with a unit"
        + (f" ({', '.join(units)})" if units else "") + ', or an expression such as "=a / 2".',
    })


def _bound(test: Callable[[float], bool], message: str) -> AfterValidator:
    def check(value: float) -> float:
        if not test(value):
            raise WrongValueError("out-of-range", f"must be {message}, got {value:.6g}")
        return value

    return AfterValidator(check)


def _size(dimension: str) -> AfterValidator:
    """Not so small that what follows from it leaves all range."""
    least = range_of(dimension).least
    return _bound(lambda v: v >= least, f"at least {with_unit(least, dimension)}")


POSITIVE = _bound(lambda v: v > 0, "greater than 0")
NOT_NEGATIVE = _bound(lambda v: v >= 0, "0 or more")
AT_MOST_ONE = _bound(lambda v: v <= 1, "at most 1")

Quantity = Annotated[Float, WrapValidator(_read_any), _schema(None)]
"""Of any dimension; the required one is known when all elements are read."""
Number = Annotated[Float, _reader("ratio"), _schema("ratio")]
Ratio = Annotated[Number, NOT_NEGATIVE]
Share = Annotated[Ratio, AT_MOST_ONE]
Coordinate = Annotated[Float, _reader("length"), _schema("length")]
Length = Annotated[Coordinate, POSITIVE, _size("length")]
Distance = Annotated[Coordinate, NOT_NEGATIVE]
Angle = Annotated[Float, _reader("angle"), _schema("angle")]
Mass = Annotated[Float, _reader("mass"), _schema("mass"), POSITIVE, _size("mass")]
Inertia = Annotated[Float, _reader("inertia"), _schema("inertia"), POSITIVE, _size("inertia")]
Density = Annotated[Float, _reader("density"), _schema("density"), POSITIVE, _size("density")]
Instant = Annotated[Float, _reader("time"), _schema("time"), NOT_NEGATIVE]
Duration = Annotated[Float, _reader("time"), _schema("time"), POSITIVE, _size("time")]
Frequency = Annotated[
    Float, _reader("frequency"), _schema("frequency"), POSITIVE, _size("frequency")
]
Force = Annotated[Float, _reader("force"), _schema("force")]
Torque = Annotated[Float, _reader("torque"), _schema("torque")]
Stiffness = Annotated[Float, _reader("stiffness"), _schema("stiffness"), NOT_NEGATIVE]
RotaryStiffness = Annotated[
    Float, _reader("rotary stiffness"), _schema("rotary stiffness"), NOT_NEGATIVE
]
Damping = Annotated[Float, _reader("damping"), _schema("damping"), NOT_NEGATIVE]
RotaryDamping = Annotated[Float, _reader("rotary damping"), _schema("rotary damping"), NOT_NEGATIVE]
Speed = Annotated[Float, _reader("speed"), _schema("speed")]
AngularSpeed = Annotated[Float, _reader("angular speed"), _schema("angular speed")]
Acceleration = Annotated[Float, _reader("acceleration"), _schema("acceleration")]

Area = Annotated[Float, _reader("area"), _schema("area"), POSITIVE, _size("area")]
Volume = Annotated[Float, _reader("volume"), _schema("volume"), POSITIVE, _size("volume")]
Displacement = Annotated[Float, _reader("displacement"), _schema("displacement")]
Pressure = Annotated[Float, _reader("pressure"), _schema("pressure")]
Modulus = Annotated[Pressure, POSITIVE, _size("pressure")]
FlowResistance = Annotated[
    Float, _reader("flow resistance"), _schema("flow resistance"), NOT_NEGATIVE
]

Flag = StrictBool
"""True or false and nothing else: ``"no"`` is a text, not a refusal."""
Point = Pair[Coordinate]
NAME = r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*$"
Name = Annotated[str, Field(pattern=NAME, max_length=100)]
