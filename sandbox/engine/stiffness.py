"""Largest stiffnesses of springs and cables, and which of them are too stiff for the step.

A spring of stiffness k whose bodies answer a unit push by s sets w^2 = k s; a leapfrog of step h
breaks down at h w = 2. What s is hangs on the pose and on all other joints, which only make it
smaller, so a bound that holds in every pose decides: from h^2 k s = 1 on, which leaves a factor of
four, a spring is a row of the solve, taken at the step's end. It is stable then whatever k, and
its vibration is damped: of its amplitude 1 / sqrt(1 + (h w)^2) is left after a step. Cords go by
the same bound; from :data:`RIGID` on, where they stand for one without stretch, they are rows at
any step.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from sandbox.elements.tendons import RIGID
from sandbox.engine.records import SOFT
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import AnySignal, Table, values


def too_stiff(model: Model, h: float) -> Flags:
    """Whether each spring is solved at the end of a step h [s], [ns]; by its largest stiffness."""
    return np.asarray(h * h * largest_stiffness(model) * responses(model) > SOFT)


def responses(model: Model) -> Array:
    """A bound, over all poses, of each spring's s [1/kg, 1/(kg m^2)], [ns]."""
    springs, hinges = model.springs, across(model)
    found = []
    for i, straight in enumerate(springs.straight):
        if not straight:
            found.append(_turning(model, int(springs.joint[i])))
            continue
        hinge = hinges.get(frozenset(springs.bodies[i].tolist()))
        found.append(_between_points(model, i) if hinge is None else min(
            _between_points(model, i), _arm(model, i, hinge)**2 * _turning(model, hinge)))
    return np.array(found, dtype=float)


def stiff_servos(model: Model, h: float) -> Flags:
    """Whether each drive that goes to a place as a spring would is solved at the step's end, [nd].

    False of other drives.
    """
    drives = model.drives
    found = [h * h * drives.stiffness[i] * _driven(model, i) > SOFT if kind.places else False
             for i, kind in enumerate(drives.kind)]
    return np.array(found, dtype=bool)


def _driven(model: Model, drive: int) -> float:
    """A bound, over all poses, of how what a drive acts on answers a unit push."""
    joint = int(model.drives.target[drive])
    if model.joints.angle[joint]:
        return _turning(model, joint)
    return _between(model, zip(model.joints.bodies[joint], model.joints.anchor[joint],
                               strict=True))


def stiff_cords(model: Model, h: float) -> Flags:
    """Whether each cord, if no drive pulls it, is solved at the end of a step h [s], [nt].

    By its largest stiffness, as springs are.
    """
    k = largest_cord_stiffness(model)
    return np.asarray((k >= RIGID) | (h * h * k * cord_responses(model) > SOFT))


def cord_responses(model: Model) -> Array:
    """A bound of J M^-1 J^T [1/kg] over all poses, [nt]: each guide feels at most two pulls."""
    return np.array([_pulled(model, cord) for cord in range(len(model.tendons.name))], dtype=float)


def _pulled(model: Model, cord: int) -> float:
    bodies, tendons, guides = model.bodies, model.tendons, model.tendons.guides(cord)
    force: dict[int, float] = {}
    moment: dict[int, float] = {}
    for n in range(guides.start, guides.stop):
        pulls = 1.0 if n in (guides.start, guides.stop - 1) else 2.0
        body = int(tendons.guide_body[n])
        lever = (float(np.hypot(*(tendons.guide_at[n] - bodies.centre[body])))
                 + abs(float(tendons.guide_radius[n])))
        force[body] = force.get(body, 0.0) + pulls
        moment[body] = moment.get(body, 0.0) + pulls * lever
    return float(sum(1 / bodies.mass[b] * force[b] ** 2 + 1 / bodies.inertia[b] * moment[b] ** 2
                     for b in force if bodies.free[b]))


def across(model: Model) -> dict[frozenset[int], int]:
    """The hinge between two bodies; the last one if there are several."""
    return {frozenset(model.joints.bodies[hinge].tolist()): hinge
            for hinge in model.joints.hinges.tolist()}


def _between_points(model: Model, spring: int) -> float:
    return _between(model, zip(model.springs.bodies[spring], model.springs.anchor[spring],
                               strict=True))


def _between(model: Model, ends: Iterable[tuple[int, Array]]) -> float:
    """1/m + r^2/I of both ends, r from the centre of mass."""
    bodies, found = model.bodies, 0.0
    for body, point in ends:
        if bodies.free[body]:
            arm = point - bodies.centre[body]
            found += float(1 / bodies.mass[body] + arm @ arm / bodies.inertia[body])
    return found


def _arm(model: Model, spring: int, hinge: int) -> float:
    """The longest arm about a hinge that a straight spring across it may have [m]."""
    centre = dict(zip(model.joints.bodies[hinge].tolist(), model.joints.anchor[hinge], strict=True))
    ends = zip(model.springs.bodies[spring].tolist(), model.springs.anchor[spring], strict=True)
    return min(float(np.hypot(*(point - centre[body]))) for body, point in ends)


def _turning(model: Model, hinge: int) -> float:
    """1/I of both bodies; of one that turns on a still one 1/I about the hinge."""
    bodies, joints = model.bodies, model.joints
    inertia = []
    for side, body in enumerate(joints.bodies[hinge]):
        if bodies.free[body]:
            arm = joints.anchor[hinge, side] - bodies.centre[body]
            inertia.append((bodies.inertia[body], bodies.mass[body] * float(arm @ arm)))
    if len(inertia) == 1:
        return float(1 / sum(inertia[0]))
    return float(sum(1 / own for own, _ in inertia))


def line_responses(model: Model) -> Array:
    """A bound of A M^-1 A^T [m^4/kg] over all poses of each line, [nl]."""
    return np.array([_pressed(model, line) for line in range(len(model.lines.name))], dtype=float)


def _pressed(model: Model, line: int) -> float:
    bodies, lines = model.bodies, model.lines
    force: dict[int, float] = {}
    moment: dict[int, float] = {}
    for n in range(*lines.chambers(line).indices(len(lines.gain))):
        gain = abs(float(lines.gain[n]))
        for body, point in zip(lines.bodies[n].tolist(), lines.anchor[n], strict=True):
            lever = float(np.hypot(*(point - bodies.centre[body])))
            turns = lines.joint[n] >= 0
            force[body] = force.get(body, 0.0) + (0.0 if turns else gain)
            moment[body] = moment.get(body, 0.0) + (gain if turns else gain * lever)
    return float(sum(1 / bodies.mass[b] * force[b] ** 2 + 1 / bodies.inertia[b] * moment[b] ** 2
                     for b in force if bodies.free[b]))


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
