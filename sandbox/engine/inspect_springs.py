"""Checks of springs, dampers and stiff tendons against the step; springs that can snap through.

- **Step**: a spring of stiffness k (of a law its largest slope) vibrates with w = sqrt(k s), s the
  response of its bodies to a unit push; a leapfrog of step h is off by (h w)^2 / 24 in frequency.
  One that is too stiff for it (:mod:`sandbox.engine.stiffness`) is solved at the step's end, which
  damps its vibration. A damper c settles in 1 / (c s). Of the joints only a hinge between the two
  bodies is counted: others make s smaller.
- **Over centre**: a straight spring across a hinge C has no arm when its ends and C are in line
  with C between; beyond, it turns the hinge the other way (rho_0 + w_0 of equations (22)-(23)).
- **Undamped tendons**: one from :data:`RIGID` on is solved at the end of a step h, which acts as a
  damper h k along it, besides its own c: of a mode of w the damping ratio is
  zeta = (c + h k) w / (2 k), large for a small mass and small for a large one.

Modes are those of the pose at t = 0 with joints, springs, dampers and taut tendons that no drive
pulls; contacts and gravity are left out. They are computed again with all tendons taut.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from sandbox.elements.tendons import RIGID
from sandbox.engine import stiffness as stiffnesses
from sandbox.engine.inspect_elements import STRAIGHT, deg, groups, look
from sandbox.engine.records import RESOLVED, STIFF
from sandbox.errors import Problem
from sandbox.model import supports
from sandbox.model.model import NONE, Model
from sandbox.model.programs import STRETCH
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.cables import lengths_at_start, rest_lengths
from sandbox.samples.loads import pulls_at_start
from sandbox.samples.stiffness import null_space

COARSE = 0.5  # h w at which the frequency is 1 % off: (0.5)^2 / 24
OVERDAMPED = 5.0  # step over a damper's settling time beyond which the step hides the motion


def against_step(model: Model) -> Iterator[Problem]:
    """Springs and dampers, those of hinges too, that are too stiff or strong for the step."""
    springs, joints, hinges = model.springs, model.joints, stiffnesses.across(model)
    stiffness = np.maximum(stiffnesses.largest_stiffness(model), 0.0)
    bounds = stiffnesses.responses(model)
    for i, name in enumerate(springs.name):
        joint = int(springs.joint[i])
        if springs.straight[i]:
            joint = hinges.get(frozenset(springs.bodies[i].tolist()), NONE)
        if np.isfinite(stiffness[i] * bounds[i]):  # else its law has no value there
            yield from _against(model, f"$.springs[{i}]", name, float(stiffness[i]),
                                float(springs.damping[i]), _spring(model, i), joint,
                                float(bounds[i]))
    for j in joints.hinges.tolist():
        yield from _against(model, f"$.joints[{j}]", joints.name[j], 0.0, float(joints.damping[j]),
                            supports.turning_row(model, j)[0], j, stiffnesses.turning(model, j))
    for i, law in enumerate(springs.law):
        if law is not None:
            tried = stiffnesses.range_of_stretch(model, i)
            force = law.force(tried, np.zeros(len(tried)), float(springs.stiffness[i]))
            lacks = tried[~np.isfinite(force)]
            if len(lacks):
                yield look("undefined-law", f"$.springs[{i}]", springs.name[i], "its law has no "
                           f"value at a {law.names[STRETCH]} of "
                           f"{lacks[np.argmin(np.abs(lacks))]:.3g}",
                           "give it a value over the whole range of the spring")


def _against(
    model: Model, path: str, name: str, k: float, c: float, wrench: Array, hinge: int,
    bound: float,
) -> Iterator[Problem]:
    h = model.mechanism.run.step
    if 1.01 * bound * h * max(k * h / COARSE**2, c / OVERDAMPED) < 1:
        return  # its response is no larger than the bound
    bodies = np.flatnonzero(wrench.any(axis=1))
    weight = _weight(model, bodies)
    motions = _motions(model, bodies, weight, () if hinge == NONE else (hinge,))
    # response of two bodies, which a hinge may join, to unit pushes [1/kg, 1/(kg m^2)]
    softness = float(np.sum((wrench[bodies].ravel() / weight @ motions)**2))
    pace, rate = math.sqrt(k * softness), c * softness
    if h * h * k * bound > RESOLVED:
        fine = min(COARSE / pace if pace else math.inf, math.sqrt(RESOLVED / (k * bound)))
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
    springs, joints, hinges = model.springs, model.joints, stiffnesses.across(model)
    for i in np.flatnonzero(springs.straight).tolist():
        path, name, ends = f"$.springs[{i}]", springs.name[i], springs.bodies[i].tolist()
        if ends[0] == ends[1]:
            continue
        if math.dist(*map(model.at_start, ends, springs.anchor[i])) < STRAIGHT and springs.rest[i]:
            yield look("coincident-points", path, name, "its ends coincide at t = 0",
                       "it has no force until they separate")
        hinge = hinges.get(frozenset(ends))
        if hinge is not None and (angle := over_centre(model, i, hinge)) is not None:
            bound = ("within its limits" if hinge in joints.stopped else "the hinge has no limits")
            yield look("snap-through", path, name, f"snaps over the centre of "
                       f"{joints.name[hinge]!r} at {deg(angle)} ({bound})", "limit the hinge "
                       "below that, or move the spring's ends")


def over_centre(model: Model, spring: int, hinge: int) -> float | None:
    """The nearest hinge angle [rad] at which a straight spring passes over the hinge, or None."""
    springs, joints = model.springs, model.joints
    centre = model.ends(hinge)[0]
    anchors = dict(zip(springs.bodies[spring].tolist(), springs.anchor[spring], strict=True))
    directions = []
    for body in joints.bodies[hinge].tolist():
        x, y = model.at_start(body, anchors[body])
        if math.dist((x, y), centre) < STRAIGHT:
            return None
        directions.append(math.atan2(y - centre[1], x - centre[0]))
    start = float(joints.start[hinge])
    nearest = start + float(joints.sense[hinge]) * (math.pi - (directions[1] - directions[0]))
    low, high = joints.stops[hinge].tolist() if hinge in joints.stopped else (-math.inf, math.inf)
    angles = [angle for k in (-2, -1, 0, 1, 2) if low < (angle := nearest + 2 * math.pi * k) < high]
    return min(angles, key=lambda angle: abs(angle - start), default=None)


PERIODS = 15  # number of periods after which an oscillation should have decayed to LEFT
LEFT = 0.01
ENOUGH = -math.log(LEFT) / (2 * math.pi * PERIODS)  # the damping ratio for that: 5 %


class _Mode(NamedTuple):
    """A mode with most of its energy in stiff tendons; the least damped comes first."""

    ratio: float  # damping ratio
    omega: float  # [rad/s]
    cable: int  # the tendon with the largest share
    damping: float  # damping of this tendon [N s/m] for ENOUGH


class _Element(NamedTuple):
    wrench: Array  # forces and moments about centres of mass of 1 N or 1 N m of it, [nb, 3]
    stiffness: float
    damping: float  # with h k added if it is solved at the end of a step h
    cable: int = NONE


def ringing_problems(model: Model) -> Iterator[Problem]:
    """Stiff tendons with most of the energy of a mode that is damped less than :data:`ENOUGH`."""
    free = np.asarray(model.tendons.drive == NONE)
    if not (free & (model.tendons.stiffness >= RIGID)).any():
        return
    now = free & ~np.asarray(lengths_at_start(model) < rest_lengths(model) - STRAIGHT)
    h, springs, tendons = model.mechanism.run.step, model.springs, model.tendons
    damping = tendons.damping + h * tendons.stiffness * stiffnesses.stiff_cables(model, h)
    elements = [_Element(pulls, float(k), float(damping[i]), i) for i, (pulls, k)
                in enumerate(zip(pulls_at_start(model), tendons.stiffness, strict=True))]
    largest = stiffnesses.largest_stiffness(model)
    damping = springs.damping + np.where(
        stiffnesses.spring_kinds(model, h) == STIFF, h * largest, 0.0)
    elements += [_Element(_spring(model, i), float(k), float(damping[i]))
                 for i, k in enumerate(largest)]
    elements += [_Element(supports.turning_row(model, j)[0], 0.0, float(model.joints.damping[j]))
                 for j in np.flatnonzero(model.joints.damping > 0).tolist()]
    ringing = _ringing(model, elements, now)
    later = {} if (now == free).all() else _ringing(model, elements, free)
    for cable, mode in sorted((later | ringing).items()):
        periods = -math.log(LEFT) / (2 * math.pi * mode.ratio)
        yield look("undamped", f"$.tendons[{cable}]", model.tendons.name[cable], "vibrates at "
                   f"{mode.omega / (2 * math.pi):.3g} "
                   f"Hz{'' if cable in ringing else ' once all tendons are taut'}: it decays to "
                   f"{100 * LEFT:.0f} % in {periods:.3g} periods, "
                   f"{2 * math.pi * periods / mode.omega:.2g} s", "with 'damping' "
                   f"{mode.damping:.3g} N s/m it would take {PERIODS} periods")


def _ringing(model: Model, elements: list[_Element], taut: Flags) -> dict[int, _Mode]:
    """The least damped mode of each tendon, if it rings, with some tendons taut."""
    rigid = taut & (model.tendons.stiffness >= RIGID)
    at: dict[int, dict[int, _Element]] = {}
    for i, element in enumerate(elements):
        if element.cable == NONE or taut[element.cable]:
            for body in np.flatnonzero(element.wrench.any(axis=1)).tolist():
                at.setdefault(body, {})[i] = element
    worst: dict[int, _Mode] = {}
    for bodies in groups(model, springs=True) if rigid.any() else ():
        if 3 * len(bodies) <= supports.LARGEST_GROUP:
            here = {i: each for body in bodies.tolist() for i, each in at.get(body, {}).items()}
            for mode in _modes(model, bodies, [here[i] for i in sorted(here)], rigid):
                worst[mode.cable] = min(worst.get(mode.cable, mode), mode)
    return {cable: mode for cable, mode in worst.items() if mode.ratio < ENOUGH}


def _modes(model: Model, bodies: Integers, own: list[_Element], rigid: Flags) -> Iterator[_Mode]:
    """The modes of a group of bodies with their own elements."""
    cable = np.array([each.cable for each in own], dtype=np.int64)
    stiff = np.array([c != NONE and rigid[c] for c in cable], dtype=bool)
    if not stiff.any():
        return
    stiffness = np.array([each.stiffness for each in own])
    damping = np.array([each.damping for each in own])
    weight = _weight(model, bodies)
    joints = np.flatnonzero(np.isin(model.joints.bodies, bodies).any(axis=1)).tolist()
    rows = np.array([each.wrench[bodies].ravel() for each in own]) / weight
    rows = rows @ _motions(model, bodies, weight, joints)
    squares, shapes = np.linalg.eigh((rows * stiffness[:, None]).T @ rows)
    negligible = supports.RANK * max(float(squares.max(initial=0.0)), 1e-300)
    for square, shape in zip(squares, shapes.T, strict=True):
        if square <= negligible:
            continue
        moved = (rows @ shape)**2
        share = np.where(stiff, stiffness * moved, 0.0) / square
        if share.sum() > 0.5:
            omega, largest = math.sqrt(float(square)), int(share.argmax())
            ratio = float(damping @ moved) / (2 * omega)
            more = max(ENOUGH - ratio, 0.0) * 2 * omega / float(moved[largest])
            number = int(cable[largest])
            yield _Mode(ratio, omega, number, float(model.tendons.damping[number]) + more)


def _weight(model: Model, bodies: Integers) -> Array:
    """Roots of the masses and inertias of bodies, [3 n]."""
    mass = model.bodies.mass[bodies]
    weight: Array = np.sqrt(np.stack([mass, mass, model.bodies.inertia[bodies]], axis=1)).ravel()
    return weight


def _motions(model: Model, bodies: Integers, weight: Array, joints: Sequence[int]) -> Array:
    """A basis of the motions that joints allow, times the roots of the masses, [3 n, freedoms]."""
    pose = model.bodies.pose
    rows = [supports.about_centres(model, pose, supports.joint_rows(
        model, pose, joint, flank=int(model.joints.play[joint] == 0)))[:, bodies]
        for joint in joints]
    found = np.concatenate([np.zeros((0, len(bodies), 3)), *rows])
    return null_space(found.reshape(-1, len(weight)) / weight)


def _spring(model: Model, spring: int) -> Array:
    """What a unit force of a spring does at t = 0; along x if its ends coincide."""
    pose, springs = model.bodies.pose, model.springs
    if not springs.straight[spring]:
        return np.asarray(supports.turning_row(model, int(springs.joint[spring]))[0])
    bodies = springs.bodies[spring].tolist()
    at = np.array([*map(model.at_start, bodies, springs.anchor[spring])])
    way = at[1] - at[0]
    length = float(np.hypot(*way))
    u = way / length if length > STRAIGHT else np.array([1.0, 0.0])
    found = np.zeros((1, len(pose), 3))
    for body, point, sign in zip(bodies, at, (1.0, -1.0), strict=True):
        arm = point - pose[body, :2]
        found[0, body] += sign * np.array([*u, arm[0] * u[1] - arm[1] * u[0]])
    return np.asarray(supports.about_centres(model, pose, found)[0])
