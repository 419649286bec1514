"""Recorded poses, lengths, gaps and velocities against closed forms; points are complex numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sandbox.audit.evidence import DIGITS, ROUNDING, STOPPED, Check, Evidence, Worst, peak
from sandbox.elements.element import GRAZE
from sandbox.model.joints import flank_gaps, slipped
from sandbox.numeric import Array
from sandbox.samples.cables import lengths_at_start, lying, rest_lengths, wound_up
from sandbox.values.signals import values

Point = complex | NDArray[np.complex128]
FEW = 8  # Least number of samples for differences of poses
FAST = 0.1  # Fraction of its largest velocity above which a body counts as moving


@Check("poses", "m", "(31)", asks="are the links where their hinge angles put them?",
       compared="poses from the hinge angles against the recorded poses, {count:comparison}, "
                "worst: {where}; the hinge gaps on the way are allowed",
       none="no chain of hinges starts at a fixed body")
def _poses(evidence: Evidence, worst: Worst) -> None:
    model, frames = evidence.model, evidence.frames
    at, angle, joints = frames.pose[0] + 1j * frames.pose[1], frames.pose[2], model.joints
    placed: dict[int, tuple[Point, Array, Array | float]] = {
        i: (at[i], angle[i], 0.0) for i in np.flatnonzero(~model.bodies.free).tolist()}
    waiting = [j for j in joints.hinges.tolist() if evidence.joints_hold[j].all()]
    while ready := [j for j in waiting
                    if sum(int(body) in placed for body in joints.bodies[j]) == 1]:
        waiting.remove(j := ready[0])
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


def _turned(evidence: Evidence, hinge: int) -> Array:
    """Angle of the second body against the first, from a hinge's recorded angle [rad], [n]."""
    joints = evidence.model.joints
    angle = evidence.arrays["joint_angle"][:, hinge] + joints.zero[hinge]
    return np.asarray(joints.sense[hinge] * angle)


def _across(evidence: Evidence, bodies: Array, points: Array) -> tuple[Array, int] | None:
    """Distance of two points [2, 2] on two bodies with a hinge, from its angle, and its number."""
    joints = evidence.model.joints
    for j in joints.hinges.tolist() if bodies[0] != bodies[1] else ():
        if evidence.joints_hold[j].all() and set(joints.bodies[j].tolist()) == {*bodies.tolist()}:
            same = 1 if bodies[0] == joints.bodies[j, 0] else -1
            one, two = (complex(*arm) for arm in points[::same] - joints.anchor[j])
            return np.abs(one - np.exp(1j * _turned(evidence, j)) * two), j
    return None


@Check("tendon.path", "m", "(17), (19)",
       asks="is each tendon as long as its path along the guides?",
       compared="length along all guides in the recorded poses against the recorded length, "
                "{count:tendon}, worst: {where}")
def _tendon_paths(evidence: Evidence, worst: Worst) -> None:
    if names := evidence.model.tendons.name:
        off = evidence.frames.lengths - evidence.arrays["tendon_length"].T
        for name, error in zip(names, np.abs(off), strict=True):
            worst.add(name, error, ROUNDING)


@Check("tendon.lift", "m", "φ ≥ 0",
       asks="does a tendon leave a wheel exactly where it would have to stick to it?",
       compared="length of wheel on which a tendon would have to stick, or overlap of its path "
                "with a wheel that it has left, {count:comparison}, worst: {where}",
       none="no tendon can lift off a wheel")
def _tendon_wheels(evidence: Evidence, worst: Worst) -> None:
    tendons = evidence.model.tendons
    for k, guide in enumerate(tendons.wheels.tolist()):
        tendon = int(np.searchsorted(tendons.first, guide, side="right")) - 1
        name = f"{tendons.name[tendon]} at guide {guide - int(tendons.first[tendon])}"
        radius = abs(float(tendons.guide_radius[guide]))
        angle, clear = lying(evidence.frames, k)
        worst.add(name, radius * np.maximum(-angle, 0.0), ROUNDING + GRAZE * radius)
        worst.add(f"{name}, which it is off", np.nan_to_num(np.maximum(-clear, 0.0)), ROUNDING)


@Check("tendon.shortening", "m", "(16)-(19)",
       asks="does the tendon shortening match the hinge angles?",
       compared="shortening from the hinge angles against the recorded one, {count:tendon}, "
                "worst: {where}; the gap of each hinge is allowed",
       none="no tendon crosses a hinge between point guides")
