"""Checks of springs, dampers and stiff cables against the step; springs that can snap through.

- **Step**: a spring of stiffness k between two bodies vibrates with
  w = sqrt(k s), s the response of the two to a unit push (1/m_a + 1/m_b for
  two points); a leapfrog of step h is off by (h w)^2 / 24 in frequency. One that
  is too stiff for it (:mod:`sandbox.engine.stiffness`) is solved at the step's end,
  which damps its vibration. For a spring with a law, k is the largest slope in
  its range. A damper c settles in 1 / (c s). Of the joints
  only a hinge between the two is counted: the others could only make the
  response smaller. Of tendons only stiff ones are checked.
- **Over centre**: a straight spring across a hinge C has no arm when its ends
  and C are in line with C between; beyond, it turns the hinge the other way
  (rho_0 + w_0 of equations (22)-(23)).
- **Undamped cables**: what a cable of stiffness k carries vibrates on it.

A cable from :data:`RIGID` on is solved at the end
of a step h, which acts as a damper h k along it, besides its own c: of a mode of w the damping
ratio is zeta = (c + h k) w / (2 k), large for a small mass and small for a large one. No default
suits both: k times 1 ms takes the peak of a 0.5 kg weight that is released from 2 to
1.5 weights, and leaves 20 kg ringing for 1.8 s.

Modes are those of the pose at t = 0 with joints, springs, dampers and taut cords that no drive
pulls; contacts and gravity are left out. Modes are computed again with all cords taut.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sandbox.elements.tendons import RIGID
from sandbox.engine.inspect_words import STRAIGHT, deg, groups, linked, look
from sandbox.engine.records import SOFT
from sandbox.engine.stiffness import (
    across,
    largest_stiffness,
    range_of_stretch,
    responses,
    stiff_cords,
    too_stiff,
)
from sandbox.errors import Problem
from sandbox.model.laws import STRETCH, SpringLaw
from sandbox.model.model import NONE, Model
from sandbox.model.supports import LARGEST_GROUP, RANK, about_centre, joint_rows
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.cords import Pulls, pulls_at_start, rest_lengths
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
    """Response to two opposite pushes: l^T W l [1/kg or 1/(kg m^2)].

    W is the inverse mass matrix of the two bodies, reduced by a hinge between
    them at ``hinge``: W - W J^T (J W J^T)^-1 J W.
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
    if not (free and square > 0.0):  # no hinge, or one too far away
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
    """A law that has no value in the range of the spring."""
    tried = range_of_stretch(model, spring)
    lacks = ~np.isfinite(law.force(tried, np.zeros(len(tried)),
                                   float(model.springs.stiffness[spring])))
    if lacks.any():
        nearest = tried[lacks][np.argmin(np.abs(tried[lacks]))]
        yield look("undefined-law", f"$.springs[{spring}]", model.springs.name[spring],
                   f"its law has no value at a {law.names[STRETCH]} of {nearest:.3g}",
                   "give it a value over the whole range of the spring")


def _against(
    h: float, path: str, name: str, k: float, c: float, softness: float, bound: float,
) -> Iterator[Problem]:
    pace, rate = math.sqrt(k * softness), c * softness
    if h * h * k * bound > SOFT:
        fine = min(COARSE / pace if pace else math.inf, math.sqrt(SOFT / (k * bound)))
        left = 1 / math.hypot(1, h * pace)
        yield look("stiff-step", path, name, f"too stiff for the step: h w = {h * pace:.3g}, so it "
                   f"is solved at the step's end and its vibration damped, to {100 * left:.0f} % "
                   "in a step", f"use a step of {fine:.2g} s to resolve the vibration")
    elif h * pace > COARSE:
        yield look("stiff-step", path, name, f"stiff for the step: h w = {h * pace:.3g}, its "
                   f"frequency is more than {100 * COARSE**2 / 24:.0f} % off above {COARSE:g}",
                   f"use a step of {COARSE / pace:.2g} s")
    if h * rate > OVERDAMPED:
        yield look("stiff-step", path, name, "the damper is too strong for the step: alone it "
                   f"would settle in {1 / rate:.2g} s, the step is {h:.2g} s",
                   f"use a step of {OVERDAMPED / rate:.2g} s")


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
                       "at t = 0", "it has no force until they separate")
        hinge = hinges.get(frozenset((a, b)))
        if hinge is not None and (angle := over_centre(model, i, hinge)) is not None:
            bound = ("within its limits" if hinge in joints.stopped
                     else "the hinge has no limits")
            yield look("snap-through", f"$.springs[{i}]", springs.name[i], "snaps over the centre "
                       f"of {joints.name[hinge]!r} at {deg(angle)} ({bound})", "limit the hinge "
                       "below that, or move the spring's ends")


