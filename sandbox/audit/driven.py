"""Fluid lines, releases, drives and stops.

The content of a line is the inflow; it fills the volume at the line's pressure. A step relates the
pressure to volume and content at the recorded instant (docs/engine.md), with one of two weights of
velocities throughout the run. At its least pressure a line may not be full.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from sandbox.audit.evidence import (
    EXACT,
    HELD,
    ROUNDING,
    SMALLEST_SCALE,
    SOLVED,
    STILL,
    STOPPED,
    Check,
    Evidence,
    NotComputed,
    Worst,
    lost_rate,
    peak,
    whole,
)
from sandbox.audit.laws import follow
from sandbox.elements.element import ATMOSPHERE
from sandbox.model.joints import lengthening, turning
from sandbox.model.model import NONE
from sandbox.numeric import Array, Integers
from sandbox.samples.cables import piece_tensions
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import values

NEWTON = 1e-8  # Relative error of the flow of an orifice at which iterations stop
FADED = 0.01  # Fraction of the last impulses that fades in a step (docs/engine.md)


def _growth(evidence: Evidence, velocity: Array) -> Array:
    """Growth rates of lines as bodies move with ``velocity`` [3, nb, n]; [nl, n]."""
    return evidence.loads.line_efforts.rates(len(evidence.model.lines.name), velocity)


def _grown(evidence: Evidence) -> tuple[Array, Array]:
    """Growth of lines since t = 0, from the poses [m^3], [nl, n], and sums of areas, [nl]."""
    lines = evidence.model.lines
    place = evidence.places(lines.bodies, lines.anchor, lines.joint)
    found = np.zeros((len(lines.name), place.shape[1]))
    np.add.at(found, lines.of, lines.gain[:, None] * (place - lines.start[:, None]))
    return found, np.bincount(lines.of, np.abs(lines.gain), len(lines.name)).astype(float)


@Check("line.volume", "m^3", "V = V0 + Σ A (L - L0)",
       asks="is the volume of each fluid line the sum of its chambers?",
       compared="volumes of {count:line} from the recorded poses, worst: {where}")
def _volumes(evidence: Evidence, worst: Worst) -> None:
    lines = evidence.model.lines
    (grown, gains), recorded = _grown(evidence), evidence.arrays["line_volume"].T
    for i, name in enumerate(lines.name):
        error = np.abs(lines.volume[i] + grown[i] - recorded[i])
        worst.add(name, error, ROUNDING * (gains[i] + lines.volume[i]))


@Check("line.flow", source="dM/dt = Σ Q", asks="does the fluid in each line equal the net inflow?",
       compared="flow into each line against valves and drives, and content against total inflow, "
                "relative to it, {count:comparison}, worst: {where}",
       none="there is no line")
def _flows(evidence: Evidence, worst: Worst) -> None:
    model, a, h = evidence.model, evidence.arrays, evidence.h
    pumps = model.drives.giving("flow", "pressure")
    for i, name in enumerate(model.lines.name):
        share = (model.valves.lines[:, 1] == i) - 1.0 * (model.valves.lines[:, 0] == i)
        into = np.concatenate([a["valve_flow"] * share, a["drive_flow"][
            :, pumps[model.drives.target[pumps] == i]]], axis=1)
        flow, most = a["line_flow"][:, i], max(peak(into), 1e-24)
        worst.add(name, np.abs(flow - into.sum(axis=1)) / most, EXACT)
        if evidence.every_step:
            came = h * (np.cumsum(flow) - flow[0])
            held = a["line_content"][:, i] + a["line_spilled"][:, i]
            turned = max(h * float(np.abs(flow).sum()), model.lines.compliance[i])
            worst.add(name, np.abs(held - held[0] - came) / turned,
                      EXACT + ROUNDING * peak(held) / turned)


@Check("line.law", "m^3", "M = V + C p", asks="does each line's pressure match its content?",
       compared="content of {count:line} against volume and pressure, worst: {where}; for gas, "
                "the linearisation error of a step is allowed")
def _pressures(evidence: Evidence, worst: Worst) -> None:
    lines, a, h = evidence.model.lines, evidence.arrays, evidence.h
    if not lines.name:
        return
    (volume, gains), ahead = _grown(evidence), a["line_ahead"].T / h
    rate = h * _growth(evidence, evidence.velocity_after)
    change = h * h * _growth(evidence, evidence.frames.acceleration)
    for i, name in enumerate(lines.name):
        p, came = a["line_pressure"][:, i], h * a["line_flow"][:, i]
        content = a["line_content"][:, i] + (ahead[i] - 0.5) * came
        void = p <= lines.least[i] + EXACT * ATMOSPHERE
        slack = gains[i] * (ROUNDING + h * max(STILL)) + EXACT * (
            lines.compliance[i] * (peak(p) + 1.0)) + ROUNDING * np.abs(content)
        laws = []
        for ratio in (1.5, 2.0):
            more = ahead[i] * rate[i] + ((ahead[i] + 0.5) / ratio - ahead[i]) * change[i]
            holds, straight = volume[i] + more + lines.compliance[i] * p, np.zeros(len(p))
            if not np.isnan(n := float(lines.gas[i])):
                total = lines.volume[i] + (volume[i] + more)
                gas = total * np.maximum(p / ATMOSPHERE + 1.0, 0.0) ** (1.0 / n)
                moved = np.abs(total - a["line_volume"][:, i]) / total + np.abs(
                    (ahead[i] + 0.5) * came) / gas
                holds, straight = gas - lines.volume[i], gas * n * moved**2
            off = np.where(void & (content < holds), 0.0, np.abs(content - holds))
            laws.append((off, slack + straight))
        worst.add_nearest(name, laws)


@Check("valve.law", source="Δp = R Q + ρ/2 (Q / Cd A)²",
       asks="does the pressure drop of each valve match its flow?",
       compared="pressure drops of {count:valve} against their flows, relative to the largest of "
                "each, worst: {where}; below 0.001 Pa an orifice counts as a long passage")
def _valves(evidence: Evidence, worst: Worst) -> None:
    """A valve that is shut has no flow; one that opens one way has none against a pressure drop."""
    valves, a = evidence.model.valves, evidence.arrays
    pressure = np.column_stack([a["line_pressure"], np.zeros(len(evidence.run))])  # NONE is last
    for v, name in enumerate(valves.name):
        flow, (one, two) = a["valve_flow"][:, v], valves.lines[v].tolist()
        across = pressure[:, one] - pressure[:, two]
        opening = np.minimum(a["drive_value"][:, valves.drive[v]], 1.0) if (
            valves.drive[v] != NONE) else np.ones(len(flow))
        shut = opening <= 1e-9
        through = flow / np.where(shut, 1.0, opening)
        off = np.abs(valves.resistance[v] * through
                     + valves.orifice[v] * np.abs(through) * through - across)
        if valves.one_way[v]:
            off = np.where(flow == 0.0, np.maximum(across, 0.0), np.maximum(off, -flow))
        most = max(whole(across), 1.0)
        worst.add(name, np.where(shut, np.abs(flow), off) / most, EXACT + 2 * NEWTON + 3e-3 / most)


@Check("line.energy", source="W = Σ (p V work + C p²/2 + throttled)",
       asks="does the work of pumps go to bodies, fluid and valves?",
       compared="work of pumps minus the work on bodies, the energy stored in fluid and the losses "
                "of valves and reliefs, relative to the total; pressure change in a step times "
                "flow is allowed")
def _energy(evidence: Evidence, worst: Worst) -> None:
    model, a, lines, h = evidence.model, evidence.arrays, evidence.model.lines, evidence.h
    if not lines.name:
        raise NotComputed("there is no line")
    if np.isfinite(lines.gas).any():
        raise NotComputed("a gas exchanges heat with its surroundings")
    evidence.require_every_step()
    p, work = a["line_pressure"], a["line_work"].sum(axis=1)
    pumps = a["drive_work"][:, model.drives.giving("flow", "pressure")].sum(axis=1)
    spilled = np.diff(a["line_spilled"], axis=0, prepend=a["line_spilled"][:1]) * p
    lost = a["valve_loss"].sum(axis=1) + (np.cumsum(spilled, axis=0) - spilled / 2).sum(axis=1)
    stored = (lines.compliance * p**2 / 2).sum(axis=1)
    left = pumps - lost - stored - work
    change = np.abs(np.diff(p, axis=0, prepend=p[:1]))
    growth, bend = (np.abs(_growth(evidence, v)).T for v in (
        evidence.velocity, evidence.frames.acceleration))
    step = np.cumsum((lines.compliance * change**2 + h * h * bend * (np.abs(p) + change)
                      + change * h * (growth + np.abs(a["line_flow"]))).sum(axis=1))
    # works are up to the middle of a step, pressures may be at its end
    half = (lines.compliance * np.abs(p) * change).sum(axis=1)
    step = step + half + half[:2].max(initial=0.0)
    scale = max(peak(np.abs(pumps) + np.abs(work) + stored + np.abs(lost)), 1e-15)
    error = np.abs(left - left[0])
    k = int(np.argmax(error - step))
    worst.judge(error[k] / scale, EXACT + step[k] / scale)


@Check("release.force", "N", "F = 0 where released",
       asks="do released and broken elements carry no load?")
def _released(evidence: Evidence, worst: Worst) -> str:
    bonds, held, most, released = evidence.model.bonds, evidence.arrays["held"], 0.0, []
    if not bonds.name:
        raise NotComputed("nothing can be released")
    for bond, name in enumerate(bonds.name):
        gone = held[:, bond] == 0.0
        if gone.any():
            released.append(f"{name} at {evidence.run.time[np.argmax(gone)]:.4g} s")
        gone[1:] &= gone[:-1].copy()  # in the step of breaking it carries a part of its load
        most = max(most, peak(_load(evidence, bond)[gone]))
    worst.judge(most, 0.0)
    return "largest load of released elements; released: " + ("; ".join(released[:4]) or "nothing")


@Check("release.load", source="F <= F_b", asks="does no element carry more than its breaking load?",
       compared="load above the breaking load, relative to it, {count:element}, worst: {where}",
       none="no element has a breaking load")
def _breaking_loads(evidence: Evidence, worst: Worst) -> None:
    bonds = evidence.model.bonds
    if not bonds.name:
        raise NotComputed("nothing can be released")
    for bond in np.flatnonzero(np.isfinite(bonds.breaks_at)).tolist():
        over = _load(evidence, bond) / bonds.breaks_at[bond] - 1.0
        worst.add(bonds.name[bond], np.maximum(over, 0.0), EXACT,
                  evidence.arrays["held"][:, bond] != 0.0)


def _load(evidence: Evidence, bond: int) -> Array:
    """Magnitude of the load of an element [N, N m], [n]; of a tendon the largest tension."""
    (kind, i), model, a = evidence.model.bonds.element(bond), evidence.model, evidence.arrays
    if kind == "joints":
        return np.asarray(a["joint_reaction"][:, i])
    if kind == "tendons":
        pieces = np.flatnonzero(model.tendons.stretch_tendon == i)
        return np.asarray(np.abs(piece_tensions(model, a, pieces)).max(axis=0))
    force = np.abs(evidence.loads.spring_forces[i])
    least = 0.0 if model.springs.straight[i] else EXACT * peak(a["spring_force"][:, i])
    return np.asarray(np.where(force > least, force, 0.0))


def set_while_running(mechanism: Mechanism) -> set[str]:
    """Names of everything that controllers and events set, drives among them."""
    names = {name for controller in mechanism.controllers for name in controller.written}
    keys = {key for event in mechanism.events for key in event.set}
    return names | keys | {key.split(".")[0] for key in keys}


@Check("drive.signal", source="u(t)", asks="do drives have the values of the scene?",
       compared="values of {count:drive} against their signals, relative to the largest of each, "
                "worst: {where}")
def _signals(evidence: Evidence, worst: Worst) -> None:
    """A drive's value is its signal at the sample; a motor's, a rigid servo's is that of later."""
    mechanism, drives, a = evidence.model.mechanism, evidence.model.drives, evidence.arrays
    set_by = set_while_running(mechanism)
    for i, drive in enumerate(mechanism.drives):
        if drive.name in set_by:
            worst.left_out.append(f"the run changes {drive.name}")
            continue
        late = evidence.h * float(drives.late[i])
        signal = np.maximum(values(drive.signal(mechanism), evidence.run.time + late,
                                   mechanism.functions), drives.floor[i])
        worst.add(drive.name, np.abs(a["drive_value"][:, i] - signal) / whole(signal), ROUNDING)


