"""Releases, drives and stops: signals, motors, servos, work."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import (
    DIGITS,
    EXACT,
    NOT_EVERY_STEP,
    ROUNDING,
    SMALLEST_SCALE,
    STILL,
    STOPPED,
    NotComputed,
    Worst,
    check,
    lost_rate,
    peak,
    whole,
)
from sandbox.model.joints import lengthening, turning
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.cords import piece_tensions
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import values

SOLVED = 1e-9
"""Error of the rates of bounded rows, relative to the largest."""
HELD, FADED = 1e-10, 0.01
"""Regularisation of impulses towards the last ones, and the fraction of these that fades
(docs/engine.md)."""


# -- release and breaking ---------------------------------------------------------------------


@check("release.force", "N", "F = 0 where released",
       asks="do released and broken elements carry no load?")
def _released(evidence: Evidence, worst: Worst) -> str:
    ties, held, most, told = evidence.model.ties, evidence.run.arrays["held"], 0.0, []
    if not ties.name:
        raise NotComputed("nothing can be released")
    for tie, name in enumerate(ties.name):
        holds = held[:, tie] != 0.0
        gone = ~holds
        gone[1:] &= ~holds[:-1]  # in the step of breaking it carries a part of its load
        most = max(most, peak(_load(evidence, tie)[gone]))
        if not holds.all():
            told.append(f"{name} at {evidence.run.time[int(np.argmin(holds))]:.4g} s"
                        + _lost_energy(evidence, tie, holds))
    worst.judge(most, 0.0)
    return "largest load of released elements; released: " + ("; ".join(told[:4]) or "nothing")


@check("release.load", source="F <= F_b", asks="does no element carry more than its breaking load?",
       compared="load above the breaking load, relative to it, {count:element}, worst: {where}",
       none="no element has a breaking load")
def _breaking_loads(evidence: Evidence, worst: Worst) -> None:
    ties = evidence.model.ties
    if not ties.name:
        raise NotComputed("nothing can be released")
    for tie in np.flatnonzero(np.isfinite(ties.breaks_at)).tolist():
        over = _load(evidence, tie) / ties.breaks_at[tie] - 1.0
        worst.add(ties.name[tie], np.maximum(over, 0.0), EXACT,
                  evidence.run.arrays["held"][:, tie] != 0.0)


def _load(evidence: Evidence, tie: int) -> Array:
    """Magnitude of the load of an element [N, N m], [n]; of a tendon the largest tension."""
    (kind, i), model = evidence.model.ties.element(tie), evidence.model
    if kind == "joints":
        return np.asarray(evidence.run.arrays["joint_reaction"][:, i])
    if kind == "tendons":
        pieces = np.flatnonzero(model.tendons.stretch_tendon == i)
        return np.asarray(np.abs(piece_tensions(
            model, evidence.run.arrays, pieces)).max(axis=0))
    force = evidence.loads.spring_forces[i]
    if model.springs.straight[i]:
        return np.asarray(np.abs(force))
    least = EXACT * peak(evidence.run.arrays["spring_force"][:, i])
    return np.asarray(np.where(np.abs(force) > least, np.abs(force), 0.0))


def _lost_energy(evidence: Evidence, tie: int, holds: Flags) -> str:
    """The energy of a linear spring or tendon that is lost when it is released, in words."""
    (kind, i), model = evidence.model.ties.element(tie), evidence.model
    last = int(np.argmin(holds)) - 1
    if kind == "joints" or last < 0:
        return ""
    springs, tendons = model.springs, model.tendons
    nonlinear, k = ((springs.law[i] is not None or springs.drive[i] >= 0, springs.stiffness[i])
                    if kind == "springs" else
                    (max(tendons.drive[i], tendons.stiffener[i]) >= 0, tendons.stiffness[i]))
    if nonlinear or not k > 0:
        return ""
    return f" with {float(_load(evidence, tie)[last]) ** 2 / (2 * k):.3g} J, which go with it"


# -- drives and stops -------------------------------------------------------------------------


def set_while_running(mechanism: Mechanism) -> set[str]:
    """Names of everything that controllers and events set, drives among them."""
    names = {name for controller in mechanism.controllers for name in controller.written}
    keys = {key for event in mechanism.events for key in event.set}
    return names | keys | {key.split(".")[0] for key in keys}


@check("drive.signal", source="u(t)", asks="do drives have the values of the scene?",
       compared="values of {count:drive} against their signals, relative to the largest of each, "
                "worst: {where}{note}",
       none="there is no drive")
def _signals(evidence: Evidence, worst: Worst) -> str:
    """A drive's value is its signal at the sample; a motor's, a rigid servo's is that of later."""
    mechanism, drives, a = evidence.model.mechanism, evidence.model.drives, evidence.run.arrays
    set_by = set_while_running(mechanism)
    for i, drive in enumerate(mechanism.drives):
        if drive.name not in set_by:
            late = evidence.h * float(drives.late[i])
            signal = np.maximum(values(drive.signal(mechanism), evidence.run.time + late,
                                       mechanism.functions), drives.floor[i])
            worst.add(drive.name, np.abs(a["drive_value"][:, i] - signal) / whole(signal), ROUNDING)
    left_out = [drive.name for drive in mechanism.drives if drive.name in set_by]
    note = f"left out, because the run changes them: {', '.join(left_out[:3])}"
    if left_out and not worst.count:
        raise NotComputed(note)
    return f"; {note}" if left_out else ""