def over_centre(model: Model, spring: int, hinge: int) -> float | None:
    """The hinge angle [rad] at which a straight spring passes over the centre of the hinge.

    The nearest to the start (of two equally near, the lower) within the limits of the
    hinge; None if there is none, or if an end is on the hinge.
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


PERIODS = 15
"""Number of periods after which an oscillation should have decayed to :data:`LEFT`."""
LEFT = 0.01
ENOUGH = -math.log(LEFT) / (2 * math.pi * PERIODS)
"""The damping ratio for that: 5 %."""


def ringing_problems(model: Model) -> Iterator[Problem]:
    """Stiff cords with most of the energy of a mode that is damped less than :data:`ENOUGH`."""
    free = np.asarray(model.tendons.drive == NONE)
    pulls = pulls_at_start(model)
    now = free & ~np.asarray(pulls.length < rest_lengths(model) - STRAIGHT)
    if not (free & (model.tendons.stiffness >= RIGID)).any():
        return
    elements = _elements(model, pulls)
    ringing = _ringing(model, elements, now)
    later = {} if (now == free).all() else _ringing(model, elements, free)
    for cord, mode in sorted((later | ringing).items()):
        periods = -math.log(LEFT) / (2 * math.pi * mode.ratio)
        yield look("undamped", f"$.tendons[{cord}]", model.tendons.name[cord], "vibrates at "
                   f"{mode.omega / (2 * math.pi):.3g} "
                   f"Hz{'' if cord in ringing else ' once all tendons are taut'}: it decays to "
                   f"{100 * LEFT:.0f} % in {periods:.3g} periods, "
                   f"{2 * math.pi * periods / mode.omega:.2g} s", "with 'damping' "
                   f"{mode.damping:.3g} N s/m it would take {PERIODS} periods")


def _ringing(model: Model, elements: list[_Element], taut: Flags) -> dict[int, _Mode]:
    """The least damped mode of each cord, if it rings, with some cords taut."""
    rigid = taut & (model.tendons.stiffness >= RIGID)
    at: dict[int, dict[int, _Element]] = {}
    for i, element in enumerate(elements):
        if element.cord == NONE or taut[element.cord]:
            for body, _ in element.parts:
                at.setdefault(body, {})[i] = element
    worst: dict[int, _Mode] = {}
    for bodies in groups(model, linked(model, springs=True)) if rigid.any() else ():
        if 3 * len(bodies) <= LARGEST_GROUP:
            here = {i: each for body in bodies.tolist() for i, each in at.get(body, {}).items()}
            for mode in _modes(model, bodies, [here[i] for i in sorted(here)], rigid):
                worst[mode.cord] = min(worst.get(mode.cord, mode), mode)
    return {cord: mode for cord, mode in worst.items() if mode.ratio < ENOUGH}


class _Mode(NamedTuple):
    """A mode with most of its energy in stiff cords; the least damped comes first."""

    ratio: float
    """Damping ratio."""
    omega: float
    """[rad/s]"""
    cord: int
    """The cord with the largest share."""
    damping: float
    """Damping of this cord [N s/m] for :data:`ENOUGH`."""


class _Element(NamedTuple):
    """A spring, cord or damper: bodies and the wrenches of 1 N or 1 N m on them."""

    parts: list[tuple[int, Array]]
    stiffness: float
    damping: float
    """With h k added if it is solved at the end of a step h."""
    cord: int = NONE


def _modes(
    model: Model, bodies: Integers, elements: list[_Element], rigid: Flags,
) -> Iterator[_Mode]:
    """The modes of a group of bodies with their elements."""
    rows, stiffness, damping, cord = _table(bodies, elements)
    if not len(rows) or not rigid[cord[cord >= 0]].any():
        return
    weight = np.sqrt(np.stack([model.bodies.mass[bodies], model.bodies.mass[bodies],
                               model.bodies.inertia[bodies]], axis=1).ravel())
    motions = _motions(model, bodies, weight)
    rows = (rows / weight) @ motions
    squares, shapes = np.linalg.eigh((rows * stiffness[:, None]).T @ rows)
    least = RANK * max(float(squares.max(initial=0.0)), 1e-300)
    stiff = np.array([c >= 0 and bool(rigid[c]) for c in cord])
    for square, shape in zip(squares, shapes.T, strict=True):
        if square <= least:
            continue
        moved = (rows @ shape) ** 2
        share = np.where(stiff, stiffness * moved, 0.0) / square
        if share.sum() > 0.5:
            omega, most = math.sqrt(float(square)), int(share.argmax())
            ratio = float(damping @ moved) / (2 * omega)
            more = max(ENOUGH - ratio, 0.0) * 2 * omega / float(moved[most])
            number = int(cord[most])
            yield _Mode(ratio, omega, number, float(model.tendons.damping[number]) + more)


def _motions(model: Model, bodies: Integers, weight: Array) -> Array:
    """A basis of the motions that joints allow, times the roots of the masses, [3 n, freedoms]."""
    place = {body: 3 * i for i, body in enumerate(bodies.tolist())}
    pose, found = model.bodies.pose, []
    for joint in sorted({joint for body in place for joint, _ in model.neighbours[body]}):
        for row in joint_rows(model, pose, joint, flank=int(model.joints.play[joint] == 0)):
            line = np.zeros(len(weight))
            for body, wrench in row:
                if body in place:
                    line[place[body]:place[body] + 3] += about_centre(model, pose, body, wrench)
            found.append(line / weight)
    if not found:
        return np.eye(len(weight))
    lines = np.array(found)
    if len(lines) > lines.shape[1]:  # redundant rows: the left vectors are not needed
        lines = np.asarray(np.linalg.qr(lines, mode="r"))
    _, values, right = np.linalg.svd(lines)
    rank = int(np.count_nonzero(values > RANK * values.max(initial=0.0)))
    motions: Array = right[rank:].T
    return motions


def _elements(model: Model, pulls: Pulls) -> list[_Element]:
    """All springs, cords and dampers, in this order."""
    h, springs, tendons = model.mechanism.run.step, model.springs, model.tendons
    found, at_end = [], stiff_cords(model, h)
    for i, stiffness in enumerate(tendons.stiffness.tolist()):
        more = h * stiffness if at_end[i] else 0.0
        found.append(_Element(pulls.parts(i), stiffness, float(tendons.damping[i]) + more, i))
    largest, springs_at_end = largest_stiffness(model), too_stiff(model, h)
    for i, straight in enumerate(springs.straight):
        parts = _along(model, i) if straight else _about(model, int(springs.joint[i]))
        k, c = float(largest[i]), float(springs.damping[i])
        found.append(_Element(parts, k, c + (h * k if springs_at_end[i] else 0.0)))
    for j in np.flatnonzero(model.joints.damping > 0).tolist():
        found.append(_Element(_about(model, j), 0.0, float(model.joints.damping[j])))
    return found


def _table(
    bodies: Integers, elements: list[_Element],
) -> tuple[Array, Array, Array, Integers]:
    """Elements of a group: rows [n, 3 nb], stiffness, damping, cord; -1 is no cord."""
    place = {body: 3 * i for i, body in enumerate(bodies.tolist())}
    rows: list[Array] = []
    kept: list[_Element] = []
    for element in elements:
        line = np.zeros(3 * len(bodies))
        for body, wrench in element.parts:
            if body in place:
                line[place[body]:place[body] + 3] += wrench
        if line.any():
            rows.append(line)
            kept.append(element)
    return (np.array(rows), np.array([each.stiffness for each in kept]),
            np.array([each.damping for each in kept]),
            np.array([each.cord for each in kept], dtype=np.int64))


def _about(model: Model, joint: int) -> list[tuple[int, Array]]:
    a, b = model.joints.bodies[joint].tolist()
    turn = np.array([0.0, 0.0, 1.0])
    return [(a, -turn), (b, turn)]


def _along(model: Model, spring: int) -> list[tuple[int, Array]]:
    """Wrenches of a unit force of a straight spring at t = 0; none if its ends coincide."""
    pose, springs = model.bodies.pose, model.springs
    arms = []
    for body, point in zip(springs.bodies[spring].tolist(), springs.anchor[spring], strict=True):
        c, s = np.cos(pose[body, 2]), np.sin(pose[body, 2])
        arms.append((body, np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])))
    (a, on_a), (b, on_b) = arms
    way = pose[b, :2] + on_b - pose[a, :2] - on_a
    length = float(np.hypot(*way))
    if length < STRAIGHT:
        return []
    u = way / length
    return [(body, about_centre(model, pose, body, sign * np.array(
        [*u, arm[0] * u[1] - arm[1] * u[0]]))) for body, arm, sign in ((a, on_a, 1.0),
                                                                      (b, on_b, -1.0))]