def _tendon_triangles(evidence: Evidence, worst: Worst) -> None:
    frames, tendons = evidence.frames, evidence.model.tendons
    for tendon, name in enumerate(tendons.name):
        total, allowed, crossed = np.zeros(len(evidence.run)), ROUNDING + np.zeros(1), False
        for row in np.flatnonzero(tendons.stretch_tendon == tendon).tolist():
            ends = tendons.stretch_first[row] + np.arange(2)
            found = None if tendons.guide_radius[ends].any() else _across(
                evidence, tendons.guide_body[ends], tendons.guide_at[ends])
            if found:
                total += found[0] - frames.cables.length[row]
                allowed, crossed = allowed + evidence.joint_slack[found[1]], True
        if crossed:
            recorded = evidence.arrays["tendon_length"][:, tendon]
            worst.add(name, np.abs(total + frames.lengths[tendon] - recorded), allowed)


@Check("spring.length", "m", "(28)-(30)",
       asks="is each spring as long as the distance between its ends?",
       compared="lengths from the hinge angles, or from the poses if no hinge is crossed, "
                "{count:spring}, worst: {where}",
       none="there is no straight spring")
def _spring_triangles(evidence: Evidence, worst: Worst) -> None:
    springs = evidence.model.springs
    places = evidence.places(springs.bodies, springs.anchor, springs.joint)
    for i in np.flatnonzero(springs.straight).tolist():
        found, allowed = _across(evidence, springs.bodies[i], springs.anchor[i]), ROUNDING
        length = found[0] if found else places[i]
        worst.add(springs.name[i], np.abs(length - evidence.arrays["spring_length"][:, i]),
                  allowed + evidence.joint_slack[found[1]] if found else allowed)


@Check("joint.drift", "m", "gap = 0", asks="do joints hold their two sides together?",
       compared="largest gap between the two sides of {count:joint}, against the allowed gap of a "
                "step: {where}",
       none="no joint can drift")
def _drift(evidence: Evidence, worst: Worst) -> None:
    joints, pose = evidence.model.joints, evidence.arrays["body_pose"]
    for j in joints.keeping("point", "groove", "distance", "gear", "rack", "roll").tolist():
        gap, allowed = evidence.frames.gaps[j], evidence.joint_slack[j] + ROUNDING
        if not evidence.model.bodies.free[joints.bodies[j]].any():
            continue
        match joints.kind[j].keeps:
            case "groove":
                gap = evidence.frames.place_in_slot(j).off
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
                    reaction = np.nan_to_num(evidence.arrays["joint_reaction"][:, j])
                    allowed = allowed + peak(reaction) / float(joints.stiffness[j])
        worst.add(joints.name[j], gap, allowed, evidence.joints_hold[j])


@Check("stop.overrun", "rad", "q <= qmax", asks="does every hinge stay within its stops?",
       compared="largest overrun of {count:hinge}, worst: {where}", none="no hinge has stops")
def _stops(evidence: Evidence, worst: Worst) -> None:
    joints = evidence.model.joints
    for j in joints.stopped:
        over = np.maximum(joints.stops[j, 0] - evidence.angles[j],
                          evidence.angles[j] - joints.stops[j, 1])
        worst.add(joints.name[j], np.maximum(over, 0.0), STOPPED, evidence.joints_hold[j])


@Check("differential", "m", "(4)-(7)",
       asks="does each rocker or pulley move by the weighted mean of its strings?",
       compared="travel of each pivot against the mean travel of its two strings, weighted by "
                "their arms, {count:rocker or wheel|rockers or wheels}, worst: {where}; the "
                "inclination of the strings is allowed",
       none="there is no tree of rockers or pulleys")
