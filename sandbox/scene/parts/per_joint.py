"""Lists with one entry a joint, which an author may shorten to the one value that all share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, TypeVar

from pydantic import BeforeValidator, WithJsonSchema

from sandbox.values.numbers import (
    Angle,
    Coordinate,
    Damping,
    Items,
    Point,
    RotaryDamping,
    Stiffness,
)

_NUMBER: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string"}]}
_PAIR: dict[str, Any] = {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2}

T = TypeVar("T")


def each(given: Sequence[T], count: int) -> tuple[T, ...]:
    """``given`` for ``count`` joints: as it is, or its one entry for all of them."""
    return tuple(given) * count if len(given) == 1 else tuple(given)


def _lift(value: Any) -> Any:
    return value if isinstance(value, (list, tuple)) else [value]


def _lift_point(value: Any) -> Any:
    listed = isinstance(value, (list, tuple))
    return value if listed and value and isinstance(value[0], (list, tuple)) else [value]


def _lift_limit(value: Any) -> Any:
    if not isinstance(value, (list, tuple)):
        value = [value]
    return [limit if isinstance(limit, (list, tuple)) else [0.0, limit] for limit in value]


def _schema(item: dict[str, Any], *, single: bool = True) -> WithJsonSchema:
    several = {"type": "array", "items": item, "minItems": 1}
    return WithJsonSchema({"anyOf": [item, several]} if single else several)


Stiffnesses = Annotated[Items[Stiffness], BeforeValidator(_lift), _schema(_NUMBER)]
Dampings = Annotated[Items[Damping], BeforeValidator(_lift), _schema(_NUMBER)]
RotaryDampings = Annotated[Items[RotaryDamping], BeforeValidator(_lift), _schema(_NUMBER)]
Coordinates = Annotated[Items[Coordinate], BeforeValidator(_lift), _schema(_NUMBER)]
Angles = Annotated[Items[Angle], BeforeValidator(_lift), _schema(_NUMBER)]
Points = Annotated[Items[Point], BeforeValidator(_lift_point), _schema(_PAIR)]
Limits = Annotated[
    Items[tuple[Angle, Angle]], BeforeValidator(_lift_limit),
    _schema({"anyOf": [*_NUMBER["anyOf"], _PAIR]}),
]
