"""Figures of a run for who has it at hand."""

from __future__ import annotations

import math
from typing import Any

from sandbox.draw.figure import signals
from sandbox.errors import OutputError
from sandbox.recording.recording import Recording
from sandbox.samples.samples import TIME
from sandbox.samples.targets import targets
from sandbox.scene.values.numbers import number_from
from sandbox.wording import WrongValueError, quoted


def plot(
    run: Recording, quantities: tuple[str, ...], x: str = "", begin: float | str = 0.0,
    end: float | str = math.inf,
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
                            _instant("begin", begin), _instant("end", end)))


def _instant(name: str, time: float | str) -> float:
    """In seconds."""
    if isinstance(time, float | int):
        return float(time)
    try:
        return number_from(time, "time", {})
    except ValueError as error:
        said = error.message if isinstance(error, WrongValueError) else str(error)
        raise OutputError(f"{name}={quoted(time)}: {said}; pass seconds, or a time such as "
                          "'0.8 s'") from None
