"""What drives may come to while a run goes on, as far as the mechanism tells beforehand."""

from __future__ import annotations

import math

import numpy as np

from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import AnySignal, Table, values

TRIED = 1025
"""Stretches at which a law's slope is looked at."""
LEAST = 1e-6
"""Of the range of stretches [m, rad]."""
INSTANTS = 257
"""Of a run, at which a signal is looked at."""


def largest_stiffness(model: Model) -> Array:
    """The largest stiffness [N/m, N m/rad] of every spring, shape [ns].

    Of one with a law of its own the law's largest slope, where it may come to.

    Of one that a drive sets: by the drive's signal, the upper limits of a controller that writes
    it, and what events set it to. What a controller without limits does is not known.
    """
    found = _largest_set(model, model.springs.stiffness, model.springs.drive)
    for i, law in enumerate(model.springs.law):
        if law is not None:
            slopes = law.slopes(range_of_stretch(model, i), float(found[i]))
            found[i] = max(0.0, float(np.nanmax(slopes, initial=0.0)))
    return found


def largest_cord_stiffness(model: Model) -> Array:
    """The largest stiffness [N/m] of every tendon, as far as is known, shape [nt]."""
    return _largest_set(model, model.tendons.stiffness, model.tendons.stiffener)


def _largest_set(model: Model, own: Array, setter: Integers) -> Array:
    """The largest of stiffnesses, of which drives set some (their numbers, or -1)."""
    mechanism, found = model.mechanism, own.copy()
    limits: dict[str, float] = {}
    for controller in mechanism.controllers:
        given = getattr(controller, "limits", None)
        writes = controller.written
        pairs = [given] if len(writes) == 1 and given and np.isscalar(given[0]) else given or ()
        limits |= {name: pair[1] for name, pair in zip(writes, pairs, strict=False)}
    events: dict[str, float] = {}
    for event in mechanism.events:
        events |= {name: max(value, events.get(name, value)) for name, value in event.set.items()}
    for i in np.flatnonzero(setter >= 0).tolist():
        drive = mechanism.drives[setter[i]]
        found[i] = max([
            float(found[i]) if drive.value is None
            else _largest(drive.value, mechanism),
            limits.get(drive.name, 0.0), events.get(drive.name, 0.0)])
    return found


def range_of_stretch(model: Model, spring: int) -> Array:
    """Stretches [m, rad] that a spring may come to, as far as it tells, [TRIED].

    Lengths from 0 to twice the larger of those at t = 0 and at rest; angles between the hinge's
    stops, or up to half a turn from rest and from the start.
    """
    springs, rest = model.springs, float(model.springs.rest[spring])
    start = float(springs.start[spring])
    if springs.straight[spring]:
        return np.linspace(0.0, 2 * max(start, rest, LEAST), TRIED) - rest
    low, high = model.joints.stops[springs.joint[spring]].tolist()
    if not math.isfinite(high - low):
        low, high = min(rest, start) - math.pi, max(rest, start) + math.pi
    return np.linspace(low, max(high, low + LEAST), TRIED) - rest


def _largest(signal: AnySignal, mechanism: Mechanism) -> float:
    if isinstance(signal, Table):
        return max(value for _, value in signal.table)
    instants = np.linspace(0.0, mechanism.run.duration, INSTANTS)
    return float(values(signal, instants, mechanism.functions).max())
