"""The base of controllers and of their laws; controllers without dynamics.

An act after step k reads the quantities of step k, and its values hold from step k + 1 to the next
act; the first act is before the first step. Limits and rate limits are applied outside of the laws,
which get the applied values against windup. Laws are plain Python on floats, which is faster than
arrays of so few numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field, ValidationInfo

from sandbox.elements.element import Element
from sandbox.errors import Problem
from sandbox.values import numbers as of
from sandbox.values.signals import AnySignal, Signal
from sandbox.values.spec import TYPE
from sandbox.wording import refuse_if

if TYPE_CHECKING:
    from sandbox.scene.mechanism import Mechanism

RATE = 1000.0  # default rate of acts [Hz]; the nearest whole number of steps is used


def bound(text: str, info: ValidationInfo) -> str:
    """An expression of quantities with the scene's parameters put in; a plain name stays."""
    expression = of.bound_expression(text, info)
    return f"={expression.text}" if text.lstrip().startswith("=") else text.strip()


def _ordered(limits: tuple[float, float]) -> tuple[float, float]:
    refuse_if(limits[0] >= limits[1], f"limits are [lowest, highest], and {limits[0]:g} is not "
              f"below {limits[1]:g}", "out-of-range")
    return limits


Range = Annotated[of.Pair[of.Quantity], AfterValidator(_ordered)]
Positive = Annotated[of.Quantity, of.POSITIVE]
Matrix = of.Items[of.Items[of.Quantity]]
Reading = Annotated[str, AfterValidator(bound)]
Row = Sequence[float]  # a number for each reading, target or drive


def every(rate: float | None, step: float) -> int:
    """Steps of ``step`` [s] between two acts at ``rate`` [Hz]; None is near :data:`RATE`."""
    return max(1, round(1 / ((rate or RATE) * step)))


class Law:
    """Computes drive values from readings; the base of laws is one without memory."""

    def __init__(self, spec: Any, period: float) -> None:
        """The law of a controller that acts every ``period`` [s]."""

    def begin(self, readings: Row, targets: Row, inputs: Row) -> None:
        """Begin, or begin anew after being switched on during a run, from the drives' values."""

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        """A value for each drive, in its unit, until the next act; ``t`` is the time [s].

        ``applied`` are the values since the last act: those that the law returned, to the last
        bit, unless a limit or a rate limit cut them.
        """
        raise NotImplementedError

    def report(self) -> dict[str, Any]:
        """Results of the law as plain JSON data for ``run.json``; {} if there are none."""
        return {}

    @staticmethod
    def integrated(integral: float, step: float, cut: float) -> float:
        """An integral after a step, which is left out if it would increase a ``cut`` of output."""
        return integral if cut and step * cut >= 0 else integral + step


class ControllerSpec(Element):
    """The base of all controllers."""

    PYMUNK = "a controller"
    LAW: ClassVar[Any]  # the class of its law, of the controller and its period [s]
    of_drive: ClassVar[tuple[str, ...]] = ()  # fields with numbers in the unit of its drives
    of_reading: ClassVar[tuple[str, ...]] = ()  # and of its readings
    target_key: ClassVar[str] = "target"  # the field that has its targets
    reads_key: ClassVar[str] = "reads"  # the field that has its readings
    sets_target: ClassVar[bool] = False  # whether it sets its drive to its target

    name: of.Name
    """Its name, by which events set ``<name>.target`` and ``<name>.active``."""
    rate: of.Frequency | None = None
    """How often it acts [Hz]; by default 1 kHz or the nearest rate that the step divides."""
    active: of.Flag = True
    """Whether it acts from the start; an event may switch it by setting ``<name>.active``."""

    def _all_of(self, field: str) -> tuple[Any, ...]:
        """The entries of a field that has one or several; none where it is missing."""
        found = getattr(self, field, None)
        return () if found is None else found if isinstance(found, tuple) else (found,)

    @property
    def written(self) -> tuple[str, ...]:
        return self._all_of("writes")

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """Lowest and highest value of each drive; empty without limits."""
        limits: Any = getattr(self, "limits", None)
        return (limits,) if limits and isinstance(limits[0], float) else limits or ()

    @property
    def readings(self) -> tuple[str, ...]:
        """What it reads: quantities, or expressions of them that begin with ``=``."""
        return self._all_of(self.reads_key)

    @property
    def signals(self) -> tuple[AnySignal, ...]:
        """The targets of its readings over time; of a schedule its value."""
        return self._all_of(self.target_key)

    @property
    def immediate(self) -> str:
        """The expression that its output equals at once; empty of a law with memory."""
        return ""

    def law_problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        """Reasons why its law cannot work on this mechanism, whose names and units are right."""
        return iter(())

    def make_law(self, mechanism: Mechanism, period: float) -> Law:
        law: Law = self.LAW(self, period)
        return law


