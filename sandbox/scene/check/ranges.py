"""What follows from a mechanism's numbers must be a number that can be computed with, too.

What stands in a field is held to its range where it is read
(:mod:`sandbox.values.units`). Here are the numbers that nobody wrote: what a body weighs
by its shapes, how far apart corners are, which values a drive runs through.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from sandbox.elements.registry import KINDS
from sandbox.errors import Problem
from sandbox.numeric import Array
from sandbox.scene.bodies import SHAPES, Body, Polygon, Polyline, Shape
from sandbox.scene.geometry import mass_properties
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.outlines.paths import path_through
from sandbox.values.signals import AnySignal, Formula, Table, values
from sandbox.values.tables import Tables
from sandbox.values.units import RANGES, in_range, size_fault
from sandbox.wording import WrongValueError

INSTANTS = 257
"""At which the value of a drive or a path is tried."""


def nothing_to_run(mechanism: Mechanism) -> Iterator[Problem]:
    """A mechanism without bodies: there is nothing that could be simulated."""
    if not mechanism.bodies:
        yield Problem("nothing-to-simulate", "there are no bodies, so there is nothing to simulate",
                      "$.bodies", allowed="at least one body, or a part that has some")


def check_ranges(mechanism: Mechanism) -> Iterator[Problem]:
    """Weights, corners, paths, directions and signals that are beyond what can be computed."""
    for i, body in enumerate(mechanism.bodies):
        yield from _corners(body, f"$.bodies[{i}]")
        if body.motion == "dynamic":
            yield from _weight(body, f"$.bodies[{i}]")
        for axis, dimension in (("x", "length"), ("y", "length"), ("angle", "angle")):
            if body.path is not None and (signal := getattr(body.path, axis)) is not None:
                yield from _signal(signal, dimension, mechanism, f"$.bodies[{i}].path.{axis}")
    for i, joint in enumerate(mechanism.joints):
        points, closed = joint.path_points()
        if points and not path_through(points, closed=closed).is_smooth:
            yield Problem("bad-outline", "this path turns back on itself at a point",
                          f"$.joints[{i}].path", allowed="points that lead on in a smooth curve")
    for kind in KINDS:
        for i, element in enumerate(getattr(mechanism, kind)):
            yield from element.range_problems(f"$.{kind}[{i}]")
    for i, drive in enumerate(mechanism.drives):
        if drive.value is not None:
            yield from _signal(drive.value, drive.kind.dimension or "stiffness", mechanism,
                               f"$.drives[{i}].value")
    drives = {drive.name: drive for drive in mechanism.drives}
    for i, event in enumerate(mechanism.events):
        for name in event.set.keys() & drives.keys():
            try:
                in_range(event.set[name], drives[name].kind.dimension or "stiffness")
            except WrongValueError as error:
                yield Problem.of(error, f"$.events[{i}].set.{name}")


def _corners(body: Body, path: str) -> Iterator[Problem]:
    """Corners of polygons and polylines that are as good as one."""
    for place, shape in _placed(body):
        if isinstance(shape, Polygon):
            rings = [(shape.points, "points"), *((hole, f"holes[{k}]")
                                                 for k, hole in enumerate(shape.holes))]
            sides = [(list(zip(ring, ring[1:] + ring[:1], strict=True)), field)
                     for ring, field in rings]
        elif isinstance(shape, Polyline):
            sides = [(list(pairwise(shape.points)), "points")]
        else:
            continue
        for ends, field in sides:
            if fault := size_fault(min(math.dist(p, q) for p, q in ends), "length"):
                yield Problem("out-of-range", f"the shortest side of this {shape.type} is {fault}",
                              f"{path}.{place}.{field}")


def _placed(body: Body) -> Iterator[tuple[str, Shape]]:
    """All outlines of a body, with the place of each in it."""
    for field in SHAPES:
        for j, shape in enumerate(getattr(body, field)):
            yield f"{field}[{j}]", shape


def _weight(body: Body, path: str) -> Iterator[Problem]:
    """Mass and inertia, given or derived from the shapes."""
    try:
        weight = mass_properties(body)
    except ArithmeticError:
        yield Problem("out-of-range",
                      "mass and inertia cannot be computed from shapes so large or so small", path)
        return
    for what, value in (("mass", weight.mass), ("inertia", weight.inertia)):
        if fault := size_fault(value, what):
            yield Problem("out-of-range", f"its {what} is {fault}", path)
            return
    if not all(abs(c) <= RANGES["length"].most for c in weight.centre):
        yield Problem("out-of-range", "its centre of mass is far from its shapes", path)


def _signal(
    signal: AnySignal, dimension: str, mechanism: Mechanism, path: str,
) -> Iterator[Problem]:
    """A value over time that is beyond its range at some time of the run."""
    t = mechanism.run.duration * (np.arange(INSTANTS, dtype=np.float64) + 0.5) / INSTANTS
    if isinstance(signal, Table):
        t = np.array([at for at, _ in signal.table])
    try:
        found = values(signal, t, mechanism.functions)
    except WrongValueError:
        return  # reported by the references
    worst = int(np.argmax(np.abs(found)))
    try:
        in_range(float(found[worst]), dimension)
    except WrongValueError as error:
        yield Problem.of(error, path, message=f"{error.message}, at t = {t[worst]:.4g} s")


SIGNAL_SAMPLES = 257
"""Instants of a run at which a formula is tried."""


def check_signals(mechanism: Mechanism) -> Iterator[Problem]:
    """Formulas without a finite value during the run, radii that are not positive."""
    duration, tables = mechanism.run.duration, mechanism.functions
    for path, signal, positive in _signals(mechanism):
        if isinstance(signal, Formula) or positive:
            yield from _try_signal(signal, duration, path, tables, positive=positive,
                                   at_once=path.startswith("$.controllers"))


def _signals(mechanism: Mechanism) -> Iterator[tuple[str, AnySignal, bool]]:
    """Every signal with its path, and whether it must stay positive."""
    for i, drive in enumerate(mechanism.drives):
        if drive.value is not None:
            yield f"$.drives[{i}].value", drive.value, drive.positive_value
    for i, controller in enumerate(mechanism.controllers):
        signals = controller.signals
        key = controller.target_key
        for j, signal in enumerate(signals):
            place = f"[{j}]" if key == "targets" else ""
            yield f"$.controllers[{i}].{key}{place}", signal, False
    for i, body in enumerate(mechanism.bodies):
        if body.path is not None:
            for key in ("x", "y", "angle"):
                if (signal := getattr(body.path, key)) is not None:
                    yield f"$.bodies[{i}].path.{key}", signal, False


def _try_signal(
    signal: AnySignal, duration: float, path: str, tables: Tables, *, positive: bool,
    at_once: bool = False,
) -> Iterator[Problem]:
    """With ``at_once`` the signal is evaluated at t = 0, too; drives have no such step."""
    t: Array = duration * (np.arange(SIGNAL_SAMPLES, dtype=np.float64) + 0.5) / SIGNAL_SAMPLES
    if at_once:
        t = np.append(0.0, t)
    count = len(t) if not _lacks(signal, t, tables) else bisect_left(
        range(1, len(t) + 1), True, key=lambda n: _lacks(signal, t[:n], tables) != "")
    if positive and count and np.any((found := values(signal, t[:count], tables)) <= 0):
        first = t[int(np.argmax(found <= 0))]
        yield Problem("out-of-range",
                      f"the radius is not greater than 0 at t = {first:.4g} s", path)
    elif count < len(t):
        yield Problem("out-of-range", f"{_lacks(signal, t[count:count + 1], tables)} at t = "
                      f"{t[count]:.4g} s", path, allowed=f"a finite value from 0 to {duration:g} s")


def _lacks(signal: AnySignal, t: Array, tables: Tables) -> str:
    """Why a signal has no value at one of some instants, or nothing."""
    try:
        values(signal, t, tables)
    except ValueError as error:
        return str(error)
    return ""
