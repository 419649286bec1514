"""Balances of forces, and of energy: the work of joints and contacts against all other work.

In each step the kinetic energy of a body grows by the work of its forces, to rounding. Ideal joints
and closed contacts should do no work, but their reactions R do h R v, since a step keeps the rate v
of their gaps at 0 to second order only. This work, from the samples, is the error of the step;
beyond :data:`LARGEST_STEP_ERROR` of the energy the step is too coarse.

A motor whose speed u differs from its hinge's rate q starts with an impact. Its impulse P gives the
work P (q + u) / 2 to the bodies and takes P u from the motor: P (u - q) / 2 is lost. The gaps of
joints open at up to h/2 of the acceleration's change da in that step, so that joints do up to
h/2 dv . M da.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from sandbox.audit.driven import initial_rate, set_while_running
from sandbox.audit.evidence import EXACT, ROUNDING, Check, Evidence, NotComputed, Worst, peak, whole
from sandbox.model.joints import placed
from sandbox.model.model import Model
from sandbox.model.supports import LARGEST_GROUP, shared_joints
from sandbox.numeric import Array, Flags
from sandbox.samples.samples import OLDER
from sandbox.values.signals import values

LARGEST_STEP_ERROR = 0.01  # relative to all energy converted
LEFT = 1e-8  # Overlap [m] whose removal does not count as a source of energy
POSES = 5  # in which a joint has to be redundant: near a dead centre some are in one
OUTLIER = 10.0  # Largest power of a joint relative to that in the samples beside
UNBALANCED = ("difference between {0} and the sum of all {1} on a body, relative to the largest, "
              "{{count:body|bodies}}, worst: {{where}}")


@Check("reaction.size", source="|R|",
       asks="is each reaction the magnitude of its x and y components?",
       compared="magnitude of each reaction against its components, relative to the largest of its "
                "joint, {count:joint}, worst: {where}")
def _reaction_sizes(evidence: Evidence, worst: Worst) -> None:
    a = evidence.arrays
    if not evidence.vectors:
        raise NotComputed(OLDER)
    off = np.abs(np.hypot(*a["joint_force"].transpose(2, 0, 1)) - a["joint_reaction"])
    for j, name in enumerate(evidence.model.joints.name):
        worst.add(name, off[:, j] / whole(a["joint_reaction"][:, j]), ROUNDING)


@Check("reaction.shared", source="rank of J", asks="does statics determine every joint reaction?",
       compared="joints whose reactions statics does not determine: {note}")
def _shared(evidence: Evidence, worst: Worst) -> str:
    model, poses = evidence.model, evidence.arrays["body_pose"]
    if not len(model.joints.name):
        raise NotComputed("there is no joint")
    if not evidence.joints_hold.all():
        raise NotComputed("joints were released: others share the load")
    few = np.unique(np.linspace(0, len(poses) - 1, min(len(poses), POSES)).astype(int))
    found = [shared_joints(model, poses[i]) for i in few]
    if not found[0].examined:
        raise NotComputed(f"more than {LARGEST_GROUP} forces are connected")
    shared = [model.joints.name[j] for j in sorted(set.intersection(*(f.joints for f in found)))]
    worst.judge(len(shared), 0.0)
    more = f" and {len(shared) - 6} more" if len(shared) > 6 else ""
    return "; ".join(shared[:6]) + more if shared else "none"


def _residuals(evidence: Evidence, worst: Worst, *, row: int) -> None:
    """Compare the residuals of m a - sum F (``row`` 0) or of I alpha - sum M (1)."""
    if not evidence.vectors:
        raise NotComputed(OLDER)
    loads, (force, moment) = evidence.loads, evidence.loads.largest
    sizes = np.maximum(moment, force * ROUNDING / EXACT) if row else force
    for b in np.flatnonzero(evidence.model.bodies.free).tolist():
        scale, left = whole(sizes[b]), loads.left[:, b]
        error = np.abs(left[2]) if row else np.hypot(left[0], left[1])
        allowed = evidence.left_allowed[row, b]
        worst.add(evidence.model.bodies.name[b], error / scale, allowed / scale)


_momentum = Check("momentum.force", source="m a = Σ F", asks="is F = m a for every body?",
                  compared=UNBALANCED.format("m a", "forces"),
                  none="nothing moves freely")(partial(_residuals, row=0))
_angular_momentum = Check("momentum.moment", source="I α = Σ M",
                          asks="is M = I alpha for every body?",
                          compared=UNBALANCED.format("I alpha", "moments"),
                          none="nothing moves freely")(partial(_residuals, row=1))


class _Balance(NamedTuple):
    """All works against the kinetic energy."""

    scale: float  # All energy converted [J]
    left: Array  # Kinetic energy minus the work of all but contacts and joints that hold [J], [n]
    least: float  # Tolerance without the error of the step, relative to the scale
    allowed: float  # Tolerance with it
    cost: float  # Loss by motors that start at speed [J]
    jumps: list[str]  # These motors, if their loss exceeds the error of the step


def _balance(evidence: Evidence) -> _Balance:
    """The balance of energy; joints that close, as those that are engaged, do work."""
    a, model, drives = evidence.arrays, evidence.model, evidence.model.drives
    if len(moved := np.flatnonzero(model.bodies.scheduled)):
        raise NotComputed(
            f"the work of {model.bodies.name[moved[0]]!r}, moved by a schedule, is not recorded")
    if len(grown := drives.giving("radius")):
        raise NotComputed(
            f"the work of {drives.name[grown[0]]!r}, which changes a radius, is not recorded")
    weights, by_weight = evidence.loads.weights.T[:, :, None], _work_of_weight(evidence)
    # the mean of the kinetic energies before and after the step
    change = evidence.h / 2 * evidence.frames.acceleration
    kinetic = (weights * (evidence.velocity**2 + change**2)).sum(axis=(0, 1)) / 2
    works = np.abs(by_weight) + sum(np.abs(a[f"{kind}_work"]).sum(axis=1)
                                    for kind in ("drive", "spring", "line", "load"))
    scale = max(float((works + kinetic).max(initial=0.0)), 1e-15)
    # the work of a pull is that of its tendon, the work of a pump goes into its line
    own = np.delete(a["drive_work"], drives.giving("tension", "flow", "pressure"), axis=1)
    left = kinetic - by_weight - own.sum(axis=1) - (
        evidence.loads.weights * model.bodies.velocity**2).sum() / 2
    for kind in ("tendon", "spring", "line", "load", "joint_damping", "joint_friction"):
        left = left - np.nan_to_num(a[f"{kind}_work"]).sum(axis=1)
    least = EXACT + _of_gaps(evidence) / scale
    most, error, (jumps, cost, unsure) = (
        scale * LARGEST_STEP_ERROR, _of_the_step(evidence), starts(evidence))
    if cost <= scale * least + min(error, most):
        jumps, unsure = [], 0.0
    allowed = least + min(error + unsure, most) / scale
    if not evidence.joints_hold.all():
        left = left - _work_of_joints(evidence, ~evidence.joints_hold)
    return _Balance(scale, left, least, allowed, cost, jumps)


def _closed_balance(evidence: Evidence) -> _Balance:
    """The balance, if the work of joints that close is known."""
    found, a, bonds = evidence.once(_balance), evidence.arrays, evidence.model.bonds
    open_ = ~evidence.joints_hold
    carried = (np.nan_to_num(a["joint_reaction"]) + np.abs(np.nan_to_num(a["joint_couple"]))).T
    breaks = (bonds.joint >= 0) & np.isfinite(np.append(bonds.breaks_at, np.inf))[bonds.joint]
    if (breaks & open_.any(axis=1)).any() or carried[open_].any():
        evidence.require_every_step("joints broke or were engaged again, which does work, and ")
    return found


@Check("energy.start", source="W = P Δω / 2",
       asks="do motors start without a jolt that loses energy?")
def _started(evidence: Evidence, worst: Worst) -> str:
    balance = evidence.once(_balance)
    if not paced(evidence.model).any():
        raise NotComputed("there is no motor")
    worst.judge(balance.cost / balance.scale, balance.allowed)
    return "every motor starts at the speed of its hinge" if not balance.jumps else (
        f"{'; '.join(balance.jumps[:3])}. This is an impact in one step: its forces "
        "grow as 1 / step. A signal that starts at the hinge's speed avoids it")


@Check("energy.created", source="ΔE = Σ W", asks="is there no more energy than was supplied?",
       compared="most energy that joints and contacts supplied, relative to all energy converted: "
                "kinetic energy minus the work of drives, tendons, springs, dampers and weight; "
                "the error of the step is allowed, up to 1 %")
def _created(evidence: Evidence, worst: Worst) -> None:
    """The energy that joints and contacts take never decreases."""
    balance = _closed_balance(evidence)
    made = balance.left[evidence.known]
    lowest = np.minimum.accumulate(np.minimum(made, 0.0))
    worst.judge((made - lowest).max(initial=0.0) / balance.scale, balance.allowed)


@Check("energy.lost", source="ΔE = Σ W",
       asks="is energy lost only to friction, dampers and impacts?")
def _lost(evidence: Evidence, worst: Worst) -> str:
    """The energy that joints and contacts take, against the work of contacts and stops."""
    balance, run, a = _closed_balance(evidence), evidence.run, evidence.arrays
    stops = np.nan_to_num(run.means("joint_stop")["joint_stop"])
    touched = len(run.mean_contacts.sample) or len(a["impact_time"]) or stops.any() or (
        _stretched(evidence))
    if not touched:
        worst.judge(peak(balance.left) / balance.scale, balance.allowed)
        return ("energy lost without contacts: kinetic energy minus the work of drives, tendons, "
                "springs, dampers and weight, relative to all energy converted; the error of the "
                "step is allowed as in energy.created")
    evidence.require_every_step("contacts, stops and ropes do work in every step, and ")
    if not evidence.vectors:
        raise NotComputed(OLDER)
    # contacts do a part of the work of running surfaces, the rest is heat
    running = a["drive_work"][:, evidence.model.drives.giving("surface")].sum(axis=1)
    sides = evidence.loads.contact_sides
    v = (evidence.velocity * evidence.model.bodies.free[:, None])[:, sides.body, sides.sample]
    power = np.bincount(sides.sample, (sides.wrench.T * v).sum(axis=0), len(run)) + np.nan_to_num(
        a["joint_stop"] * a["joint_rate"]).sum(axis=1)
    left = balance.left + running - _to_middle(evidence.h * power) - _work_of_joints(
        evidence, evidence.joints_hold)
    # where impacts displace poses all other loads work besides
    moved = evidence.displacement * evidence.model.bodies.free[:, None]
    left = left + _to_middle(sum((batch.power(moved).sum(axis=0)
                                  for batch in evidence.loads.batches), np.zeros(len(run))))
    worst.judge(peak(left[evidence.known]) / balance.scale, balance.least)
    return ("kinetic energy minus all work, including contacts, stops and joints in every step, "
            "relative to all energy converted")


def _to_middle(step: Array) -> Array:
    """Sums of work per step [n] up to the middle of each [J]."""
    return np.asarray(np.cumsum(step) - step / 2)


def _work_of_joints(evidence: Evidence, among: Flags) -> Array:
    """Work of reactions ``among`` [nj, n] up to the middle of each step [J], [n]."""
    power = np.nan_to_num(evidence.loads.joints.power(evidence.velocity)) * np.tile(among, (2, 1))
    return _to_middle(evidence.h * power.sum(axis=0))


def _work_of_weight(evidence: Evidence) -> Array:
    """M g . (c - c_0 + h^2 a / 4) [J], [n], with half of the known displacements by impacts."""
    frames, h, free = evidence.frames, evidence.h, evidence.model.bodies.free
    now, a = frames.centre[:2], frames.acceleration[:2]
    if evidence.run.time[0] < h:
        first = now[:, :, 0] - h / 2 * (evidence.velocity[:2] - h / 2 * a)[:, :, 0]
    else:
        first = placed(evidence.model.bodies.pose, evidence.arrays["body_centre"]).T
    moved = now - first[:, :, None] + h * h / 4 * a + evidence.displacement[:2] / 2
    weight = np.outer(evidence.model.mechanism.gravity, evidence.arrays["body_mass"][free])
    return np.asarray(np.einsum("ab,abn->n", weight, moved[:, free]))


def _stretched(evidence: Evidence) -> bool:
    """Whether a rope was taut, a pin pressed on an end of its groove, or loose teeth met."""
    force = np.nan_to_num(evidence.run.means("joint_force")["joint_force"])
    joints = evidence.model.joints
    along = [np.hypot(*force[:, j].T) for j in np.union1d(
        joints.keeping("range"), np.flatnonzero(joints.play > 0)).astype(int)]
    for j in joints.keeping("groove").tolist():
        place = evidence.frames.place_in_slot(j)
        pressed = np.abs(force[:, j, 0] * place.x + force[:, j, 1] * place.y)
        along.append(np.where(pressed > EXACT * peak(force[:, j]), pressed, 0.0))
    return any(each.any() for each in along)


def _of_gaps(evidence: Evidence) -> float:
    """Work of joints and contacts that close gaps, and rounding of weights [J]."""
    a, free = evidence.arrays, evidence.model.bodies.free
    work = evidence.closed * np.hypot(*np.nan_to_num(a["joint_force"]).T).max(axis=1, initial=0.0)
    size, touch = np.hypot(*a["contact_force"].T), 0.0
    overlap = np.clip(-a["contact_gap"], 0.0, LEFT + evidence.contact_depth)
    for _, _, own in evidence.pairs():
        touch += float(size[own].max() * (evidence.closed + overlap[own].max()))
    weight = np.hypot(*evidence.model.mechanism.gravity) * a["body_mass"][free].sum()
    return float(work.sum() + touch + weight * ROUNDING)


def _of_the_step(evidence: Evidence) -> float:
    """Work of joints, contacts and taut ropes by the error of the step [J], without outliers."""
    a, time = evidence.arrays, evidence.run.time
    joints, ropes = evidence.model.joints.name, evidence.model.joints.keeping("range")
    power = np.nan_to_num(evidence.loads.joints.rates(len(joints), evidence.velocity))
    power[ropes] = np.maximum(power[ropes], 0.0)
    power = np.abs(power)
    if len(time) > 1:
        beside = np.pad(power, ((0, 0), (1, 1)), mode="reflect")
        most = OUTLIER * np.maximum(beside[:, :-2], beside[:, 2:])
        most[:, 0] = np.inf
        for _, sample, _, _ in _jumps(evidence):
            most[:, max(sample - 1, 0):sample + 2] = np.inf
        power = np.minimum(power, most)
    rate = evidence.contact_rate(evidence.velocity, a["contact_normal"])
    contacts = np.maximum(evidence.run.contacts.normal * rate, 0.0).sum()
    apart = evidence.h if evidence.every_step or len(time) < 2 else np.median(np.diff(time))
    unknown = 0.0  # work of weight before the first sample, and by unknown displacements
    fall = evidence.h**2 * np.hypot(*evidence.model.mechanism.gravity)
    change = evidence.h**2 * np.hypot(*evidence.frames.acceleration[:2])
    weight = np.hypot(*evidence.model.mechanism.gravity) * evidence.loads.weights[:, 0]
    if evidence.run.time[0] >= evidence.h:
        unknown += float(weight @ np.maximum(change.max(axis=1, initial=0.0), fall)) / 8
    if not evidence.every_step:  # a displacement is less than h times the change of velocity
        unknown += float(np.where(evidence.struck, weight @ change, 0.0).max(initial=0.0)) / 2
    return float(apart * (power.sum() + contacts)) + unknown


def starts(evidence: Evidence) -> tuple[list[str], float, float]:
    """Motors that start at speed, their loss, and the most that joints do besides unseen [J]."""
    a, drives, texts, cost, unsure = evidence.arrays, evidence.model.drives, [], 0.0, 0.0
    weights, acceleration = evidence.loads.weights.T, evidence.frames.acceleration
    for drive, sample, before, speed in _jumps(evidence):
        rate = evidence.rates[drives.target[drive], sample]
        # the rate of a sample in the step of an impact is the mean of before and after
        inside = (rate - before) / (speed - before) < 0.75
        work = np.diff(a["drive_work"][:, drive], prepend=0.0)[sample]
        impulse = float(evidence.h * a["drive_torque"][sample, drive] if inside
                        else work / np.float64((before + speed) / 2))
        lost = abs(impulse * (speed - before)) / 2
        cost += lost
        what, unit, push = (("actuator", "m/s", "N s") if drives.kind[drive].gives == "push"
                            else ("hinge", "rad/s", "N m s"))
        began = evidence.run.time[sample - 1] if sample else 0.0
        texts.append(f"{drives.name[drive]} accelerates its {what} from {before:.4g} to "
                     f"{speed:.4g} {unit} after {began:.4g} s with {impulse:.3g} {push}, "
                     f"which loses {lost:.3g} J")
        after = min(sample + int(inside), len(evidence.run) - 1)
        change = evidence.velocity[..., after] - (
            evidence.velocity[..., sample - 1] if sample else evidence.model.bodies.velocity.T)
        bend = acceleration[..., after] - (acceleration[..., sample - 1] if sample else 0.0)
        unsure += 0.0 if evidence.every_step else float(
            evidence.h / 2 * np.abs(weights * change * bend).sum())
    return texts, cost, unsure


def _jumps(evidence: Evidence) -> Iterator[tuple[int, int, float, float]]:
    """Motors that change a rate at once: drive, sample after it, rates before and after."""
    a, drives, mechanism = evidence.arrays, evidence.model.drives, evidence.model.mechanism
    set_by, times = set_while_running(mechanism), np.array([evidence.h, 2 * evidence.h])
    for i in np.flatnonzero(paced(evidence.model)).tolist():
        # at its limit a motor speeds its hinge up step by step
        holds = np.abs(a["drive_torque"][:, i]) < drives.most[i] * (1 - EXACT)
        value, rates = a["drive_value"][:, i], evidence.rates[drives.target[i]]
        least = evidence.rate_error(rates, turning=True)
        rate, spec = initial_rate(evidence, i), mechanism.drives[i]
        one, two = (value[[0, 0]] if spec.name in set_by else
                    values(spec.signal(mechanism), times, mechanism.functions)).tolist()
        if holds[0] and abs(2 * one - two - rate) > abs(two - one) + least:
            yield i, 0, rate, 2 * one - two
        each = np.abs(np.diff(value))
        if len(each) > 1:
            beside = np.append(each[1], each[:-1]) + np.append(each[1:], each[-2])
            for s in np.flatnonzero((each > beside + least) & holds[1:]).tolist():
                yield i, s + 1, float(rates[s]), float(value[s + 1])


def paced(model: Model) -> Flags:
    """Drives that keep a speed of a hinge or actuator, [nd]."""
    limited = np.array([kind.limited and kind.timely == "end" for kind in model.drives.kind],
                       dtype=bool)
    return np.asarray(limited & np.isnan(model.drives.slope))
