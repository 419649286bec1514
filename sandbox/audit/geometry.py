"""Figures of geometry: lengths, poses and gaps against closed forms, in recorded poses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import ROUNDING, STOPPED, Figure, Worst, missing
from sandbox.elements.element import GRAZE
from sandbox.mechanics.springs import spring_length
from sandbox.mechanics.tendon import segment_length
from sandbox.model.joints import flank_gaps, slipped
from sandbox.numeric import Array
from sandbox.samples.cords import lengths, lying, wound_up
from sandbox.scene.geometry import pose_of, to_world
from sandbox.scene.settings import Group


def geometry_figures(evidence: Evidence) -> Iterator[Figure]:
    """Poses, lengths of tendons and springs, drift of joints, stops."""
    yield _poses(evidence)
    yield _tendon_paths(evidence)
    yield _tendon_wheels(evidence)
    yield _tendon_triangles(evidence)
    yield _spring_triangles(evidence)
    yield _drift(evidence)
    yield _stops(evidence)
    yield _differential(evidence)


def _poses(evidence: Evidence) -> Figure:
    """Equation (31): every body that hangs on hinges from a fixed one, from the recorded angles."""
    name, source = "poses", "(31)"
    model, frames, a = evidence.model, evidence.loads.frames, evidence.run.arrays
    placed: dict[int, tuple[Array, Array, Array, Array]] = {
        i: (frames.x[i], frames.y[i], frames.angle[i], np.zeros(frames.samples))
        for i in np.flatnonzero(~model.bodies.free).tolist()}
    worst, waiting = Worst(), _kept_pivots(evidence)
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
    return worst.figure(
        name, "m", source=source, none="no chain of hinges starts at a fixed body",
        why="poses from the hinge angles against the recorded poses, {count:comparison}, worst: "
            "{where}; the hinge gaps on the way are allowed")


def _kept_pivots(evidence: Evidence) -> list[int]:
    """Hinges that were never let go."""
    return [j for j in evidence.model.joints.pivots.tolist() if evidence.joints_hold[j].all()]


def _moved(x: Array, y: Array, angle: Array, point: Array) -> tuple[Array, Array]:
    c, s = np.cos(angle), np.sin(angle)
    return x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]


def _tendon_paths(evidence: Evidence) -> Figure:
    """The path through all guides in the recorded poses against the recorded length."""
    worst = Worst()
    tendons, loads = evidence.model.tendons, evidence.loads
    if tendons.name:
        found = lengths(loads.frames, loads.cords)
        recorded = evidence.run.arrays["tendon_length"].T
        for i, name in enumerate(tendons.name):
            allowed = ROUNDING
            worst.add(name, np.abs(found[i] - recorded[i]), allowed)
    return worst.figure(
        "tendon.path", "m", source="(17), (19)", none="there is no tendon",
        why="length along all guides in the recorded poses against the recorded length, "
            "{count:tendon}, worst: {where}")


def _tendon_wheels(evidence: Evidence) -> Figure:
    """A cord pushes no wheel away from it, and goes through none that it is off."""
    worst, tendons, loads = Worst(), evidence.model.tendons, evidence.loads
    for k, guide in enumerate(tendons.wheels.tolist()):
        tendon = int(np.searchsorted(tendons.first, guide, side="right")) - 1
        name = f"{tendons.name[tendon]} at guide {guide - int(tendons.first[tendon])}"
        radius, found = abs(float(tendons.guide_radius[guide])), lying(loads.frames, loads.cords, k)
        worst.add(name, radius * np.maximum(-found.angle, 0.0), ROUNDING + GRAZE * radius)
        worst.add(f"{name}, which it is off", np.nan_to_num(np.maximum(-found.clear, 0.0)),
                  ROUNDING)
    return worst.figure(
        "tendon.lift", "m", source="φ ≥ 0", none="no tendon can lift off a wheel",
        why="length of wheel on which a tendon would have to stick, or overlap of its path with a "
            "wheel that it has left, {count:comparison}, worst: {where}")


def _tendon_triangles(evidence: Evidence) -> Figure:
    """Equations (16)-(19): shortening from the hinge angles alone."""
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
    worst = Worst()
    if errors:
        path = lengths(loads.frames, loads.cords)
        recorded = evidence.run.arrays["tendon_length"].T
        for key, error in errors.items():
            total = np.abs(error + path[key] - recorded[key])
            worst.add(tendons.name[key], total, allowed[key])
    return worst.figure(
        "tendon.shortening", "m", source="(16)-(19)",
        none="no tendon crosses a hinge between point guides",
        why="shortening from the hinge angles against the recorded one, {count:tendon}, worst: "
            "{where}; the gap of each hinge is allowed")


def _spring_triangles(evidence: Evidence) -> Figure:
    """Equations (28)-(30): length from the hinge angle; others from the poses."""
    worst, frames = Worst(), evidence.loads.frames
    springs, recorded = evidence.model.springs, evidence.run.arrays["spring_length"].T
    for i in np.flatnonzero(springs.straight):
        ends = list(zip(springs.bodies[i].tolist(), springs.anchor[i], strict=True))
        hinge = _hinge_between(evidence, ends[0][0], ends[1][0])
        allowed = ROUNDING
        if hinge is None:
            at = [frames.places([body], point) for body, point in ends]
            length = np.hypot(at[1].x[0] - at[0].x[0], at[1].y[0] - at[0].y[0])
        else:
            length = _across(evidence, hinge, ends, tendon=False)
            allowed = allowed + evidence.joint_slack[hinge]
        worst.add(springs.name[i], np.abs(length - recorded[i]), allowed)
    return worst.figure(
        "spring.length", "m", source="(28)-(30)", none="there is no straight spring",
        why="lengths from the hinge angles, or from the poses if no hinge is crossed, "
            "{count:spring}, worst: {where}")


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


def _drift(evidence: Evidence) -> Figure:
    """How far apart the two sides of a joint are, but for ropes, which are free."""
    worst, joints, free = Worst(), evidence.model.joints, evidence.model.bodies.free
    for j in joints.keeping("point", "groove", "distance", "gear", "rack", "roll"):
        if free[joints.bodies[j]].any():
            worst.add(joints.name[j], _gap(evidence, j),
                      evidence.joint_slack[j] + ROUNDING + _yielded(evidence, j),
                      evidence.joints_hold[j])
    return worst.figure(
        "joint.drift", "m", source="gap = 0", none="no joint can drift",
        why="largest gap between the two sides of {count:joint}, against the allowed gap of a "
            "step: {where}")


def _gap(evidence: Evidence, j: int) -> Array:
    """How far the points of a joint are from where it keeps them [m], [n]."""
    joints = evidence.model.joints
    match joints.kind[j].keeps:
        case "groove":
            return evidence.loads.place_in_slot(j).off
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
    """By how much teeth without play give way under what they carry [m]; 0 of other joints."""
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
    """How far teeth without play are apart where they push, those with play in one another [m]."""
    joints = evidence.model.joints
    play = float(joints.play[j] * np.cos(joints.pressure[j]) / 2)
    gaps = flank_gaps(evidence.model, j, evidence.run.arrays["body_pose"])
    if play > 0:
        return np.asarray(np.maximum(-gaps.min(axis=0) - play, 0.0))
    return np.asarray(np.abs(gaps).min(axis=0))


def _stops(evidence: Evidence) -> Figure:
    """How far hinges went beyond their stops, and which stops were touched."""
    a, joints = evidence.run.arrays, evidence.model.joints
    worst, touched = Worst(), []
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
    return worst.figure(
        "stop.overrun", "rad", source="q <= qmax", none="no hinge has stops",
        why="touched: " + text if text else "no stop was touched")


def _differential(evidence: Evidence) -> Figure:
    """Every rocker and wheel of every tree: its pivot's displacement against its two strings'."""
    groups = [group for group in evidence.model.mechanism.groups
              if group.kind in ("rocker_tree", "pulley_tree")]
    if not groups:
        return missing("differential", source="(4)-(7)",
                       why="there is no tree of rockers or pulleys")
    worst, left_out = Worst(), []
    for group in groups:
        for name in group.bodies:
            reason = _compare(evidence, group, name, worst)
            if reason:
                left_out.append(f"{name}: {reason}")
    return worst.figure(
        "differential", "m", source="(4)-(7)", none="; ".join(left_out[:2]),
        why="travel of each pivot against the mean travel of its two strings, weighted by their "
            "arms, {count:rocker or wheel|rockers or wheels}, worst: {where}; the inclination of "
            "the strings is allowed"
            + (f"; left out: {'; '.join(left_out[:2])}" if left_out else ""))


@dataclass
class _String:
    """A string at a rocker or wheel: its arm, and its displacement on the far side [m]."""

    arm: float
    displacement: Array
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
    """The string of a tendon that ends on ``body``, pulled by it; None if it does not.

    Its displacement is what the cord gives on the far side of its last stretch: the
    guide there moves along the pull, and what the path before shortens. What
    its slant takes off its length along the pull is allowed.
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
    # what a wheel at the end has wound up is not part of the path before
    before = path - straight - wound_up(loads.frames, loads.cords, tendon, last=True)
    moved = (pull[0] * (loads.cords.start.x[row] - point0[0])
             + pull[1] * (loads.cords.start.y[row] - point0[1]))
    # the cord's own length now: its stretch T / k is no fault of the rocker
    displacement = moved + evidence.run.arrays["tendon_length"][:, tendon] - before - straight0
    along = np.abs(pull[0] * loads.cords.x[row] + pull[1] * loads.cords.y[row])
    slant = straight * (1 - along)
    return _String(arm, displacement, slant + evidence.closed + ROUNDING)


def _at_start(evidence: Evidence, guide: int) -> Array:
    """Where a guide's centre is at t = 0, in the world [m]."""
    x, y = evidence.model.tendons.guide_at[guide]
    body = evidence.model.mechanism.bodies[evidence.model.tendons.guide_body[guide]]
    return np.array(to_world(pose_of(body), (float(x), float(y))))
