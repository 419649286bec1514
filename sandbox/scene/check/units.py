"""Units around control: what a controller or an event sets is in the unit of its drive.

The fields of controllers and events take any unit, since only the drive that they
write, or the quantity that they read, says which one is right. This is looked at in
the data of a scene, where the units still stand.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from sandbox.scene.read.findings import Finding
from sandbox.scene.read.paths import JsonPath
from sandbox.scene.values.numbers import NAME
from sandbox.scene.values.units import parse_quantity
from sandbox.wording import WrongValueError

DRIVES = {"force": "force", "pull": "force", "torque": "torque", "brake": "torque",
          "radius": "length", "motor": "angular speed"}
"""Dimensions of the drives' values; that of a stiffness depends on its spring."""
SPRINGS = {"linear": "stiffness", "rotary": "rotary stiffness"}
SECTION_SPRINGS = {"push": "stiffness", "hold": "rotary stiffness"}
READINGS = {
    "angle": "angle", "rate": "angular speed", "omega": "angular speed",
    "x": "length", "y": "length", "length": "length", "shortening": "length",
    "vx": "speed", "vy": "speed",
    "tension": "force", "normal": "force", "reaction": "force", "force": "force",
}
"""Dimensions of the quantities that can be read, by the last word of their names."""
PLAIN = re.compile(rf"{NAME[1:-1]}(/{NAME[1:-1]})?")
OF_DRIVE = {"pid": ("bias",), "schedule": (), "feedback": (), "relay": ("bias", "amplitude"),
            "switch": ("value_below", "value_above")}
"""By controller of one drive, the numbers in the unit of the drive, besides its limits."""
OF_READING = {"switch": ("below", "above"), "relay": ("hysteresis",)}

Place = tuple[JsonPath, Any, str | None]
"""A value with its path, and the dimension that it should have; None if nobody knows."""


def control_units(data: Any) -> Iterator[Finding]:
    """Quantities around control that have a unit of another dimension than is set or read.

    Args:
        data: a scene as JSON gives it, templates merged. What is no quantity, or of
            no known drive, is passed over: the models and the references tell it.
    """
    scene = _Scene(data)
    for path, value, dimension in (*scene.stiffnesses(), *scene.laws(), *scene.events()):
        wrong = _wrong(value, dimension)
        if wrong is not None:
            yield Finding(wrong.message, path, wrong.allowed, wrong.hint)


def _wrong(value: Any, dimension: str | None) -> WrongValueError | None:
    if dimension is None or not isinstance(value, str) or value.lstrip().startswith("="):
        return None
    try:
        parse_quantity(value, None)
    except WrongValueError:  # the models say so
        return None
    try:
        parse_quantity(value, dimension)
    except WrongValueError as error:
        return error
    return None


