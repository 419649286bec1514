"""What of a scene can be set while it is played with, and what a new value of a parameter changes.

A parameter may shape anything. One that only changes what drives and targets are set to, and these
constant by now, is set while the run goes on; for any other it begins anew.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

from sandbox.engine.live import Live
from sandbox.errors import Problem, SceneError
from sandbox.model.catalogue import UnknownQuantityError
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.played import Setting
from sandbox.scene.read.load import Loaded
from sandbox.values.signals import AnySignal, Constant, Ramp, Table
from sandbox.values.units import UNITS, Measured, parse_quantity, units_of
from sandbox.wording import WrongValueError, listed, quoted

PARAMETER = "parameters."
"""Begins the name of a parameter, as in ``--set``."""
USUAL = {"N": 10.0, "N m": 0.1, "rad": math.pi, "rad/s": 10.0, "m": 0.1, "m/s": 0.5, "1": 1.0,
         "Pa": 1e5, "m^3/s": 1e-5, "N/m": 1000.0, "N m/rad": 1.0}
"""How far to either side a slider goes of which nothing better is known, by unit."""


KINDS = ("parameter", "drive", "target", "switch")
"""In the order in which they are shown."""


@dataclass(frozen=True)
class Control:
    """What can be set: a slider, or a switch."""

    name: str
    """``parameters.pull``, a drive, ``<controller>.target`` or ``.active``."""
    kind: Literal["parameter", "drive", "target", "switch"]
    value: float
    """What it is, in :attr:`unit`."""
    low: float
    high: float
    """From where to where a slider goes; values beyond may be typed."""
    unit: str
    """That of value, low and high; empty of a plain number."""
    drive: int = -1
    """Number of the drive whose value it shows, in the order of the channel; else -1."""


Spans = dict[tuple[str, str], tuple[float, float]]
"""From where to where sliders go, by the name of what they set and its unit."""


def controls(loaded: Loaded, live: Live, spans: Spans) -> list[dict[str, Any]]:
    """All that can be set of a scene, as plain data.

    Sliders keep the ``spans`` that they had, whatever their values are by now; of new ones these
    are noted there.
    """
    found = [*_parameters(loaded), *_drives(loaded.mechanism, live), *_controllers(live)]
    kept = []
    for control in sorted(found, key=lambda one: KINDS.index(one.kind)):
        low, high = spans.setdefault((control.name, control.unit), (control.low, control.high))
        kept.append(asdict(replace(control, low=low, high=high)))
    return kept


def _parameters(loaded: Loaded) -> Iterator[Control]:
    for name, value in loaded.scene.parameters.items():
        if name in loaded.derived:
            continue
        unit = value.unit if isinstance(value, Measured) else ""
        shown = float(value) / (UNITS[unit][0] if unit else 1.0)
        shown = float(f"{shown:.12g}")
        yield Control(PARAMETER + name, "parameter", shown, *_span(shown, unit), unit)


def _drives(mechanism: Mechanism, live: Live) -> Iterator[Control]:
    written = {name for controller in mechanism.controllers for name in controller.written}
    for i, drive in enumerate(mechanism.drives):
        if drive.name in written:
            continue
        kind, unit = drive.kind, live.unit(f"{drive.name}.value")
        most = _largest(drive.signal(mechanism), mechanism.run.duration)
        low, high = (0.0, 1.0) if kind.gives in ("hold", "opening") else _span(most, unit)
        if kind.floor is not None and math.isfinite(kind.floor):
            low = max(low, kind.floor)
        yield Control(drive.name, "drive", live[f"{drive.name}.value"], low, high, _shown(unit), i)


def _controllers(live: Live) -> Iterator[Control]:
    given = {each.name: each.value for each in live.inputs if isinstance(each, Setting)}
    for controller in live.scene.controllers:
        targets = controller.signals
        if len(targets) == 1:
            unit = _unit_of(live, controller.readings[0])
            value = final(targets[0], math.inf)
            value = 0.0 if value is None else value
            name, (low, high) = f"{controller.name}.target", _span(value, unit)
            yield Control(name, "target", given.get(name, value), low, high, _shown(unit))
        name = f"{controller.name}.active"
        yield Control(name, "switch", given.get(name, float(controller.active)), 0.0, 1.0, "")


def _unit_of(live: Live, reading: str) -> str:
    """Of an expression it is not known."""
    try:
        return live.unit(reading)
    except UnknownQuantityError:
        return ""


def read_value(name: str, text: str, mechanism: Mechanism, live: Live) -> float:
    """The value in SI that a text gives a drive, ``<controller>.target`` or ``.active``.

    Raises:
        SceneError: no number with a unit of what is set.
    """
    unit = next((each.unit for each in (*_drives(mechanism, live), *_controllers(live))
                 if each.name == name), "")
    kind = next((drive.kind for drive in mechanism.drives if drive.name == name), None)
    dimension = UNITS[unit][1] if unit in UNITS else kind.dimension if kind else ""
    allowed = "a number" + f", or one with a unit: {listed(units_of(dimension))}" * bool(dimension)
    try:  # of what has no dimension a text of any unit is Measured
        value = parse_quantity(text, dimension or None)
    except WrongValueError as error:
        raise SceneError([Problem(error.code, f"{quoted(name)}: {error.message}", "",
                                  allowed=allowed, hint=error.hint)]) from None
    if not dimension and isinstance(value, Measured):
        raise SceneError([Problem("wrong-unit",
                                  f"{quoted(name)} takes no unit", "", allowed=allowed)])
    return value


def _shown(unit: str) -> str:
    return "" if unit == "1" else unit


def _span(value: float, unit: str) -> tuple[float, float]:
    """From where to where a slider goes whose value is at first this."""
    if value and math.isfinite(value):
        return min(0.0, 2 * value), max(0.0, 2 * value)
    factor = UNITS[unit][0] if unit in UNITS else 1.0
    most = USUAL.get(unit) or next(
        (usual / factor for si, usual in USUAL.items()
         if si in UNITS and unit in UNITS and UNITS[si][1] == UNITS[unit][1]), 1.0)
    return -most, most


def _largest(signal: AnySignal, duration: float) -> float:
    """The value of a signal that is largest, sign left as it is."""
    match signal:
        case Constant():
            return signal.constant
        case Ramp():
            return max(signal.start_value, signal.to, key=abs)
        case Table():
            return max((value for _, value in signal.table), key=abs)
        case _:
            return 0.0


def final(signal: AnySignal, time: float) -> float | None:
    """The value that a signal has from an instant [s] on; None if it still changes."""
    match signal:
        case Constant():
            return signal.constant
        case Ramp():
            return signal.to if time >= signal.start + signal.over else None
        case Table():
            return signal.table[-1][1] if time >= signal.table[-1][0] else None
        case _:
            return None


def changes(old: Mechanism, new: Mechanism, time: float) -> dict[str, float] | None:
    """What to set at an instant [s] so that from then on the one scene is the other.

    None where that cannot be done: what is not set while a run goes on, or changes with time.
    Expectations and views do not matter.
    """
    found: dict[str, float] = {}
    still = {"expect": (), "view": new.view, "drives": (), "controllers": (), "parameters": {},
             "run": new.run}
    if old.run.step != new.run.step or old.model_copy(update=still) != new.model_copy(update=still):
        return None
    if len(old.drives) != len(new.drives) or len(old.controllers) != len(new.controllers):
        return None
    written = {name for controller in new.controllers for name in controller.written}
    for was, drive in zip(old.drives, new.drives, strict=True):
        if was == drive:
            continue
        value = final(drive.signal(new), time)
        if drive.model_copy(update={"value": was.value}) != was or value is None \
                or drive.name in written:
            return None
        found[drive.name] = value
    for before, controller in zip(old.controllers, new.controllers, strict=True):
        if before == controller:
            continue
        targets = controller.signals
        field = "target" if hasattr(controller, "target") else "value"
        if len(targets) != 1 or controller.name != before.name or not hasattr(before, field):
            return None
        value = final(targets[0], time)
        plain = controller.model_copy(update={field: getattr(before, field)})
        if plain != before or value is None:
            return None
        found[f"{controller.name}.target"] = value
    return found
