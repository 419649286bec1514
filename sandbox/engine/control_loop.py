"""One controller at work: readings in, law, rate limits and limits, drive values out.

A loop acts a thousand times a second and more, so what it does again and again is
bound once, in :func:`_single` for one reading and one drive, else in :func:`_several`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from sandbox.elements.controllers.controller import Law
from sandbox.engine.readings import Readings
from sandbox.errors import Problem, SceneError, SimulationDiverged
from sandbox.numeric import Array
from sandbox.values.expressions import Read
from sandbox.values.signals import AnySignal, Constant, Ramp, values
from sandbox.values.tables import NONE, Tables

Act = Callable[[float, int], None]

AHEAD = 4096
"""So many acts' targets are worked out in one go."""
ANY = 1e300
"""A change that no rate limit cuts; less than infinity, which is no value to be set."""


class Setpoint:
    """A signal at the instants of a controller's acts, or the value that an event gave it."""

    def __init__(
        self, signal: AnySignal, period: float, last: int, tables: Tables = NONE,
    ) -> None:
        self.tables = tables
        self.signal, self.period, self.last = signal, period, last
        self.fixed: float | None = signal.constant if isinstance(signal, Constant) else None
        self._first = 0
        self._values: list[float] = []

    def at(self, act: int) -> float:
        """The value for the act with this number, counted from 0 at t = 0.

        Raises:
            SceneError: it has no finite value at some act of the run.
        """
        if self.fixed is not None:
            return self.fixed
        ramp = self.signal
        if isinstance(ramp, Ramp) and act * self.period >= ramp.start + ramp.over:
            self.fixed = ramp.to
            return self.fixed
        if not self._first <= act < self._first + len(self._values):
            stop = min(act + AHEAD, max(act, self.last) + 1)
            instants: Array = self.period * np.arange(act, stop, dtype=np.float64)
            try:
                self._first, self._values = act, values(
                    self.signal, instants, self.tables).tolist()
            except ValueError as error:
                raise SceneError([Problem("bad-argument",
                                          f"a controller's target: {error}")]) from None
        return self._values[act - self._first]


@dataclass(frozen=True)
class Bound:
    """What may be set of a drive."""

    column: int  # Of the drive
    most: float = ANY  # largest change from one act to the next
    low: float = -math.inf
    high: float = math.inf


class Desk:
    """The drive values that controllers and events set, as a list and as rows for the engine."""

    def __init__(self, readings: Readings, floor: Array) -> None:
        """``readings`` know what drives had in the last step, whoever set them.

        ``floor`` [nd] are the least values in force.
        """
        count = len(readings.drive)
        self._readings, self._floor = readings, floor.tolist()
        self.values = [0.0] * count
        self.owned = [False] * count
        self.row: Array = np.zeros(count)
        self.mask = np.zeros(count, dtype=bool)
        self.any = self.all = False

    def set(self, column: int, value: float, *, owned: bool = True) -> None:
        """Give a drive a value of its own, or let it follow its signal again."""
        value = max(value, self._floor[column])
        self.values[column], self.owned[column] = value, owned
        self.row[column], self.mask[column] = value, owned
        self.any, self.all = any(self.owned), all(self.owned)

    def taken(self, column: int) -> float:
        """The value that a drive has now, and keeps from now on."""
        if not self.owned[column]:
            self.set(column, float(self._readings.drive[column]))
        return self.values[column]

    def overlay(self, rows: Array) -> None:
        """Put what is set into rows [n, nd] of drive values."""
        if self.all:
            rows[:] = self.row
        elif self.any:
            np.copyto(rows, self.row, where=self.mask)


@dataclass
class ControlLoop:
    """A controller of a run: what it reads, its law, what it sets."""

    name: str
    reads: Sequence[str]
    readings: list[Read]
    targets: list[Setpoint]
    law: Law
    bounds: list[Bound]
    drives: list[str]  # names of the drives that it sets
    every: int  # steps between its acts
    desk: Desk
    active: bool = False
    run: Act = field(init=False)
    """Acts at an instant [s] and number; does nothing while the loop is switched off."""
    away_first: float = math.nan  # its largest distance from a target when it began; nan before

    def __post_init__(self) -> None:
        alone = len(self.readings) == len(self.targets) == len(self.bounds) == 1
        self._act = _single(self) if alone else _several(self)
        self.switch(on=self.active)

    def switch(self, *, on: bool) -> None:
        """Let it act or not; switched on, it begins anew with what its drives have then."""
        if on != self.active or not hasattr(self, "run"):
            self.run = self._begin if on else _idle
        self.active = on

    def _begin(self, t: float, number: int) -> None:
        """Begin with what the drives have now, then act."""
        inputs = [self.desk.taken(bound.column) for bound in self.bounds]
        self.refuse(t, inputs)
        self.law.begin([read() for read in self.readings],
                       [target.at(number) for target in self.targets], inputs)
        self.away_first = self.away(number)
        self.run = self._act
        self._act(t, number)

    def away(self, number: int) -> float:
        """The largest distance of a reading from its target; 0 without targets, inf for a nan."""
        distances = [abs(target.at(number) - read())
                     for target, read in zip(self.targets, self.readings, strict=False)]
        return math.inf if any(map(math.isnan, distances)) else max(distances, default=0.0)

    def refuse(self, t: float, wanted: Sequence[float]) -> None:
        """Raise SimulationDiverged if something that is read or wanted is not a number."""
        for text, read in zip(self.reads, self.readings, strict=True):
            if not math.isfinite(value := read()):
                raise SimulationDiverged(t, self.name, f"it reads {text}, which is {value}")
        for drive, value in zip(self.drives, wanted, strict=True):
            if not math.isfinite(value):
                raise SimulationDiverged(t, self.name, f"it wants {value} of {drive}")


def _idle(t: float, number: int) -> None:
    pass

def _single(loop: ControlLoop) -> Act:
    (read,), (target,), (bound,) = loop.readings, loop.targets, loop.bounds
    column, most, low, high = bound.column, bound.most, bound.low, bound.high
    law, values, row = loop.law.act, loop.desk.values, loop.desk.row

    def act(t: float, number: int) -> None:
        goal = target.fixed
        now = values[column]
        want, = law(t, (read(),), (target.at(number) if goal is None else goal,), (now,))
        if not now - most <= want <= now + most:
            loop.refuse(t, (want,))
            want = now + most if want > now else now - most
        values[column] = row[column] = high if want > high else low if want < low else want

    return act


def _several(loop: ControlLoop) -> Act:
    law, values, row = loop.law.act, loop.desk.values, loop.desk.row
    readings, targets = loop.readings, loop.targets
    columns = [bound.column for bound in loop.bounds]
    bounds = [(bound.column, bound.most, bound.low, bound.high) for bound in loop.bounds]

    def act(t: float, number: int) -> None:
        goals = [target.at(number) if target.fixed is None else target.fixed
                 for target in targets]
        wanted = law(t, [read() for read in readings], goals,
                     [values[column] for column in columns])
        for want, (column, most, low, high) in zip(wanted, bounds, strict=True):
            now = values[column]
            if not now - most <= want <= now + most:
                loop.refuse(t, wanted)
                want = now + most if want > now else now - most
            values[column] = row[column] = high if want > high else low if want < low else want

    return act
