"""Control during a run: controllers and events, between steps.

At one instant events come first, then controllers. What one writes the next one can read only after
a step. A controller may act thousands of times a second, so :func:`_single` and :func:`_several`
bind what its acts need once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from sandbox.elements.controllers.controller import Law, every
from sandbox.elements.controllers.custom import Custom, CustomController, StopRun
from sandbox.elements.registry import Controller
from sandbox.engine.bonds import hold
from sandbox.engine.inputs import Clock, signal_values
from sandbox.engine.sampler import Readings
from sandbox.errors import SimulationDiverged
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.samples.outcome import Happened, Stop
from sandbox.scene.settings import Event, first_step
from sandbox.values.expressions import Read
from sandbox.values.signals import AnySignal, Constant
from sandbox.values.tables import Tables

Act = Callable[[float, int], None]
NEVER = 1 << 62  # a step that no run reaches
CHUNK = 4096  # acts whose targets are computed at once
UNLIMITED = 1e300  # a change that no rate limit cuts; less than infinity, which cannot be set


class Setpoint:
    """A signal at the instants of a controller's acts, or the value that an event has set."""

    def __init__(self, signal: AnySignal, period: float, last: int, tables: Tables) -> None:
        self.signal, self.period, self.last, self.tables = signal, period, last, tables
        self.fixed: float | None = signal.constant if isinstance(signal, Constant) else None
        self._first = 0
        self._values: list[float] = []

    def at(self, act: int) -> float:
        """The value for an act, counted from 0 at t = 0."""
        if self.fixed is not None:
            return self.fixed
        if not self._first <= act < self._first + len(self._values):
            stop = min(act + CHUNK, max(act, self.last) + 1)
            times = self.period * np.arange(act, stop, dtype=float)
            self._first, self._values = act, signal_values(
                "a controller's target", self.signal, times, self.tables).tolist()
        return self._values[act - self._first]


class DriveValues:
    """The drive values that controllers and events set, as a list and as rows for the engine."""

    def __init__(self, readings: Readings, floor: Array) -> None:
        self._readings, self._floor = readings, floor.tolist()
        self.values = [0.0] * len(floor)
        self.row: Array = np.zeros(len(floor))
        self.owned = np.zeros(len(floor), dtype=bool)
        self.any = self.all = False

    def set(self, column: int, value: float, owned: bool = True) -> None:
        """Set a drive, or let it follow its signal again."""
        self.values[column] = self.row[column] = max(value, self._floor[column])
        self.owned[column] = owned
        self.any, self.all = bool(self.owned.any()), bool(self.owned.all())

    def overlay(self, rows: Array) -> None:
        """Put what is set into rows [n, nd] of drive values."""
        if self.all:
            rows[:] = self.row
        elif self.any:
            np.copyto(rows, self.row, where=self.owned)

    def take(self, column: int) -> float:
        """The value that a drive has now; it keeps that until it is set."""
        if not self.owned[column]:
            self.set(column, float(self._readings.drive[column]))
        return self.values[column]


