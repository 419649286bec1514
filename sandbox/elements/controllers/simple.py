"""Controllers without dynamics: a value over time, an expression, on/off with hysteresis."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import model_validator

from sandbox.elements.controllers.controller import (
    Law,
    Reading,
    ReadingController,
    Row,
    SingleController,
)
from sandbox.values.numbers import Quantity
from sandbox.values.signals import Signal
from sandbox.values.spec import TYPE
from sandbox.wording import WrongValueError


class Direct(Law):
    """Sets its target, or its reading where it has no target."""

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        """The current target or reading."""
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
    """Value of the drive, in its unit: an expression of quantities, of parameters and of the time
    ``t`` [s], such as ``"=0.2 * cos(axle.angle)"``."""

    @property
    def immediate(self) -> str:
        """The expression."""
        return self.value


class Switch(Law):
    """One value from the moment the reading is below a threshold, another once it is above one.

    Between the thresholds it keeps its value. During a run it begins with the drive's value, at
    the start of one with ``value_below``.
    """

    def __init__(self, spec: SwitchController, period: float) -> None:
        self._spec, self._value, self._keeps = spec, spec.value_below, not spec.active

    def begin(self, readings: Row, targets: Row, inputs: Row) -> None:
        """Set the value to be kept between the thresholds."""
        self._value = inputs[0] if self._keeps else self._spec.value_below
        self._keeps = True

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        """Switch if the reading is outside of the thresholds; on one of them it is not."""
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
    below: Quantity
    """Below this reading ``value_below`` is set, in the reading's unit."""
    above: Quantity
    """Above this reading ``value_above`` is set, in the reading's unit; more than ``below``."""
    value_below: Quantity
    """Value of the drive once the reading is less than ``below``, in the drive's unit."""
    value_above: Quantity
    """Value of the drive once the reading is more than ``above``, in the drive's unit."""

    @model_validator(mode="after")
    def _thresholds(self) -> Self:
        if self.below >= self.above:
            raise WrongValueError("out-of-range", "'below' must be less than 'above'")
        return self