@check("drive.motor", source="ω = u, τ = c (u - ω) or τ = ±τmax",
       asks="do motors and brakes keep their speed, or act at their limit?",
       compared="rates and torques of motors and brakes against their targets and limits, "
                "{count:comparison}, worst: {where}",
       none="there is no motor and no brake")
def _motors(evidence: Evidence, worst: Worst) -> None:
    """Motors and brakes keep their speed at the end of a step, or act at their limit."""
    model, a = evidence.model, evidence.run.arrays
    h, drives = evidence.h, model.drives
    rates, shared = evidence.rates_after, _limited_drives(evidence)
    for i, kind in enumerate(drives.kind):
        if not kind.limited:
            continue
        j, torque, value = int(drives.target[i]), a["drive_torque"][:, i], a["drive_value"][:, i]
        brake = bool(np.isnan(drives.most[i]))
        most = value if brake else np.full(len(torque), drives.most[i])
        largest = whole(most)
        if np.isfinite(largest):
            worst.add(f"limit of {drives.name[i]}",
                      np.maximum(np.abs(torque) - most, 0.0) / largest, EXACT)
        if shared[j] > 1 or kind.places:
            continue
        if not np.isnan(drives.slope[i]):
            _compare_line(evidence, i, worst)
            continue
        off = (rates[j] - (0.0 if brake else value) + bend(evidence, j)) * evidence.joints_hold[j]
        gives = np.abs(torque) < most * (1 - EXACT)
        fast = 1 + peak(rates[j])
        # within its limit it holds its speed; at it, it pulls towards that
        wrong = np.where(gives, np.abs(off), np.maximum(off * np.sign(torque), 0.0))
        held = np.where(gives, held_off(evidence, i, h * most), 0.0)
        worst.add(drives.name[i], wrong / fast, SOLVED + (STILL[1] + DIGITS / h + held) / fast)


def _limited_drives(evidence: Evidence) -> Integers:
    """Number of drives with a limit of each joint, [nj]."""
    drives = evidence.model.drives
    limited = [target for target, kind in zip(drives.target, drives.kind, strict=True)
               if kind.limited]
    return np.bincount(np.array(limited, dtype=np.int64),
                       minlength=len(evidence.model.joints.name))


def _compare_line(evidence: Evidence, drive: int, worst: Worst) -> None:
    """Compare a motor's torque with its line at the rate at mid-step, within its limit."""
    drives, a = evidence.model.drives, evidence.run.arrays
    torque, rate = a["drive_torque"][:, drive], evidence.rates[drives.target[drive]]
    slope, most = float(drives.slope[drive]), float(drives.most[drive])
    law = np.clip(slope * (a["drive_value"][:, drive] - rate), -most, most)
    kept = held_off(evidence, drive, np.full(len(torque), np.inf))
    allowed = EXACT * whole(torque) + slope * (kept + lost_rate(rate, turning=True))
    worst.add(f"line of {drives.name[drive]}", np.abs(torque - law) / whole(torque),
              allowed / whole(torque),
              evidence.holds("joint")[drives.target[drive]])


def bend(evidence: Evidence, joint: int) -> Array:
    """Rate of an actuator's length in a step besides that along its line [m/s], [n]; 0 of hinges.

    It follows from the velocities before the step, as in the engine.
    """
    if not evidence.model.joints.kind[joint].line:
        return np.zeros(len(evidence.run))
    frames, h = evidence.loads.frames, evidence.h
    before = evidence.velocity - h / 2 * frames.acceleration
    ahead = []
    for n, ends in zip(evidence.model.joints.bodies[joint], frames.anchors, strict=True):
        c, s = np.cos(h * before[2, n]), np.sin(h * before[2, n])
        x, y = ends.arm_x[joint], ends.arm_y[joint]
        ahead.append((frames.centre_x[n] + h * before[0, n] + c * x - s * y,
                      frames.centre_y[n] + h * before[1, n] + s * x + c * y))
    (ax, ay), (bx, by) = ahead
    rate = evidence.rates_of(before)[joint]
    return np.asarray((np.hypot(bx - ax, by - ay) - frames.gaps[joint]) / h - rate)


