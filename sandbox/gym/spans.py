"""Between which values a scene itself lets a quantity or a drive be."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from sandbox.errors import SceneError
from sandbox.kinds.quantities import is_yes_no
from sandbox.model.catalogue import Catalogue, Source
from sandbox.model.model import Model
from sandbox.scene.elements.drives import MotorDrive
from sandbox.scene.mechanism import signal_of
from sandbox.scene.values.ranges import range_of
from sandbox.scene.values.signals import values
from sandbox.scene.values.units import UNITS

Span = tuple[float, float]
LOOKS = 1001
"""Instants at which a signal is looked at."""
NEVER_NEGATIVE = {("tendon", "tension"), ("tendon", "length"), ("body", "contact.normal"),
                  ("group", "contact.normal"), ("group", "contact.count"), ("pair", "normal"),
                  ("joint", "reaction"), ("joint", "length"), ("line", "volume")}
SHARES = ("hold", "opening")
"""What a drive gives that is a share of something, 0 to 1."""


def acted(model: Model, drive: str) -> Span | None:
    """Between which values a drive moves; None where the scene does not say it.

    A servo between its hinge's stops, an actuator between its ends of stroke, a motor with a line
    between its speeds without load, a valve between shut and open; any other between 0 and what
    its own signal comes to.
    """
    index = model.names.drive[drive]
    spec, kind = model.mechanism.drives[index], model.drives.kind[index]
    if kind.gives in SHARES:
        return 0.0, 1.0
    if kind.places:
        joint = int(model.drives.target[index])
        return _whole(*(model.joints.stops if kind.dimension == "angle" else model.joints.reach)
                      [joint].tolist())
    if isinstance(spec, MotorDrive) and spec.no_load is not None:
        return -float(spec.no_load), float(spec.no_load)
    try:
        found = values(signal_of(spec, model.mechanism),
                       np.linspace(0.0, model.mechanism.run.duration, LOOKS),
                       model.mechanism.functions)
    except (ValueError, SceneError):
        return None
    low, high = min(0.0, float(found.min())), max(0.0, float(found.max()))
    return _whole(max(low, kind.floor), high)


def observed(model: Model, known: Catalogue, name: str, actions: Mapping[str, Span]) -> Span:
    """Between which values a quantity is, as far as the scene says; else how far numbers reach."""
    if name.startswith("=") or name not in known:
        return _any("")
    source = known.find(name)
    if is_yes_no(source.kind, source.quantity):
        return 0.0, 1.0
    if source.kind == "drive" and source.quantity == "value":
        drive = model.drives.name[source.index]
        if span := actions.get(drive) or acted(model, drive):
            return span
    if span := _of_joint(model, source):
        return span
    low, high = _any(source.unit)
    return (0.0 if (source.kind, source.quantity) in NEVER_NEGATIVE else low), high


def _of_joint(model: Model, source: Source) -> Span | None:
    """Stops of a hinge, ends of an actuator's stroke."""
    if source.kind == "spring" and source.quantity == "angle":
        joint = int(model.springs.joint[source.index])
    elif source.kind == "joint":
        joint = source.index
    else:
        return None
    joints = model.joints
    if source.quantity == "angle":
        return _whole(*joints.stops[joint].tolist())
    return _whole(*joints.reach[joint].tolist()) if source.quantity == "length" else None


def _any(unit: str) -> Span:
    """As far as numbers of a unit may reach in a scene, to either side."""
    most = range_of(UNITS[unit][1] if unit in UNITS else None).most
    return -most, most


def _whole(low: float, high: float) -> Span | None:
    return (low, high) if math.isfinite(low) and math.isfinite(high) and low < high else None