class ControlLoop:
    """A controller of a run: what it reads, its law, the drives that it sets."""

    def __init__(
        self, spec: Controller | CustomController, model: Model, clock: Clock, readings: Readings,
        drives: DriveValues,
    ) -> None:
        self.name, self.every, self.values = spec.name, every(spec.rate, clock.step), drives
        period, ranges = self.every * clock.step, spec.ranges
        self.reads, self.drives = spec.readings, list(spec.written)
        self.law: Law = spec.make_law(model.mechanism, period)
        self.targets = [Setpoint(signal, period, (clock.steps - 1) // self.every,
                                 model.mechanism.functions) for signal in spec.signals]
        self.readings = [readings.of(text) for text in self.reads]
        rates: Any = [spec.slew] if isinstance(spec.slew, float) else spec.slew
        self.bounds: list[tuple[int, float, float, float]] = []  # column, largest change, low, high
        for j, drive in enumerate(self.drives):
            low, high = ranges[j] if ranges else (-math.inf, math.inf)
            column = model.names.drive[drive]
            # the law gets the value in force, or it would wind up below the floor
            floor = float(model.drives.floor[column])
            change = min(rates[j] * period, UNLIMITED) if rates else UNLIMITED
            self.bounds.append((column, change, max(low, floor), max(high, floor)))
        alone = len(self.readings) == len(self.targets) == len(self.bounds) == 1
        self._act = _single(self) if alone else _several(self)
        self.start_error = math.nan  # its largest distance from a target when it began
        self.active = spec.active
        self.run: Act = self._begin if self.active else _idle  # acts; nothing if switched off

    def switch(self, on: bool) -> None:
        """Switch it on or off; switched on, it begins anew with the values of its drives then."""
        if on != self.active:
            self.active, self.run = on, self._begin if on else _idle

    def _begin(self, t: float, number: int) -> None:
        inputs = [self.values.take(column) for column, *_ in self.bounds]
        self.refuse(t, inputs)
        self.law.begin([read() for read in self.readings],
                       [target.at(number) for target in self.targets], inputs)
        self.start_error = self.error(number)
        self.run = self._act
        self._act(t, number)

    def error(self, number: int) -> float:
        """The largest distance of a reading from its target; 0 without targets, inf for a nan."""
        distances = [abs(target.at(number) - read())
                     for target, read in zip(self.targets, self.readings, strict=False)]
        return math.inf if any(map(math.isnan, distances)) else max(distances, default=0.0)

    def refuse(self, t: float, outputs: Sequence[float]) -> None:
        """Raise SimulationDiverged if a reading or an output is not finite."""
        for text, read in zip(self.reads, self.readings, strict=True):
            if not math.isfinite(value := read()):
                raise SimulationDiverged(t, self.name, f"it reads {text}, which is {value}")
        for drive, value in zip(self.drives, outputs, strict=True):
            if not math.isfinite(value):
                raise SimulationDiverged(t, self.name, f"it sets {drive} to {value}")


def _idle(t: float, number: int) -> None:
    pass


def _single(loop: ControlLoop) -> Act:
    (read,), (target,), ((column, change, low, high),) = loop.readings, loop.targets, loop.bounds
    law, values, row = loop.law.act, loop.values.values, loop.values.row

    def act(t: float, number: int) -> None:
        goal = target.fixed
        now = values[column]
        new, = law(t, (read(),), (target.at(number) if goal is None else goal,), (now,))
        if not now - change <= new <= now + change:
            loop.refuse(t, (new,))
            new = now + change if new > now else now - change
        values[column] = row[column] = high if new > high else low if new < low else new

    return act


def _several(loop: ControlLoop) -> Act:
    law, values, row = loop.law.act, loop.values.values, loop.values.row
    readings, targets, bounds = loop.readings, loop.targets, loop.bounds

    def act(t: float, number: int) -> None:
        goals = [target.at(number) if target.fixed is None else target.fixed for target in targets]
        outputs = law(t, [read() for read in readings], goals,
                      [values[bound[0]] for bound in bounds])
        for new, (column, change, low, high) in zip(outputs, bounds, strict=True):
            now = values[column]
            if not now - change <= new <= now + change:
                loop.refuse(t, outputs)
                new = now + change if new > now else now - change
            values[column] = row[column] = high if new > high else low if new < low else new

    return act


