"""Geometry: recorded poses, lengths and gaps against closed forms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import ROUNDING, STOPPED, NotComputed, Worst, check
from sandbox.elements.element import GRAZE
from sandbox.mechanics.springs import spring_length
from sandbox.mechanics.tendon import segment_length
from sandbox.model.joints import flank_gaps, slipped
from sandbox.numeric import Array
from sandbox.samples.cords import lengths, lying, wound_up
from sandbox.scene.geometry import pose_of, to_world
from sandbox.scene.settings import Group


@check("poses", "m", "(31)", asks="are the links where their hinge angles put them?",
       compared="poses from the hinge angles against the recorded poses, {count:comparison}, "
                "worst: {where}; the hinge gaps on the way are allowed",
       none="no chain of hinges starts at a fixed body")
def _poses(evidence: Evidence, worst: Worst) -> None:
    model, frames, a = evidence.model, evidence.loads.frames, evidence.run.arrays
    placed: dict[int, tuple[Array, Array, Array, Array]] = {
        i: (frames.x[i], frames.y[i], frames.angle[i], np.zeros(frames.samples))
        for i in np.flatnonzero(~model.bodies.free).tolist()}
    waiting = _kept_pivots(evidence)
    while ready := [j for j in waiting
                    if sum(int(body) in placed for body in model.joints.bodies[j]) == 1]:
        j = ready[0]
        waiting.remove(j)
        inward, outward = (int(body) for body in model.joints.bodies[j])
        ends, sign = model.joints.anchor[j], 1.0
        if inward not in placed:
            inward, outward, ends, sign = outward, inward, ends[::-1], -1.0
        x, y, angle, allowed = placed[inward]
        hinged = model.joints.sense[j] * (a["joint_angle"][:, j] + model.joints.zero[j])
        own = angle + sign * hinged
        hinge = _moved(x, y, angle, ends[0])
        back = _moved(np.zeros_like(x), np.zeros_like(y), own, ends[1])
        found = hinge[0] - back[0], hinge[1] - back[1]
        allowed = allowed + evidence.joint_slack[j] + ROUNDING
        error = np.hypot(found[0] - frames.x[outward], found[1] - frames.y[outward])
        worst.add(model.bodies.name[outward], error, allowed)
        error = np.abs(own - frames.angle[outward])
        worst.add(f"angle of {model.bodies.name[outward]}", error, ROUNDING * (1 + np.abs(own)))
        placed[outward] = (*found, own, allowed)


def _kept_pivots(evidence: Evidence) -> list[int]:
    """Hinges that were never released."""
    return [j for j in evidence.model.joints.pivots.tolist() if evidence.joints_hold[j].all()]


def _moved(x: Array, y: Array, angle: Array, point: Array) -> tuple[Array, Array]:
    c, s = np.cos(angle), np.sin(angle)
    return x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]


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
    loads, slack = evidence.loads, evidence.joint_slack
    errors: dict[int, Array] = {}
    allowed: dict[int, Array] = {}
    tendons = evidence.model.tendons
    for row, (tendon, first) in enumerate(zip(tendons.stretch_tendon, tendons.stretch_first,
                                              strict=True)):
        if tendons.guide_radius[first] or tendons.guide_radius[first + 1]:
            continue
        ends = [(int(tendons.guide_body[k]), tendons.guide_at[k]) for k in (first, first + 1)]
        hinge = _hinge_between(evidence, ends[0][0], ends[1][0])
        if hinge is None:
            continue
        length = _across(evidence, hinge, ends, tendon=True)
        error = length - loads.cords.length[row]
        key = int(tendon)
        errors[key] = errors.get(key, 0.0) + error
        allowed[key] = allowed.get(key, ROUNDING) + slack[hinge]
    if errors:
        path = lengths(loads.frames, loads.cords)
        recorded = evidence.run.arrays["tendon_length"].T
        for key, error in errors.items():
            total = np.abs(error + path[key] - recorded[key])
            worst.add(tendons.name[key], total, allowed[key])


@check("spring.length", "m", "(28)-(30)",
       asks="is each spring as long as the distance between its ends?",
       compared="lengths from the hinge angles, or from the poses if no hinge is crossed, "
                "{count:spring}, worst: {where}",
       none="there is no straight spring")
def _spring_triangles(evidence: Evidence, worst: Worst) -> None:
    springs, recorded = evidence.model.springs, evidence.run.arrays["spring_length"].T
    for i in np.flatnonzero(springs.straight):
        ends = list(zip(springs.bodies[i].tolist(), springs.anchor[i], strict=True))
        hinge = _hinge_between(evidence, ends[0][0], ends[1][0])
        allowed = ROUNDING
        if hinge is None:
            length = evidence.loads.distances(springs.bodies[i:i + 1], springs.anchor[i:i + 1])[0]
        else:
            length = _across(evidence, hinge, ends, tendon=False)
            allowed = allowed + evidence.joint_slack[hinge]
        worst.add(springs.name[i], np.abs(length - recorded[i]), allowed)


def _hinge_between(evidence: Evidence, one: int, two: int) -> int | None:
    for j in _kept_pivots(evidence):
        if {one, two} == set(evidence.model.joints.bodies[j].tolist()):
            return int(j)
    return None


def _across(
    evidence: Evidence, hinge: int, ends: list[tuple[int, Array]], *, tendon: bool,
) -> Array:
    """Distance of two points on either side of a hinge, by the cosine rule from its angle, [n].

    Two sides at the hinge never change; the angle between them changes with the hinge's.
    """
    joints = evidence.model.joints
    a, b = joints.bodies[hinge].tolist()
    points = dict(ends)
    one, two = points[a] - joints.anchor[hinge, 0], points[b] - joints.anchor[hinge, 1]
    angle = evidence.run.arrays["joint_angle"][:, hinge]
    hinged = joints.sense[hinge] * (angle + joints.zero[hinge])
    between = np.arctan2(two[1], two[0]) - np.arctan2(one[1], one[0]) + hinged
    folded = np.arccos(np.cos(between))
    rule = segment_length if tendon else spring_length
    lengths_of = float(np.hypot(*one)), float(np.hypot(*two))
    try:
        return np.asarray(rule(lengths_of[0], lengths_of[1], folded))
    except ValueError:  # in line with the hinge, where the closed forms stop
        square = lengths_of[0]**2 + lengths_of[1]**2
        return np.asarray(np.sqrt(square - 2 * lengths_of[0] * lengths_of[1] * np.cos(between)))


@check("joint.drift", "m", "gap = 0", asks="do joints hold their two sides together?",
       compared="largest gap between the two sides of {count:joint}, against the allowed gap of a "
                "step: {where}",
       none="no joint can drift")
def _drift(evidence: Evidence, worst: Worst) -> None:
    joints, free = evidence.model.joints, evidence.model.bodies.free
    for j in joints.keeping("point", "groove", "distance", "gear", "rack", "roll"):
        if free[joints.bodies[j]].any():
            worst.add(joints.name[j], _gap(evidence, j),
                      evidence.joint_slack[j] + ROUNDING + _yielded(evidence, j),
                      evidence.joints_hold[j])


def _gap(evidence: Evidence, j: int) -> Array:
    """Distance of the points of a joint from where it keeps them [m], [n]."""
    joints = evidence.model.joints
    match joints.kind[j].keeps:
        case "groove":
            return evidence.loads.frames.place_in_slot(j).off
        case "distance":
            return np.asarray(np.abs(evidence.loads.frames.gaps[j] - joints.reach[j, 0]))
        case "roll":
            return np.asarray(np.maximum(
                np.abs(evidence.loads.frames.gaps[j] - _touching(evidence, j)),
                np.abs(slipped(evidence.model, j, evidence.run.arrays["body_pose"]))))
        case "gear" | "rack":
            return _teeth(evidence, j)
        case "point" | "range":
            return np.asarray(evidence.loads.frames.gaps[j])


def _yielded(evidence: Evidence, j: int) -> float:
    """Deformation of teeth without backlash under their load [m]; 0 of other joints."""
    joints = evidence.model.joints
    if joints.play[j] > 0 or not joints.stiffness[j] > 0:
        return 0.0
    most = float(np.nan_to_num(evidence.run.arrays["joint_reaction"][:, j]).max(initial=0.0))
    return most / float(joints.stiffness[j])


def _touching(evidence: Evidence, j: int) -> float:
    """Distance of the centres of two circles that touch [m]."""
    joints = evidence.model.joints
    ra, rb = joints.radii[j].tolist()
    return abs(ra - rb) if joints.inside[j] else float(ra + rb)


def _teeth(evidence: Evidence, j: int) -> Array:
    """Gap of teeth without backlash where they push; overlap of those with backlash [m]."""
    joints = evidence.model.joints
    play = float(joints.play[j] * np.cos(joints.pressure[j]) / 2)
    gaps = flank_gaps(evidence.model, j, evidence.run.arrays["body_pose"])
    if play > 0:
        return np.asarray(np.maximum(-gaps.min(axis=0) - play, 0.0))
    return np.asarray(np.abs(gaps).min(axis=0))


@check("stop.overrun", "rad", "q <= qmax", asks="does every hinge stay within its stops?",
       compared="{note}", none="no hinge has stops")
def _stops(evidence: Evidence, worst: Worst) -> str:
    a, joints, touched = evidence.run.arrays, evidence.model.joints, []
    for j in joints.stopped:
        angle, torque = evidence.angles[j], a["joint_stop"][:, j]
        lowest, highest = joints.stops[j]
        over = np.maximum(lowest - angle, angle - highest)
        worst.add(joints.name[j], np.maximum(over, 0.0), STOPPED, evidence.joints_hold[j])
        if (on := np.abs(torque) > 0).any():
            first, most = int(np.argmax(on)), float(np.abs(torque).max())
            began = evidence.run.time[first]
            touched.append(f"{joints.name[j]} from {began:.3g} s, up to {most:.3g} N m")
    text = "; ".join(touched[:4]) + (f" and {len(touched) - 4} more" if len(touched) > 4 else "")
    return "touched: " + text if text else "no stop was touched"


@check("differential", "m", "(4)-(7)",
       asks="does each rocker or pulley move by the weighted mean of its strings?",
       compared="travel of each pivot against the mean travel of its two strings, weighted by "
                "their arms, {count:rocker or wheel|rockers or wheels}, worst: {where}; the "
                "inclination of the strings is allowed{note}")
def _differential(evidence: Evidence, worst: Worst) -> str:
    groups = [group for group in evidence.model.mechanism.groups if group.tree]
    if not groups:
        raise NotComputed("there is no tree of rockers or pulleys")
    reasons = ((name, _compare(evidence, group, name, worst))
               for group in groups for name in group.bodies)
    left_out = "; ".join([f"{name}: {reason}" for name, reason in reasons if reason][:2])
    if not worst.count:
        raise NotComputed(left_out)
    return f"; left out: {left_out}" if left_out else ""


@dataclass
class _String:
    """A string at a rocker or wheel."""

    arm: float
    """[m]"""
    displacement: Array
    """Of its far side [m], [n]."""
    allowed: Array


def _compare(evidence: Evidence, group: Group, name: str, worst: Worst) -> str:
    """Add one rocker or wheel; a reason if it cannot be compared."""
    model, frames = evidence.model, evidence.loads.frames
    joints, body = model.joints, model.names.body[name]
    slots = [j for j in joints.keeping("groove") if joints.bodies[j, 1] == body]
    if not slots:
        return "its pivot does not slide on a slot"
    frame = joints.bodies[slots[0], 0]
    along = joints.groove[slots[0], 1] - joints.groove[slots[0], 0]
    direction = along / np.hypot(*along)
    c, s = frames.cos[frame, 0], frames.sin[frame, 0]
    pull = np.array([c * direction[0] - s * direction[1], s * direction[0] + c * direction[1]])
    strings = [found for tendon in range(len(model.tendons.name))
               if (found := _string(evidence, tendon, body, pull)) is not None]
    if len(strings) != 2:
        return f"it has {len(strings)} strings that are tendons, not 2"
    x, y, _ = model.bodies.pose[body]
    own = pull[0] * (frames.x[body] - x) + pull[1] * (frames.y[body] - y)
    one, two = strings
    # arms count to either side: the pivot's displacement is the mean, weighted by the other's arm
    total = one.arm - two.arm
    if abs(total) < 1e-12:
        return "its strings pull at the same point"
    mean = (one.arm * two.displacement - two.arm * one.displacement) / total
    allowed = np.maximum(one.allowed, two.allowed) + evidence.closed + ROUNDING
    worst.add(name, np.abs(own - mean), allowed)
    return ""


def _string(evidence: Evidence, tendon: int, body: int, pull: Array) -> _String | None:
    """The string of a tendon that ends on ``body``; None if it does not.

    Its displacement is that of the guide before its last straight piece along the pull, plus the
    shortening of the path before. The inclination of the piece is allowed.
    """
    loads, tendons = evidence.loads, evidence.model.tendons
    last = int(tendons.first[tendon + 1]) - 1
    if tendons.guide_body[last] != body:
        return None
    place = evidence.model.bodies.pose[body, :2]
    at0 = _at_start(evidence, last) - place
    across = np.array([-pull[1], pull[0]])
    arm = float(across @ at0 + tendons.guide_radius[last])
    far = last - 1
    path = lengths(loads.frames, loads.cords)[tendon]
    row = int(np.flatnonzero(tendons.stretch_tendon == tendon)[-1])
    straight = loads.cords.length[row]
    point0, end0 = _at_start(evidence, far), place + at0
    offset = float(tendons.guide_radius[far] - tendons.guide_radius[last])
    straight0 = float(np.sqrt(np.sum((end0 - point0)**2) - offset**2))
    before = path - straight - wound_up(loads.frames, loads.cords, tendon, last=True)
    moved = (pull[0] * (loads.cords.start.x[row] - point0[0])
             + pull[1] * (loads.cords.start.y[row] - point0[1]))
    # with the present length: the stretch T / k is not an error of the rocker
    displacement = moved + evidence.run.arrays["tendon_length"][:, tendon] - before - straight0
    along = np.abs(pull[0] * loads.cords.x[row] + pull[1] * loads.cords.y[row])
    slant = straight * (1 - along)
    return _String(arm, displacement, slant + evidence.closed + ROUNDING)


def _at_start(evidence: Evidence, guide: int) -> Array:
    """Centre of a guide at t = 0, in the world [m]."""
    x, y = evidence.model.tendons.guide_at[guide]
    body = evidence.model.mechanism.bodies[evidence.model.tendons.guide_body[guide]]
    return np.array(to_world(pose_of(body), (float(x), float(y))))
