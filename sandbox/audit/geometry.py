"""Geometry: recorded poses, lengths and gaps against closed forms. Points are complex numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import ROUNDING, STOPPED, NotComputed, Worst, check, peak
from sandbox.elements.element import GRAZE
from sandbox.model.joints import flank_gaps, slipped
from sandbox.numeric import Array
from sandbox.samples.cords import lengths, lying, wound_up
from sandbox.scene.geometry import pose_of, to_world

Point = complex | NDArray[np.complex128]


@check("poses", "m", "(31)", asks="are the links where their hinge angles put them?",
       compared="poses from the hinge angles against the recorded poses, {count:comparison}, "
                "worst: {where}; the hinge gaps on the way are allowed",
       none="no chain of hinges starts at a fixed body")
def _poses(evidence: Evidence, worst: Worst) -> None:
    model, frames = evidence.model, evidence.loads.frames
    at, angle, joints = frames.x + 1j * frames.y, frames.angle, model.joints
    placed: dict[int, tuple[Point, Array, Array | float]] = {
        i: (at[i], angle[i], 0.0) for i in np.flatnonzero(~model.bodies.free).tolist()}
    waiting = _kept_pivots(evidence)
    while ready := [j for j in waiting
                    if sum(int(body) in placed for body in joints.bodies[j]) == 1]:
        j = ready[0]
        waiting.remove(j)
        sides = [0, 1] if int(joints.bodies[j, 0]) in placed else [1, 0]
        near, far = joints.bodies[j, sides].tolist()
        start, turn, allowed = placed[near]
        own = turn + (sides[1] - sides[0]) * _turned(evidence, j)
        one, two = (complex(*joints.anchor[j, side]) for side in sides)
        found = start + np.exp(1j * turn) * one - np.exp(1j * own) * two
        allowed = allowed + evidence.joint_slack[j] + ROUNDING
        worst.add(model.bodies.name[far], np.abs(found - at[far]), allowed)
        worst.add(f"angle of {model.bodies.name[far]}", np.abs(own - angle[far]),
                  ROUNDING * (1 + np.abs(own)))
        placed[far] = found, own, allowed


def _kept_pivots(evidence: Evidence) -> list[int]:
    """Hinges that were never released."""
    return [j for j in evidence.model.joints.pivots.tolist() if evidence.joints_hold[j].all()]


def _turned(evidence: Evidence, hinge: int) -> Array:
    """Angle of the second body against the first, from a hinge's recorded angle [rad], [n]."""
    joints = evidence.model.joints
    angle = evidence.run.arrays["joint_angle"][:, hinge] + joints.zero[hinge]
    return np.asarray(joints.sense[hinge] * angle)


def _across(evidence: Evidence, bodies: Array, points: Array) -> tuple[Array, int] | None:
    """Distance of two points [2, 2] on two bodies with a hinge, from its angle, and its number."""
    joints = evidence.model.joints
    for j in _kept_pivots(evidence):
        if set(joints.bodies[j].tolist()) == set(bodies.tolist()) and bodies[0] != bodies[1]:
            same = 1 if bodies[0] == joints.bodies[j, 0] else -1
            one, two = (complex(*arm) for arm in points[::same] - joints.anchor[j])
            return np.abs(one - np.exp(1j * _turned(evidence, j)) * two), j
    return None


@check("tendon.path", "m", "(17), (19)",
       asks="is each tendon as long as its path along the guides?",
       compared="length along all guides in the recorded poses against the recorded length, "
                "{count:tendon}, worst: {where}",
       none="there is no tendon")
def _tendon_paths(evidence: Evidence, worst: Worst) -> None:
    loads, names = evidence.loads, evidence.model.tendons.name
    if names:
        off = lengths(loads.frames, loads.cords) - evidence.run.arrays["tendon_length"].T
        for name, error in zip(names, np.abs(off), strict=True):
            worst.add(name, error, ROUNDING)


@check("tendon.lift", "m", "φ ≥ 0",
       asks="does a tendon leave a wheel exactly where it would have to stick to it?",
       compared="length of wheel on which a tendon would have to stick, or overlap of its path "
                "with a wheel that it has left, {count:comparison}, worst: {where}",
       none="no tendon can lift off a wheel")