def initial_rate(evidence: Evidence, drive: int) -> float:
    """Rate of the hinge or actuator of a motor or brake at t = 0, from the scene [rad/s, m/s]."""
    model, joint = evidence.model, int(evidence.model.drives.target[drive])
    if model.joints.kind[joint].line:
        return lengthening(model, joint)
    return float(model.joints.sense[joint] * turning(model, joint))


def held_off(evidence: Evidence, drive: int, most: Array) -> Array:
    """Error of a rate by the regularisation towards the last impulses [rad/s], [n].

    It is :data:`HELD` times the change of the impulse times the response of the two bodies without
    joints; :data:`FADED` of the last impulse is dropped first. Where the step before was not
    recorded, its impulse follows from the work since the last sample, and is ``most`` at most.
    """
    a, h, joints = evidence.run.arrays, evidence.h, evidence.model.joints
    j = int(evidence.model.drives.target[drive])
    alone = float((1 / a["body_inertia"][joints.bodies[j]]).sum())
    if joints.kind[j].line:  # a rod of its points' masses at most
        alone = float((1 / a["body_mass"][joints.bodies[j]]).sum()
                      + sum((end[j] ** 2 / a["body_inertia"][n]).max() for n, ends in zip(
                          joints.bodies[j], evidence.loads.frames.anchors, strict=True)
                          for end in (ends.arm_x, ends.arm_y)))
    impulse = h * np.abs(a["drive_torque"][:, drive])
    if evidence.every_step:
        change = np.abs(np.diff(h * a["drive_torque"][:, drive], prepend=0.0))
        last = np.concatenate([[0.0], impulse[:-1]])
    else:
        rate = np.concatenate([[initial_rate(evidence, drive)], evidence.rates[j]])
        work = np.abs(np.diff(a["drive_work"][:, drive], prepend=0.0))
        mean = np.abs(rate[1:] + rate[:-1]) / 2
        last = np.minimum(np.where(work > 0, work / mean, 0.0), most)
        change = impulse + last
    return np.asarray(HELD * alone * (change + FADED * last))


@check("stop.law", "rad", "τ > 0 at the limit only", asks="do stops act only at the hinge limits?",
       compared="distance of stops in action from their limit, and overshoot in a step, "
                "{count:comparison}, worst: {where}",
       none="no hinge has stops")
def _stops(evidence: Evidence, worst: Worst) -> None:
    joints, a, h = evidence.model.joints, evidence.run.arrays, evidence.h
    rates = evidence.rates_after
    for j in joints.stopped.tolist():
        torque, angle = a["joint_stop"][:, j], evidence.angles[j]
        low, high = joints.stops[j].tolist()
        to_low, to_high = angle + h * rates[j] - low, high - angle - h * rates[j]
        ahead = np.where(torque > 0, np.minimum(to_low, angle - low),
                         np.where(torque < 0, np.minimum(to_high, high - angle), 0.0))
        fast = 1 + peak(rates[j])
        # an overrun is corrected at up to 1 rad/s, and may last
        wrong = np.where(ahead > 0, ahead, 0.0)
        worst.add(joints.name[j], wrong, STOPPED + h * SOLVED * fast, evidence.holds("joint")[j])
        worst.add(f"reach of {joints.name[j]}", np.maximum(np.maximum(-to_low, -to_high), 0.0),
                  STOPPED + h * SOLVED * fast + np.maximum(
                      np.maximum(low - angle, angle - high) - h, 0.0), evidence.joints_hold[j])


@check("work", source="W = Σ h F v", asks="is the work of each element the integral of its power?",
       compared="recorded work against the sum of force times rate over all steps, relative to all "
                "work of each of {count:element}, worst: {where}",
       none="nothing works")
def _works(evidence: Evidence, worst: Worst) -> None:
    if not evidence.every_step:
        raise NotComputed(NOT_EVERY_STEP)
    for name, power, work in _powers(evidence):
        each = evidence.h * power
        added = np.cumsum(each) - each / 2 - (np.cumsum(each) - each / 2)[0]
        off = np.abs(work - work[0] - added)[evidence.known]
        worst.add(name, off / max(float(np.abs(each).sum()), SMALLEST_SCALE), EXACT)