@Check("drive.motor", source="ω = u, τ = c (u - ω) or τ = ±τmax",
       asks="do motors and brakes keep their speed, or act at their limit?",
       compared="rates and torques of motors and brakes against their targets and limits, "
                "{count:comparison}, worst: {where}",
       none="there is no motor and no brake")
def _motors(evidence: Evidence, worst: Worst) -> None:
    a, drives = evidence.arrays, evidence.model.drives
    rates, shared = evidence.rates_after, _limited_drives(evidence)
    for i, kind in enumerate(drives.kind):
        if not kind.limited:
            continue
        j, torque, slope = int(drives.target[i]), a["drive_torque"][:, i], float(drives.slope[i])
        most, holds = evidence.loads.limits[i], evidence.holds["joint"][j]
        largest, speed = whole(most), 0.0 if np.isnan(drives.most[i]) else a["drive_value"][:, i]
        if np.isfinite(largest):
            over = np.maximum(np.abs(torque) - most, 0.0) / largest
            worst.add(f"limit of {drives.name[i]}", over, EXACT)
        if shared[j] > 1 or kind.places:
            continue
        held = held_off(evidence, i)
        if not np.isnan(slope):
            off = held + lost_rate(evidence.rates[j], turning=True)
            follow(worst, f"line of {drives.name[i]}", torque,
                   lambda v, i=i, slope=slope, most=most: np.clip(
                       slope * (a["drive_value"][:, i] - v), -most, most),
                   [((evidence.rates[j],), (off,))], holds)
            continue
        off, fast = rates[j] - speed + bend(evidence, j), 1 + peak(rates[j])
        floor = evidence.rate_error(rates[j], turning=True) + held
        worst.add_law(drives.name[i], torque, off * evidence.joints_hold[j], most,
                      (EXACT * np.maximum(most, SMALLEST_SCALE), floor), floor / fast)