class SingleController(ControllerSpec):
    """A controller of one drive."""

    writes: of.Name
    """Name of the drive that it sets."""
    limits: Range | None = None
    """[lowest, highest] that it sets, in the drive's unit; none by default."""
    slew: Positive | None = None
    """Maximum change per second, in the drive's unit; none by default."""


class ReadingController(SingleController):
    """A controller of one drive by one reading."""

    reads: Reading
    """A quantity (``finger.mcp.angle``) or an expression (``"=a.angle - b.angle"``)."""


class SeveralController(ControllerSpec):
    """A controller of several drives."""

    PER_DRIVE: ClassVar[tuple[str, ...]] = ("limits", "slew")  # fields with an entry for each

    writes: of.Items[of.Name] = Field(min_length=1, max_length=32)
    """Names of the drives that it sets."""
    limits: of.Items[Range] | None = None
    """[lowest, highest] of each drive, in its unit; none by default."""
    slew: of.Items[Positive] | None = None
    """Maximum change per second of each drive, in its unit; none by default."""

    def _verify(self) -> None:
        for key in self.PER_DRIVE:
            given = getattr(self, key)
            refuse_if(given is not None and len(given) != len(self.writes), f"'{key}': expected "
                      f"{len(self.writes)} entries, one a drive, got {len(given or ())}",
                      "wrong-type")


class Direct(Law):
    """Sets its target, or its reading where it has no target."""

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        return [(targets or readings)[0]]


class ScheduleController(SingleController):
    """Sets a drive to a value over time, at its own rate and within limits."""

    LAW = Direct
    target_key = "value"
    sets_target = True
    type: Literal["schedule"] = TYPE
    value: Signal
    """Value of the drive over time, in its unit."""


class FeedbackController(SingleController):
    """Sets a drive to an expression of quantities and of the time ``t``."""

    LAW = Direct
    reads_key = "value"
    type: Literal["feedback"] = TYPE
    value: Reading
    """An expression of quantities, parameters and the time ``t`` [s], in the drive's unit."""

    @property
    def immediate(self) -> str:
        return self.value


class Switch(Law):
    """On/off with hysteresis; during a run it begins with the drive's value."""

    def __init__(self, spec: SwitchController, period: float) -> None:
        self._spec, self._value, self._keeps = spec, spec.value_below, not spec.active

    def begin(self, readings: Row, targets: Row, inputs: Row) -> None:
        self._value = inputs[0] if self._keeps else self._spec.value_below
        self._keeps = True

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        if readings[0] < self._spec.below:
            self._value = self._spec.value_below
        elif readings[0] > self._spec.above:
            self._value = self._spec.value_above
        return [self._value]


class SwitchController(ReadingController):
    """On/off with hysteresis: one value once the reading fell below, another once it rose above.

    In between the drive keeps what it has; at the start of a run that is ``value_below``.
    """

    LAW = Switch
    of_drive = ("value_below", "value_above")
    of_reading = ("below", "above")
    type: Literal["switch"] = TYPE
    below: of.Quantity
    """Below this reading ``value_below`` is set, in the reading's unit."""
    above: of.Quantity
    """Above this reading ``value_above`` is set, in the reading's unit; more than ``below``."""
    value_below: of.Quantity
    """Value of the drive once the reading is less than ``below``, in the drive's unit."""
    value_above: of.Quantity
    """Value of the drive once the reading is more than ``above``, in the drive's unit."""

    def _verify(self) -> None:
        refuse_if(self.below >= self.above, "'below' must be less than 'above'", "out-of-range")