class Control:
    """All controllers and events of one run; ``drives`` holds what they have set."""

    def __init__(
        self, model: Model, clock: Clock, readings: Readings, customs: Sequence[Custom],
    ) -> None:
        self.model, self.clock, self.readings = model, clock, readings
        self.mechanism = mechanism = model.mechanism
        self.drives = DriveValues(readings, model.drives.floor)
        self.loops = [ControlLoop(spec, model, clock, readings, self.drives)
                      for spec in (*mechanism.controllers, *(each.controller for each in customs))]
        self._groups = [(each, [loop for loop in self.loops if loop.every == each])
                        for each in sorted({loop.every for loop in self.loops})]
        self._stride = math.gcd(*(loop.every for loop in self.loops)) or NEVER
        self._waiting: list[tuple[Event, int, int, Read | None]] = []
        """Events to come: the steps before each, those between checks of its condition, that."""
        for event in mechanism.events:
            self.add(event)
        self._endings: list[tuple[int, list[Callable[[], None]]]] = []
        self._in_force: dict[str, dict[object, tuple[Any, ...]]] = {}
        """Of each name that events set its first state, then the states that they set."""
        self.happened: list[Happened] = []
        self.stopped: Stop | None = None

    def __bool__(self) -> bool:
        return bool(self.loops or self.mechanism.events or self._waiting or self._endings)

    def add(self, event: Event) -> None:
        """Wait for one more event, after those of the scene."""
        step = self.clock.step
        self._waiting.append((event, first_step(event, step), every(event.rate, step),
                              None if event.when is None else self.readings.of(event.when)))

    def writer(self, drive: str) -> str:
        """The controller or event that sets a drive at some time; empty if none does."""
        return next((owner.name for owner in (*self.loops, *self.mechanism.events)
                     if drive in (owner.drives if isinstance(owner, ControlLoop) else owner.set)),
                    "")

    def ahead(self, done: int) -> int:
        """How many steps may be made after ``done`` before something may act again."""
        nearest = self._stride - done % self._stride
        for _, first, between, condition in self._waiting:
            nearest = min(nearest, first - done if condition is None or done < first
                          else between - done % between)
        for step, _ in self._endings:
            nearest = min(nearest, step - done)
        return max(1, nearest)

    def moved(self, done: int, drive: Array) -> None:
        """Note that ``done`` steps are made, the last one with ``drive`` [nd]."""
        readings = self.readings
        readings.now, readings.drive, readings.listed = done * self.clock.step, drive, None

    def act(self, done: int) -> None:
        """Let events happen and controllers act that are due after ``done`` steps."""
        for ending in [ending for ending in self._endings if ending[0] <= done]:
            for end in ending[1]:
                end()
            self._endings.remove(ending)
        t = done * self.clock.step
        for pending in list(self._waiting):
            event, first, between, condition = pending
            due = done >= first
            if due and condition is not None:
                value = 0.0 if done % between else condition()
                if math.isnan(value):
                    raise SimulationDiverged(
                        t, event.name, f"its condition {event.when} has no value")
                due = value > 0
            if due:
                self._waiting.remove(pending)
                self._happen(event, done, t)
        for each, loops in self._groups:
            number, more = divmod(done, each)
            for loop in () if more else loops:
                try:
                    loop.run(t, number)
                except StopRun as request:  # the run may go on to its first sample without it
                    loop.switch(False)
                    self._stop(Stop(loop.name, request.verdict, t, request.because))

    def _happen(self, event: Event, done: int, t: float) -> None:
        self.happened.append(Happened(event.name, t))
        ends = [self._set(name, value) for name, value in event.set.items()]
        for names, held in ((event.release, False), (event.take_up, True)):
            for bond in map(self.model.bonds.name.index, names):
                hold(self.readings.sampler.tables, bond, held=held)
                ends.append(partial(hold, self.readings.sampler.tables, bond, held=not held))
        if event.lasts is not None:
            self._endings.append((done + max(1, round(event.lasts / self.clock.step)), ends))
        if event.stop is not None:
            self._stop(Stop(event.name, event.stop, t, event.because))

    def _stop(self, stop: Stop) -> None:
        """End the run; of several stops the first counts, but one that fails it before all."""
        if stop.verdict == "fail" or self.stopped is None:
            self.stopped = stop

    def _set(self, name: str, value: float) -> Callable[[], None]:
        """Set a drive, a target or a switch. The result ends that: the last event counts then."""
        head, _, what = name.rpartition(".")
        put: Callable[..., None]
        now: tuple[Any, ...]
        new: tuple[Any, ...]
        if name in self.model.names.drive:
            column, drives = self.model.names.drive[name], self.drives
            put = partial(drives.set, column)
            now, new = (drives.values[column], bool(drives.owned[column])), (value, True)
        else:
            loop = next(loop for loop in self.loops if loop.name == head)
            if what == "target":
                target = loop.targets[0]
                put, now, new = partial(setattr, target, "fixed"), (target.fixed,), (value,)
            else:
                put, now, new = loop.switch, (loop.active,), (value != 0,)
        states, key = self._in_force.setdefault(name, {None: now}), object()
        states[key] = new
        put(*new)

        def end() -> None:
            del states[key]
            put(*list(states.values())[-1])

        return end

    def furthest(self) -> str:
        """The loop whose error has grown most since it began, for a divergence."""
        done = round(self.readings.now / self.clock.step)
        running = [loop for loop in self.loops if loop.active and not math.isnan(loop.start_error)]
        if not running:
            return ""
        worst = max(running, key=lambda loop: (
            loop.error(done // loop.every) / max(loop.start_error, 1e-300)))
        signals = [f"{text} = {read():.4g}"
                   for text, read in zip(worst.reads, worst.readings, strict=True)]
        signals += [f"{drive} = {self.drives.values[bound[0]]:.4g}"
                    for drive, bound in zip(worst.drives, worst.bounds, strict=True)]
        return f"controller {worst.name} ({', '.join(signals)})"