def _tendon_wheels(evidence: Evidence, worst: Worst) -> None:
    tendons, loads = evidence.model.tendons, evidence.loads
    for k, guide in enumerate(tendons.wheels.tolist()):
        tendon = int(np.searchsorted(tendons.first, guide, side="right")) - 1
        name = f"{tendons.name[tendon]} at guide {guide - int(tendons.first[tendon])}"
        radius, found = abs(float(tendons.guide_radius[guide])), lying(loads.frames, loads.cords, k)
        worst.add(name, radius * np.maximum(-found.angle, 0.0), ROUNDING + GRAZE * radius)
        worst.add(f"{name}, which it is off", np.nan_to_num(np.maximum(-found.clear, 0.0)),
                  ROUNDING)


@check("tendon.shortening", "m", "(16)-(19)",
       asks="does the tendon shortening match the hinge angles?",
       compared="shortening from the hinge angles against the recorded one, {count:tendon}, "
                "worst: {where}; the gap of each hinge is allowed",
       none="no tendon crosses a hinge between point guides")
def _tendon_triangles(evidence: Evidence, worst: Worst) -> None:
    loads, tendons = evidence.loads, evidence.model.tendons
    for tendon in range(len(tendons.name)):
        pieces = np.flatnonzero(tendons.stretch_tendon == tendon)
        total, allowed, crossed = np.zeros(len(evidence.run)), ROUNDING + np.zeros(1), False
        for row in pieces.tolist():
            ends = tendons.stretch_first[row] + np.arange(2)
            found = None if tendons.guide_radius[ends].any() else _across(
                evidence, tendons.guide_body[ends], tendons.guide_at[ends])
            if found:
                total += found[0] - loads.cords.length[row]
                allowed, crossed = allowed + evidence.joint_slack[found[1]], True
        if crossed:
            path = lengths(loads.frames, loads.cords)[tendon]
            recorded = evidence.run.arrays["tendon_length"][:, tendon]
            worst.add(tendons.name[tendon], np.abs(total + path - recorded), allowed)


@check("spring.length", "m", "(28)-(30)",
       asks="is each spring as long as the distance between its ends?",
       compared="lengths from the hinge angles, or from the poses if no hinge is crossed, "
                "{count:spring}, worst: {where}",
       none="there is no straight spring")
def _spring_triangles(evidence: Evidence, worst: Worst) -> None:
    springs = evidence.model.springs
    for i in np.flatnonzero(springs.straight).tolist():
        found, allowed = _across(evidence, springs.bodies[i], springs.anchor[i]), ROUNDING
        length = found[0] if found else evidence.loads.distances(
            springs.bodies[i:i + 1], springs.anchor[i:i + 1])[0]
        worst.add(springs.name[i], np.abs(length - evidence.run.arrays["spring_length"][:, i]),
                  allowed + evidence.joint_slack[found[1]] if found else allowed)


@check("joint.drift", "m", "gap = 0", asks="do joints hold their two sides together?",
       compared="largest gap between the two sides of {count:joint}, against the allowed gap of a "
                "step: {where}",
       none="no joint can drift")
def _drift(evidence: Evidence, worst: Worst) -> None:
    joints, free = evidence.model.joints, evidence.model.bodies.free
    for j in joints.keeping("point", "groove", "distance", "gear", "rack", "roll"):
        if free[joints.bodies[j]].any():
            worst.add(joints.name[j], *_gap(evidence, j), evidence.joints_hold[j])


def _gap(evidence: Evidence, j: int) -> tuple[Array, Array]:
    """Distance of the points of a joint from where it keeps them [m], [n], and its tolerance."""
    joints, pose = evidence.model.joints, evidence.run.arrays["body_pose"]
    gap, allowed = evidence.loads.frames.gaps[j], evidence.joint_slack[j] + ROUNDING
    match joints.kind[j].keeps:
        case "groove":
            gap = evidence.loads.frames.place_in_slot(j).off
        case "distance":
            gap = np.abs(gap - joints.reach[j, 0])
        case "roll":
            ra, rb = joints.radii[j].tolist()
            apart = gap - (abs(ra - rb) if joints.inside[j] else ra + rb)
            gap = np.maximum(np.abs(apart), np.abs(slipped(evidence.model, j, pose)))
        case "gear" | "rack":  # gap of the flanks that push; with backlash their overlap
            play = float(joints.play[j] * np.cos(joints.pressure[j]) / 2)
            gaps = flank_gaps(evidence.model, j, pose)
            gap = (np.maximum(-gaps.min(axis=0) - play, 0.0) if play > 0
                   else np.abs(gaps).min(axis=0))
            if play == 0 and joints.stiffness[j] > 0:
                reaction = np.nan_to_num(evidence.run.arrays["joint_reaction"][:, j])
                allowed = allowed + peak(reaction) / float(joints.stiffness[j])
    return np.asarray(gap), np.asarray(allowed)


