"""Figures of drives and stops: signals, motors, servos, work."""

from __future__ import annotations

from collections.abc import Iterator

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
    Figure,
    Worst,
    lost_rate,
    missing,
    peak,
    whole,
)
from sandbox.model.starts import lengthening, turning
from sandbox.model.ties import held_one
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import values

SOLVED = 1e-9
"""Share of the fastest that bounded rows see by which their rates may be off."""
HELD, FADED = 1e-10, 0.01
"""How strongly impulses are held to the last, and how much of these fades (docs/engine.md)."""


def driven_figures(evidence: Evidence) -> Iterator[Figure]:
    """Signals, motors and brakes, stops, work, servos."""
    yield _signals(evidence)
    yield _motors(evidence)
    yield _stops(evidence)
    yield _works(evidence)
    yield _places(evidence)


def set_while_running(mechanism: Mechanism) -> set[str]:
    """Names of all that controllers and events set, drives among them."""
    names = {name for controller in mechanism.controllers for name in controller.written}
    keys = {key for event in mechanism.events for key in event.set}
    return names | keys | {key.split(".")[0] for key in keys}


def _signals(evidence: Evidence) -> Figure:
    """A drive's value is its signal's at the sample; a motor's, a rigid servo's that of later."""
    mechanism, drives, a = evidence.model.mechanism, evidence.model.drives, evidence.run.arrays
    set_by, worst, left_out = set_while_running(mechanism), Worst(), []
    for i, drive in enumerate(mechanism.drives):
        if drive.name in set_by:
            left_out.append(drive.name)
            continue
        late = evidence.h * float(drives.late[i])
        signal = np.maximum(values(drive.signal(mechanism), evidence.run.time + late,
                                   mechanism.functions), drives.floor[i])
        most = whole(signal)
        worst.add(drive.name, np.abs(a["drive_value"][:, i] - signal) / most, ROUNDING)
    more = f"; left out, because the run changes them: {', '.join(left_out[:3])}"
    return worst.figure(
        "drive.signal", "", source="u(t)",
        none="there is no drive" if not left_out else more.removeprefix("; "),
        why="values of {count:drive} against their signals, relative to the largest of each, "
            "worst: {where}" + (more if left_out else ""))


def _motors(evidence: Evidence) -> Figure:
    """Motors and brakes give what keeps their speed at the end of a step, or the most they can."""
    model, a, worst = evidence.model, evidence.run.arrays, Worst()
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
            _line(evidence, i, worst)
            continue
        off = (rates[j] - (0.0 if brake else value) + bend(evidence, j)) * evidence.joints_hold[j]
        gives = np.abs(torque) < most * (1 - EXACT)
        fast = 1 + peak(rates[j])
        # within its limit it holds its speed; at it, it pulls towards that
        wrong = np.where(gives, np.abs(off), np.maximum(off * np.sign(torque), 0.0))
        held = np.where(gives, held_off(evidence, i, h * most), 0.0)
        worst.add(drives.name[i], wrong / fast, SOLVED + (STILL[1] + DIGITS / h + held) / fast)
    return worst.figure(
        "drive.motor", "", source="ω = u, τ = c (u - ω) or τ = ±τmax",
        none="there is no motor and no brake",
        why="rates and torques of motors and brakes against their targets and limits, "
            "{count:comparison}, worst: {where}")


def _limited_drives(evidence: Evidence) -> Integers:
    """How many drives with a limit each joint has, [nj]."""
    drives = evidence.model.drives
    limited = [target for target, kind in zip(drives.target, drives.kind, strict=True)
               if kind.limited]
    return np.bincount(np.array(limited, dtype=np.int64),
                       minlength=len(evidence.model.joints.name))


def _line(evidence: Evidence, drive: int, worst: Worst) -> None:
    """A motor's torque is that of its line at the rate in the middle of the step, or its most."""
    drives, a = evidence.model.drives, evidence.run.arrays
    torque, rate = a["drive_torque"][:, drive], evidence.rates[drives.target[drive]]
    slope, most = float(drives.slope[drive]), float(drives.most[drive])
    law = np.clip(slope * (a["drive_value"][:, drive] - rate), -most, most)
    # its impulse is held to the last as others are, by so much of a rate
    kept = held_off(evidence, drive, np.full(len(torque), np.inf))
    allowed = EXACT * whole(torque) + slope * (kept + lost_rate(rate, turning=True))
    worst.add(f"line of {drives.name[drive]}", np.abs(torque - law) / whole(torque),
              allowed / whole(torque), still_held(evidence, int(drives.target[drive])))


def still_held(evidence: Evidence, joint: int) -> Flags:
    """In which samples a joint holds, [n]: what acts about one that is let go gives nothing.

    In the step in which it breaks a part of what it gave, of either sign.
    """
    return held_one(evidence.model.ties.joint[joint], evidence.run.arrays["held"])


