"""A Python callable as a controller, for scripts; scenes never run code."""

from __future__ import annotations

import numbers
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from pydantic import Field

from sandbox.elements.controllers.controller import Law, Reading, Row, SeveralController
from sandbox.errors import ControllerFailed, SandboxError, SceneError
from sandbox.values.numbers import Items, Name
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
    """The callables that were passed as ``controllers``."""
    found = tuple(given) if isinstance(given, Iterable) else (None,)
    if not all(isinstance(one, Custom) for one in found):
        raise SandboxError(f"controllers: {quoted(given)} are no controllers; "
                           "pass a list of sandbox.Custom")
    return found


class CustomLaw(Law):
    """Calls the function and checks its result."""

    def __init__(self, spec: CustomController, period: float) -> None:
        self._act, self._name, self._count = spec.act, spec.name, len(spec.writes)

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        """The result of the function; ControllerFailed unless it has a number for each drive."""
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


class CustomController(SeveralController):
    """The arguments of a :class:`Custom`, checked."""

    LAW = CustomLaw

    reads: Items[Reading]
    writes: Items[Name] = Field(max_length=32)
    act: Callable[..., Any]


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
    controller: CustomController = field(init=False, repr=False)

    def __post_init__(self) -> None:
        given = {key: value for key, value in vars(self).items() if value is not None}
        for key in given.keys() & {"reads", "writes", "slew"}:
            if isinstance(given[key], (str, numbers.Real)):
                given[key] = [given[key]]
        if isinstance(self.limits, Sequence) and any(
                isinstance(limit, numbers.Real) for limit in self.limits):
            given["limits"] = [self.limits]
        try:
            controller = CustomController(**given)
        except SceneError as error:
            faults = "; ".join(str(problem).removeprefix("$.") for problem in error.problems)
            raise ValueError(f"controller {quoted(self.name)}: {faults}") from None
        for key in given:
            object.__setattr__(self, key, getattr(controller, key))
        object.__setattr__(self, "controller", controller)