def _differential(evidence: Evidence, worst: Worst) -> None:
    model, frames, left = evidence.model, evidence.frames, worst.left_out
    joints, tendons = model.joints, model.tendons
    for name in (name for group in model.mechanism.groups if group.tree for name in group.bodies):
        body = model.names.body[name]
        slots = [j for j in joints.keeping("groove") if joints.bodies[j, 1] == body]
        ends = np.flatnonzero(tendons.guide_body[tendons.first[1:] - 1] == body).tolist()
        if not slots or len(ends) != 2:
            left.append(f"{name}: it has {len(ends)} strings that are tendons, not 2" if slots
                        else f"{name}: its pivot does not slide on a slot")
            continue
        along = complex(*(joints.groove[slots[0], 1] - joints.groove[slots[0], 0]))
        pull = along / abs(along) * np.exp(1j * frames.pose[2, joints.bodies[slots[0], 0], 0])
        place = complex(*model.bodies.pose[body, :2])
        (arm, one, allowed), (other, two, more) = (
            _string(evidence, tendon, place, pull) for tendon in ends)
        # arms count to either side: the pivot moves by the mean, weighted by the other's arm
        if abs(arm - other) < 1e-12:
            left.append(f"{name}: its strings pull at the same point")
            continue
        own = ((frames.pose[0, body] + 1j * frames.pose[1, body] - place) * pull.conjugate()).real
        mean = (arm * two - other * one) / (arm - other)
        worst.add(name, np.abs(own - mean),
                  np.maximum(allowed, more) + 2 * (evidence.closed + ROUNDING))


def _string(evidence: Evidence, tendon: int, place: complex, pull: complex) -> tuple[
        float, Array, Array]:
    """Arm of a string at its last guide [m], displacement of its far side, inclination, [n]."""
    frames, tendons, cables = evidence.frames, evidence.model.tendons, evidence.frames.cables
    first, row = frames.first.cables, int(np.flatnonzero(tendons.stretch_tendon == tendon)[-1])
    far, near = (complex(at.x[row, 0], at.y[row, 0]) for at in (first.start, first.end))
    arm = ((near - place) * pull.conjugate()).imag + float(
        tendons.guide_radius[tendons.first[tendon + 1] - 1])
    straight = cables.length[row]
    before = frames.lengths[tendon] - straight - wound_up(frames, tendon, last=True)
    moved = ((cables.start.x[row] + 1j * cables.start.y[row] - far) * pull.conjugate()).real
    # with the present length: the stretch T / k is not an error of the rocker
    displacement = moved + evidence.arrays["tendon_length"][:, tendon] - before - first.length[row]
    slant = 1 - np.abs(((cables.x[row] + 1j * cables.y[row]) * pull.conjugate()).real)
    return arm, displacement, straight * slant


@Check("clock", "step", "t = (k - 1/2) h", asks="do the sample times match the sample rate?")
def _clock(evidence: Evidence, worst: Worst) -> str:
    run, settings = evidence.whole, evidence.model.mechanism.run
    h, time = settings.solver_step, run.time
    every = max(1, round(1 / (run.info.sample_rate * h)))
    k = time / h + 0.5
    off = np.abs(k - np.round(k))
    if len(time) > 1:
        off = np.maximum(off, np.abs(np.diff(k, prepend=k[0] - every) - every))
    step = abs(run.info.step / h - 1)
    worst.judge(max(peak(off), step), 8 * DIGITS * float(np.abs(k).max(initial=1.0)) + ROUNDING)
    return (f"distance of samples from the middle of a step of {h:g} s, and from a spacing of "
            f"{every} steps")


@Check("scene.numbers", asks="are masses and lengths those of the scene?",
       compared="recorded masses, centres of mass, rest lengths and initial lengths against the "
                "scene, {count:number}, worst: {where}",
       none="there is no body")
def _numbers(evidence: Evidence, worst: Worst) -> None:
    model, a = evidence.model, evidence.arrays
    bodies, tendons = model.bodies, model.tendons
    for what, names, off in (
        ("centre", bodies.name, np.hypot(*(a["body_centre"] - bodies.centre).T)),
        *((what, bodies.name, np.where(a[f"body_{what}"] == of, 0.0, a[f"body_{what}"] / of - 1))
          for what, of in (("mass", bodies.mass), ("inertia", bodies.inertia))),
        ("initial", tendons.name, a["tendon_initial"] - lengths_at_start(model)),
        ("rest", tendons.name, a["tendon_rest"] - rest_lengths(model)),
    ):
        for name, error in zip(names, np.abs(off), strict=True):
            worst.add(f"{what} of {name}", error[None], ROUNDING)


@Check("schedule", "m", "x(t)", asks="do fixed and scheduled bodies follow the scene?",
       compared="poses of {count:fixed or scheduled body|fixed or scheduled bodies}, worst: "
                "{where}",
       none="all bodies move freely")
