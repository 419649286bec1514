"""Values over time, multiplied and added: the path of a body that is placed with its assembly."""

from __future__ import annotations

import numpy as np

from sandbox.errors import Problem
from sandbox.scene.parts.expansion import PartError
from sandbox.values.signals import AnySignal, Constant, Formula, Ramp, Table, values


def scaled(signal: AnySignal, factor: float, offset: float = 0.0) -> AnySignal:
    """The signal ``factor`` s(t) + ``offset``."""
    if factor == 1.0 and offset == 0.0:
        return signal
    if isinstance(signal, Constant):
        return Constant(constant=factor * signal.constant + offset)
    if isinstance(signal, Ramp):
        return signal.model_copy(update={"start_value": factor * signal.start_value + offset,
                                         "to": factor * signal.to + offset})
    if isinstance(signal, Table):
        return signal.model_copy(update={
            "table": tuple((t, factor * value + offset) for t, value in signal.table)})
    return Formula(expression=f"={factor!r} * ({_text(signal)}) + {offset!r}")


def added(one: AnySignal, other: AnySignal) -> AnySignal:
    """The sum of two signals.

    Raises:
        PartError: of a table and an expression, and of tables with steps at times of their own.
    """
    if isinstance(one, Constant):
        return scaled(other, 1.0, one.constant)
    if isinstance(other, Constant):
        return scaled(one, 1.0, other.constant)
    if isinstance(one, Table) and isinstance(other, Table) and one.between == other.between:
        return _tables(one, other)
    if isinstance(one, Table) or isinstance(other, Table):
        raise PartError([Problem(
            "bad-part",
            "a path with a table for one of x and y and something else for the other cannot be "
            "turned", path="", allowed="tables for both, expressions for both, or a quarter turn")])
    return Formula(expression=f"={_text(one)} + {_text(other)}")


def _tables(one: Table, other: Table) -> Table:
    """At the times of both: between two of them both are linear, or both constant."""
    times = np.array(sorted({t for t, _ in (*one.table, *other.table)}))
    total = values(one, times) + values(other, times)
    return one.model_copy(update={"table": tuple(
        (float(t), float(value)) for t, value in zip(times, total, strict=True))})


def _text(signal: AnySignal) -> str:
    """A ramp or a formula as an expression of ``t``."""
    if isinstance(signal, Formula):
        return f"({signal.expression.removeprefix('=')})"
    assert isinstance(signal, Ramp)  # constants and tables do not come here
    start, rise = signal.start_value, signal.to - signal.start_value
    done = (f"clip((t - {signal.start!r}) / {signal.over!r}, 0, 1)" if signal.over
            else f"(t >= {signal.start!r})")
    return f"({start!r} + {rise!r} * {done})"
