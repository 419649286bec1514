"""Sliders and switches of a live view, and which parameters can be set during a run.

A parameter that only changes the values of drives and targets, which are constant by now, is set
during the run; any other restarts it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from sandbox.engine.live import Live
from sandbox.model.catalogue import UnknownQuantityError
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.played import Setting
from sandbox.scene.read.load import Loaded
from sandbox.values.signals import AnySignal, Constant, Ramp, Table
from sandbox.values.units import UNITS, Measured, parse_quantity, units_of
from sandbox.wording import WrongValueError, listed, quoted, refuse_if

PARAMETER = "parameters."  # begins the name of a parameter, as in --set
USUAL = {"N": 10.0, "N m": 0.1, "rad": math.pi, "rad/s": 10.0, "m": 0.1, "m/s": 0.5,
         "Pa": 1e5, "m^3/s": 1e-5, "N/m": 1000.0, "N m/rad": 1.0}
"""Default range of a slider to either side, by unit."""
Spans = dict[tuple[str, str], tuple[float, float]]  # ranges of sliders, by the name and the unit


def controls(loaded: Loaded, live: Live, spans: Spans) -> list[dict[str, Any]]:
    """All controls of a scene, as plain data.

    ``kind`` is parameter, drive, target or switch. ``value``, ``low`` and ``high`` are in ``unit``;
    values beyond the range may be typed. ``drive`` is the index of the drive whose value it shows,
    or -1. Sliders keep the ``spans`` that they had; those of new ones are added there.
    """
    found = []
    for name, value in loaded.scene.parameters.items():
        if name not in loaded.derived:
            unit = value.unit if isinstance(value, Measured) else ""
            shown = float(f"{float(value) / (UNITS[unit][0] if unit else 1.0):.12g}")
            found.append(_control(PARAMETER + name, "parameter", shown, _span(shown, unit), unit))
    rest = [*_drives(loaded.mechanism, live), *_controllers(live)]
    found += sorted(rest, key=lambda one: ("drive", "target", "switch").index(one["kind"]))
    for one in found:
        one["low"], one["high"] = spans.setdefault(
            (one["name"], one["unit"]), (one["low"], one["high"]))
    return found


def _control(name: str, kind: str, value: float, span: tuple[float, float], unit: str = "",
             drive: int = -1) -> dict[str, Any]:
    return {"name": name, "kind": kind, "value": value, "low": span[0], "high": span[1],
            "unit": "" if unit == "1" else unit, "drive": drive}


def _drives(mechanism: Mechanism, live: Live) -> Iterator[dict[str, Any]]:
    written = {name for controller in mechanism.controllers for name in controller.written}
    for i, drive in enumerate(mechanism.drives):
        if drive.name in written:
            continue
        kind, unit = drive.kind, live.unit(f"{drive.name}.value")
        largest = max(course(drive.signal(mechanism))[0], key=abs, default=0.0)
        low, high = (0.0, 1.0) if kind.gives in ("hold", "opening") else _span(largest, unit)
        if kind.floor is not None and math.isfinite(kind.floor):
            low = max(low, kind.floor)
        yield _control(drive.name, "drive", live[f"{drive.name}.value"], (low, high), unit, i)


def _controllers(live: Live) -> Iterator[dict[str, Any]]:
    given = {each.name: each.value for each in live.inputs if isinstance(each, Setting)}
    for controller in live.scene.controllers:
        if len(controller.signals) == 1:
            try:
                unit = live.unit(controller.readings[0])
            except UnknownQuantityError:  # an expression
                unit = ""
            value = (course(controller.signals[0])[0] or [0.0])[-1]
            name = f"{controller.name}.target"
            yield _control(name, "target", given.get(name, value), _span(value, unit), unit)
        name = f"{controller.name}.active"
        yield _control(name, "switch", given.get(name, float(controller.active)), (0.0, 1.0))


def read_value(name: str, text: str, mechanism: Mechanism, live: Live) -> float:
    """The SI value of a text for a drive, ``<controller>.target`` or ``.active``."""
    unit = next((each["unit"] for each in (*_drives(mechanism, live), *_controllers(live))
                 if each["name"] == name), "")
    kind = next((drive.kind for drive in mechanism.drives if drive.name == name), None)
    dimension = UNITS[unit][1] if unit in UNITS else kind.dimension if kind else ""
    allowed = "a number" + f", or one with a unit: {listed(units_of(dimension))}" * bool(dimension)
    try:  # without a dimension, a text of any unit is Measured
        value = parse_quantity(text, dimension or None)
    except WrongValueError as error:
        raise WrongValueError(error.code, f"{quoted(name)}: {error.message}", allowed=allowed,
                              hint=error.hint) from None
    refuse_if(not dimension and isinstance(value, Measured), f"{quoted(name)} takes no unit",
              "wrong-unit", allowed=allowed)
    return value


def _span(value: float, unit: str) -> tuple[float, float]:
    """The range of a slider with this first value."""
    if value and math.isfinite(value):
        return min(0.0, 2 * value), max(0.0, 2 * value)
    factor, dimension = UNITS.get(unit, (1.0, ""))
    most = next((usual / factor for si, usual in USUAL.items() if UNITS[si][1] == dimension), 1.0)
    return -most, most


def course(signal: AnySignal | None) -> tuple[list[float], float]:
    """The values that a signal takes in turn, and the instant [s] from which on it has the last."""
    match signal:
        case Constant():
            return [signal.constant], -math.inf
        case Ramp():
            return [signal.start_value, signal.to], signal.start + signal.over
        case Table():
            return [value for _, value in signal.table], signal.table[-1][0]
        case _:
            return [], math.inf


def changes(old: Mechanism, new: Mechanism, time: float) -> dict[str, float] | None:
    """The settings at an instant [s] that make one scene the other from then on.

    None if other elements differ, or values still change. Expectations and views do not matter.
    """
    found: dict[str, float] = {}
    still = {"expect": (), "view": new.view, "drives": (), "controllers": (), "parameters": {},
             "run": new.run}
    if (old.run.step != new.run.step or len(old.drives) != len(new.drives)
            or len(old.controllers) != len(new.controllers)
            or old.model_copy(update=still) != new.model_copy(update=still)):
        return None
    written = {name for controller in new.controllers for name in controller.written}
    # of each: before, now, the field that may differ, its signal, the name of the setting
    pairs: list[tuple[Any, Any, str, AnySignal | None, str]] = [
        (was, now, "value", now.signal(new), now.name)
        for was, now in zip(old.drives, new.drives, strict=True)]
    pairs += [(was, now, "target" if hasattr(now, "target") else "value",
               now.signals[0] if len(now.signals) == 1 else None, f"{now.name}.target")
              for was, now in zip(old.controllers, new.controllers, strict=True)]
    for was, now, field, signal, name in pairs:
        if was == now:
            continue
        values, last = course(signal)
        if (time < last or name in written or not hasattr(was, field)
                or now.model_copy(update={field: getattr(was, field)}) != was):
            return None
        found[name] = values[-1]
    return found
