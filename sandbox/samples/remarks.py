"""Notes on a run: broken elements, points at the end of their groove, stalled drives."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.model.joints import slot_length
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


def stalled(run: Stored) -> Iterator[str]:
    """A note on each drive at its limit on bodies that are at rest at the end."""
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
