"""Linear feedback of several readings to several drives, with integrals."""

from __future__ import annotations

from collections.abc import Sequence
from operator import add, mul, sub
from typing import Literal

from pydantic import Field

from sandbox.elements.controllers.controller import Law, Matrix, Reading, Row, SeveralController
from sandbox.values.numbers import Items, Quantity
from sandbox.values.signals import Signal
from sandbox.values.spec import TYPE
from sandbox.wording import refuse_if


class StateFeedback(Law):
    """u = bias + K e + I with e = targets - readings, and for each drive an integral of its own.

    I is the integral of the row of ``integral_gains`` times e over straight lines between acts. It
    stops while its drive's output is cut and it would increase the cut. Rows are lists: numpy takes
    as long for 4 x 6 numbers.
    """

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

    def begin(self, readings: Row, targets: Row, inputs: Row) -> None:
        """Set bias and integrals; during a run integrals begin at their drives' values."""
        self._bias = tuple(inputs) if self._given is None else self._given
        self._integrals = [0.0] * len(self._bias)
        if self._resumes and self._kept:
            errors = list(map(sub, targets, readings))
            self._integrals = [
                now - bias - sum(map(mul, row, errors)) if any(half) else 0.0
                for now, bias, row, half in zip(
                    inputs, self._bias, self._gains, self._half_gains, strict=True)]
        self._resumes = self._fresh = True

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        errors = list(map(sub, targets, readings))
        if self._kept:
            kept = [errors[j] for j in self._kept]
            if not self._fresh:
                sums = list(map(add, kept, self._errors))
                self._integrals = [
                    self.integrated(integral, sum(map(mul, half, sums)), wanted - value)
                    for integral, half, wanted, value in zip(
                        self._integrals, self._half_gains, self._wanted, applied, strict=False)]
            self._fresh, self._errors = False, kept
        self._wanted = [
            bias + sum(map(mul, row, errors)) + integral
            for bias, row, integral in zip(self._bias, self._gains, self._integrals, strict=True)]
        return self._wanted.copy()


class StateFeedbackController(SeveralController):
    """Brings several readings to their targets at once, by a gain for each.

    u = bias + gains (targets - readings) + integral_gains ∫(targets - readings) dt.

    The gains come from a design such as a linear-quadratic one.
    """

    LAW = StateFeedback
    PER_DRIVE = ("limits", "slew", "bias")
    of_drive = ("bias",)
    target_key = "targets"
    type: Literal["state_feedback"] = TYPE
    reads: Items[Reading] = Field(min_length=1, max_length=64)
    """Quantities, or expressions of them, in the order of the columns of ``gains``."""
    targets: Items[Signal]
    """Target of each reading over time, in its unit."""
    gains: Matrix
    """A row for each drive, a column for each reading [drive's unit per reading's unit]."""
    integral_gains: Matrix | None = None
    """Gains of the errors' integrals, in the shape of ``gains``; none by default."""
    bias: Items[Quantity] | None = None
    """Added for each drive, in its unit; by default the drives' values at the beginning."""

    def _verify(self) -> None:
        super()._verify()
        columns = len(self.reads)
        for key, gains in ("gains", self.gains), ("integral_gains", self.integral_gains):
            refuse_if(gains is not None and list(map(len, gains)) != [columns] * len(self.writes),
                      f"'{key}': expected {len(self.writes)} rows (drives) and {columns} columns",
                      "wrong-type")
        refuse_if(len(self.targets) != columns,
                  f"'targets': expected {columns} entries, one a reading", "wrong-type")
