"""Values over time: constant, ramp, table or expression of ``t``; :func:`values` evaluates them."""

from __future__ import annotations

import numbers
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag, TypeAdapter, ValidationInfo

from sandbox.numeric import Array
from sandbox.values import numbers as of
from sandbox.values.expressions import parse_expression, unknown_name
from sandbox.values.spec import ReadMark, Spec
from sandbox.values.tables import NONE, Tables
from sandbox.values.units import units_of
from sandbox.wording import refuse_if


class Ramp(Spec):
    """Linear from ``from`` to ``to``, then held."""

    start_value: Annotated[of.Quantity, Field(alias="from")] = 0.0
    """Value until the ramp starts, in the unit of the driven quantity."""
    to: of.Quantity
    """Value from the end of the ramp on, in the unit of the driven quantity."""
    start: of.Instant = 0.0
    """Start of the ramp [s]."""
    over: of.Instant
    """Duration [s]; 0 is a step."""


def _in_order(table: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    refuse_if(any(b[0] <= a[0] for a, b in pairwise(table)),
              "the times of a table must increase", "bad-table")
    return table


class Table(Spec):
    """Points ``[t, value]`` in order of time, held before the first and after the last."""

    table: Annotated[of.Items[tuple[of.Instant, of.Quantity]], AfterValidator(_in_order)] = Field(
        min_length=1)
    """Points ``[t, value]``: increasing times [s], values in the unit of the driven quantity."""
    between: Literal["linear", "step"] = "linear"
    """Interpolation: ``linear``, or ``step``, which keeps the value of the point before."""


def _bound(text: str, info: ValidationInfo) -> str:
    bound = of.bound_expression(text, info)
    for unknown in sorted(bound.names - {"t"}):
        raise unknown_name(unknown, of.parameters_of(info), also="t")
    return f"={bound.text}"


class Formula(Spec):
    """An expression of the time ``t`` [s]; parameters are bound when it is read."""

    expression: Annotated[str, AfterValidator(_bound)]
    """An expression of ``t`` [s] and of parameters, such as ``"=pull * sin(2 * pi * t)"``."""


class Constant(Spec):
    """The same value at all times."""

    constant: of.Quantity
    """The value, in the unit of the driven quantity."""


AnySignal = Ramp | Table | Formula | Constant


def _kind(value: Any) -> str | None:
    if isinstance(value, Spec):
        return type(value).__name__.lower()
    tags = {"to": "ramp", "table": "table", "expression": "formula", "constant": "constant"}
    return next((tags[key] for key in tags if isinstance(value, dict) and key in value), None)


def _as_object(value: Any) -> Any:
    """Read a number or its string as a constant, ``{"ramp": {...}}`` as its body."""
    if isinstance(value, str) and value.lstrip().startswith("="):
        try:
            timeless = "t" not in parse_expression(value).names
        except ValueError:
            timeless = False
        return {"constant": value} if timeless else {"expression": value}
    if isinstance(value, (numbers.Real, str)) and not isinstance(value, bool):
        return {"constant": value}
    if isinstance(value, dict) and len(value) == 1 and isinstance(value.get("ramp"), dict):
        return value["ramp"]
    return value


@dataclass(frozen=True)
class OverTime(ReadMark):
    """Marks a value over time of a dimension; one of none takes any unit."""

    dimension: str | None = None

    def json_schema(self, schema: dict[str, Any]) -> dict[str, Any]:
        """A number, a text, or one of the objects."""
        objects = schema["oneOf"]
        ramp = {"type": "object", "required": ["ramp"], "additionalProperties": False,
                "properties": {"ramp": objects[0]}}
        return {
            "anyOf": [{"type": "number"}, {"type": "string"}, *objects, ramp],
            "description": f"A value over time{self.unit}: a number, a string with a unit, an "
            'expression such as "=pull * sin(t)", a ramp, or a table.',
        }

    @property
    def unit(self) -> str:
        """The SI unit as `` [N]``; empty if there is none."""
        shown = self.dimension not in (None, "ratio")
        return f" [{units_of(str(self.dimension))[0]}]" if shown else ""

    def read(self, value: Any, info: ValidationInfo) -> Any:
        """The signal; units of its numbers of another dimension are refused."""
        return _ANY.validate_python(_as_object(value), context={
            **(info.context or {}), "dimension": self.dimension})


_WANTED = "expected a number, a ramp {…}, a table {…} or an expression"
_Union = of.Written[Annotated[
    Annotated[Ramp, Tag("ramp")] | Annotated[Table, Tag("table")]
    | Annotated[Formula, Tag("formula")] | Annotated[Constant, Tag("constant")],
    Discriminator(_kind, custom_error_type="signal", custom_error_message=_WANTED),
]]
_ANY: TypeAdapter[Any] = TypeAdapter(_Union)
Signal = Annotated[_Union, OverTime()]
ForceSignal = Annotated[_Union, OverTime("force")]
TorqueSignal = Annotated[_Union, OverTime("torque")]
LengthSignal = Annotated[_Union, OverTime("length")]
AngleSignal = Annotated[_Union, OverTime("angle")]
SpeedSignal = Annotated[_Union, OverTime("angular speed")]
RateSignal = Annotated[_Union, OverTime("speed")]
FlowSignal = Annotated[_Union, OverTime("flow")]
PressureSignal = Annotated[_Union, OverTime("pressure")]
ShareSignal = Annotated[_Union, OverTime("ratio")]


def values(signal: AnySignal, t: Array, tables: Tables = NONE, *, finite: bool = True) -> Array:
    """The signal at times ``t`` [s], shape [n]; SI. Formulas may call ``tables``, the scene's."""
    if isinstance(signal, Constant):
        return np.full(len(t), signal.constant)
    if isinstance(signal, Ramp):
        with np.errstate(over="ignore"):  # a ramp of next to no length is a step
            fraction = np.clip((t - signal.start) / signal.over, 0.0, 1.0) if signal.over else (
                np.where(t >= signal.start, 1.0, 0.0))
        return signal.start_value * (1 - fraction) + signal.to * fraction
    if isinstance(signal, Table):
        at, value = np.array(signal.table).T
        row: Array = np.interp(t, at, value)
        if signal.between == "step":
            row = value[np.clip(np.searchsorted(at, t, side="right") - 1, 0, None)]
        return row
    result = parse_expression(signal.expression).evaluate({**tables, "t": t}, finite=finite)
    return np.broadcast_to(np.asarray(result, dtype=float), t.shape).copy()


class Path(Spec):
    """Pose of a scheduled body over time [m, rad]; omitted coordinates keep their initial value."""

    x: LengthSignal | None = None
    """World x of the body's origin [m]."""
    y: LengthSignal | None = None
    """World y of the body's origin [m]."""
    angle: AngleSignal | None = None
    """Turn of the body's frame against the world [rad], counter-clockwise."""

    def _verify(self) -> None:
        refuse_if(self.x is None and self.y is None and self.angle is None,
                  "a path needs 'x', 'y' or 'angle'")