def _limited_drives(evidence: Evidence) -> Integers:
    """Number of drives with a limit of each joint, [nj]."""
    drives = evidence.model.drives
    limited = [kind.limited for kind in drives.kind]
    return np.bincount(drives.target[limited], minlength=len(evidence.model.joints.name))


def bend(evidence: Evidence, joint: int) -> Array:
    """Rate of an actuator's length besides that along its line [m/s], [n]; 0 of hinges."""
    joints, frames, h = evidence.model.joints, evidence.frames, evidence.h
    if not joints.kind[joint].line:
        return np.zeros(len(evidence.run))
    before = evidence.velocity - h / 2 * frames.acceleration
    moved = []
    for n, ends in zip(joints.bodies[joint], frames.anchors, strict=True):
        arm = (ends.arm_x[joint] + 1j * ends.arm_y[joint]) * np.exp(1j * h * before[2, n])
        moved.append(frames.centre[0, n] + 1j * frames.centre[1, n]
                     + h * (before[0, n] + 1j * before[1, n]) + arm)
    rate = evidence.rates_of(before)[joint]
    return np.asarray((np.abs(moved[1] - moved[0]) - frames.gaps[joint]) / h - rate)


def initial_rate(evidence: Evidence, drive: int) -> float:
    """Rate of the hinge or actuator of a motor or brake at t = 0, from the scene [rad/s, m/s]."""
    model, joint = evidence.model, int(evidence.model.drives.target[drive])
    if model.joints.kind[joint].line:
        return lengthening(model, joint)
    return float(model.joints.sense[joint] * turning(model, joint))


