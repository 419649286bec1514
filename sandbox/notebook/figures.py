"""Figures of a run for who has it at hand."""

from __future__ import annotations

from typing import Any

from sandbox.draw.figure import signals
from sandbox.errors import OutputError
from sandbox.recording.recording import Recording
from sandbox.samples.samples import TIME
from sandbox.samples.targets import targets
from sandbox.scene.values.numbers import number_from
from sandbox.wording import WrongValueError, quoted

FORMS = {"time": "seconds, or a time such as '0.8 s'",
         "length": "metres, or a length such as '85 mm'"}
"""What of a dimension may be passed."""


def plot(
    run: Recording, quantities: tuple[str, ...], x: str, begin: float | str, end: float | str,
    width: float | str | None, title: bool,
) -> Any:
    """See :meth:`sandbox.Recording.plot`."""
    if not quantities:
        some = next(iter(run.names()), "finger.mcp.angle")
        raise OutputError(f"plot() needs quantities, such as {some!r} or '*.angle'; run.names() "
                          "lists them")
    names = list(dict.fromkeys(name for each in quantities for name in run.names(each)))
    label = run.mechanism.title or run.mechanism.name
    if x and x != TIME:
        run.catalogue.find(x)
    return signals.draw([signals.Plotted(label, run, targets(run))], names,
                        x="" if x == TIME else x, window=signals.Window(
                            _number("begin", begin, "time"), _number("end", end, "time")),
                        width=None if width is None else _number("width", width, "length"),
                        titled=title)


def _number(name: str, value: float | str, dimension: str) -> float:
    """In SI."""
    if isinstance(value, float | int):
        return float(value)
    try:
        return number_from(value, dimension, {})
    except ValueError as error:
        said = error.message if isinstance(error, WrongValueError) else str(error)
        raise OutputError(f"{name}={quoted(value)}: {said}; pass {FORMS[dimension]}") from None