def bend(evidence: Evidence, joint: int) -> Array:
    """The rate by which an actuator grows longer in a step, besides that along its line [m/s], [n].

    As the velocities before the step have it: those that the engine has foreseen it by. 0 of
    hinges.
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
    """Of the hinge or actuator of a motor or brake at t = 0, from the scene [rad/s, m/s]."""
    model, joint = evidence.model, int(evidence.model.drives.target[drive])
    if model.joints.kind[joint].line:
        return lengthening(model, joint)
    return float(model.joints.sense[joint] * turning(model, joint))


def held_off(evidence: Evidence, drive: int, most: Array) -> Array:
    """How far a rate may be off since impulses are held to those of the step before [rad/s], [n].

    A row's rate is :data:`HELD` times the change of its impulse times what its two bodies,
    joined to nothing, make of one; of the last impulse up to :data:`FADED` is forgotten first.
    On a light link that leads a heavy one bodies make far more of it than the mechanism does.
    Where the step before was not recorded, its impulse is what did the work since the last
    sample, and ``most`` at most.
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


def _stops(evidence: Evidence) -> Figure:
    """A stop pushes back, and only where the hinge comes to its limit in that step."""
    joints, a, worst, h = evidence.model.joints, evidence.run.arrays, Worst(), evidence.h
    rates = evidence.rates_after
    for j in joints.stopped.tolist():
        torque, angle = a["joint_stop"][:, j], evidence.angles[j]
        low, high = joints.stops[j].tolist()
        to_low, to_high = angle + h * rates[j] - low, high - angle - h * rates[j]
        ahead = np.where(torque > 0, to_low, np.where(torque < 0, to_high, 0.0))
        fast = 1 + peak(rates[j])
        # an overrun goes back no faster than 1 rad/s, and may last
        wrong = np.where(ahead > 0, ahead, 0.0)
        worst.add(joints.name[j], wrong, STOPPED + h * SOLVED * fast, still_held(evidence, j))
        worst.add(f"reach of {joints.name[j]}", np.maximum(np.maximum(-to_low, -to_high), 0.0),
                  STOPPED + h * SOLVED * fast + np.maximum(
                      np.maximum(low - angle, angle - high) - h, 0.0), evidence.joints_hold[j])
    return worst.figure(
        "stop.law", "rad", source="τ > 0 at the limit only", none="no hinge has stops",
        why="distance of stops in action from their limit, and overshoot in a step, "
            "{count:comparison}, worst: {where}")


def _works(evidence: Evidence) -> Figure:
    """Work, added up, against forces and rates of every recorded step."""
    name, source = "work", "W = Σ h F v"
    if not evidence.every_step:
        return missing(name, source=source, why=NOT_EVERY_STEP)
    worst, h = Worst(), evidence.h
    for label, power, work in _powers(evidence):
        each = h * power
        added = np.cumsum(each) - each / 2 - (np.cumsum(each) - each / 2)[0]
        moved = float(np.abs(each).sum())
        off = np.abs(work - work[0] - added)[evidence.known]
        worst.add(label, off / max(moved, SMALLEST_SCALE), EXACT)
    return worst.figure(
        name, "", source=source, none="nothing works",
        why="recorded work against the sum of force times rate over all steps, relative to all "
            "work of each of {count:element}, worst: {where}")


def _powers(evidence: Evidence) -> Iterator[tuple[str, Array, Array]]:
    """Of every element that works: its name, power [W] and recorded work [J], [n]."""
    model, a, loads = evidence.model, evidence.run.arrays, evidence.loads
    way = evidence.velocity + evidence.displacement / evidence.h
    rates = evidence.rates_of(way)
    if model.tendons.name:
        power = -loads.lengthening(loads.cord_loads, len(model.tendons.name), way)
        for i, name in enumerate(model.tendons.name):
            yield name, power[i], a["tendon_work"][:, i]
    if model.lines.name:
        rate = -loads.lengthening(loads.line_pushes, len(model.lines.name), way)
        for i, name in enumerate(model.lines.name):
            yield name, a["line_pressure"][:, i] * rate[i], a["line_work"][:, i]
    straight = np.flatnonzero(model.springs.straight)
    if len(straight):
        rate = loads.lengthening(loads.spring_pulls, len(model.springs.name), way)
        for i in straight.tolist():
            yield (model.springs.name[i], -a["spring_force"][:, i] * rate[i],
                   a["spring_work"][:, i])
    for i in np.flatnonzero(~model.springs.straight).tolist():
        j = model.springs.joint[i]
        holds = still_held(evidence, j)
        torque = a["spring_force"][:, i] - holds * model.springs.damping[i] * evidence.rates[j]
        yield model.springs.name[i], -torque * rates[j], a["spring_work"][:, i]
    for j in model.joints.hinges.tolist():
        yield (f"damper of {model.joints.name[j]}", a["joint_damping"][:, j] * rates[j],
               a["joint_damping_work"][:, j])
    rate = -loads.lengthening(loads.rub_pushes, len(model.joints.name), way)
    for j in model.joints.rubbed.tolist():
        yield (f"friction of {model.joints.name[j]}", np.nan_to_num(a["joint_friction"][:, j])
               * rate[j], np.nan_to_num(a["joint_friction_work"][:, j]))
    for i in model.drives.giving("torque", "push").tolist():
        j = model.drives.target[i]
        yield model.drives.name[i], loads.given[i] * rates[j], a["drive_work"][:, i]
    for i in model.drives.giving("surface").tolist() if evidence.one_normal.all() else []:
        on = np.isin([a["contact_body"], a["contact_other"]], model.drives.target[i]).any(axis=0)
        friction = np.bincount(a["contact_sample"][on], evidence.run.contacts.tangential[on],
                               len(evidence.run))
        yield (model.drives.name[i], model.drives.sense[i] * a["drive_value"][:, i] * friction,
               a["drive_work"][:, i])