def held_off(evidence: Evidence, drive: int) -> float:
    """Error of a rate by the regularisation towards the last impulses [rad/s].

    It is the change of the impulse times the response of the two bodies without joints. Impulses of
    steps that were not recorded follow from the work since the last sample.
    """
    a, j = evidence.arrays, evidence.model.drives.target[drive]
    alone = peak(evidence.answer(evidence.loads.drive_efforts, drive))
    impulse = evidence.h * peak(a["drive_torque"][:, drive])
    if not evidence.every_step:
        rate = np.concatenate([[initial_rate(evidence, drive)], evidence.rates[j]])
        work, mean = np.diff(a["drive_work"][:, drive], prepend=0.0), (rate[1:] + rate[:-1]) / 2
        since = np.abs(np.divide(work, mean, out=np.zeros_like(work), where=work != 0))
        impulse = max(impulse, min(peak(since), evidence.h * peak(evidence.loads.limits[drive])))
    return HELD * alone * (2 + FADED) * impulse


@Check("stop.law", "rad", "τ > 0 at the limit only", asks="do stops act only at the hinge limits?",
       compared="distance of stops in action from their limit, and overshoot in a step, "
                "{count:comparison}, worst: {where}",
       none="no hinge has stops")
def _stops(evidence: Evidence, worst: Worst) -> None:
    """A stop acts where its limit is reached in the step; it undoes an overrun at 1 rad/s."""
    joints, h = evidence.model.joints, evidence.h
    for j in joints.stopped.tolist():
        torque, angle = evidence.arrays["joint_stop"][:, j], evidence.angles[j]
        rate, holds = evidence.rates_after[j], evidence.joints_hold[j]
        tolerance = STOPPED + h * SOLVED * (1 + peak(rate))
        for sign, limit in zip((1.0, -1.0), joints.stops[j].tolist(), strict=True):
            gap = sign * (angle - limit)
            ahead = gap + h * sign * rate
            acts = evidence.holds["joint"][j] & (sign * torque > 0)
            worst.add(joints.name[j], acts * np.maximum(np.minimum(ahead, gap), 0.0), tolerance)
            worst.add(joints.name[j], np.maximum(-ahead, 0.0),
                      tolerance + np.maximum(-gap - h, 0.0), holds)