class _Scene:
    """What the drives of a scene set and its controllers read, by name."""

    def __init__(self, data: Any) -> None:
        self.data = data if isinstance(data, dict) else {}
        self.springs = self._named("springs")
        self.parts = self._named("parts")
        self.meters = self._named("meters")
        self.drives = {name: self._of_drive(each) for name, each in self._named("drives").items()}
        self.controllers = self._named("controllers")

    def _named(self, kind: str) -> dict[str, dict[str, Any]]:
        named: dict[str, dict[str, Any]] = {}
        for _, entry in self._all(kind):
            if isinstance(name := entry.get("name"), str):
                named.setdefault(name, entry)
        return named

    def _all(self, kind: str) -> Iterator[tuple[int, dict[str, Any]]]:
        for i, entry in enumerate(_list(self.data.get(kind))):
            if isinstance(entry, dict):
                yield i, entry

    def _of_drive(self, drive: dict[str, Any]) -> str | None:
        kind = drive.get("type")
        if kind == "stiffness":
            return self._of_spring(drive.get("spring"))
        return DRIVES.get(kind) if isinstance(kind, str) else None

    def _of_spring(self, name: Any) -> str | None:
        if not isinstance(name, str):
            return None
        if name in self.springs:
            kind = self.springs[name].get("type")
            return SPRINGS.get(kind) if isinstance(kind, str) else None
        part, _, last = name.rpartition(".")
        kind = self.parts[part].get("type") if part in self.parts else None
        if kind == "section":
            return SECTION_SPRINGS.get(last)
        return "stiffness" if kind == "finger" else None

    def _of_reading(self, text: Any) -> str | None:
        """The dimension of a plain quantity; of an expression or a meter it is not known."""
        match = PLAIN.fullmatch(text.strip()) if isinstance(text, str) else None
        if match is None or match.group() in self.meters:
            return None
        element, _, last = match.group().rpartition(".")
        first, divided, _ = element.partition("/")
        if divided and (last != "normal" or first in self.meters
                        or first.rpartition(".")[2] in (*READINGS, "value", "t")):
            return None  # not a pair of bodies but a quotient
        return READINGS.get(last) if element else None

    def _of_written(self, name: Any) -> str | None:
        return self.drives.get(name) if isinstance(name, str) else None

    def _of_target(self, controller: dict[str, Any]) -> str | None:
        """The dimension of what an event sets as the one target of a controller."""
        kind = controller.get("type")
        if kind == "schedule":
            return self._of_written(controller.get("writes"))
        if kind == "equilibrium":
            return "angle"
        reads = controller.get("reads")
        several = _list(reads)
        return self._of_reading(several[0] if several else reads)

    def stiffnesses(self) -> Iterator[Place]:
        """The values of stiffness drives; those of the other drives are checked by their models."""
        for i, drive in self._all("drives"):
            if drive.get("type") == "stiffness":
                dimension = self._of_drive(drive)
                yield from _signal(("drives", i, "value"), drive.get("value"), dimension)

    def laws(self) -> Iterator[Place]:
        for i, controller in self._all("controllers"):
            kind = controller.get("type")
            if kind in ("state_feedback", "equilibrium"):
                yield from self._several(("controllers", i), controller, kind)
            elif isinstance(kind, str) and kind in OF_DRIVE:
                yield from self._single(("controllers", i), controller, kind)

    def _single(self, path: JsonPath, law: dict[str, Any], kind: str) -> Iterator[Place]:
        written, read = self._of_written(law.get("writes")), self._of_reading(law.get("reads"))
        yield from _entries((*path, "limits"), law.get("limits"), [written] * 2)
        for keys, dimension in ((OF_DRIVE[kind], written), (OF_READING.get(kind, ()), read)):
            for key in keys:
                yield (*path, key), law.get(key), dimension
        if kind == "schedule":
            yield from _signal((*path, "value"), law.get("value"), written)
        elif kind in ("pid", "relay"):
            yield from _signal((*path, "target"), law.get("target"), read)

    def _several(self, path: JsonPath, law: dict[str, Any], kind: str) -> Iterator[Place]:
        written = [self._of_written(name) for name in _list(law.get("writes"))]
        for j, (pair, dimension) in enumerate(zip(_list(law.get("limits")), written, strict=False)):
            yield from _entries((*path, "limits", j), pair, [dimension] * 2)
        if kind == "equilibrium":  # its targets are angles by their model
            yield (*path, "pull"), law.get("pull"), "force"
            return
        yield from _entries((*path, "bias"), law.get("bias"), written)
        read = [self._of_reading(reads) for reads in _list(law.get("reads"))]
        for j, (target, dimension) in enumerate(zip(_list(law.get("targets")), read, strict=False)):
            yield from _signal((*path, "targets", j), target, dimension)

    def events(self) -> Iterator[Place]:
        for i, event in self._all("events"):
            given = event.get("set")
            for name, value in given.items() if isinstance(given, dict) else ():
                dimension = self._of_written(name)
                controller, _, key = name.rpartition(".") if isinstance(name, str) else ("",) * 3
                if name not in self.drives and key == "target" and controller in self.controllers:
                    dimension = self._of_target(self.controllers[controller])
                yield ("events", i, "set", name), value, dimension


def _entries(path: JsonPath, values: Any, dimensions: list[str | None]) -> Iterator[Place]:
    for i, (value, dimension) in enumerate(zip(_list(values), dimensions, strict=False)):
        yield (*path, i), value, dimension


def _signal(path: JsonPath, value: Any, dimension: str | None) -> Iterator[Place]:
    """Every quantity of a value over time."""
    if isinstance(value, dict) and len(value) == 1 and isinstance(value.get("ramp"), dict):
        path, value = (*path, "ramp"), value["ramp"]
    if not isinstance(value, dict):
        yield path, value, dimension
    elif "to" in value:
        for key in ("from", "to"):
            yield (*path, key), value.get(key), dimension
    elif "table" in value:
        for i, row in enumerate(_list(value["table"])):
            if len(_list(row)) == 2:
                yield (*path, "table", i, 1), row[1], dimension
    elif "constant" in value:
        yield (*path, "constant"), value["constant"], dimension


def _list(value: Any) -> list[Any] | tuple[Any, ...]:
    return value if isinstance(value, (list, tuple)) else ()
