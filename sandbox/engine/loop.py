"""One controller at work: readings in, law, rate limits and limits, drive values out.

A loop acts a thousand times a second and more, so what it does again and again is
bound once, in :func:`_single` for one reading and one drive, else in :func:`_several`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sandbox.control.law import Law
from sandbox.errors import SimulationDiverged
from sandbox.scene.closures import Read
from sandbox.scene.signals import AnySignal, Constant, values

Array = NDArray[np.float64]
Act = Callable[[float, int], None]

AHEAD = 4096
"""So many acts' targets are worked out in one go."""
ANY = 1e300
"""A change that no rate limit cuts; less than infinity, which is no value to be set."""


class Target:
    """A signal at the instants of a controller's acts, or the value that an event gave it."""

    def __init__(self, signal: AnySignal, period: float) -> None:
        self.signal, self.period = signal, period
        self.fixed: float | None = signal.constant if isinstance(signal, Constant) else None
        self._first, self._values = 0, np.zeros(0)

    def at(self, act: int) -> float:
        """The value for the act with this number, counted from 0 at t = 0."""
        if self.fixed is not None:
            return self.fixed
        if not self._first <= act < self._first + len(self._values):
            instants: Array = self.period * np.arange(act, act + AHEAD, dtype=np.float64)
            self._first, self._values = act, values(self.signal, instants)
        return float(self._values[act - self._first])


@dataclass(frozen=True)
class Bound:
    """What may be set of a drive."""

    column: int
    """Of the drive."""
    most: float = ANY
    """Largest change from one act to the next."""
    low: float = -math.inf
    high: float = math.inf


class Desk:
    """The drive values that controllers and events set, for the drives that they hold.

    ``values`` is a list, which is read and written fastest; ``row`` [nd] and
    ``mask`` [nd] are the same for the loop.
    """

    def __init__(self, count: int) -> None:
        self.values = [0.0] * count
        self.held = [False] * count
        self.row: Array = np.zeros(count)
        self.mask = np.zeros(count, dtype=bool)
        self.any = False

    def hold(self, column: int, value: float, *, held: bool = True) -> None:
        """Let a drive keep a value, or follow its signal again."""
        self.values[column], self.held[column] = value, held
        self.row[column], self.mask[column] = value, held
        self.any = any(self.held)


@dataclass
class Loop:
    """A controller of a run: what it reads, its law, what it sets."""

    name: str
    reads: Sequence[str]
    readings: list[Read]
    targets: list[Target]
    law: Law
    bounds: list[Bound]
    drives: list[str]
    """Names of the drives that it sets."""
    every: int
    """Steps between its acts."""
    active: bool
    started: bool = False
    errors: list[float] = field(default_factory=list)
    """Its largest distance from a target when it began, and lately."""

    def begin(self, t: float, number: int, inputs: list[float]) -> None:
        """Begin, or begin anew, with what the drives have now.

        Raises:
            SimulationDiverged: a reading is not a number.
        """
        readings = [read() for read in self.readings]
        self.refuse(t, inputs)
        self.law.begin(readings, [target.at(number) for target in self.targets], inputs)
        self.started = True
        self.errors = [self.away(number)]

    def away(self, number: int) -> float:
        """The largest distance of a reading from its target; 0 without targets."""
        return max((abs(target.at(number) - read())
                    for target, read in zip(self.targets, self.readings, strict=False)),
                   default=0.0)

    def actor(self, desk: Desk) -> Act:
        """What acts for this loop at an instant [s] and number, once it has begun."""
        if len(self.readings) == len(self.targets) == len(self.bounds) == 1:
            return _single(self, desk)
        return _several(self, desk)

    def refuse(self, t: float, wanted: Sequence[float]) -> None:
        """Give up if something that is read or wanted is not a number.

        Raises:
            SimulationDiverged: with what it is, and this controller's name.
        """
        for text, read in zip(self.reads, self.readings, strict=True):
            if not math.isfinite(value := read()):
                raise SimulationDiverged(t, self.name, f"it reads {text}, which is {value}")
        for drive, value in zip(self.drives, wanted, strict=True):
            if not math.isfinite(value):
                raise SimulationDiverged(t, self.name, f"it wants {value} of {drive}")


def _single(loop: Loop, desk: Desk) -> Act:
    (read,), (target,), (bound,) = loop.readings, loop.targets, loop.bounds
    column, most, low, high = bound.column, bound.most, bound.low, bound.high
    law, values, row = loop.law.act, desk.values, desk.row

    def act(t: float, number: int) -> None:
        goal = target.fixed
        now = values[column]
        want, = law(t, (read(),), (target.at(number) if goal is None else goal,), (now,))
        if not now - most <= want <= now + most:
            loop.refuse(t, (want,))
            want = now + most if want > now else now - most
        values[column] = row[column] = high if want > high else low if want < low else want

    return act


def _several(loop: Loop, desk: Desk) -> Act:
    law, values, row = loop.law.act, desk.values, desk.row
    columns = [bound.column for bound in loop.bounds]

    def act(t: float, number: int) -> None:
        wanted = law(t, [read() for read in loop.readings],
                     [target.at(number) for target in loop.targets],
                     [values[column] for column in columns])
        for want, bound in zip(wanted, loop.bounds, strict=True):
            now, most = values[bound.column], bound.most
            if not now - most <= want <= now + most:
                loop.refuse(t, wanted)
                want = now + most if want > now else now - most
            values[bound.column] = row[bound.column] = min(max(want, bound.low), bound.high)

    return act
