"""Balances of forces, and of energy: the work of joints and contacts against all other work.

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
    SMALLEST_SCALE,
    NotComputed,
    Worst,
    check,
    peak,
    whole,
)
from sandbox.audit.starts import StartsAtSpeed, initial_velocity, paced, starts
from sandbox.model.joints import placed
from sandbox.model.supports import LARGEST_GROUP, shared_joints
from sandbox.numeric import Array, Flags
from sandbox.samples.samples import OLDER

LARGEST_STEP_ERROR = 0.01
"""Largest error of the step that is allowed, relative to all energy converted."""
LEFT = 1e-8
"""Overlap [m] whose removal does not count as a source of energy."""
POSES = 5
"""Number of poses in which a joint has to be redundant: near a dead centre some are in one."""
UNBALANCED = ("difference between {0} and the sum of all {1} on a body, relative to the largest, "
              "{{count:body|bodies}}, worst: {{where}}")


@check("reaction.size", source="|R|",
       asks="is each reaction the magnitude of its x and y components?",
       compared="magnitude of each reaction against its components, relative to the largest of its "
                "joint, {count:joint}, worst: {where}",
       none="there is no joint")
def _reaction_sizes(evidence: Evidence, worst: Worst) -> None:
    a = evidence.run.arrays
    if not evidence.vectors:
        raise NotComputed(OLDER)
    off = np.abs(np.hypot(*a["joint_force"].transpose(2, 0, 1)) - a["joint_reaction"])
    for j, name in enumerate(evidence.model.joints.name):
        worst.add(name, off[:, j] / whole(a["joint_reaction"][:, j]), ROUNDING)


@check("reaction.shared", source="rank of J", asks="does statics determine every joint reaction?",
       compared="joints whose reactions statics does not determine: {note}")
def _shared(evidence: Evidence, worst: Worst) -> str:
    """Joints with undetermined reactions in each of a few poses."""
    model, poses = evidence.model, evidence.run.arrays["body_pose"]
    if not len(model.joints.name):
        raise NotComputed("there is no joint")
    if not evidence.joints_hold.all():
        raise NotComputed("joints were released: others share the load")
    few = np.unique(np.linspace(0, len(poses) - 1, min(len(poses), POSES)).astype(int))
    found = [shared_joints(model, poses[i]) for i in few]
    if not found[0].asked:
        raise NotComputed(f"more than {LARGEST_GROUP} forces are connected")
    shared = [model.joints.name[j] for j in sorted(set.intersection(*(f.joints for f in found)))]
    worst.judge(len(shared), 0.0)
    more = f" and {len(shared) - 6} more" if len(shared) > 6 else ""
    return "; ".join(shared[:6]) + more if shared else "none"


@check("momentum.force", source="m a = Σ F", asks="is F = m a for every body?",
       compared=UNBALANCED.format("m a", "forces"), none="nothing moves freely")
def _momentum(evidence: Evidence, worst: Worst) -> None:
    _residuals(evidence, worst, 0)


@check("momentum.moment", source="I α = Σ M", asks="is M = I alpha for every body?",
       compared=UNBALANCED.format("I alpha", "moments"), none="nothing moves freely")
def _angular_momentum(evidence: Evidence, worst: Worst) -> None:
    _residuals(evidence, worst, 1)


def _residuals(evidence: Evidence, worst: Worst, row: int) -> None:
    """Compare the residuals of m a - sum F (``row`` 0) or of I alpha - sum M (1)."""
    if not evidence.vectors:
        raise NotComputed(OLDER)
    model, loads = evidence.model, evidence.loads
    for b in np.flatnonzero(model.bodies.free).tolist():
        force, moment = loads.largest[:, b].tolist()
        scale = max(moment, force * ROUNDING / EXACT) if row else force
        scale = max(scale, SMALLEST_SCALE)
        left = loads.left[:, b]
        error = np.abs(left[2]) if row else np.hypot(left[0], left[1])
        worst.add(model.bodies.name[b], error / scale, evidence.left_allowed[row, b] / scale)


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
    """The balance, without the work of joints that close gaps.

    Raises:
        NotComputed: some work is not recorded.
    """
    a, model, drives = evidence.run.arrays, evidence.model, evidence.model.drives
    if len(moved := np.flatnonzero(model.bodies.scheduled)):
        raise NotComputed(
            f"the work of {model.bodies.name[moved[0]]!r}, moved by a schedule, is not recorded")
    if len(grown := drives.giving("radius")):
        raise NotComputed(
            f"the work of {drives.name[grown[0]]!r}, which changes a radius, is not recorded")
    weights, by_weight = evidence.loads.weights.T[:, :, None], _work_of_weight(evidence)
    # the mean of the kinetic energies before and after the step
    change = evidence.h / 2 * evidence.loads.frames.acceleration
    kinetic = (weights * (evidence.velocity**2 + change**2)).sum(axis=(0, 1)) / 2
    works = np.abs(by_weight) + sum(np.abs(a[f"{kind}_work"]).sum(axis=1)
                                    for kind in ("drive", "spring", "line", "load"))
    scale = max(float((works + kinetic).max(initial=0.0)), 1e-15)
    # the work of a pull is that of its tendon, the work of a pump goes into its line
    own = np.delete(a["drive_work"], drives.giving("tension", "flow", "pressure"), axis=1)
    left = kinetic - by_weight - own.sum(axis=1) - (
        evidence.loads.weights * initial_velocity(evidence)**2).sum() / 2
    for kind in ("tendon", "spring", "line", "load", "joint_damping", "joint_friction"):
        left = left - np.nan_to_num(a[f"{kind}_work"]).sum(axis=1)
    least = EXACT + _of_gaps(evidence) / scale
    started, each = starts(evidence), _of_the_step(evidence)
    smooth = float(each[~started.within].sum()) + _first_half(evidence)
    blow = not started.cost <= scale * (least + min(smooth / scale, LARGEST_STEP_ERROR))
    error = smooth + (started.unsure if blow else float(each[started.within].sum()))
    allowed = least + min(error / scale, LARGEST_STEP_ERROR)
    return _Balance(scale, left, started.made * blow, least, allowed, started, blow)


def _closed_balance(evidence: Evidence) -> _Balance:
    """The balance with the work of joints that close gaps, as they do when they are engaged.

    Raises:
        NotComputed: it is unknown.
    """
    found, a, ties = evidence.once(_balance), evidence.run.arrays, evidence.model.ties
    open_ = ~evidence.joints_hold
    if not evidence.every_step:
        carried = (np.nan_to_num(a["joint_reaction"])
                   + np.abs(np.nan_to_num(a["joint_couple"]))).T
        breaks = (ties.joint >= 0) & np.isfinite(np.append(ties.breaks_at, np.inf))[ties.joint]
        if (breaks & open_.any(axis=1)).any() or carried[open_].any():
            raise NotComputed(
                f"joints broke or were engaged again, which does work, and {NOT_EVERY_STEP}")
    if open_.any():
        found = found._replace(by_joints=found.by_joints + _work_of_joints(evidence, open_))
    return found


@check("energy.start", source="W = P Δω / 2",
       asks="do motors start without a jolt that loses energy?")
def _started(evidence: Evidence, worst: Worst) -> str:
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
    lowest = np.minimum.accumulate(np.minimum(made, 0.0))
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
    # where impacts displace poses all other loads work besides
    moved = evidence.displacement * evidence.model.bodies.free[:, None]
    left = left + _to_middle(sum((batch.power(moved).sum(axis=0)
                                  for batch in evidence.loads.batches), np.zeros(len(run))))
    worst.judge(peak(left[evidence.known]) / balance.scale, balance.least)
    return ("kinetic energy minus all work, including contacts, stops and joints in every step, "
            "relative to all energy converted")


# -- works ------------------------------------------------------------------------------------


def _to_middle(step: Array) -> Array:
    """Sums of work per step [n] up to the middle of each [J]."""
    return np.asarray(np.cumsum(step) - step / 2)


def _work_of_joints(evidence: Evidence, among: Flags | None = None) -> Array:
    """Work of reactions up to the middle of each step [J], [n]; ``among`` selects [nj, n].

    Ideal joints do none. An impact turns arms under a joint in the middle of a step, and closing
    the gap takes work; so does closing a joint that is engaged.
    """
    power = np.nan_to_num(evidence.loads.joints.power(evidence.velocity))
    if among is not None:
        power = np.where(np.tile(among, (2, 1)), power, 0.0)
    return _to_middle(evidence.h * power.sum(axis=0))


def _work_of_contacts(evidence: Evidence) -> Array:
    """Work of contacts and stops up to the middle of each step [J], [n]."""
    a, sides = evidence.run.arrays, evidence.loads.contact_sides
    v = (evidence.velocity * evidence.model.bodies.free[:, None])[:, sides.body, sides.sample]
    power = sides.force[:, 0] * v[0] + sides.force[:, 1] * v[1] + sides.moment * v[2]
    step = np.bincount(sides.sample, weights=power, minlength=len(evidence.run))
    return _to_middle(evidence.h * (
        step + np.nan_to_num(a["joint_stop"] * a["joint_rate"]).sum(axis=1)))


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
    free, g = evidence.model.bodies.free, np.hypot(*evidence.model.mechanism.gravity)
    a = np.hypot(*evidence.loads.frames.acceleration[:2, free])
    most = np.maximum(a.max(axis=1, initial=0.0), g)
    return float(evidence.h**2 / 8 * g * (evidence.run.arrays["body_mass"][free] @ most))


def _unseen(evidence: Evidence) -> float:
    """Largest work of weight in half of an unknown displacement by an impact [J].

    A displacement is less than h times the change of velocity.
    """
    if evidence.every_step:
        return 0.0
    change = np.hypot(*evidence.loads.frames.acceleration[:2]) * evidence.h**2 / 2
    weight = np.hypot(*evidence.model.mechanism.gravity) * evidence.loads.weights[:, 0]
    return float(np.where(evidence.struck, weight @ change, 0.0).max(initial=0.0))


def _stretched(evidence: Evidence) -> bool:
    """Whether a rope was taut, a pin pressed on an end of its groove, or loose teeth met."""
    force = np.nan_to_num(evidence.run.means("joint_force")["joint_force"])
    joints = evidence.model.joints
    along = [np.hypot(*force[:, j].T) for j in np.union1d(
        joints.keeping("range"), np.flatnonzero(joints.play > 0)).astype(int)]
    for j in joints.keeping("groove").tolist():
        x, y = evidence.loads.frames.groove_direction(j)
        pressed = np.abs(force[:, j, 0] * x + force[:, j, 1] * y)
        along.append(np.where(pressed > EXACT * peak(force[:, j]), pressed, 0.0))
    return any(each.any() for each in along)


# -- tolerances -------------------------------------------------------------------------------


def _of_gaps(evidence: Evidence) -> float:
    """Work of joints and contacts that close gaps, and rounding of weights [J]."""
    a, free = evidence.run.arrays, evidence.model.bodies.free
    work = evidence.closed * np.hypot(*np.nan_to_num(a["joint_force"]).T).max(axis=1, initial=0.0)
    pair = a["contact_body"] * len(free) + a["contact_other"]
    size, touch = np.hypot(*a["contact_force"].T), 0.0
    overlap = np.clip(-a["contact_gap"], 0.0, LEFT + evidence.contact_depth)
    for kind in np.unique(pair):
        own = pair == kind
        touch += float(size[own].max() * (evidence.closed + overlap[own].max()))
    weight = np.hypot(*evidence.model.mechanism.gravity) * a["body_mass"][free].sum()
    return float(work.sum() + touch + weight * ROUNDING)


def _of_the_step(evidence: Evidence) -> Array:
    """Work of joints and contacts up to each sample by the error of the step [J], [n].

    A groove that turns at w adds w^2 v to the bending of arms, v the speed along it; a rod of
    length L, or a path with this radius of curvature, adds as much as an arm that turns at v / L.
    """
    loads, sides, v = evidence.loads, evidence.loads.contact_sides, evidence.velocity
    joints, frames, h, a = evidence.model.joints, loads.frames, evidence.h, evidence.run.arrays
    omega, alpha = np.abs(v[2]), np.abs(frames.acceleration[2])
    bend = omega**3 / 6 + omega * alpha / 2
    force, couple = np.hypot(*a["joint_force"].T), np.abs(a["joint_couple"].T)
    (one, two), (on_a, on_b), w = joints.bodies.T, frames.anchors, v[2]
    arms = [np.hypot(end.arm_x, end.arm_y) for end in (on_a, on_b)]
    arms[0] = arms[0] + frames.gaps  # where a groove or a rod has its other end
    power = sum((force * arm + couple) * bend[body]
                for arm, body in zip(arms, (one, two), strict=True))
    speed = np.hypot(v[0, two] - w[two] * on_b.arm_y - v[0, one] + w[one] * on_a.arm_y,
                     v[1, two] + w[two] * on_b.arm_x - v[1, one] - w[one] * on_a.arm_x)
    change = np.hypot(*(frames.acceleration[:2, two] - frames.acceleration[:2, one]))
    for j, kind in enumerate(joints.kind):
        if kind.keeps == "groove":
            power[j] += force[j] * (w[one[j]]**2 * speed[j] + evidence.path_jerk[j])
        elif kind.keeps == "rack":
            power[j] += force[j] * w[two[j]]**2 * speed[j]
        elif kind.keeps in ("distance", "range", "gear", "roll"):
            along = math.sin(joints.pressure[j]) if kind.keeps == "gear" else 1.0
            length = np.maximum(frames.gaps[j] * along, 1e-9)
            power[j] += force[j] * (
                speed[j]**3 / length**2 / 6 + speed[j] * change[j] / length / 2)
    own = np.hypot(*sides.force.T) * np.hypot(*sides.arm.T) * bend[sides.body, sides.sample]
    total = np.nan_to_num(power).sum(axis=0) + _of_curvature(evidence) + np.bincount(
        sides.sample, weights=own, minlength=frames.samples)
    steps = 1.0
    if not evidence.every_step and frames.samples > 1:
        steps = float(np.median(np.diff(evidence.run.time))) / h
    return np.asarray(h**3 * steps * total)


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
