"""Control: names of drives, times and rates, units.

Fields of controllers and events take any unit: the dimension depends on the drive that they write,
or on the quantity that they read. Their numbers keep their unit
(:class:`sandbox.values.units.Measured`) until every element is known.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from typing import Any

from sandbox.elements.controllers.controller import every
from sandbox.elements.quantities import QUANTITIES
from sandbox.errors import Problem
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import Event, first_step
from sandbox.values.expressions import parse_expression
from sandbox.values.numbers import NAME
from sandbox.values.paths import path_text
from sandbox.values.spec import Spec
from sandbox.values.units import UNITS, Measured, factor_of, size_fault
from sandbox.wording import NearMisses, WrongValueError, listed, quoted

READINGS = {name.rpartition(".")[2]: UNITS[quantity.unit][1]
            for rows in QUANTITIES.values() for name, quantity in rows.items()
            if quantity.live and quantity.unit in UNITS}
"""Dimensions of the quantities that can be read, by the last word of their names."""
Place = tuple[str, float | None, str | None]
"""A path, the number there, and its required dimension; None if unknown."""
WHOLE = 1e-6
"""Relative deviation of the steps between two acts from a whole number: a rate in decimals."""


def check_control(mechanism: Mechanism, assumed: Callable[[str], bool]) -> Iterator[Problem]:
    """Drives, rates and events that are unknown or impossible; ``assumed`` names count as known."""
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
    settable = dict.fromkeys(
        f"{law.name}.{word}" for law in mechanism.controllers
        for word in ("active", *(["target"] if len(law.signals) == 1 else [])))
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
    """An event that cannot happen during the run, or that lasts without anything to reverse."""
    duration, step = mechanism.run.duration, mechanism.run.step
    yield from rate_problems(event.rate, step, f"{path}.rate")
    key = "at" if event.at is not None else "after"
    first, last = first_step(event, step), math.ceil(duration / step - 1e-9)
    if event.when is not None:
        first += -first % every(event.rate, step)
    if 0 < first >= last:
        yield Problem("event-never-happens", "this event can never happen: it would be due at "
                      f"{first * step:g} s, and the run ends at {duration:g} s", f"{path}.{key}",
                      allowed="an earlier time")
    if event.when is not None and not parse_expression(event.when).names:
        yield Problem("event-never-happens", f"the condition {quoted(event.when)} reads nothing, "
                      "so it never changes", f"{path}.when", allowed="a condition of quantities "
                      'or of the time t, such as "=finger.mcp.angle > 0.5"')
    if event.lasts is not None and not (event.set or event.release or event.take_up):
        yield Problem("conflicting-keys", "'lasts' needs 'set', 'release' or 'take_up'",
                      f"{path}.lasts")


def check_units(mechanism: Mechanism) -> Iterator[Problem]:
    """Quantities of control with a unit of another dimension than the one set or read."""
    for path, value, dimension in _measured(mechanism):
        if dimension is not None and isinstance(value, Measured):
            try:
                factor_of(value.unit, dimension)
            except WrongValueError as error:
                yield Problem.of(error, path)


def _measured(mechanism: Mechanism) -> Iterator[Place]:
    """The values of drives, controllers and events with the dimensions that they must have."""
    drives = {each.name: each.dimension(mechanism) for each in reversed(mechanism.drives)}
    meters = {meter.name for meter in mechanism.meters}
    targets: dict[str, list[str | None]] = {}
    for i, drive in enumerate(mechanism.drives):
        if drive.value is not None:  # only those of stiffnesses are not checked by their models
            yield from _values(f"$.drives[{i}].value", drive.value, drive.dimension(mechanism))
    for i, law in enumerate(mechanism.controllers):
        # of an expression, a pair or a meter the dimension is not known
        wanted = [drives.get(name) for name in law.written] if law.sets_target else [
            READINGS.get(text.rpartition(".")[2]) if "." in text and text not in meters
            and re.fullmatch(NAME, text) else None for text in law.readings]
        path, alone = f"$.controllers[{i}]", isinstance(law.writes, str)
        targets.setdefault(law.name, wanted)
        for key in ("limits", *law.of_drive):  # one entry for each drive
            given = getattr(law, key)
            for j, (name, entry) in enumerate(zip(
                    law.written, (given,) if alone else given or (), strict=False)):
                yield from _values(f"{path}.{key}" if alone else f"{path}.{key}[{j}]", entry,
                                    drives.get(name))
        for key in law.of_reading:
            yield f"{path}.{key}", getattr(law, key), wanted[0]
        for j, (target, dimension) in enumerate(zip(law.signals, wanted, strict=False)):
            index = f"[{j}]" if law.target_key == "targets" else ""
            yield from _values(f"{path}.{law.target_key}{index}", target, dimension)
    for i, event in enumerate(mechanism.events):
        for name, value in event.set.items():
            controller, _, key = name.rpartition(".")
            dimension = drives.get(name)
            if name not in drives and key == "target":
                dimension = next(iter(targets.get(controller, ())), None)
            yield path_text(("events", i, "set", name)), value, dimension


def _values(path: str, value: Any, dimension: str | None) -> Iterator[Place]:
    """The number of a field, or all those of a list or a signal."""
    if isinstance(value, Spec):
        kind = type(value).__name__.lower()
        for name, field in type(value).model_fields.items():
            yield from _values(f"{path}.{kind}.{field.alias or name}", getattr(value, name),
                               dimension)
    elif isinstance(value, tuple):
        for i, entry in enumerate(value):
            yield from _values(f"{path}[{i}]", entry, dimension)
    else:
        yield path, value, dimension
