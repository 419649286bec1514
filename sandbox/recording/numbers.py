"""What the numbers of a recorded array have to be, looked at piece by piece."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import IN_ORDER, LARGEST, Recorded
from sandbox.numeric import Array, Flags, Integers

Check = Callable[[int, NDArray[Any]], str]
"""Of the number of the first row of a piece and the piece: what is wrong with it, or nothing."""
ROUNDING = 1e-9


@dataclass(frozen=True)
class Span:
    """What the numbers of a recording refer to."""

    sizes: Mapping[str, int]
    """How many there are along every axis."""
    end: float
    """No sample is later [s]."""


def checks(kind: Recorded, span: Span) -> Check:
    """What to look for in an array; its pieces come in order, from the first row on."""
    if kind.name == "time":
        return _Rising(span.end)
    if kind.points:
        return _Pointing(span.sizes[kind.points], ordered=kind.name in IN_ORDER)
    row = {"once": "element", "sample": "sample", "mean": "sample", "meters": "sample"}.get(
        kind.when, "row")

    def numbers(first: int, values: Array) -> str:
        wrong = ~(np.abs(values) <= LARGEST)
        if kind.also == "inf":
            if (values <= 0).any():
                return "is not greater than 0"
            wrong &= values != np.inf
        elif kind.also == "nan" or kind.late:
            wrong &= ~np.isnan(values)
        if not wrong.any():
            return ""
        at = _first(wrong)
        return f"holds {values[wrong][0]:.6g} in {row} {first + at}"

    return numbers


class _Rising:
    """Time goes forward, from 0 to the run's end."""

    def __init__(self, end: float) -> None:
        self._last, self._end = 0.0, end

    def __call__(self, first: int, values: Array) -> str:
        before = np.concatenate([[self._last], values[:-1]])
        ahead = values > before
        if first == 0:
            ahead[:1] = values[:1] >= 0
        beyond = values > self._end * (1 + ROUNDING)
        if not ahead.all() or beyond.any():
            at = _first(~ahead | beyond)
            what = f"{values[at]:.9g} s in sample {first + at}"
            return (f"goes on after the run's end of {self._end:.9g} s: {what}" if beyond[at]
                    else f"does not rise: {what}")
        self._last = float(values[-1])
        return ""


class _Pointing:
    """Numbers of rows or elements that are there."""

    def __init__(self, count: int, *, ordered: bool) -> None:
        self._count, self._ordered, self._last = count, ordered, 0

    def __call__(self, first: int, values: Integers) -> str:
        outside = (values < 0) | (values >= self._count)
        if outside.any():
            at = _first(outside)
            return f"points outside 0..{self._count - 1} in row {first + at}: {values[at]}"
        if self._ordered:
            back = np.diff(values, prepend=self._last) < 0
            if back.any():
                return f"is not in order in row {first + _first(back)}"
            self._last = int(values[-1])
        return ""


def _first(wrong: Flags) -> int:
    """The first row in which something is wrong."""
    return int(np.argmax(wrong.reshape(len(wrong), -1).any(axis=1)))
