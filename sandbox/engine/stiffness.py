"""Largest stiffnesses of springs and tendons, and which of them are too stiff for the step.

A spring of stiffness k whose bodies have the response s to a unit push has w^2 = k s; a leapfrog of
step h is unstable beyond h w = 2. s depends on the pose and on all other joints, which only reduce
it, so a bound for every pose decides: from h^2 k s = 1 on, a spring is a row of the solve, which is
stable for every k. Up to :data:`RESOLVED` its force is that of the mean of the poses before, at and
after the step, with weights of 1, 2 and 1: of second order, and it keeps energy. Beyond, it is that
of the step's end, and vibration is damped to 1 / sqrt(1 + (h w)^2) in a step. The same holds for
tendons from 1 on; from :data:`RIGID` on they are rows at any step.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from sandbox.elements.tendons import RIGID
from sandbox.engine.records import ELASTIC, EVEN, RESOLVED, SOFT, STIFF
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags, Integers
from sandbox.values.signals import Table, values


def spring_kinds(model: Model, h: float) -> Integers:
    """ELASTIC, EVEN or STIFF for each spring in a step h [s], [ns]; by its largest stiffness."""
    squared = h * h * largest_stiffness(model) * responses(model)
    return np.asarray(np.where(squared > RESOLVED, STIFF, np.where(squared > SOFT, EVEN, ELASTIC)))


def stiff_servos(model: Model, h: float) -> Flags:
    """Whether each drive with a stiffness is solved at the step's end, [nd]."""
    drives, joints = model.drives, model.joints
    found = np.zeros(len(drives.name), dtype=bool)
    for i in np.flatnonzero(np.isfinite(drives.stiffness)).tolist():
        j = int(drives.target[i])
        response = turning(model, j) if joints.angle[j] else _response(
            model, _at_points(model, joints.bodies[j], joints.anchor[j]))
        found[i] = h * h * drives.stiffness[i] * response > RESOLVED
    return found


def stiff_cables(model: Model, h: float) -> Flags:
    """Whether each tendon, if no drive pulls it, is solved at the end of a step h [s], [nt]."""
    k = _largest_set(model, model.tendons.stiffness, model.tendons.stiffener)
    return np.asarray((k >= RIGID) | (h * h * k * cable_responses(model) > SOFT))


def responses(model: Model) -> Array:
    """A bound, over all poses, of each spring's s [1/kg, 1/(kg m^2)], [ns]."""
    springs, joints, hinges = model.springs, model.joints, across(model)
    found = []
    for i, straight in enumerate(springs.straight):
        if not straight:
            found.append(turning(model, int(springs.joint[i])))
            continue
        bodies, anchor = springs.bodies[i], springs.anchor[i]
        bound = _response(model, _at_points(model, bodies, anchor))
        if (hinge := hinges.get(frozenset(bodies.tolist()))) is not None:
            centre = dict(zip(joints.bodies[hinge].tolist(), joints.anchor[hinge], strict=True))
            arm = min(float(np.hypot(*(point - centre[body])))
                      for body, point in zip(bodies.tolist(), anchor, strict=True))
            bound = min(bound, arm**2 * turning(model, hinge))
        found.append(bound)
    return np.array(found, dtype=float)


def cable_responses(model: Model) -> Array:
    """A bound of J M^-1 J^T [1/kg] over all poses, [nt]: each guide feels at most two pulls."""
    tendons, found = model.tendons, []
    for cable in range(len(tendons.name)):
        guides, pushes = tendons.guides(cable), []
        for n in range(guides.start, guides.stop):
            body, pulls = int(tendons.guide_body[n]), 1 + (guides.start < n < guides.stop - 1)
            lever = _lever(model, body, tendons.guide_at[n]) + abs(float(tendons.guide_radius[n]))
            pushes.append((body, float(pulls), pulls * lever))
        found.append(_response(model, pushes))
    return np.array(found, dtype=float)


def line_responses(model: Model) -> Array:
    """A bound of A M^-1 A^T [m^4/kg] over all poses of each line, [nl]."""
    lines, found = model.lines, []
    for line in range(len(lines.name)):
        pushes: list[tuple[int, float, float]] = []
        for n in range(*lines.chambers(line).indices(len(lines.gain))):
            gain = abs(float(lines.gain[n]))
            pushes += [(body, 0.0, gain) if lines.joint[n] >= 0 else (body, gain, gain * lever)
                       for body, _, lever in _at_points(model, lines.bodies[n], lines.anchor[n])]
        found.append(_response(model, pushes))
    return np.array(found, dtype=float)


