"""The base of controllers, and the interface of their laws.

A controller acts at its own rate. An act after step k reads the quantities of step k, and its
values hold from step k + 1 to the next act; the first act is before the first step. The value of
a drive that a controller writes is its initial value.

Limits and rate limits are applied outside of the laws, which get the applied values against
windup. Readings, targets and drive values are in the order of ``reads`` and ``writes``, SI. Laws
are plain Python on floats, which is faster than arrays of so few numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import AfterValidator, Field, ValidationInfo, model_validator

from sandbox.elements.element import Element
from sandbox.errors import Problem
from sandbox.values import numbers as of
from sandbox.values.signals import AnySignal
from sandbox.wording import WrongValueError

if TYPE_CHECKING:
    from sandbox.scene.mechanism import Mechanism

RATE = 1000.0  # default rate of acts [Hz]; the nearest whole number of steps is used


def bound(text: str, info: ValidationInfo) -> str:
    """An expression of quantities with the scene's parameters put in; a plain name stays."""
    expression = of.checked_expression(text, info).bind(of.parameters_of(info))
    return f"={expression.text}" if text.lstrip().startswith("=") else text.strip()


def _ordered(limits: tuple[float, float]) -> tuple[float, float]:
    if limits[0] >= limits[1]:
        raise WrongValueError("out-of-range", f"limits are [lowest, highest], and {limits[0]:g} is "
                              f"not below {limits[1]:g}")
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
        """A value for each drive, in its unit, until the next act.

        Args:
            t: time [s]; one period after the last act.
            readings: as in :meth:`begin`; at the first act after it the same.
            targets: as in :meth:`begin`.
            applied: values in force since the last act. They equal those that the law returned,
                to the last bit, unless a limit or a rate limit cut them.
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
    # fields with numbers in the unit of its drives, of its readings, of a force
    of_drive: ClassVar[tuple[str, ...]] = ()
    of_reading: ClassVar[tuple[str, ...]] = ()
    of_force: ClassVar[tuple[str, ...]] = ()
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
        """The drives that it sets."""
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
        """Its law, which acts every ``period`` [s]."""
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

    @model_validator(mode="after")
    def _one_each(self) -> Self:
        for key in self.PER_DRIVE:
            given = getattr(self, key)
            if given is not None and len(given) != len(self.writes):
                raise WrongValueError("wrong-type", f"'{key}': expected {len(self.writes)} "
                                      f"entries, one a drive, got {len(given)}")
        return self