def _schedules(evidence: Evidence, worst: Worst) -> None:
    bodies, frames, time = evidence.model.bodies, evidence.frames, evidence.run.time
    for b in np.flatnonzero(~bodies.free).tolist():
        body = evidence.model.mechanism.bodies[b]
        pose = np.tile(np.array([*body.at, body.angle])[:, None], len(time))
        for axis, signal in enumerate((body.path.x, body.path.y, body.path.angle)
                                      if body.path is not None else ()):
            if signal is not None:
                pose[axis] = values(signal, time, evidence.model.mechanism.functions)
        off = np.abs(frames.pose[:, b] - pose).max(axis=0)
        # a scheduled body moves by h v in every step
        steps = time / evidence.h if body.path is not None else 1.0
        worst.add(bodies.name[b], off, ROUNDING + DIGITS * steps * (1 + np.abs(pose).max(axis=0)))


@Check("velocity", "m/s", "v = dx/dt", asks="are velocities the time derivatives of poses?",
       compared="velocities and accelerations against the differences of the poses{note}, "
                "{count:comparison}, worst: {where}",
       none="there is no body")
def _velocities(evidence: Evidence, worst: Worst) -> str:
    bodies, frames, h = evidence.model.bodies, evidence.frames, evidence.h
    if len(evidence.run) < FEW:
        worst.left_out.append("there are too few samples")
        return ""
    for b in np.flatnonzero(~bodies.fixed).tolist():
        for pose, v, a in zip(*(
                part[:, b] for part in (frames.centre, evidence.velocity, frames.acceleration)),
                strict=True):
            if not evidence.every_step:
                _between(evidence, bodies.name[b], pose, v, a, worst)
                continue
            # a step moves by h v and then changes v by h a; an impact displaces the pose besides
            after, lost = v + h / 2 * a, 8 * DIGITS * (1 + peak(pose)) / h
            worst.add(bodies.name[b], np.abs(np.diff(pose) / h - after[:-1])[
                ~evidence.struck[:-1]], lost)
            worst.add(bodies.name[b], np.abs(after[:-1] - (v - h / 2 * a)[1:]),
                      ROUNDING + 8 * DIGITS * (peak(v) + h * peak(a)))
    for b in np.flatnonzero(bodies.fixed).tolist():
        v, a = evidence.velocity[:, b], frames.acceleration[:, b]
        worst.add(bodies.name[b], np.abs(np.concatenate([v, a])).max(axis=0), ROUNDING)
    return "" if evidence.every_step else ", where samples are far apart by the trapezoid rule"


def _between(evidence: Evidence, name: str, pose: Array, v: Array, a: Array, worst: Worst) -> None:
    """Compare the mean velocity with the displacement between samples, by the trapezoid rule.

    Impacts are in few samples, so the median is compared with the mean tolerance.
    """
    dt = float(np.median(np.diff(evidence.run.time)))
    bend = (np.abs(v[2:] - 2 * v[1:-1] + v[:-2])
            + np.abs(v[2:] - v[:-2] - dt / 2 * (a[2:] + 2 * a[1:-1] + a[:-2])))
    error = np.abs((pose[2:] - pose[:-2]) / (2 * dt) - (v[2:] + 2 * v[1:-1] + v[:-2]) / 4)
    moving = np.abs(v[1:-1]) >= FAST * peak(v)
    if np.count_nonzero(moving) >= FEW or not np.isfinite(error).all():
        allowed = float(np.mean(bend[moving])) + 8 * DIGITS * (1 + np.abs(pose).max()) / dt
        worst.add(name, np.median(error[moving], keepdims=True), allowed)


@Check("hinge", "rad", "q = θb - θa", asks="is each hinge angle the angle between its two bodies?",
       compared="angles and rates of hinges against those of their bodies, {count:hinge}, worst: "
                "{where}")
def _hinges(evidence: Evidence, worst: Worst) -> None:
    joints, a = evidence.model.joints, evidence.arrays
    for j in joints.hinges.tolist():
        for what, found in (("angle", evidence.angles[j]), ("rate", evidence.rates[j])):
            size = 1 + peak(found)
            off = np.abs(found - a[f"joint_{what}"][:, j]) / size
            worst.add(f"{what} of {joints.name[j]}", off, ROUNDING)
