"""Notes on a run: broken elements, points at the end of their groove, stalled drives."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.model.joints import rotated, slot_length
from sandbox.model.model import Model
from sandbox.model.supports import LARGEST_GROUP, RANK, joint_rows, together
from sandbox.numeric import Array
from sandbox.samples.frames import Frames
from sandbox.samples.loads import Loads
from sandbox.samples.outcome import Stored

MOST = 8
"""Largest number of notes of one kind."""


def broken(run: Stored) -> Iterator[str]:
    """A note on each joint, spring and tendon that broke, in order of time."""
    ties, springs = run.model.ties, run.model.springs
    turning = {ties.name[tie] for tie in ties.spring[~springs.straight].tolist() if tie >= 0}
    known = {name: float(most) for name, most in zip(ties.name, ties.breaks_at, strict=True)}
    broke = [one for one in run.info.broke if one.event in known]
    for one in broke[:MOST]:
        unit = "N m" if one.event in turning else "N"
        yield f"{one.event} broke at its load of {known[one.event]:g} {unit}, t = {one.time:.6g} s"
    if len(broke) > MOST:
        yield f"{len(broke) - MOST} more broke after that"


AT_END = 1e-5
"""Distance [m] from an end of the groove at which a point that presses on it has reached it."""
PRESSES = 1e-9
"""Least force along the groove, relative to the joint's largest force."""


def ended(run: Stored) -> Iterator[str]:
    """A note on each point that reached an end of its groove after the start, in order of time."""
    joints = run.model.joints
    slots = joints.keeping("groove").tolist()
    if not slots or not len(run):
        return
    divide = {name for group in run.mechanism.groups if group.tree for name in group.bodies}
    told, frames = [], Frames(run)
    for joint in slots:
        place, length = frames.place_in_slot(joint), slot_length(run.model, joint)
        force = np.nan_to_num(run.arrays["joint_force"][:, joint])
        along = np.abs(place.x * force[:, 0] + place.y * force[:, 1])
        pressed = along > PRESSES * np.abs(force).max()
        for left in (place.along, length - place.along):
            there = np.flatnonzero((left < AT_END) & pressed)
            if len(there) and left[0] >= AT_END:
                told.append((int(there[0]), joint, float(left[0])))
    for sample, joint, gone in sorted(told)[:MOST]:
        name = run.model.bodies.name[int(joints.bodies[joint, 1])]
        more = ", and divides its pull no longer while it is there" if name in divide else ""
        yield (f"{joints.name[joint]}: {name} reached the end of its slot, {1000.0 * gone:.4g} mm "
               f"from its start, t = {run.time[sample]:.6g} s{more}")
    if len(told) > MOST:
        yield f"{len(told) - MOST} more reached the ends of their slots later"


AT_REST = 1e-6
"""Largest speed at rest [m/s, rad/s]."""
AT_MOST = 1e-6
"""Distance from its limit, relative to it, at which a drive is at its limit."""
NUDGE = 1e-4
"""Motion [rad, m] out of a dead centre; forces change by about this fraction."""
NOTHING, LEADS = 1e-9, 1e-2
"""Relative force along a motion that counts as 0; least relative growth with the motion [1/m]."""


def stalled(run: Stored) -> Iterator[str]:
    """A note on each drive that acts at the end on a mechanism at rest."""
    drives = run.model.drives
    if not len(run) or not len(drives.name):
        return
    loads = Loads(run)
    still = np.abs(run.arrays["body_velocity"]).max(axis=2) < AT_REST
    for i, kind in enumerate(drives.kind):
        if not kind.limited or not np.isfinite(drives.most[i]):
            continue
        a, b = run.model.joints.bodies[drives.target[i]].tolist()
        rests = still[:, a] & still[:, b] & (
            np.abs(loads.given[i]) >= (1 - AT_MOST) * drives.most[i])
        if rests[-1]:
            since = run.time[len(run) - np.argmin(rests[::-1])] if not rests.all() else run.time[0]
            unit = "N" if kind.gives == "push" else "N m"
            yield (f"{drives.name[i]} has stalled: from t = {since:.6g} s on it gives all of its "
                   f"{drives.most[i]:g} {unit}, and nothing moves")
    pose = run.arrays["body_pose"][-1]
    if not np.isfinite(pose).all():
        return
    for joints in together(run.model):
        bodies = sorted({body for body in run.model.joints.bodies[joints].ravel().tolist()
                         if run.model.bodies.free[body]})
        if len(bodies) > LARGEST_GROUP // 3 or not still[-1, bodies].all():
            continue
        for i, kind in enumerate(drives.kind):
            if (kind.gives in ("force", "torque") and loads.given[i, -1]
                    and _dead_centre(run.model, pose, bodies, joints, i)):
                yield (f"{drives.name[i]} acts at a dead centre: at the end it moves nothing, "
                       "although it would in neighbouring poses")


def _dead_centre(model: Model, pose: Array, bodies: list[int], joints: list[int], i: int) -> bool:
    """Whether a drive does no work in a pose, but in neighbouring poses."""
    load = _load(model, pose, bodies, i)
    size = float(np.abs(load).max(initial=0.0))
    motions = _motions(model, pose, bodies, joints)
    if not size or not motions.shape[1] or np.abs(motions.T @ load).max() > NOTHING * size:
        return False
    for motion in motions.T:
        moved = pose.copy()
        moved[bodies] += NUDGE * motion.reshape(-1, 3)
        beside = _motions(model, moved, bodies, joints)
        if motion @ beside @ beside.T @ _load(model, moved, bodies, i) > LEADS * NUDGE * size:
            return True
    return False


def _motions(model: Model, pose: Array, bodies: list[int], joints: list[int]) -> Array:
    """The motions that joints allow, orthonormal, [3 n, k]."""
    rows = [row for joint in joints for row in joint_rows(model, pose, joint)]
    J = np.zeros((len(rows), 3 * len(bodies)))
    for i, row in enumerate(rows):
        for body, coefficients in row:
            if body in bodies:
                J[i, 3 * bodies.index(body):][:3] += coefficients
    _, values, right = np.linalg.svd(J)
    return np.asarray(right[np.count_nonzero(values > RANK * values.max(initial=0.0)):].T)


def _load(model: Model, pose: Array, bodies: list[int], i: int) -> Array:
    """A unit of a drive's force or torque on bodies, moments about their frames, [3 n]."""
    drives, joints, load = model.drives, model.joints, np.zeros((len(bodies), 3))
    target = int(drives.target[i])
    if drives.kind[i].gives == "force":
        angle = pose[target, 2]
        arm, force = rotated(drives.at[i], angle), drives.direction[i]
        force = rotated(force, angle) if drives.turning[i] else force
        if target in bodies:
            load[bodies.index(target)] = *force, arm[0] * force[1] - arm[1] * force[0]
    else:
        for body, sign in zip(joints.bodies[target].tolist(), (-1.0, 1.0), strict=True):
            if body in bodies:
                load[bodies.index(body), 2] = sign * joints.sense[target]
    return load.ravel()
