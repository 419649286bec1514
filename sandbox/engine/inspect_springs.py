"""Springs and dampers against the step, and springs that can snap over a hinge's centre.

- **Step**: a spring of stiffness k between two bodies vibrates with
  w = sqrt(k s), s the response of the two to a unit push (1/m_a + 1/m_b for
  two points); a leapfrog of step h is off by (h w)^2 / 24 in frequency. One that
  is too stiff for it (:mod:`sandbox.engine.stiffness`) is solved at the step's end,
  which damps its vibration. Of a spring with a law of its own k is the largest
  slope where it may come to. A damper c settles in 1 / (c s). Of the joints
  only a hinge between the two is counted: the others could only make the
  response smaller. Of tendons only stiff ones are looked at
  (:mod:`sandbox.engine.inspect_ringing`).
- **Over centre**: a straight spring across a hinge C has no arm when its ends
  and C are in line with C between; beyond, it turns the hinge the other way
  (rho_0 + w_0 of equations (22)-(23)).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sandbox.engine.inspect_drives import largest_stiffness, range_of_stretch
from sandbox.engine.inspect_words import STRAIGHT, deg, look
from sandbox.engine.records import SOFT
from sandbox.engine.stiffness import across, responses
from sandbox.errors import Problem
from sandbox.model.model import NONE, Model
from sandbox.model.spring_laws import STRETCH, SpringLaw
from sandbox.numeric import Array
from sandbox.scene.geometry import Vec, to_world

COARSE = 0.5
"""h w at which the frequency is 1 % off: (0.5)^2 / 24."""
OVERDAMPED = 5.0
"""Step over a damper's settling time beyond which the step hides the motion."""


@dataclass(frozen=True)
class _Push:
    """A force [N] at a point of the world, or a torque [N m], on a body."""

    body: int
    point: Vec = (0.0, 0.0)
    force: Vec = (0.0, 0.0)
    torque: float = 0.0


def _place(model: Model, body: int, point: Array) -> Vec:
    """A point of a body's frame in the world at t = 0 [m]."""
    x, y, angle = model.bodies.pose[body].tolist()
    return to_world((x, y, angle), (float(point[0]), float(point[1])))


def _centre_of(model: Model, hinge: int) -> Vec:
    return _place(model, model.joints.bodies[hinge, 0], model.joints.anchor[hinge, 0])


def _softness(model: Model, first: _Push, second: _Push, hinge: Vec | None) -> float:
    """How far two opposite pushes set their points in motion: l^T W l [1/kg or 1/(kg m^2)].

    W is the inverse mass matrix of the two bodies, less what a hinge between
    them at ``hinge`` takes from it: W - W J^T (J W J^T)^-1 J W.
    """
    bodies = model.bodies
    free, slip = 0.0, [0.0, 0.0]
    xx = xy = yy = 0.0
    for push, sign in ((first, 1.0), (second, -1.0)):
        if not bodies.free[push.body]:
            continue
        m, i = float(bodies.mass[push.body]), float(bodies.inertia[push.body])
        fx, fy = push.force
        cx, cy = _place(model, push.body, bodies.centre[push.body])
        spin = push.torque + (push.point[0] - cx) * fy - (push.point[1] - cy) * fx
        free += (fx**2 + fy**2) / m + spin**2 / i
        if hinge is not None:
            dx, dy = hinge[0] - cx, hinge[1] - cy
            slip[0] += sign * (fx / m - dy * spin / i)
            slip[1] += sign * (fy / m + dx * spin / i)
            xx, xy, yy = xx + 1 / m + dy**2 / i, xy - dx * dy / i, yy + 1 / m + dx**2 / i
    square = xx * yy - xy * xy
    if not (free and square > 0.0):  # no hinge, or one so far away that rounding leaves nothing
        return free
    x, y = slip
    return max(free - (yy * x * x - 2 * xy * x * y + xx * y * y) / square, 0.0)


def _hinge_softness(model: Model, hinge: int) -> float:
    a, b = model.joints.bodies[hinge].tolist()
    return _softness(model, _Push(a, torque=-1.0), _Push(b, torque=1.0), _centre_of(model, hinge))


def _straight_softness(model: Model, spring: int, hinge: int) -> float:
    a, b = model.springs.bodies[spring].tolist()
    p, q = (_place(model, body, point)
            for body, point in zip((a, b), model.springs.anchor[spring], strict=True))
    length = math.dist(p, q)
    ux, uy = ((q[0] - p[0]) / length, (q[1] - p[1]) / length) if length > STRAIGHT else (1.0, 0.0)
    at = None if hinge == NONE else _centre_of(model, hinge)
    return _softness(model, _Push(a, p, (ux, uy)), _Push(b, q, (-ux, -uy)), at)


