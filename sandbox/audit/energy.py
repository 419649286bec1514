"""Figures of energy: the work of joints and contacts, and the balance of all work.

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
from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import (
    EXACT,
    NOT_EVERY_STEP,
    ROUNDING,
    Figure,
    judged,
    missing,
    peak,
)
from sandbox.audit.starts import StartsAtSpeed, initial_velocity, paced, starts
from sandbox.numeric import Array, Flags
from sandbox.samples.samples import OLDER

LARGEST_STEP_ERROR = 0.01
"""The largest share of all energy turned over that may be called the step's error."""
LEFT = 1e-8
"""Overlaps up to this [m] may be undone without being called a source of energy."""


def energy_figures(evidence: Evidence) -> Iterator[Figure]:
    """Of all work against the kinetic energy."""
    source = "ΔE = Σ W"
    unknown = _unrecorded(evidence)
    if unknown:
        for name in ("energy.start", "energy.created", "energy.lost"):
            yield missing(name, why=unknown, source=source)
        return
    a = evidence.run.arrays
    kinetic = kinetic_energy(evidence)
    works = sum(np.abs(a[f"{kind}_work"]).sum(axis=1)
                for kind in ("drive", "spring", "line", "load"))
    if any(evidence.model.mechanism.gravity):
        works = works + np.abs(_work_of_weight(evidence))
    scale = max(float((works + kinetic).max(initial=0.0)), 1e-15)
    left = kinetic - kinetic_at_start(evidence) - _work_of_loads(evidence)
    least = EXACT + _of_gaps(evidence) / scale
    started, each = starts(evidence), _of_the_step(evidence)
    smooth = float(each[~started.within].sum()) + _first_half(evidence)
    blow = not started.cost <= scale * (least + min(smooth / scale, LARGEST_STEP_ERROR))
    error = smooth + (started.unsure if blow else float(each[started.within].sum()))
    allowed = least + min(error / scale, LARGEST_STEP_ERROR)
    by_joints = started.made if blow else np.zeros(len(left))
    yield _started(evidence, started, blow, scale, allowed)
    if _closed_gaps(evidence) and not evidence.every_step:
        why = f"joints broke or were engaged again, which does work, and {NOT_EVERY_STEP}"
        yield missing("energy.created", why=why, source=source)
        yield missing("energy.lost", why=why, source=source)
        return
    closing = ~evidence.joints_hold
    by_joints = by_joints + (_work_of_joints(evidence, closing) if closing.any() else 0.0)
    made = (left - by_joints)[evidence.known]
    yield _created(made, scale, allowed + _unseen(evidence) / scale)
    yield _lost(evidence, left, by_joints, scale, least, allowed)


def kinetic_energy(evidence: Evidence) -> Array:
    """Mean of the energies before and after the step [J], [n]: m (v^2 + (h a / 2)^2) / 2."""
    a, count = evidence.run.arrays, len(evidence.run)
    v, change = (a[key].reshape(count, -1) for key in ("body_velocity", "body_acceleration"))
    weight = evidence.loads.weights.ravel()
    moving = np.einsum("ni,ni,i->n", v, v, weight)
    return np.asarray(moving + (evidence.h / 2)**2
                      * np.einsum("ni,ni,i->n", change, change, weight)) / 2


def kinetic_at_start(evidence: Evidence) -> float:
    """At t = 0 [J], from the scene."""
    return float((evidence.loads.weights * initial_velocity(evidence)**2).sum()) / 2


def _unrecorded(evidence: Evidence) -> str:
    bodies, drives = evidence.model.bodies, evidence.model.drives
    if len(moved := np.flatnonzero(bodies.scheduled)):
        return f"the work of {bodies.name[moved[0]]!r}, moved by a schedule, is not recorded"
    if len(grown := drives.giving("radius")):
        return f"the work of {drives.name[grown[0]]!r}, which changes a radius, is not recorded"
    return ""


