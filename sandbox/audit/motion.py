"""Motion: times, numbers of the scene, scheduled poses, velocities and hinges."""

from __future__ import annotations

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import DIGITS, ROUNDING, NotComputed, Worst, check, peak
from sandbox.samples.cords import lengths_at_start, rest_lengths
from sandbox.values.signals import values

FEW = 8
"""Least number of samples for differences of poses."""
FAST = 0.1
"""Fraction of its largest velocity above which a body counts as moving."""


@check("clock", "step", "t = (k - 1/2) h", asks="do the sample times match the sample rate?")
def _clock(evidence: Evidence, worst: Worst) -> str:
    run, settings = evidence.whole, evidence.model.mechanism.run
    h, time = settings.solver_step, run.time
    every = max(1, round(1 / (run.info.sample_rate * h)))
    k = time / h + 0.5
    off = np.abs(k - np.round(k))
    if len(time) > 1:
        off = np.maximum(off, np.abs(np.diff(k, prepend=k[0] - every) - every))
    step = abs(run.info.step / h - 1)
    worst.judge(max(peak(off), step),
                8 * DIGITS * float(np.abs(k).max(initial=1.0)) + ROUNDING)
    return (f"distance of samples from the middle of a step of {h:g} s, and from a spacing of "
            f"{every} steps")


@check("scene.numbers", asks="are masses and lengths those of the scene?",
       compared="recorded masses, centres of mass, rest lengths and initial lengths against the "
                "scene, {count:number}, worst: {where}",
       none="there is no body")
def _numbers(evidence: Evidence, worst: Worst) -> None:
    model, a = evidence.model, evidence.run.arrays
    bodies = model.bodies
    compared = {"centre": (bodies.name, np.hypot(*(a["body_centre"] - bodies.centre).T))} | {
        what: (bodies.name, np.where(a[f"body_{what}"] == of, 0.0, a[f"body_{what}"] / of - 1))
        for what, of in (("mass", bodies.mass), ("inertia", bodies.inertia))}
    compared |= {what: (model.tendons.name, a[f"tendon_{what}"] - of(model)) for what, of in (
        ("initial", lengths_at_start), ("rest", rest_lengths))}
    for what, (names, off) in compared.items():
        for name, error in zip(names, np.abs(off), strict=True):
            worst.add(f"{what} of {name}", error[None], ROUNDING)


@check("schedule", "m", "x(t)", asks="do fixed and scheduled bodies follow the scene?",
       compared="poses of {count:fixed or scheduled body|fixed or scheduled bodies}, worst: "
                "{where}",
       none="all bodies move freely")
def _schedules(evidence: Evidence, worst: Worst) -> None:
    bodies, frames = evidence.model.bodies, evidence.loads.frames
    time = evidence.run.time
    for b in np.flatnonzero(~bodies.free).tolist():
        body = evidence.model.mechanism.bodies[b]
        pose = np.tile(np.array([*body.at, body.angle])[:, None], len(time))
        for axis, signal in enumerate((body.path.x, body.path.y, body.path.angle)
                                      if body.path is not None else ()):
            if signal is not None:
                pose[axis] = values(signal, time, evidence.model.mechanism.functions)
        off = np.abs(np.stack([frames.x[b], frames.y[b], frames.angle[b]]) - pose).max(axis=0)
        # a scheduled body moves by h v in every step
        steps = time / evidence.h if body.path is not None else 1.0
        worst.add(bodies.name[b], off, ROUNDING + DIGITS * steps * (1 + np.abs(pose).max(axis=0)))


@check("velocity", "m/s", "v = dx/dt", asks="are velocities the time derivatives of poses?",
       compared="velocities and accelerations against the differences of the poses{note}, "
                "{count:comparison}, worst: {where}",
       none="there is no body")
def _velocities(evidence: Evidence, worst: Worst) -> str:
    bodies = evidence.model.bodies
    if len(evidence.run) < FEW:
        raise NotComputed("there are too few samples")
    for b in np.flatnonzero(~bodies.fixed).tolist():
        (_in_every_step if evidence.every_step else _between)(evidence, b, worst)
    for b in np.flatnonzero(bodies.fixed).tolist():
        v, a = evidence.velocity[:, b], evidence.loads.frames.acceleration[:, b]
        worst.add(bodies.name[b], np.abs(np.concatenate([v, a])).max(axis=0), ROUNDING)
    return "" if evidence.every_step else ", where samples are far apart by the trapezoid rule"


def _in_every_step(evidence: Evidence, b: int, worst: Worst) -> None:
    """A step moves by h v and then changes v by h a, except where an impact displaced the pose."""
    frames, h = evidence.loads.frames, evidence.h
    v, a = evidence.velocity[:, b], frames.acceleration[:, b]
    name = evidence.model.bodies.name[b]
    for axis, pose in enumerate((frames.centre_x[b], frames.centre_y[b], frames.angle[b])):
        after, top = v[axis] + h / 2 * a[axis], peak(v[axis])
        lost = 8 * DIGITS * (1 + peak(pose)) / h
        worst.add(name, np.abs(np.diff(pose) / h - after[:-1])[~evidence.struck[:-1]], lost)
        before = v[axis] - h / 2 * a[axis]
        worst.add(name, np.abs(after[:-1] - before[1:]), ROUNDING + 8 * DIGITS * (
            top + h * peak(a[axis])))


def _between(evidence: Evidence, b: int, worst: Worst) -> None:
    """Compare the mean velocity with the displacement between samples.

    The error of the trapezoid rule is a sixth of the second difference of v where samples resolve
    the motion, else the difference between the changes of velocity and the accelerations. Impacts
    are in few samples, so the median is compared with the mean tolerance.
    """
    frames, time = evidence.loads.frames, evidence.run.time
    dt = float(np.median(np.diff(time)))
    for axis, pose in enumerate((frames.centre_x[b], frames.centre_y[b], frames.angle[b])):
        v = evidence.velocity[axis, b]
        a = frames.acceleration[axis, b]
        bend = (np.abs(v[2:] - 2 * v[1:-1] + v[:-2])
                + np.abs(v[2:] - v[:-2] - dt / 2 * (a[2:] + 2 * a[1:-1] + a[:-2])))
        error = np.abs((pose[2:] - pose[:-2]) / (2 * dt) - (v[2:] + 2 * v[1:-1] + v[:-2]) / 4)
        moving = np.abs(v[1:-1]) >= FAST * peak(v)
        if np.count_nonzero(moving) < FEW and np.isfinite(error).all():
            continue
        allowed = float(np.mean(bend[moving])) + 8 * DIGITS * (1 + np.abs(pose).max()) / dt
        worst.add(evidence.model.bodies.name[b], np.median(error[moving], keepdims=True), allowed)


@check("hinge", "rad", "q = θb - θa", asks="is each hinge angle the angle between its two bodies?",
       compared="angles and rates of hinges against those of their bodies, {count:hinge}, worst: "
                "{where}",
       none="there is no hinge")
def _hinges(evidence: Evidence, worst: Worst) -> None:
    joints, a = evidence.model.joints, evidence.run.arrays
    for j in joints.hinges.tolist():
        for what, found in (("angle", evidence.angles[j]), ("rate", evidence.rates[j])):
            size = 1 + peak(found)
            off = np.abs(found - a[f"joint_{what}"][:, j]) / size
            worst.add(f"{what} of {joints.name[j]}", off, ROUNDING)
