"""Units around control: what a controller or an event sets is in the unit of its drive.

The fields of controllers and events take any unit, since only the drive that they
write, or the quantity that they read, says which one is right. Their numbers keep the
unit that they were written in (:class:`sandbox.values.units.Measured`), and here
every element is known.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from sandbox.elements.quantities import QUANTITIES
from sandbox.elements.registry import Controller
from sandbox.errors import Problem
from sandbox.scene.mechanism import Mechanism
from sandbox.values.numbers import NAME
from sandbox.values.paths import path_text
from sandbox.values.signals import AnySignal, Constant, Ramp, Table
from sandbox.values.units import UNITS, Measured, factor_of
from sandbox.wording import WrongValueError

READINGS = {name.rpartition(".")[2]: UNITS[quantity.unit][1]
            for rows in QUANTITIES.values() for name, quantity in rows.items()
            if quantity.live and quantity.unit in UNITS}
"""Dimensions of the quantities that can be read, by the last word of their names."""
PLAIN = re.compile(rf"{NAME[1:-1]}(/{NAME[1:-1]})?")
Place = tuple[str, float | None, str | None]
"""A path, the number there, and the dimension that it should have; None if unknown."""


def check_units(mechanism: Mechanism) -> Iterator[Problem]:
    """Quantities around control that have a unit of another dimension than is set or read.

    Of a value over time the path names its kind, ``$.drives[0].value.ramp.to``, also
    where the scene's author left that out.
    """
    known = _Dimensions(mechanism)
    for path, value, dimension in (*known.values(), *known.laws(), *known.events()):
        if dimension is None or not isinstance(value, Measured):
            continue
        try:
            factor_of(value.unit, dimension)
        except WrongValueError as error:
            yield Problem.of(error, path)


class _Dimensions:
    """What the drives of a mechanism set and its controllers read, by name."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.meters = {meter.name for meter in mechanism.meters}
        self.drives = {each.name: each.dimension(mechanism) for each in reversed(mechanism.drives)}
        self.controllers = {each.name: each for each in reversed(mechanism.controllers)}

    def _of_reading(self, text: str) -> str | None:
        """The dimension of a plain quantity; of an expression or a meter it is not known."""
        match = PLAIN.fullmatch(text)
        if match is None or text in self.meters:
            return None
        element, _, last = text.rpartition(".")
        first, divided, _ = element.partition("/")
        if divided and (last != "normal" or first in self.meters
                        or first.rpartition(".")[2] in (*READINGS, "value", "t")):
            return None  # not a pair of bodies but a quotient
        return READINGS.get(last) if element else None

    def _of_targets(self, law: Controller) -> list[str | None]:
        """The dimension of each target of a controller."""
        if law.sets_target:
            return [self.drives.get(name) for name in law.written]
        return [self._of_reading(text) for text in law.readings]

    def values(self) -> Iterator[Place]:
        """The drives' own values; only those of stiffnesses are not checked by their models."""
        for i, drive in enumerate(self.mechanism.drives):
            if drive.value is not None:
                yield from _signal(f"$.drives[{i}].value", drive.value,
                                   drive.dimension(self.mechanism))

    def laws(self) -> Iterator[Place]:
        """What the controllers set, and what they lead their readings to."""
        for i, law in enumerate(self.mechanism.controllers):
            path, wanted = f"$.controllers[{i}]", self._of_targets(law)
            for key in ("limits", *law.of_drive):
                yield from self._by_drive(f"{path}.{key}", law, getattr(law, key))
            for key in law.of_reading:
                yield f"{path}.{key}", getattr(law, key), wanted[0]
            for key in law.of_force:
                yield f"{path}.{key}", getattr(law, key), "force"
            key = law.target_key + ("[{}]" if law.target_key == "targets" else "")
            for j, (target, dimension) in enumerate(zip(law.signals, wanted, strict=False)):
                yield from _signal(f"{path}.{key.format(j)}", target, dimension)

    def _by_drive(self, path: str, law: Controller, value: Any) -> Iterator[Place]:
        """A field with one entry for each drive of a controller."""
        if isinstance(law.writes, str):
            yield from _numbers(path, value, self.drives.get(law.writes))
            return
        for j, (name, entry) in enumerate(zip(law.writes, value or (), strict=False)):
            yield from _numbers(f"{path}[{j}]", entry, self.drives.get(name))

    def events(self) -> Iterator[Place]:
        """What the events set: drives, or the targets of controllers."""
        for i, event in enumerate(self.mechanism.events):
            for name, value in event.set.items():
                dimension = self.drives.get(name)
                controller, _, key = name.rpartition(".")
                if name not in self.drives and key == "target" and controller in self.controllers:
                    dimension = next(iter(self._of_targets(self.controllers[controller])), None)
                yield path_text(("events", i, "set", name)), value, dimension


def _numbers(path: str, value: Any, dimension: str | None) -> Iterator[Place]:
    """A number, or every number of a range."""
    for i, number in enumerate(value) if isinstance(value, tuple) else ():
        yield f"{path}[{i}]", number, dimension
    if not isinstance(value, tuple):
        yield path, value, dimension


def _signal(path: str, signal: AnySignal, dimension: str | None) -> Iterator[Place]:
    """Every quantity of a value over time."""
    match signal:
        case Constant():
            yield f"{path}.constant", signal.constant, dimension
        case Ramp():
            yield f"{path}.ramp.from", signal.start_value, dimension
            yield f"{path}.ramp.to", signal.to, dimension
        case Table():
            for i, (_, value) in enumerate(signal.table):
                yield f"{path}.table[{i}][1]", value, dimension