def _work_of_loads(evidence: Evidence) -> Array:
    """All but joints and contacts: tendons, lines, drives, springs, dampers, weight [J], [n]."""
    a, model = evidence.run.arrays, evidence.model
    # the work of a pull is its tendon's, that of a pump goes into its line
    own = np.delete(a["drive_work"], model.drives.giving("tension", "flow", "pressure"), axis=1)
    total = a["tendon_work"].sum(axis=1) + a["spring_work"].sum(axis=1)
    total = total + a["line_work"].sum(axis=1) + a["load_work"].sum(axis=1)
    total = total + own.sum(axis=1)
    for key in ("joint_damping_work", "joint_friction_work"):
        total = total + np.nan_to_num(a[key]).sum(axis=1)
    if any(model.mechanism.gravity):
        total = total + _work_of_weight(evidence)
    return np.asarray(total)


def _work_of_weight(evidence: Evidence) -> Array:
    """M g . (c - c_0 + h^2 a / 4): the displacement by mean velocities, as works are added up.

    Half of what an impact displaces counts, if it is known. The first step's mean velocity leads
    back from its pose to c_0; where it was not recorded c_0 is the scene's, and a h^2 / 8 beside
    that (see :func:`_first_half`).
    """
    frames, h = evidence.loads.frames, evidence.h
    g = np.array(evidence.model.mechanism.gravity)
    total = np.zeros(frames.samples)
    for i in np.flatnonzero(evidence.model.bodies.free):
        own = float(evidence.run.arrays["body_mass"][i])
        v, a = evidence.velocity[:2, i], frames.acceleration[:2, i]
        now = np.stack([frames.centre_x[i], frames.centre_y[i]])
        if evidence.run.time[0] < h:
            first = now[:, :1] - h / 2 * (v - h / 2 * a)[:, :1]
        else:
            cx, cy = evidence.run.arrays["body_centre"][i]
            x, y, angle = evidence.model.bodies.pose[i]
            c, s = np.cos(angle), np.sin(angle)
            first = np.array([[x + c * cx - s * cy], [y + s * cx + c * cy]])
        moved = evidence.displacement[:2, i] / 2
        total += own * (g @ (now - first + h * h / 4 * a + moved))
    return total


def _first_half(evidence: Evidence) -> float:
    """What weight may have done in the first half step that samples do not show [J]."""
    if evidence.run.time[0] < evidence.h:
        return 0.0
    free, g = evidence.model.bodies.free, np.array(evidence.model.mechanism.gravity)
    a = np.hypot(*evidence.loads.frames.acceleration[:2, free])
    most = np.maximum(a.max(axis=1, initial=0.0), np.hypot(*g))
    return float(evidence.h**2 / 8 * np.hypot(*g) * (evidence.run.arrays["body_mass"][free] @ most))


def _unseen(evidence: Evidence) -> float:
    """Work of weight in half of the largest displacement by an impact, where none is known [J].

    It is less than h times the change of velocity.
    """
    if evidence.every_step:
        return 0.0
    change = np.hypot(*evidence.loads.frames.acceleration[:2]) * evidence.h**2 / 2
    weight = np.hypot(*evidence.model.mechanism.gravity) * evidence.loads.weights[:, 0]
    return float(np.where(evidence.struck, weight @ change, 0.0).max(initial=0.0))