@Check("work", source="W = Σ h F v", asks="is the work of each element the integral of its power?",
       compared="recorded work against the sum of force times rate over all steps, relative to all "
                "work of each of {count:element}, worst: {where}",
       none="nothing works")
def _works(evidence: Evidence, worst: Worst) -> None:
    evidence.require_every_step()
    for name, power, work in _powers(evidence):
        each = evidence.h * power
        added = np.cumsum(each) - each / 2
        off = np.abs(work - work[0] - added + added[0])[evidence.known]
        worst.add(name, off / max(float(np.abs(each).sum()), SMALLEST_SCALE), EXACT)


def _powers(evidence: Evidence) -> Iterator[tuple[str, Array, Array]]:
    """Name, power [W] and recorded work [J] of elements between bodies, [n] each."""
    model, a = evidence.model, evidence.arrays
    velocity = evidence.velocity + evidence.displacement / evidence.h
    works: dict[str, tuple[str, Any, str]] = {
        "tendon": ("tendon", model.tendons, ""), "line": ("line", model.lines, ""),
        "spring": ("spring", model.springs, ""), "drive": ("drive", model.drives, ""),
        "damping": ("joint_damping", model.joints, "damper of "),
        "friction": ("joint_friction", model.joints, "friction of ")}
    for batch in evidence.loads.batches:
        if batch.kind in works:
            key, elements, prefix = works[batch.kind]
            power = batch.rates(len(elements.name), velocity)
            for i in np.unique(batch.element).tolist():
                yield prefix + elements.name[i], power[i], np.nan_to_num(a[f"{key}_work"][:, i])
    for i in model.drives.giving("surface").tolist() if evidence.one_normal.all() else []:
        on = np.isin([a["contact_body"], a["contact_other"]], model.drives.target[i]).any(axis=0)
        friction = np.bincount(a["contact_sample"][on], evidence.run.contacts.tangential[on],
                               len(evidence.run))
        yield (model.drives.name[i], model.drives.sense[i] * a["drive_value"][:, i] * friction,
               a["drive_work"][:, i])


@Check("drive.place", source="τ = k (u − q) − c q′ or q → u",
       asks="does each servo effort follow its law?",
       compared="efforts of {count:servo} against k (u - q) - c q', relative to the limit; rigid "
                "servos below their limit: movement away from the target, relative to the travel; "
                "worst: {where}",
       none="there is no servo, or not every step was recorded")
def _places(evidence: Evidence, worst: Worst) -> None:
    """The law is at mid-step, or at the step's end of a servo that is too stiff for the step."""
    drives, a, h = evidence.model.drives, evidence.arrays, evidence.h
    shared = _limited_drives(evidence)
    for i, kind in enumerate(drives.kind):
        if not kind.places:
            continue
        j = int(drives.target[i])
        place, rate, after = evidence.angles[j], evidence.rates[j], evidence.rates_after[j]
        if not np.isfinite(drives.stiffness[i]):
            if evidence.every_step and shared[j] == 1:
                value, holds = a["drive_value"][:, i], evidence.holds["joint"][j]
                short = np.abs(value[:-1] - place[1:])
                away = np.maximum(short - np.append(np.inf, short[:-1]), 0.0)
                moved = np.diff(value[:-1], prepend=value[0])
                spare = holds[:-1] & holds[1:] & ((moved == 0) | np.isinf(drives.fastest[i])) & (
                    np.abs(a["drive_torque"][:-1, i]) < float(drives.most[i]) * (1 - EXACT))
                span = float(np.ptp(place)) + peak(short) + ROUNDING
                slack = evidence.joint_slack[j, 1:] + ROUNDING * (1 + np.abs(place[1:])) + 2 * h * (
                    STILL[1] + held_off(evidence, i) + SOLVED * (1 + peak(after)))
                worst.add(drives.name[i], np.where(spare, away, 0.0) / span, slack / span)
            continue
        k, c, most = (float(part[i]) for part in (drives.stiffness, drives.damping, drives.most))
        off = evidence.rate_error(after, turning=True) + held_off(evidence, i)
        follow(worst, drives.name[i], a["drive_torque"][:, i],
               lambda q, v, k=k, c=c, most=most, u=a["drive_value"][:, i]: np.clip(
                   k * (u - q) - c * v, -most, most),
               [((place + h / 2 * (after - rate), rate), (ROUNDING * (1 + np.abs(place)), off)),
                ((place + h * after, after), (ROUNDING * (1 + np.abs(place)) + h * off, off))],
               evidence.holds["joint"][j], size=most)