def against_step(model: Model) -> Iterator[Problem]:
    """Springs and dampers, those of hinges too, that are too stiff or strong for the step."""
    springs, joints, hinges = model.springs, model.joints, across(model)
    elements: list[tuple[str, str, float, float, float, float]] = []
    stiffness, bounds = largest_stiffness(model), responses(model)
    for i, name in enumerate(springs.name):
        if springs.straight[i]:
            hinge = hinges.get(frozenset(springs.bodies[i].tolist()), NONE)
            softness = _straight_softness(model, i, hinge)
        else:
            softness = _hinge_softness(model, int(springs.joint[i]))
        elements.append((f"$.springs[{i}]", name, max(float(stiffness[i]), 0.0),
                         float(springs.damping[i]), softness, float(bounds[i])))
    elements += [(f"$.joints[{hinge}]", joints.name[hinge], 0.0, float(joints.damping[hinge]),
                  _hinge_softness(model, hinge), 0.0) for hinge in joints.hinges.tolist()]
    for element in elements:
        if math.isfinite(element[2]) and math.isfinite(element[5]):  # else a law has no value there
            yield from _against(model.mechanism.run.step, *element)
    for i, law in enumerate(springs.law):
        if law is not None:
            yield from _without_value(model, i, law)


def _without_value(model: Model, spring: int, law: SpringLaw) -> Iterator[Problem]:
    """A law that has no value where the spring may come to."""
    tried = range_of_stretch(model, spring)
    lacks = ~np.isfinite(law.force(tried, np.zeros(len(tried)),
                                   float(model.springs.stiffness[spring])))
    if lacks.any():
        nearest = tried[lacks][np.argmin(np.abs(tried[lacks]))]
        yield look("undefined-law", f"$.springs[{spring}]", model.springs.name[spring],
                   f"its law has no value at a {law.names[STRETCH]} of {nearest:.3g}",
                   "give it a value wherever the spring may come to")


def _against(
    h: float, path: str, name: str, k: float, c: float, softness: float, bound: float,
) -> Iterator[Problem]:
    pace, rate = math.sqrt(k * softness), c * softness
    if h * h * k * bound > SOFT:
        fine = min(COARSE / pace if pace else math.inf, math.sqrt(SOFT / (k * bound)))
        left = 1 / math.hypot(1, h * pace)
        yield look("stiff-step", path, name, f"too stiff for the step: h w = {h * pace:.3g}, so it "
                   f"is solved at the step's end and its vibration damped, to {100 * left:.0f} % "
                   "in a step", f"a step of {fine:.2g} s shows it ring")
    elif h * pace > COARSE:
        yield look("stiff-step", path, name, f"stiff for the step: h w = {h * pace:.3g}, its "
                   f"vibration is over {100 * COARSE**2 / 24:.0f} % off above {COARSE:g}",
                   f"a step of {COARSE / pace:.2g} s would do")
    if h * rate > OVERDAMPED:
        yield look("stiff-step", path, name, "the damper is too strong for the step: alone it "
                   f"would settle in {1 / rate:.2g} s, the step is {h:.2g} s",
                   f"a step of {OVERDAMPED / rate:.2g} s would do")


def without_arm(model: Model) -> Iterator[Problem]:
    """Straight springs without a direction, or that can snap over a hinge's centre."""
    springs, joints, hinges = model.springs, model.joints, across(model)
    for i in np.flatnonzero(springs.straight).tolist():
        a, b = springs.bodies[i].tolist()
        if a == b:
            continue
        at = [_place(model, body, point)
              for body, point in zip((a, b), springs.anchor[i], strict=True)]
        if math.dist(*at) < STRAIGHT and springs.rest[i]:
            yield look("coincident-points", f"$.springs[{i}]", springs.name[i], "its ends coincide "
                       "at t = 0", "it pushes in no direction until they part")
        hinge = hinges.get(frozenset((a, b)))
        if hinge is not None and (angle := over_centre(model, i, hinge)) is not None:
            bound = ("within its limits" if hinge in joints.stopped
                     else "the hinge has no limits")
            yield look("snap-through", f"$.springs[{i}]", springs.name[i], "snaps over the centre "
                       f"of {joints.name[hinge]!r} at {deg(angle)} ({bound})", "limit the hinge "
                       "below that, or move the spring's ends")


def over_centre(model: Model, spring: int, hinge: int) -> float | None:
    """The hinge's angle [rad] at which a straight spring across it is stretched over its centre.

    The one nearest to the start (of two as near, the lower) that the hinge's limits let
    it get to; None if there is none, or when an end lies on the hinge.
    """
    springs, joints = model.springs, model.joints
    centre = _centre_of(model, hinge)
    ends = dict(zip(springs.bodies[spring].tolist(), springs.anchor[spring], strict=True))
    directions = []
    for body in joints.bodies[hinge].tolist():
        x, y = _place(model, body, ends[body])
        if math.dist((x, y), centre) < STRAIGHT:
            return None
        directions.append(math.atan2(y - centre[1], x - centre[0]))
    start = float(joints.start[hinge])
    nearest = start + float(joints.sense[hinge]) * (math.pi - (directions[1] - directions[0]))
    low, high = joints.stops[hinge].tolist() if hinge in joints.stopped else (-math.inf, math.inf)
    angles = [angle for k in (-2, -1, 0, 1, 2) if low < (angle := nearest + 2 * math.pi * k) < high]
    return min(angles, key=lambda angle: abs(angle - start), default=None)