def _of_gaps(evidence: Evidence) -> float:
    """What joints and contacts do that close what is left of a gap, and rounding of weights [J]."""
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
    """Work that joints and contacts may do up to each sample by the step's error [J], [n]."""
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
    arms = np.concatenate(evidence.contact_arms)
    own = np.hypot(*sides.force.T) * np.hypot(*arms.T) * bend[sides.body, sides.sample]
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
    """The same of what slides along or turns with a line: its turn w, and v along it, [nj, n].

    A groove adds w^2 v, a rod of length L as much as an arm that turns at v / L.
    """
    frames, v = evidence.loads.frames, evidence.velocity
    one, two = evidence.model.joints.bodies.T
    ends = frames.anchors
    vx, vy = (v[k][two] - s * v[2][two] * getattr(ends[1], arm) - v[k][one]
              + s * v[2][one] * getattr(ends[0], arm)
              for k, s, arm in ((0, 1.0, "arm_y"), (1, -1.0, "arm_x")))
    speed = np.hypot(vx, vy)
    result = np.zeros_like(force)
    joints = evidence.model.joints
    for j in joints.keeping("groove"):
        result[j] = force[j] * v[2][one[j]] ** 2 * speed[j]
    for j in joints.keeping("rack"):
        result[j] = force[j] * v[2][two[j]] ** 2 * speed[j]
    for j in joints.keeping("distance", "range", "gear", "roll"):
        along = math.sin(joints.pressure[j]) if joints.kind[j].keeps == "gear" else 1.0
        length = np.maximum(frames.gaps[j] * along, 1e-9)
        change = np.hypot(*(frames.acceleration[k][two[j]] - frames.acceleration[k][one[j]]
                            for k in (0, 1)))
        result[j] = force[j] * (speed[j] ** 3 / length**2 / 6 + speed[j] * change / length / 2)
    return result


def _started(
    evidence: Evidence, started: StartsAtSpeed, blow: bool, scale: float, allowed: float,
) -> Figure:
    """What motors that start at speed cost; a look where that can be told from the step's error."""
    name, source = "energy.start", "W = P Δω / 2"
    if not paced(evidence.model).any():
        return missing(name, why="there is no motor", source=source)
    if not blow:
        why = "every motor starts at the speed of its hinge"
    else:
        why = (f"{'; '.join(started.jumps[:3])}. This is an impact in one step: its forces grow as "
               f"1 / step. The {started.made[-1]:.2g} J of joints in it are not counted in "
               "energy.created and energy.lost. A signal that starts at the hinge's speed avoids "
               "it")
    return judged(name, started.cost / scale, "", allowed, why=why, source=source)


def _created(left: Array, scale: float, allowed: float) -> Figure:
    """Joints and contacts take energy or none: what they do may not grow."""
    lowest = np.minimum.accumulate(np.minimum(left, 0.0)) if len(left) else left
    rise = float((left - lowest).max(initial=0.0)) / scale
    return judged(
        "energy.created", rise, "", allowed, source="ΔE = Σ W",
        why="most energy that joints and contacts supplied, relative to all energy converted: "
            "kinetic energy minus the work of drives, tendons, springs, dampers and weight; the "
            "error of the step is allowed, up to 1 %")


def _lost(
    evidence: Evidence, left: Array, by_joints: Array, scale: float, least: float, allowed: float,
) -> Figure:
    """What joints and contacts took, against the contacts' and stops' own work."""
    a, run, source = evidence.run.arrays, evidence.run, "ΔE = Σ W"
    touched = (len(run.mean_contacts.sample) + len(a["impact_time"]) > 0
               or bool(np.nan_to_num(run.means("joint_stop")["joint_stop"]).any())
               or _stretched(evidence))
    if touched and not evidence.every_step:
        return missing(
            "energy.lost", source=source,
            why=f"contacts, stops and ropes do work in every step, and {NOT_EVERY_STEP}")
    if not touched:
        return judged(
            "energy.lost", peak(left - by_joints) / scale, "", allowed,
            source=source, why="energy lost without contacts: kinetic energy minus the work of "
                               "drives, tendons, springs, dampers and weight, relative to all "
                               "energy converted; the error of the step is allowed as in "
                               "energy.created")
    if not evidence.vectors:
        return missing("energy.lost", source=source, why=OLDER)
    # of what surfaces that run do the contacts' own work has a share, the rest goes into heat
    running = a["drive_work"][:, evidence.model.drives.giving("surface")].sum(axis=1)
    left = left + running - _work_of_contacts(evidence) - _work_of_joints(evidence)
    left = left + _work_of_displacements(evidence)
    return judged(
        "energy.lost", peak(left[evidence.known]) / scale, "", least, source=source,
        why="kinetic energy minus all work, including contacts, stops and joints in every step, "
            "relative to all energy converted")