@check("stop.overrun", "rad", "q <= qmax", asks="does every hinge stay within its stops?",
       compared="largest overrun of {count:hinge}, worst: {where}", none="no hinge has stops")
def _stops(evidence: Evidence, worst: Worst) -> None:
    joints = evidence.model.joints
    for j in joints.stopped:
        over = np.maximum(joints.stops[j, 0] - evidence.angles[j],
                          evidence.angles[j] - joints.stops[j, 1])
        worst.add(joints.name[j], np.maximum(over, 0.0), STOPPED, evidence.joints_hold[j])


@check("differential", "m", "(4)-(7)",
       asks="does each rocker or pulley move by the weighted mean of its strings?",
       compared="travel of each pivot against the mean travel of its two strings, weighted by "
                "their arms, {count:rocker or wheel|rockers or wheels}, worst: {where}; the "
                "inclination of the strings is allowed")
def _differential(evidence: Evidence, worst: Worst) -> None:
    trees = [group.bodies for group in evidence.model.mechanism.groups if group.tree]
    if not trees:
        raise NotComputed("there is no tree of rockers or pulleys")
    worst.left_out += [f"{name}: {reason}" for names in trees for name in names
                       if (reason := _compare_rocker(evidence, name, worst))]


def _compare_rocker(evidence: Evidence, name: str, worst: Worst) -> str:
    """Add one rocker or wheel; a reason if it cannot be compared."""
    model, frames = evidence.model, evidence.loads.frames
    joints, tendons, body = model.joints, model.tendons, model.names.body[name]
    slots = [j for j in joints.keeping("groove") if joints.bodies[j, 1] == body]
    if not slots:
        return "its pivot does not slide on a slot"
    along = complex(*(joints.groove[slots[0], 1] - joints.groove[slots[0], 0]))
    pull = along / abs(along) * np.exp(1j * frames.angle[joints.bodies[slots[0], 0], 0])
    ends = [tendon for tendon, end in enumerate(tendons.first[1:] - 1)
            if tendons.guide_body[end] == body]
    if len(ends) != 2:
        return f"it has {len(ends)} strings that are tendons, not 2"
    place = complex(*model.bodies.pose[body, :2])
    (arm, one, allowed), (other, two, more) = (
        _string(evidence, tendon, place, pull) for tendon in ends)
    # arms count to either side: the pivot's displacement is the mean, weighted by the other's arm
    if abs(arm - other) < 1e-12:
        return "its strings pull at the same point"
    own = ((frames.x[body] + 1j * frames.y[body] - place) * pull.conjugate()).real
    mean = (arm * two - other * one) / (arm - other)
    worst.add(name, np.abs(own - mean),
              np.maximum(allowed, more) + 2 * (evidence.closed + ROUNDING))
    return ""


def _string(evidence: Evidence, tendon: int, place: complex, pull: complex) -> tuple[
        float, Array, Array]:
    """Arm of a string at its last guide [m], displacement of its far side, inclination, [n]."""
    loads, tendons = evidence.loads, evidence.model.tendons
    last, cords = int(tendons.first[tendon + 1]) - 1, loads.cords
    near, far = (complex(*to_world(
        pose_of(evidence.model.mechanism.bodies[tendons.guide_body[guide]]),
        tuple(tendons.guide_at[guide]))) for guide in (last, last - 1))
    radius = float(tendons.guide_radius[last])
    arm = ((near - place) * pull.conjugate()).imag + radius
    row = int(np.flatnonzero(tendons.stretch_tendon == tendon)[-1])
    straight, offset = cords.length[row], float(tendons.guide_radius[last - 1]) - radius
    before = lengths(loads.frames, cords)[tendon] - straight - wound_up(
        loads.frames, cords, tendon, last=True)
    moved = ((cords.start.x[row] + 1j * cords.start.y[row] - far) * pull.conjugate()).real
    # with the present length: the stretch T / k is not an error of the rocker
    displacement = (moved + evidence.run.arrays["tendon_length"][:, tendon] - before
                    - np.sqrt(abs(near - far)**2 - offset**2))
    slant = 1 - np.abs(((cords.x[row] + 1j * cords.y[row]) * pull.conjugate()).real)
    return arm, displacement, straight * slant
