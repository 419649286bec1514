"""Energy: the work of joints and contacts, and the balance of all work.

In each step the kinetic energy of a body grows by the work of its forces, to rounding. Ideal joints
should do no work, but a step leaves them some of second order. An anchor at r from the centre of
mass moves along chords, so that its mean velocity over two steps differs from that of the middle by

    h^2 r (w^3 / 6 across,  w alpha / 2 along)

Times the reaction, added up over the run, this is the work that joints may do. A contact holds its
gap by the second derivative c of the gap; where c changes by dc in a step, the normal force N does
h^2 N dc / 2. Both may also move by what is left of a gap. Beyond :data:`LARGEST_STEP_ERROR` of the
energy the step is too coarse. Motors that start at speed: :mod:`sandbox.audit.starts`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import (
    EXACT,
    NOT_EVERY_STEP,
    ROUNDING,
    NotComputed,
    Worst,
    check,
    peak,
)
from sandbox.audit.starts import StartsAtSpeed, initial_velocity, paced, starts
from sandbox.model.joints import placed
from sandbox.numeric import Array, Flags
from sandbox.samples.samples import OLDER

LARGEST_STEP_ERROR = 0.01
"""Largest error of the step that is allowed, relative to all energy converted."""
LEFT = 1e-8
"""Overlap [m] whose removal does not count as a source of energy."""


class _Balance(NamedTuple):
    """All works against the kinetic energy."""

    scale: float
    """All energy converted [J]."""
    left: Array
    """Kinetic energy minus the work of all but joints and contacts [J], [n]."""
    by_joints: Array
    """Known work of joints that start or close [J], [n]."""
    least: float
    """Tolerance without the error of the step, relative to the scale."""
    allowed: float
    """Tolerance with it."""
    started: StartsAtSpeed
    blow: bool
    """Whether motors that start at speed exceed the error of the step."""


def _balance(evidence: Evidence) -> _Balance:
    a = evidence.run.arrays
    kinetic = _kinetic_energy(evidence)
    at_start = (evidence.loads.weights * initial_velocity(evidence)**2).sum() / 2
    works = sum(np.abs(a[f"{kind}_work"]).sum(axis=1)
                for kind in ("drive", "spring", "line", "load"))
    works = works + np.abs(_work_of_weight(evidence))
    scale = max(float((works + kinetic).max(initial=0.0)), 1e-15)
    left = kinetic - at_start - _work_of_loads(evidence)
    least = EXACT + _of_gaps(evidence) / scale
    started, each = starts(evidence), _of_the_step(evidence)
    smooth = float(each[~started.within].sum()) + _first_half(evidence)
    blow = not started.cost <= scale * (least + min(smooth / scale, LARGEST_STEP_ERROR))
    error = smooth + (started.unsure if blow else float(each[started.within].sum()))
    allowed = least + min(error / scale, LARGEST_STEP_ERROR)
    by_joints = started.made if blow else np.zeros(len(left))
    return _Balance(scale, left, by_joints, least, allowed, started, blow)


def _closed_balance(evidence: Evidence) -> _Balance:
    """The balance with the work of joints that close gaps.

    Raises:
        NotComputed: it is unknown.
    """
    _refuse_unrecorded(evidence)
    found = evidence.once(_balance)
    if _closed_gaps(evidence) and not evidence.every_step:
        raise NotComputed(
            f"joints broke or were engaged again, which does work, and {NOT_EVERY_STEP}")
    closing = ~evidence.joints_hold
    if closing.any():
        found = found._replace(by_joints=found.by_joints + _work_of_joints(evidence, closing))
    return found


def _refuse_unrecorded(evidence: Evidence) -> None:
    bodies, drives = evidence.model.bodies, evidence.model.drives
    if len(moved := np.flatnonzero(bodies.scheduled)):
        raise NotComputed(
            f"the work of {bodies.name[moved[0]]!r}, moved by a schedule, is not recorded")
    if len(grown := drives.giving("radius")):
        raise NotComputed(
            f"the work of {drives.name[grown[0]]!r}, which changes a radius, is not recorded")


@check("energy.start", source="W = P Δω / 2",
       asks="do motors start without a jolt that loses energy?")
def _started(evidence: Evidence, worst: Worst) -> str:
    _refuse_unrecorded(evidence)
    balance = evidence.once(_balance)
    if not paced(evidence.model).any():
        raise NotComputed("there is no motor")
    worst.judge(balance.started.cost / balance.scale, balance.allowed)
    if not balance.blow:
        return "every motor starts at the speed of its hinge"
    return (f"{'; '.join(balance.started.jumps[:3])}. This is an impact in one step: its forces "
            f"grow as 1 / step. The {balance.started.made[-1]:.2g} J of joints in it are not "
            "counted in energy.created and energy.lost. A signal that starts at the hinge's speed "
            "avoids it")


@check("energy.created", source="ΔE = Σ W", asks="is there no more energy than was supplied?",
       compared="most energy that joints and contacts supplied, relative to all energy converted: "
                "kinetic energy minus the work of drives, tendons, springs, dampers and weight; "
                "the error of the step is allowed, up to 1 %")
def _created(evidence: Evidence, worst: Worst) -> None:
    """The energy that joints and contacts take never decreases."""
    balance = _closed_balance(evidence)
    made = (balance.left - balance.by_joints)[evidence.known]
    lowest = np.minimum.accumulate(np.minimum(made, 0.0)) if len(made) else made
    worst.judge((made - lowest).max(initial=0.0) / balance.scale,
                balance.allowed + _unseen(evidence) / balance.scale)


@check("energy.lost", source="ΔE = Σ W",
       asks="is energy lost only to friction, dampers and impacts?")
def _lost(evidence: Evidence, worst: Worst) -> str:
    """The energy that joints and contacts take, against the work of contacts and stops."""
    balance, run, a = _closed_balance(evidence), evidence.run, evidence.run.arrays
    touched = (len(run.mean_contacts.sample) + len(a["impact_time"]) > 0
               or bool(np.nan_to_num(run.means("joint_stop")["joint_stop"]).any())
               or _stretched(evidence))
    if touched and not evidence.every_step:
        raise NotComputed(
            f"contacts, stops and ropes do work in every step, and {NOT_EVERY_STEP}")
    if not touched:
        worst.judge(peak(balance.left - balance.by_joints) / balance.scale, balance.allowed)
        return ("energy lost without contacts: kinetic energy minus the work of drives, tendons, "
                "springs, dampers and weight, relative to all energy converted; the error of the "
                "step is allowed as in energy.created")
    if not evidence.vectors:
        raise NotComputed(OLDER)
    # contacts do a part of the work of running surfaces, the rest is heat
    running = a["drive_work"][:, evidence.model.drives.giving("surface")].sum(axis=1)
    left = balance.left + running - _work_of_contacts(evidence) - _work_of_joints(evidence)
    left = left + _work_of_displacements(evidence)
    worst.judge(peak(left[evidence.known]) / balance.scale, balance.least)
    return ("kinetic energy minus all work, including contacts, stops and joints in every step, "
            "relative to all energy converted")


def _kinetic_energy(evidence: Evidence) -> Array:
    """Mean of the kinetic energies before and after the step [J], [n]."""
    weight = evidence.loads.weights.T[:, :, None]
    change = evidence.h / 2 * evidence.loads.frames.acceleration
    return np.asarray((weight * (evidence.velocity**2 + change**2)).sum(axis=(0, 1))) / 2


def _work_of_loads(evidence: Evidence) -> Array:
    """Work of all but joints and contacts [J], [n]."""
    a, model = evidence.run.arrays, evidence.model
    # the work of a pull is that of its tendon, the work of a pump goes into its line
    own = np.delete(a["drive_work"], model.drives.giving("tension", "flow", "pressure"), axis=1)
    total = own.sum(axis=1) + _work_of_weight(evidence)
    for kind in ("tendon", "spring", "line", "load", "joint_damping", "joint_friction"):
        total = total + np.nan_to_num(a[f"{kind}_work"]).sum(axis=1)
    return np.asarray(total)


def _work_of_weight(evidence: Evidence) -> Array:
    """M g . (c - c_0 + h^2 a / 4) [J], [n]: displacements by mean velocities, as works are summed.

    Half of a known displacement by an impact counts. The first step's mean velocity leads back from
    its pose to c_0; where it was not recorded c_0 is the scene's (see :func:`_first_half`).
    """
    frames, h, free = evidence.loads.frames, evidence.h, evidence.model.bodies.free
    now, a = np.stack([frames.centre_x, frames.centre_y]), frames.acceleration[:2]
    if evidence.run.time[0] < h:
        first = now[:, :, 0] - h / 2 * (evidence.velocity[:2] - h / 2 * a)[:, :, 0]
    else:
        first = placed(evidence.model.bodies.pose, evidence.run.arrays["body_centre"]).T
    moved = now - first[:, :, None] + h * h / 4 * a + evidence.displacement[:2] / 2
    weight = np.outer(evidence.model.mechanism.gravity, evidence.run.arrays["body_mass"][free])
    return np.asarray(np.einsum("ab,abn->n", weight, moved[:, free]))


def _first_half(evidence: Evidence) -> float:
    """Largest work of weight in the first half step, before the first sample [J]."""
    if evidence.run.time[0] < evidence.h:
        return 0.0
    free, g = evidence.model.bodies.free, np.array(evidence.model.mechanism.gravity)
    a = np.hypot(*evidence.loads.frames.acceleration[:2, free])
    most = np.maximum(a.max(axis=1, initial=0.0), np.hypot(*g))
    return float(evidence.h**2 / 8 * np.hypot(*g) * (evidence.run.arrays["body_mass"][free] @ most))


def _unseen(evidence: Evidence) -> float:
    """Largest work of weight in half of an unknown displacement by an impact [J].

    A displacement is less than h times the change of velocity.
    """
    if evidence.every_step:
        return 0.0
    change = np.hypot(*evidence.loads.frames.acceleration[:2]) * evidence.h**2 / 2
    weight = np.hypot(*evidence.model.mechanism.gravity) * evidence.loads.weights[:, 0]
    return float(np.where(evidence.struck, weight @ change, 0.0).max(initial=0.0))


def _of_gaps(evidence: Evidence) -> float:
    """Work of joints and contacts that close gaps, and rounding of weights [J]."""
    a, free = evidence.run.arrays, evidence.model.bodies.free
    force = np.hypot(*np.nan_to_num(a["joint_force"]).transpose(2, 0, 1)).max(axis=0, initial=0.0)
    pair = a["contact_body"] * len(free) + a["contact_other"]
    size, touch = np.hypot(*a["contact_force"].T), 0.0
    overlap = np.clip(-a["contact_gap"], 0.0, LEFT + evidence.contact_depth)
    for kind in np.unique(pair):
        own = pair == kind
        touch += float(size[own].max() * (evidence.closed + overlap[own].max()))
    weight = np.hypot(*evidence.model.mechanism.gravity) * a["body_mass"][free].sum()
    return float(force.sum() * evidence.closed + touch + weight * ROUNDING)


def _of_the_step(evidence: Evidence) -> Array:
    """Work of joints and contacts up to each sample by the error of the step [J], [n]."""
    loads, sides, v = evidence.loads, evidence.loads.contact_sides, evidence.velocity
    joints, frames, h = loads.joints, loads.frames, evidence.h
    omega, alpha = np.abs(v[2]), np.abs(frames.acceleration[2])
    bend = omega**3 / 6 + omega * alpha / 2
    count = len(evidence.model.joints.name)
    force = np.hypot(joints.x, joints.y)
    couple = np.abs(evidence.run.arrays["joint_couple"].T)
    power = np.zeros(frames.samples)
    for side, (body, end) in enumerate(zip(evidence.model.joints.bodies.T, frames.anchors,
                                           strict=True)):
        arm = np.hypot(end.arm_x, end.arm_y)
        if side == 0:
            arm = arm + frames.gaps  # where a groove or a rod has its other end
        power += np.nan_to_num((force[:count] * arm + couple) * bend[body]).sum(axis=0)
    power += np.nan_to_num(_of_lines(evidence, force[:count])).sum(axis=0)
    own = np.hypot(*sides.force.T) * np.hypot(*sides.arm.T) * bend[sides.body, sides.sample]
    power += np.bincount(sides.sample, weights=own, minlength=frames.samples)
    power += _of_curvature(evidence)
    steps = 1.0
    if not evidence.every_step and frames.samples > 1:
        steps = float(np.median(np.diff(evidence.run.time))) / h
    return np.asarray(h**3 * steps * power)


def _of_curvature(evidence: Evidence) -> Array:
    """N dc / (2 h dt) of all contacts, where c changes by dc from sample to sample, [n]."""
    a, frames, time = evidence.run.arrays, evidence.loads.frames, evidence.run.time
    if len(time) < 2:
        return np.zeros(len(time))
    sample = a["contact_sample"]
    along = evidence.contact_rate(frames.acceleration, a["contact_normal"])
    pair = a["contact_body"] * len(evidence.model.bodies.name) + a["contact_other"]
    kind, row = np.unique(pair * (len(time) + 1) + sample, return_inverse=True)
    mean = np.bincount(row, weights=along) / np.maximum(np.bincount(row), 1)
    change = np.append(0.0, np.abs(np.diff(mean)) * (np.diff(kind) == 1))
    own = np.abs(evidence.run.contacts.normal) * change[row] / (2 * np.median(np.diff(time)))
    return np.asarray(np.bincount(sample, weights=own, minlength=len(time)) / evidence.h)


def _of_lines(evidence: Evidence, force: Array) -> Array:
    """The same of joints along a line that turns at w, with a speed v along it, [nj, n].

    A groove adds w^2 v, a rod of length L, or a path with this radius of curvature, as much as an
    arm that turns at v / L.
    """
    frames, v = evidence.loads.frames, evidence.velocity
    one, two = evidence.model.joints.bodies.T
    (on_a, on_b), w = frames.anchors, v[2]
    speed = np.hypot(v[0, two] - w[two] * on_b.arm_y - v[0, one] + w[one] * on_a.arm_y,
                     v[1, two] + w[two] * on_b.arm_x - v[1, one] - w[one] * on_a.arm_x)
    result = np.zeros_like(force)
    joints = evidence.model.joints
    for j in joints.keeping("groove"):
        result[j] = force[j] * (w[one[j]] ** 2 * speed[j] + evidence.path_jerk[j])
    for j in joints.keeping("rack"):
        result[j] = force[j] * w[two[j]] ** 2 * speed[j]
    for j in joints.keeping("distance", "range", "gear", "roll"):
        along = math.sin(joints.pressure[j]) if joints.kind[j].keeps == "gear" else 1.0
        length = np.maximum(frames.gaps[j] * along, 1e-9)
        change = np.hypot(*(frames.acceleration[k][two[j]] - frames.acceleration[k][one[j]]
                            for k in (0, 1)))
        result[j] = force[j] * (speed[j] ** 3 / length**2 / 6 + speed[j] * change / length / 2)
    return result


def _stretched(evidence: Evidence) -> bool:
    """Whether a rope was taut, a pin pressed on an end of its groove, or loose teeth met."""
    force = np.nan_to_num(evidence.run.means("joint_force")["joint_force"])
    joints = evidence.model.joints
    loose = np.union1d(joints.keeping("range"), np.flatnonzero(joints.play > 0))
    if force[:, loose].any():
        return True
    for j in joints.keeping("groove").tolist():
        x, y = evidence.loads.frames.groove_direction(j)
        if peak(force[:, j, 0] * x + force[:, j, 1] * y) > EXACT * peak(force[:, j]):
            return True
    return False


def _closed_gaps(evidence: Evidence) -> bool:
    """Whether a joint carried a load while it broke, or while it was engaged."""
    a, ties, holds = evidence.run.arrays, evidence.model.ties, evidence.joints_hold
    carried = (np.nan_to_num(a["joint_reaction"]) + np.abs(np.nan_to_num(a["joint_couple"]))).T
    breaks = (ties.joint >= 0) & np.isfinite(np.append(ties.breaks_at, np.inf))[ties.joint]
    return bool((breaks & ~holds.all(axis=1)).any() or carried[~holds].any())


def _to_middle(step: Array) -> Array:
    """Sums of work per step [n] up to the middle of each [J]."""
    return np.asarray(np.cumsum(step) - step / 2)


def _work_of_joints(evidence: Evidence, among: Flags | None = None) -> Array:
    """Work of reactions up to the middle of each step [J], [n]; ``among`` selects [nj, n].

    Ideal joints do none. An impact turns arms under a joint in the middle of a step, and closing
    the gap takes work; so does closing a joint that is engaged.
    """
    power = evidence.loads.joints.power(evidence.velocity)
    if among is not None:
        power = np.where(np.tile(among, (2, 1)), power, 0.0)
    return _to_middle(evidence.h * np.nan_to_num(power).sum(axis=0))


def _work_of_displacements(evidence: Evidence) -> Array:
    """Work of all but joints and contacts where impacts displace poses [J], [n]."""
    free = evidence.model.bodies.free[:, None]
    moved = np.where(free, evidence.displacement, 0.0)
    work = np.zeros(len(evidence.run))
    return _to_middle(work + sum(batch.power(moved).sum(axis=0)
                                 for batch in evidence.loads.batches))


def _work_of_contacts(evidence: Evidence) -> Array:
    """Work of contacts and stops up to the middle of each step [J], [n]."""
    a, sides = evidence.run.arrays, evidence.loads.contact_sides
    v = evidence.velocity[:, sides.body, sides.sample]
    power = (sides.force[:, 0] * v[0] + sides.force[:, 1] * v[1] + sides.moment * v[2])
    power = np.where(evidence.model.bodies.free[sides.body], power, 0.0)
    step = np.bincount(sides.sample, weights=power, minlength=len(evidence.run))
    stops = np.nan_to_num(a["joint_stop"] * a["joint_rate"]).sum(axis=1)
    return _to_middle(evidence.h * (step + stops))
