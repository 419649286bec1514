"""Ranges of derived numbers: masses of shapes, values of signals over time.

The range of a field is checked where it is read (:mod:`sandbox.values.units`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.errors import Problem
from sandbox.numeric import Array
from sandbox.scene.bodies import Body
from sandbox.scene.geometry import mass_properties
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.outlines.curves import path_through
from sandbox.values.signals import AnySignal, Formula, Table, values
from sandbox.values.units import RANGES, in_range, size_fault
from sandbox.wording import WrongValueError

INSTANTS = 257  # at which a signal is evaluated


def nothing_to_run(mechanism: Mechanism) -> Iterator[Problem]:
    """A mechanism without bodies."""
    if not mechanism.bodies:
        yield Problem("nothing-to-simulate", "there are no bodies, so there is nothing to simulate",
                      "$.bodies", allowed="at least one body, or a part that has some")


def check_ranges(mechanism: Mechanism) -> Iterator[Problem]:
    """Masses, paths, directions and signals beyond their ranges."""
    for i, body in enumerate(mechanism.bodies):
        if body.motion == "dynamic":
            yield from _weight(body, f"$.bodies[{i}]")
        for axis, dimension in (("x", "length"), ("y", "length"), ("angle", "angle")):
            if body.path is not None and (signal := getattr(body.path, axis)) is not None:
                yield from _signal(signal, mechanism, f"$.bodies[{i}].path.{axis}", dimension)
    for i, joint in enumerate(mechanism.joints):
        points = getattr(joint, "path", None)
        if points and not path_through(points, closed=getattr(joint, "closed", False)).is_smooth:
            yield Problem("bad-outline", "this path turns back on itself at a point",
                          f"$.joints[{i}].path", allowed="points that lead on in a smooth curve")
    for i, drive in enumerate(mechanism.drives):
        if drive.value is not None:
            yield from _signal(drive.value, mechanism, f"$.drives[{i}].value",
                               drive.kind.dimension or "stiffness", positive=drive.kind.floor > 0)
    for i, controller in enumerate(mechanism.controllers):
        for j, signal in enumerate(controller.signals):
            place = f"[{j}]" if controller.target_key == "targets" else ""
            yield from _signal(signal, mechanism, f"$.controllers[{i}].{controller.target_key}"
                               f"{place}", None, first=0.0)
    drives = {drive.name: drive for drive in mechanism.drives}
    for i, event in enumerate(mechanism.events):
        for name in event.set.keys() & drives.keys():
            yield from _out_of_range(event.set[name], drives[name].kind.dimension or "stiffness",
                                     f"$.events[{i}].set.{name}")


def _out_of_range(value: float, dimension: str, path: str, at: str = "") -> Iterator[Problem]:
    try:
        in_range(value, dimension)
    except WrongValueError as error:
        yield Problem.of(error, path, message=f"{error.message}{at}")


def _weight(body: Body, path: str) -> Iterator[Problem]:
    try:
        weight = mass_properties(body)
    except ArithmeticError:
        faults = ["mass and inertia cannot be computed from shapes so large or so small"]
    else:
        faults = [f"its {what} is {fault}" for what in ("mass", "inertia")
                  if (fault := size_fault(getattr(weight, what), what))]
        if not all(abs(c) <= RANGES["length"].maximum for c in weight.centre):
            faults.append("its centre of mass is far from its shapes")
    yield from (Problem("out-of-range", fault, path) for fault in faults[:1])


def _signal(
    signal: AnySignal, mechanism: Mechanism, path: str, dimension: str | None, *,
    positive: bool = False, first: float | None = None,
) -> Iterator[Problem]:
    """A value over time, also at ``first``, that is not finite, positive or in its range."""
    if dimension is None and not isinstance(signal, Formula):
        return

    duration = mechanism.run.duration
    t: Array = duration * (np.arange(INSTANTS, dtype=np.float64) + 0.5) / INSTANTS
    t = t if first is None else np.append(first, t)
    try:
        found = values(signal, t, mechanism.functions, finite=False)
    except WrongValueError as error:
        yield Problem.of(error, path)
        return
    finite = np.isfinite(found)
    if positive and np.any(found <= 0):
        yield Problem("out-of-range", "the radius is not greater than 0 at t = "
                      f"{t[int(np.argmax(found <= 0))]:.4g} s", path)
    elif not finite.all():
        yield Problem("out-of-range", "this has no finite value (a division by zero, or out of "
                      f"range) at t = {t[int(np.argmin(finite))]:.4g} s", path,
                      allowed=f"a finite value from 0 to {duration:g} s")
    elif dimension is not None:
        if isinstance(signal, Table):
            t, found = np.array(signal.table).T
        worst = int(np.argmax(np.abs(found)))
        yield from _out_of_range(float(found[worst]), dimension, path, f", at t = {t[worst]:.4g} s")