def _response(model: Model, pushes: Iterable[tuple[int, float, float]]) -> float:
    """F^2/m + M^2/I of bodies, by the largest forces F and moments M of pushes on them."""
    bodies, total = model.bodies, dict[int, tuple[float, float]]()
    for body, force, moment in pushes:
        before = total.get(body, (0.0, 0.0))
        total[body] = before[0] + force, before[1] + moment
    return float(sum(1 / bodies.mass[body] * force**2 + 1 / bodies.inertia[body] * moment**2
                     for body, (force, moment) in total.items() if bodies.free[body]))


def _at_points(model: Model, bodies: Integers, points: Array) -> Iterator[tuple[int, float, float]]:
    """Unit forces at points of bodies, with their largest moments about the centres of mass."""
    for body, point in zip(bodies.tolist(), points, strict=True):
        yield body, 1.0, _lever(model, body, point)


def _lever(model: Model, body: int, point: Array) -> float:
    return float(np.hypot(*(point - model.bodies.centre[body])))


def turning(model: Model, hinge: int) -> float:
    """1/I of both bodies; of one that turns on a still one 1/I about the hinge."""
    bodies, ends = model.bodies, model.joints.bodies[hinge]
    moving = [(body, point) for body, point in zip(ends, model.joints.anchor[hinge], strict=True)
              if bodies.free[body]]
    if len(moving) == 1:
        body, point = moving[0]
        return float(1 / (bodies.inertia[body] + bodies.mass[body] * _lever(model, body, point)**2))
    return float(sum(1 / bodies.inertia[body] for body, _ in moving))


def across(model: Model) -> dict[frozenset[int], int]:
    """The hinge between two bodies; the last one if there are several."""
    return {frozenset(model.joints.bodies[hinge].tolist()): hinge
            for hinge in model.joints.hinges.tolist()}


TRIED = 1025  # stretches at which a law's slope is evaluated
MIN_RANGE = 1e-6  # of the range of stretches [m, rad]
INSTANTS = 257  # of a run, at which a signal is evaluated


def largest_stiffness(model: Model) -> Array:
    """The largest stiffness [N/m, N m/rad] of every spring, by its law or drive, [ns]."""
    found = _largest_set(model, model.springs.stiffness, model.springs.drive)
    for i, law in enumerate(model.springs.law):
        if law is not None:
            slopes = law.slopes(range_of_stretch(model, i), float(found[i]))
            found[i] = max(0.0, float(np.nanmax(slopes, initial=0.0)))
    return found


def _largest_set(model: Model, own: Array, setter: Integers) -> Array:
    """The largest of stiffnesses, of which drives set some (their numbers, or -1)."""
    mechanism, found, highest = model.mechanism, own.copy(), dict[str, float]()
    set_to = [(name, limits[1]) for each in mechanism.controllers
              for name, limits in zip(each.written, each.ranges, strict=False)]
    for name, value in [*set_to, *(pair for each in mechanism.events for pair in each.set.items())]:
        highest[name] = max(value, highest.get(name, 0.0))
    for i in np.flatnonzero(setter >= 0).tolist():
        drive, value = mechanism.drives[setter[i]], float(found[i])
        if isinstance(drive.value, Table):
            value = max(y for _, y in drive.value.table)
        elif drive.value is not None:
            instants = np.linspace(0.0, mechanism.run.duration, INSTANTS)
            value = float(values(drive.value, instants, mechanism.functions).max())
        found[i] = max(value, highest.get(drive.name, 0.0))
    return found


def range_of_stretch(model: Model, spring: int) -> Array:
    """Stretches [m, rad] that a spring may reach, [TRIED]."""
    springs, rest = model.springs, float(model.springs.rest[spring])
    start = float(springs.start[spring])
    if springs.straight[spring]:
        return np.linspace(0.0, 2 * max(start, rest, MIN_RANGE), TRIED) - rest
    low, high = model.joints.stops[springs.joint[spring]].tolist()
    if not math.isfinite(high - low):
        low, high = min(rest, start) - math.pi, max(rest, start) + math.pi
    return np.linspace(low, max(high, low + MIN_RANGE), TRIED) - rest