def _stretched(evidence: Evidence) -> bool:
    """Whether a rope was ever taut, a pin at an end of its groove, teeth with play hit one another.

    All of them stop what comes.
    """
    force = evidence.run.means("joint_force")["joint_force"]
    joints = evidence.model.joints
    loose = np.union1d(joints.keeping("range"), np.flatnonzero(joints.play > 0))
    if np.nan_to_num(force[:, loose]).any():
        return True
    frames = evidence.loads.frames
    for j in joints.keeping("groove").tolist():
        along = joints.groove[j, 1] - joints.groove[j, 0]
        a = joints.bodies[j, 0]
        x, y = along / np.hypot(*along)
        c, s = frames.cos[a], frames.sin[a]
        pressed = force[:, j, 0] * (c * x - s * y) + force[:, j, 1] * (s * x + c * y)
        if (np.abs(pressed) > EXACT * np.abs(force[:, j]).max(initial=0.0)).any():
            return True
    return False


def _closed_gaps(evidence: Evidence) -> bool:
    """Whether any joint carried something while it broke, or while it was taken up."""
    a = evidence.run.arrays
    carried = (np.nan_to_num(a["joint_reaction"]) + np.abs(np.nan_to_num(a["joint_couple"]))).T
    ever = evidence.model.ties.joint >= 0
    may = ever & np.isfinite(np.append(evidence.model.ties.breaks_at, np.inf))[
        evidence.model.ties.joint]
    broke = may & ~evidence.joints_hold.all(axis=1)
    return bool(broke.any() or (carried[~evidence.joints_hold] != 0.0).any())


def _work_of_joints(evidence: Evidence, among: Flags | None = None) -> Array:
    """Sum of R . v over the joints and steps, up to the middle of each [J].

    Ideal joints do none; an impact turns arms under a joint in the middle of a
    step, and closing what that opened takes work; so does closing one that is taken up. ``among``
    are the samples of each joint that count, [nj, n].
    """
    joints, v = evidence.loads.joints, evidence.loads.frames.velocity[:, evidence.loads.joints.body]
    power = joints.x * v[0] + joints.y * v[1] + joints.moment * v[2]
    if among is not None:
        power = np.where(np.tile(among, (2, 1)), power, 0.0)
    step = evidence.h * np.nan_to_num(power).sum(axis=0)
    return np.asarray(np.cumsum(step) - step / 2)


def _work_of_displacements(evidence: Evidence) -> Array:
    """What all but joints and contacts do where impacts displace poses, up to each [J], [n]."""
    loads, frames, sides = evidence.loads, evidence.loads.frames, evidence.loads.contact_sides
    force = frames.acceleration * np.where(loads.weights > 0, loads.weights, 0.0).T[:, :, None]
    joints = loads.joints
    for axis, touch, push in zip(force, (*sides.force.T, sides.moment),
                                 (joints.x, joints.y, joints.moment), strict=True):
        np.subtract.at(axis, (sides.body, sides.sample), touch)
        np.subtract.at(axis, joints.body, np.nan_to_num(push))
    free = evidence.model.bodies.free
    work = np.einsum("abn,abn->n", force[:, free], evidence.displacement[:, free])
    return np.asarray(np.cumsum(work) - work / 2)


def _work_of_contacts(evidence: Evidence) -> Array:
    """Sum of F . v over the contacts and stops of every step, up to the middle of each [J]."""
    a, frames = evidence.run.arrays, evidence.loads.frames
    sides = evidence.loads.contact_sides
    v = frames.velocity[:, sides.body, sides.sample]
    power = (sides.force[:, 0] * v[0] + sides.force[:, 1] * v[1] + sides.moment * v[2])
    power = np.where(evidence.model.bodies.free[sides.body], power, 0.0)
    step = np.bincount(sides.sample, weights=power, minlength=frames.samples)
    step = evidence.h * (step + np.nan_to_num(a["joint_stop"] * a["joint_rate"]).sum(axis=1))
    return np.asarray(np.cumsum(step) - step / 2)