def _places(evidence: Evidence) -> Figure:
    """Drives with a stiffness give what its law says; rigid ones come nearer to their targets."""
    drives, worst, shared = evidence.model.drives, Worst(), _limited_drives(evidence)
    for i, kind in enumerate(drives.kind):
        if not kind.places:
            continue
        if np.isfinite(drives.stiffness[i]):
            worst.add(drives.name[i], *_sprung(evidence, i))
        elif evidence.every_step and shared[drives.target[i]] == 1:
            worst.add(drives.name[i], *_approach(evidence, i))
    return worst.figure(
        "drive.place", "", source="τ = k (u − q) − c q′ or q → u",
        none="there is no servo, or not every step was recorded",
        why="efforts of {count:servo} against k (u - q) - c q', relative to the limit; rigid "
            "servos below their limit: movement away from the target, relative to the travel; "
            "worst: {where}")


def _sprung(evidence: Evidence, drive: int) -> tuple[Array, Array]:
    """By how much the law is missed and may be, shares of the limit, [n] each.

    The law is taken evenly about the pose, or at the step's end where it is too stiff for the
    step: as one of the two all samples have to be.
    """
    drives, a, h = evidence.model.drives, evidence.run.arrays, evidence.h
    j, most = int(drives.target[drive]), float(drives.most[drive])
    k, c = float(drives.stiffness[drive]), float(drives.damping[drive])
    rate, after = evidence.rates[j], evidence.rates_after[j]
    missing = k * (a["drive_value"][:, drive] - evidence.angles[j])
    evenly = missing - c * rate - k * h / 2 * (after - rate)
    at_end = missing - (c + h * k) * after
    given = a["drive_torque"][:, drive]
    holds = still_held(evidence, j)
    off = min((holds * np.abs(np.clip(law, -most, most) - given) for law in (evenly, at_end)),
              key=peak)
    held = held_off(evidence, drive, np.full(len(given), h * most))
    wrong = (c + h * k) * (SOLVED * (1 + peak(after)) + STILL[1] + DIGITS / h + held)
    wrong += k * ROUNDING * (1 + np.abs(evidence.angles[j]))
    return off / most, EXACT + wrong / most


def _approach(evidence: Evidence, drive: int) -> tuple[Array, Array]:
    """By how much a rigid drive moves away from its target, and may, shares of the way, [n - 1].

    Where its speed is limited it may fall behind a target that moves.
    """
    drives, a, h = evidence.model.drives, evidence.run.arrays, evidence.h
    j, most, place = int(drives.target[drive]), float(drives.most[drive]), evidence.angles[
        int(drives.target[drive])]
    value = a["drive_value"][:, drive]
    short = np.abs(value[:-1] - place[1:])
    before, moved = np.concatenate([[np.inf], short[:-1]]), np.abs(np.diff(value, prepend=value[0]))
    spare = np.abs(a["drive_torque"][:-1, drive]) < most * (1 - EXACT)
    holds = still_held(evidence, j)
    spare &= holds[:-1] & holds[1:]
    spare &= (moved[:-1] == 0) | np.isinf(drives.fastest[drive])
    span = float(np.ptp(place)) + peak(short) + ROUNDING
    held = held_off(evidence, drive, np.full(len(value), h * most))[:-1]
    slack = evidence.joint_slack[j, 1:] + 2 * h * (
        STILL[1] + held + SOLVED * (1 + peak(evidence.rates_after[j]))) + ROUNDING * (
        1 + np.abs(place[1:]))
    return np.where(spare, np.maximum(short - before, 0.0), 0.0) / span, slack / span