def _powers(evidence: Evidence) -> Iterator[tuple[str, Array, Array]]:
    """Name, power [W] and recorded work [J] of every element that works, [n] each.

    Forces on single bodies are left out.
    """
    model, a = evidence.model, evidence.run.arrays
    velocity = evidence.velocity + evidence.displacement / evidence.h
    works: dict[str, Any] = {
        "tendon": model.tendons, "line": model.lines, "spring": model.springs,
        "joint_damping": model.joints, "joint_friction": model.joints, "drive": model.drives}
    for batch in evidence.loads.batches:
        kind = f"joint_{batch.kind}" if batch.kind in ("damping", "friction") else batch.kind
        if kind not in works:
            continue
        prefix = {"damping": "damper of ", "friction": "friction of "}.get(batch.kind, "")
        names: tuple[str, ...] = works[kind].name
        power = batch.rates(len(names), velocity)
        for i in np.unique(batch.element).tolist():
            yield prefix + names[i], power[i], np.nan_to_num(a[f"{kind}_work"][:, i])
    for i in model.drives.giving("surface").tolist() if evidence.one_normal.all() else []:
        on = np.isin([a["contact_body"], a["contact_other"]], model.drives.target[i]).any(axis=0)
        friction = np.bincount(a["contact_sample"][on], evidence.run.contacts.tangential[on],
                               len(evidence.run))
        yield (model.drives.name[i], model.drives.sense[i] * a["drive_value"][:, i] * friction,
               a["drive_work"][:, i])


@check("drive.place", source="τ = k (u − q) − c q′ or q → u",
       asks="does each servo effort follow its law?",
       compared="efforts of {count:servo} against k (u - q) - c q', relative to the limit; rigid "
                "servos below their limit: movement away from the target, relative to the travel; "
                "worst: {where}",
       none="there is no servo, or not every step was recorded")
def _places(evidence: Evidence, worst: Worst) -> None:
    drives, shared = evidence.model.drives, _limited_drives(evidence)
    for i, kind in enumerate(drives.kind):
        if not kind.places:
            continue
        if np.isfinite(drives.stiffness[i]):
            worst.add(drives.name[i], *_sprung(evidence, i))
        elif evidence.every_step and shared[drives.target[i]] == 1:
            worst.add(drives.name[i], *_approach(evidence, i))


def _sprung(evidence: Evidence, drive: int) -> tuple[Array, Array]:
    """Error and tolerance of the law of a servo, relative to its limit, [n] each.

    The law is at mid-step, or at the step's end if it is too stiff for the step, in all samples
    alike.
    """
    drives, a, h = evidence.model.drives, evidence.run.arrays, evidence.h
    j, most = int(drives.target[drive]), float(drives.most[drive])
    k, c = float(drives.stiffness[drive]), float(drives.damping[drive])
    rate, after = evidence.rates[j], evidence.rates_after[j]
    missing = k * (a["drive_value"][:, drive] - evidence.angles[j])
    evenly = missing - c * rate - k * h / 2 * (after - rate)
    at_end = missing - (c + h * k) * after
    given = a["drive_torque"][:, drive]
    holds = evidence.holds("joint")[j]
    off = min((holds * np.abs(np.clip(law, -most, most) - given) for law in (evenly, at_end)),
              key=peak)
    held = held_off(evidence, drive, np.full(len(given), h * most))
    wrong = (c + h * k) * (SOLVED * (1 + peak(after)) + STILL[1] + DIGITS / h + held)
    wrong += k * ROUNDING * (1 + np.abs(evidence.angles[j]))
    return off / most, EXACT + wrong / most


def _approach(evidence: Evidence, drive: int) -> tuple[Array, Array]:
    """Motion of a rigid servo away from its target, and tolerance, relative to its travel, [n - 1].

    A servo of limited speed may fall behind a moving target.
    """
    drives, a, h = evidence.model.drives, evidence.run.arrays, evidence.h
    j, most, place = int(drives.target[drive]), float(drives.most[drive]), evidence.angles[
        int(drives.target[drive])]
    value = a["drive_value"][:, drive]
    short = np.abs(value[:-1] - place[1:])
    before, moved = np.concatenate([[np.inf], short[:-1]]), np.abs(np.diff(value, prepend=value[0]))
    spare = np.abs(a["drive_torque"][:-1, drive]) < most * (1 - EXACT)
    holds = evidence.holds("joint")[j]
    spare &= holds[:-1] & holds[1:]
    spare &= (moved[:-1] == 0) | np.isinf(drives.fastest[drive])
    span = float(np.ptp(place)) + peak(short) + ROUNDING
    held = held_off(evidence, drive, np.full(len(value), h * most))[:-1]
    slack = evidence.joint_slack[j, 1:] + 2 * h * (
        STILL[1] + held + SOLVED * (1 + peak(evidence.rates_after[j]))) + ROUNDING * (
        1 + np.abs(place[1:]))
    return np.where(spare, np.maximum(short - before, 0.0), 0.0) / span, slack / span
