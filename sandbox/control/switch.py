"""On/off control with hysteresis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sandbox.elements.controllers import SwitchController


class Switch:
    """One value from the moment the reading is below a threshold, another once it is above one.

    Between the thresholds it keeps what it has. In the middle of a run it
    begins with what the drive has, at the start of one with ``value_below``.
    """

    __slots__ = ("_above", "_below", "_keeps", "_value", "_value_above", "_value_below")

    def __init__(self, spec: SwitchController) -> None:
        self._below, self._above = spec.below, spec.above
        self._value_below, self._value_above = spec.value_below, spec.value_above
        self._value = spec.value_below
        self._keeps = not spec.active

    def begin(
        self, readings: Sequence[float], targets: Sequence[float], inputs: Sequence[float],
    ) -> None:
        """Take the value to be kept between the thresholds."""
        self._value = inputs[0] if self._keeps else self._value_below
        self._keeps = True

    def act(
        self, t: float, readings: Sequence[float], targets: Sequence[float],
        applied: Sequence[float],
    ) -> list[float]:
        """Switch if the reading is outside of the thresholds; on one of them it is not."""
        reading = readings[0]
        if reading < self._below:
            self._value = self._value_below
        elif reading > self._above:
            self._value = self._value_above
        return [self._value]

    def report(self) -> dict[str, Any]:
        """Nothing to tell."""
        return {}
