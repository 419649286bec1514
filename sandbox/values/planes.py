"""Planes: layers, one above the other, in which bodies lie; those of different ones pass."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from sandbox.values.numbers import Items, number_from, parameters_of
from sandbox.wording import WrongValueError, kind_of, near, number_text, quoted

ALL: Literal["all"] = "all"
MOST = 1000
"""Of a plane's number, to either side of 0."""
MANY = 64
"""Planes in which one body may lie."""
WORDS = f'a whole number, a list of them, or "{ALL}"'

_PLANE: dict[str, Any] = {"anyOf": [
    {"type": "integer", "minimum": -MOST, "maximum": MOST}, {"type": "string", "pattern": "^="}]}
SCHEMA = WithJsonSchema({"anyOf": [
    _PLANE, {"type": "array", "items": _PLANE, "minItems": 1, "maxItems": MANY}, {"const": ALL}]})


def _read(value: Any, info: ValidationInfo) -> tuple[int, ...] | Literal["all"]:
    if value == ALL:
        return ALL
    numbers = tuple(value) if isinstance(value, (list, tuple)) else (value,)
    if not 0 < len(numbers) <= MANY:
        raise WrongValueError("wrong-type", f"expected 1 to {MANY} planes, got {len(numbers)}")
    return tuple(_plane(number, info) for number in numbers)


def _plane(written: Any, info: ValidationInfo) -> int:
    number = written
    if isinstance(written, str) and written.lstrip().startswith("="):
        computed = number_from(written, None, parameters_of(info))
        if not computed.is_integer():
            raise WrongValueError("not-allowed", f"{quoted(written)} is {number_text(computed)}, "
                                  "which is not a plane", allowed=WORDS)
        number = int(computed)
    if isinstance(number, bool) or not isinstance(number, int):
        named = number if isinstance(number, str) else ""
        raise WrongValueError("not-allowed", f"{quoted(named) if named else kind_of(number)} is "
                              "not a plane", allowed=WORDS, hint=near(named, [ALL]))
    if abs(number) > MOST:
        shown = number if abs(number) < 1e9 else "so large a number"
        raise WrongValueError("not-allowed", f"{shown} is not a plane",
                              allowed=f"whole numbers from {-MOST} to {MOST}")
    return number


Planes = Annotated[Items[int] | Literal["all"], BeforeValidator(_read), SCHEMA]
"""The planes that a body lies in."""


def share(one: Planes, other: Planes) -> bool:
    """Whether bodies of these planes meet in one anywhere."""
    return one == ALL or other == ALL or not set(one).isdisjoint(other)


def depth(planes: Planes) -> int:
    """From back to front, where a body of these planes is drawn: at the lowest of them."""
    return -MOST - 1 if planes == ALL else min(int(plane) for plane in planes)
