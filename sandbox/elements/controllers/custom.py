"""A Python callable as a controller, for scripts; scenes never run code."""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from sandbox.elements.controllers.controller import Law, Row
from sandbox.errors import ControllerFailed, SandboxError
from sandbox.values.expressions import parse_expression
from sandbox.values.numbers import NAME
from sandbox.wording import quoted

Act = Callable[[float, Sequence[float]], float | Sequence[float] | None]
Range = tuple[float, float]


class StopRun(Exception):
    """Raised by the function of a :class:`Custom` to end the run, as an event with ``stop`` does.

    The run counts as complete. It ends before the next step, but not before its first sample.

    Args:
        because: why, for the verdicts.
        verdict: ``"pass"``, or ``"fail"``, which fails the run.

    Raises:
        ValueError: another verdict.
    """

    def __init__(self, because: str = "", *, verdict: Literal["pass", "fail"] = "pass") -> None:
        if verdict not in ("pass", "fail"):
            raise ValueError(f"a run is stopped with the verdict 'pass' or 'fail', not "
                             f"{quoted(verdict)}")
        super().__init__(because)
        self.because, self.verdict = str(because), verdict


def customs(given: object) -> tuple[Custom, ...]:
    """The callables that were passed as ``controllers``.

    Raises:
        SandboxError: they are none.
    """
    found = tuple(given) if isinstance(given, Iterable) else (None,)
    if not all(isinstance(one, Custom) for one in found):
        raise SandboxError(f"controllers: {quoted(given)} are no controllers; "
                           "pass a list of sandbox.Custom")
    return found


@dataclass(frozen=True)
class Custom:
    """A controller made of a Python function.

    ``act(t, readings)`` gets the time [s] and the values of ``reads``, and returns the value of
    the drive of ``writes``, or one for each drive. Without drives it only watches and returns
    nothing; the run is the same as without it. It may raise :class:`StopRun`. It is called once an
    act in the order of time, so it may keep a state. Arguments become tuples, one entry a drive.

    Raises:
        ValueError: an argument of another kind, or too few or many entries.
    """

    name: str
    reads: Sequence[str]  #: quantities (``finger.mcp.angle``) or expressions (``"=2 * a.angle"``)
    writes: Sequence[str]  #: drives; ``[]`` for a function that only watches
    act: Act
    rate: float | None = None  #: of its acts [Hz]; by default 1 kHz or nearly, in whole steps
    limits: Sequence[Range] | Range | None = None  #: (lowest, highest) of the drive or each drive
    slew: Sequence[float] | float | None = None  #: maximum change per second, the same way

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not re.fullmatch(NAME, self.name):
            raise ValueError(f"a controller's name is made of letters, digits, underscores and "
                             f"dots, and {quoted(self.name)} is not")
        reads, writes = (self._texts(key) for key in ("reads", "writes"))
        try:
            reads = tuple(f"={plain}" if text.lstrip().startswith("=") else plain
                          for text in reads for plain in [parse_expression(text).text])
        except ValueError as error:
            raise self._wrong(f"'reads': {error}") from None
        if len(set(writes)) < len(writes):
            raise self._wrong("'writes' names a drive twice")
        if not callable(self.act):
            raise self._wrong(f"'act' must be callable, got {quoted(self.act)}")
        if self.rate is not None and not self._number("rate", self.rate) > 0:
            raise self._wrong(f"'rate' must be greater than 0, got {self.rate!r}")
        for key, value in (("reads", reads), ("writes", writes),
                           ("limits", self._limits(len(writes))),
                           ("slew", self._slew(len(writes)))):
            object.__setattr__(self, key, value)

    def law(self) -> CustomLaw:
        """The callable as a law."""
        return CustomLaw(self)

    def _wrong(self, what: str) -> ValueError:
        return ValueError(f"controller {quoted(self.name)}: {what}")

    def _texts(self, key: str) -> tuple[str, ...]:
        """A list of names; one name may stand alone."""
        given = getattr(self, key)
        if isinstance(given, str):
            return (given,)
        if not isinstance(given, Sequence) or not all(isinstance(text, str) for text in given):
            raise self._wrong(f"'{key}' must be a list of names, got {quoted(given)}")
        return tuple(given)

    def _number(self, key: str, value: Any) -> float:
        if (isinstance(value, bool) or not isinstance(value, numbers.Real)
                or not math.isfinite(value)):
            raise self._wrong(f"'{key}' must be made of finite numbers, got {quoted(value)}")
        return float(value)

    def _limits(self, count: int) -> tuple[Range, ...] | None:
        given: Any = self.limits
        if given is None:
            return None
        if isinstance(given, Sequence) and any(isinstance(x, numbers.Real) for x in given):
            given = [given]  # one pair for one drive
        if isinstance(given, Sequence) and len(given) == count and all(
                isinstance(pair, Sequence) and len(pair) == 2 for pair in given):
            pairs = tuple((self._number("limits", low), self._number("limits", high))
                          for low, high in given)
            if all(low < high for low, high in pairs):
                return pairs
        raise self._wrong(f"'limits' must be {count} of [lowest, highest], one for each drive, "
                          f"got {quoted(given)}")

    def _slew(self, count: int) -> tuple[float, ...] | None:
        if self.slew is None:
            return None
        entries = self.slew if isinstance(self.slew, Sequence) else [self.slew]
        rates = tuple(self._number("slew", rate) for rate in entries)
        if len(rates) != count or min(rates) <= 0:
            raise self._wrong(f"'slew' must have {count} entries greater than 0, one for each "
                              f"drive, got {quoted(self.slew)}")
        return rates


class CustomLaw(Law):
    """Calls the function and checks its result."""

    def __init__(self, spec: Custom) -> None:
        self._act, self._name, self._count = spec.act, spec.name, len(spec.writes)

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        """The result of the function.

        Raises:
            StopRun: the function raised it.
            ControllerFailed: it raised something else, or did not return a number for each drive.
        """
        try:
            result: Any = self._act(t, readings)
        except StopRun:
            raise
        except Exception as error:
            raise ControllerFailed(
                t, self._name, f"raised {type(error).__name__}: {error}") from error
        if not self._count and result is None:
            return []
        returned = f"returned {quoted(result)}"
        if not self._count:
            raise ControllerFailed(t, self._name, f"{returned}, but 'writes' names no drive that "
                                                  "could have it")
        try:
            if isinstance(result, str):
                raise TypeError("a text, although its letters may be digits")
            wanted = [float(result)] if isinstance(result, numbers.Real) else [*map(float, result)]
        except (TypeError, ValueError):
            raise ControllerFailed(t, self._name, f"{returned} instead of numbers") from None
        if len(wanted) != self._count:
            raise ControllerFailed(
                t, self._name, f"returned {len(wanted)} values for {self._count} drives")
        return wanted
