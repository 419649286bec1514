"""Control while a run goes on: controllers and events, between steps.

At one instant events come first, then controllers; what one writes the next one can read only after
a step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from sandbox.elements.controllers.controller import Law, every
from sandbox.elements.controllers.custom import Custom, StopRun
from sandbox.elements.registry import Controller
from sandbox.engine.bonds import hold
from sandbox.engine.control_loop import ANY, Bound, ControlLoop, Desk, Setpoint
from sandbox.engine.inputs import Clock
from sandbox.engine.readings import Readings
from sandbox.errors import SimulationDiverged
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.samples.outcome import Happened, Stop
from sandbox.scene.settings import Event, first_step
from sandbox.values.expressions import Read

NEVER = 1 << 62
"""A step that no run comes to."""


@dataclass(frozen=True)
class Pending:
    """An event that has not happened yet."""

    event: Event
    first: int  # steps before it may happen
    every: int  # steps between two looks at its condition
    condition: Read | None


class Steering:
    """All controllers and events of one run; ``desk`` holds what they have set."""

    def __init__(
        self, model: Model, clock: Clock, readings: Readings, customs: Sequence[Custom] = (),
    ) -> None:
        self.model, self.clock, self.readings = model, clock, readings
        self.mechanism = mechanism = model.mechanism
        self._column = model.names.drive
        self.desk = Desk(readings, model.drives.floor)
        self.loops = [self._loop(spec) for spec in (*mechanism.controllers, *customs)]
        self._groups = [(each, [loop for loop in self.loops if loop.every == each])
                        for each in sorted({loop.every for loop in self.loops})]
        self._by_name = {loop.name: loop for loop in self.loops}
        self._waiting = [self._pending(event) for event in mechanism.events]
        self._endings: list[tuple[int, Callable[[], None]]] = []
        self._in_force: dict[str, list[Callable[[], None]]] = {}
        """What gives back a name's first value, then what events have set it to, in order."""
        self.happened: list[dict[str, Any]] = []
        self.stopped: Stop | None = None
        self._stride = math.gcd(*(loop.every for loop in self.loops)) or NEVER

    def __bool__(self) -> bool:
        return bool(self.loops or self.mechanism.events or self._waiting or self._endings)

    # -- building -------------------------------------------------------------------

    def _loop(self, spec: Controller | Custom) -> ControlLoop:
        count = every(spec.rate, self.clock.step)
        period, targets, active = count * self.clock.step, [], True
        law: Law
        ranges: Any
        if isinstance(spec, Custom):
            reads, writes, ranges, law = spec.reads, spec.writes, spec.limits, spec.law()
        else:
            reads, writes, ranges, active = spec.readings, spec.written, spec.ranges, spec.active
            law = spec.make_law(self.mechanism, period)
            targets = [Setpoint(signal, period, (self.clock.steps - 1) // count,
                                self.mechanism.functions) for signal in spec.signals]
        rates: Any = [spec.slew] if isinstance(spec.slew, float) else spec.slew
        bounds = []
        for j, drive in enumerate(writes):
            low, high = ranges[j] if ranges else (-math.inf, math.inf)
            column = self._column[drive]
            # the law is given what is in force, or it would wind up below
            floor = float(self.model.drives.floor[column])
            low, high = max(low, floor), max(high, floor)
            most = min(rates[j] * period, ANY) if rates else ANY
            bounds.append(Bound(column, most, low, high))
        return ControlLoop(
            spec.name, reads, [self.readings.of(text) for text in reads], targets, law, bounds,
            list(writes), count, self.desk, active)

    def _pending(self, event: Event) -> Pending:
        step = self.clock.step
        return Pending(event, first_step(event, step), every(event.rate, step),
                       None if event.when is None else self.readings.of(event.when))

    def add(self, event: Event) -> None:
        """Wait for one event more, after those of the scene."""
        self._waiting.append(self._pending(event))

    def writer(self, drive: str) -> str:
        """The controller or event that sets a drive at some time; empty if none does."""
        owners = [loop.name for loop in self.loops if drive in loop.drives]
        owners += [event.name for event in self.mechanism.events if drive in event.set]
        return owners[0] if owners else ""

    # -- the loop's side --------------------------------------------------------------

    def ahead(self, done: int) -> int:
        """How many steps may be made after ``done`` before something may act again."""
        nearest = self._stride - done % self._stride
        for pending in self._waiting:
            if pending.condition is None or done < pending.first:
                nearest = min(nearest, pending.first - done)
            else:
                nearest = min(nearest, pending.every - done % pending.every)
        for step, _ in self._endings:
            nearest = min(nearest, step - done)
        return max(1, nearest)

    def moved(self, done: int, drive: Array) -> None:
        """Say that ``done`` steps are made, the last one with ``drive`` [nd]."""
        readings = self.readings
        readings.now, readings.drive, readings.listed = done * self.clock.step, drive, None

    def act(self, done: int) -> None:
        """Let events happen and controllers act that are due after ``done`` steps."""
        for step, end in [ending for ending in self._endings if ending[0] <= done]:
            end()
            self._endings.remove((step, end))
        for pending in list(self._waiting):
            if self._due(pending, done):
                self._waiting.remove(pending)
                self._happen(pending.event, done)
        t = done * self.clock.step
        for each, loops in self._groups:
            number, more = divmod(done, each)
            if more:
                continue
            for loop in loops:
                try:
                    loop.run(t, number)
                except StopRun as wish:  # asked once: it may go on to the first sample
                    loop.switch(on=False)
                    self._stop(Stop(loop.name, wish.verdict, t, wish.because))

    # -- events -----------------------------------------------------------------------

    def _due(self, pending: Pending, done: int) -> bool:
        """Whether an event happens now; SimulationDiverged if its condition has no value."""
        if done < pending.first or pending.condition is None:
            return done >= pending.first
        if done % pending.every:
            return False
        value, event = pending.condition(), pending.event
        if math.isnan(value):
            raise SimulationDiverged(
                done * self.clock.step, event.name, f"its condition {event.when} has no value")
        return value > 0

    def _happen(self, event: Event, done: int) -> None:
        self.happened.append({"event": event.name, "time_s": done * self.clock.step})
        ends = [self._set(name, value) for name, value in event.set.items()]
        for names, held in ((event.release, False), (event.take_up, True)):
            for bond in map(self.model.bonds.name.index, names):
                hold(self.readings.tables, bond, held=held)
                ends.append(partial(hold, self.readings.tables, bond, held=not held))
        if event.lasts is not None:
            def end() -> None:
                for one in ends:
                    one()

            self._endings.append((done + max(1, round(event.lasts / self.clock.step)), end))
        if event.stop is not None:
            self._stop(Stop(event.name, event.stop, done * self.clock.step, event.because))

    def _stop(self, stop: Stop) -> None:
        """End the run; of several stops the first counts, but one that fails it before all."""
        if stop.verdict == "fail" or self.stopped is None:
            self.stopped = stop

    def _set(self, name: str, value: float) -> Callable[[], None]:
        """Set a drive, a target or a switch; what ends that. The last unended event counts."""
        give, back = self._giver(name, value)
        stack = self._in_force.setdefault(name, [back])
        stack.append(give)
        give()

        def end() -> None:
            stack.remove(give)
            stack[-1]()

        return end

    def _giver(self, name: str, value: float) -> tuple[Callable[[], None], Callable[[], None]]:
        """What sets a name to a value, and what sets it to what it has now."""
        if name in self._column:
            column, desk = self._column[name], self.desk
            return partial(desk.set, column, value), partial(
                desk.set, column, desk.values[column], owned=desk.owned[column])
        head, _, what = name.rpartition(".")
        loop = self._by_name[head]
        if what == "target":
            target = loop.targets[0]
            return (partial(setattr, target, "fixed", value),
                    partial(setattr, target, "fixed", target.fixed))
        return partial(loop.switch, on=value != 0), partial(loop.switch, on=loop.active)

    # -- what is reported -------------------------------------------------------------------

    def furthest(self) -> str:
        """The loop that has gone furthest from its targets since it began, for a divergence."""
        done = round(self.readings.now / self.clock.step)

        def growth(loop: ControlLoop) -> float:
            return loop.away(done // loop.every) / max(loop.away_first, 1e-300)

        running = [loop for loop in self.loops if loop.active and not math.isnan(loop.away_first)]
        if not running:
            return ""
        worst = max(running, key=growth)
        signals = [f"{text} = {read():.4g}"
                   for text, read in zip(worst.reads, worst.readings, strict=True)]
        signals += [f"{drive} = {self.desk.values[bound.column]:.4g}"
                    for drive, bound in zip(worst.drives, worst.bounds, strict=True)]
        return f"controller {worst.name} ({', '.join(signals)})"

    def info(self) -> tuple[tuple[Happened, ...], Stop | None, dict[str, dict[str, Any]]]:
        """Events that happened, the one that stopped the run, and what laws found out."""
        events = tuple(Happened(each["event"], each["time_s"]) for each in self.happened)
        reports = {loop.name: report for loop in self.loops if (report := loop.law.report())}
        return events, self.stopped, reports
