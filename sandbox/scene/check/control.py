"""Names and times of controllers and events that must lead somewhere."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from sandbox.elements.controllers.controller import every
from sandbox.elements.registry import Controller
from sandbox.errors import Problem
from sandbox.scene.events import Event, first_step
from sandbox.scene.mechanism import Mechanism
from sandbox.values.expressions import parse_expression
from sandbox.values.paths import path_text
from sandbox.values.units import size_fault
from sandbox.wording import NearMisses, listed, quoted

MOST_LOOKS = 500_000
"""At conditions of the time, of all events: what is tried before a run."""
WHOLE = 1e-6
"""How far from a whole number the steps between two acts may be, for a rate given as decimals."""


def check_control(
    mechanism: Mechanism, assumed: Callable[[str], bool],
) -> Iterator[Problem]:
    """Drives that nobody has or two write, rates that no step divides, events that cannot be.

    ``assumed`` are names that count as known although they were not read.
    """
    near = NearMisses()
    drives = dict.fromkeys(drive.name for drive in mechanism.drives)
    owners: dict[str, str] = {}
    for i, controller in enumerate(mechanism.controllers):
        path = f"$.controllers[{i}]"
        yield from rate_problems(controller.rate, mechanism.run.step, f"{path}.rate")
        alone = isinstance(getattr(controller, "writes", None), str)
        for j, name in enumerate(controller.written):
            place = f"{path}.writes" if alone else f"{path}.writes[{j}]"
            if name not in drives and not assumed(name):
                yield Problem("name-not-found", f"there is no drive named {quoted(name)} to write",
                              place, allowed=listed(drives) or "none: the scene has no drives",
                              hint=near(name, drives))
            elif name in owners:
                yield Problem("set-twice", f"the drive {quoted(name)} is written already, by "
                              f"{owners[name]}", place, allowed="one controller for each drive")
            owners.setdefault(name, f"the controller {quoted(controller.name)}")
    settable = dict.fromkeys(_settable(mechanism.controllers))
    known = {**drives, **settable}
    for i, event in enumerate(mechanism.events):
        yield from _times(event, mechanism, f"$.events[{i}]")
        for name, value in event.set.items():
            path = path_text(("events", i, "set", name))
            if name in owners:
                yield Problem("set-twice", f"{quoted(name)} is written by {owners[name]}, which "
                              "would set it again", path, allowed="a drive without a controller, "
                              "or <controller>.target or .active")
            elif name not in known and not assumed(name):
                yield Problem("name-not-found", f"there is nothing named {quoted(name)} to set",
                              path, allowed=listed(known) or "none: there are no drives",
                              hint=near(name, known))
            elif name.endswith(".active") and name in settable and value not in (0.0, 1.0):
                yield Problem("out-of-range", f"{quoted(name)} is 0 or 1, not {value:g}", path)


def _settable(controllers: tuple[Controller, ...]) -> list[str]:
    """What events may set of controllers."""
    names = []
    for controller in controllers:
        names.append(f"{controller.name}.active")
        if len(controller.signals) == 1:
            names.append(f"{controller.name}.target")
    return names


def rate_problems(rate: float | None, step: float, path: str) -> Iterator[Problem]:
    """A rate [Hz] that steps of ``step`` [s] cannot keep."""
    if rate is None:
        return
    if fault := size_fault(rate, "frequency"):
        yield Problem("bad-rate", f"as a rate this is {fault}", path)
        return
    count = 1 / (rate * step)
    if count < 1 - WHOLE:
        yield Problem("bad-rate", f"{rate:g} Hz is more often than every step of {step:g} s", path,
                      allowed=f"at most {1 / step:g} Hz")
    elif abs(count - round(count)) > WHOLE * count:
        below, above = 1 / (step * (int(count) + 1)), 1 / (step * int(count))
        yield Problem("bad-rate",
                      f"{rate:g} Hz is no whole number of steps: one act every {count:.6g} steps "
                      f"of {step:g} s", path, allowed=f"{above:.6g} Hz or {below:.6g} Hz")


def _times(event: Event, mechanism: Mechanism, path: str) -> Iterator[Problem]:
    """An event that cannot happen during the run, or that lasts without anything to undo."""
    duration, step = mechanism.run.duration, mechanism.run.step
    yield from rate_problems(event.rate, step, f"{path}.rate")
    key = "at" if event.at is not None else "after"
    start = event.at if event.at is not None else event.after
    first = first_step(event, step)
    if event.when is not None:
        first += -first % every(event.rate, step)
    if start >= duration:
        yield Problem("event-never-happens", "this event can never happen: the run ends at "
                      f"{duration:g} s", f"{path}.{key}", allowed=f"less than {duration:g} s")
    elif first > 0 and first >= math.ceil(duration / step - 1e-9):
        yield Problem("event-never-happens",
                      f"this event can never happen: it would be due at {first * step:g} s, after "
                      "the run's last step has begun", f"{path}.{key}", allowed="an earlier time")
    if event.when is not None and not parse_expression(event.when).names:
        yield Problem("event-never-happens",
                      f"the condition {quoted(event.when)} reads nothing, so it never changes",
                      f"{path}.when", allowed="a condition of quantities or of the time t, such "
                      'as "=finger.mcp.angle > 0.5"')
    elif event.when is not None and _never(event.when, first, every(event.rate, step), mechanism):
        yield Problem("event-never-happens", f"this event can never happen: {quoted(event.when)} "
                      f"is true at no time of the run, which ends at {duration:g} s",
                      f"{path}.when", allowed="a condition that becomes true")
    if event.lasts is not None and not (event.set or event.release or event.take_up):
        yield Problem("conflicting-keys", "'lasts' needs 'set', 'release' or 'take_up'",
                      f"{path}.lasts")


def _never(when: str, first: int, every_steps: int, mechanism: Mechanism) -> bool:
    """Whether a condition of nothing but the time is false whenever it is looked at.

    If that is more than :data:`MOST_LOOKS` times, nothing is said of it.
    """
    condition = parse_expression(when)
    if condition.names != {"t"}:
        return False
    step = mechanism.run.step
    last = math.ceil(mechanism.run.duration / step - 1e-9)
    if (last - first) / every_steps * len(mechanism.events) > MOST_LOOKS:
        return False
    looks = step * np.arange(first, last, every_steps)
    try:
        return len(looks) > 0 and not np.any(np.asarray(condition.evaluate(
            {**mechanism.functions, "t": looks})) > 0)
    except ValueError:  # no number somewhere, and perhaps true elsewhere
        return False
