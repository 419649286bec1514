"""Linear feedback of several readings to several drives, with integrals."""

from __future__ import annotations

from collections.abc import Sequence
from operator import add, mul, sub
from typing import Any

from sandbox.elements.controllers import StateFeedbackController


class StateFeedback:
    """u = bias + K e + I with e = targets - readings, and for each drive an integral of its own.

    I is the integral of the row of ``integral_gains`` times e over straight lines
    between acts. It is left as it is while its drive's output is cut, by limits or the
    rate limit, and the integral would lead further out. Columns without an integral gain are
    left out of the integrals. Rows are lists: numpy needs as long for 4 x 6 numbers.
    """

    __slots__ = ("_bias", "_errors", "_fresh", "_gains", "_given", "_half_gains", "_integrals",
                 "_kept", "_resumes", "_wanted")

    def __init__(self, spec: StateFeedbackController, period: float) -> None:
        rows = len(spec.writes)
        self._gains = spec.gains
        integral_gains = spec.integral_gains or ()
        self._kept = [j for j, column in enumerate(zip(*integral_gains, strict=True))
                      if any(column)]
        self._half_gains = tuple(
            tuple(0.5 * period * row[j] for j in self._kept) for row in integral_gains)
        self._given = spec.bias
        self._bias: Sequence[float] = (0.0,) * rows
        self._integrals = self._wanted = [0.0] * rows
        self._errors: list[float] = []
        self._resumes, self._fresh = not spec.active, True

    def begin(
        self, readings: Sequence[float], targets: Sequence[float], inputs: Sequence[float],
    ) -> None:
        """Set bias and integrals.

        In the middle of a run the rows with integral gains take up the
        difference to what their drives have; others keep to their bias.
        """
        self._bias = tuple(inputs) if self._given is None else self._given
        self._integrals = [0.0] * len(self._bias)
        if self._resumes and self._kept:
            errors = list(map(sub, targets, readings))
            self._integrals = [
                now - bias - sum(map(mul, row, errors)) if any(half) else 0.0
                for now, bias, row, half in zip(
                    inputs, self._bias, self._gains, self._half_gains, strict=True)]
        self._resumes = self._fresh = True

    def act(
        self, t: float, readings: Sequence[float], targets: Sequence[float],
        applied: Sequence[float],
    ) -> list[float]:
        """The output; see the class."""
        errors = list(map(sub, targets, readings))
        if self._kept:
            kept = [errors[j] for j in self._kept]
            if not self._fresh:
                self._integrate(list(map(add, kept, self._errors)), applied)
            self._fresh, self._errors = False, kept
        self._wanted = [
            bias + sum(map(mul, row, errors)) + integral
            for bias, row, integral in zip(self._bias, self._gains, self._integrals, strict=True)]
        return self._wanted.copy()

    def _integrate(self, sums: list[float], applied: Sequence[float]) -> None:
        """Add one period, where it does not lead further out of what can be set."""
        integrals = self._integrals
        for i, half in enumerate(self._half_gains):
            step = sum(map(mul, half, sums))
            cut = self._wanted[i] - applied[i]
            if not cut or step * cut < 0:
                integrals[i] += step

    def report(self) -> dict[str, Any]:
        """Nothing to tell."""
        return {}
