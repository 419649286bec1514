"""Figures of force: joints' reactions, momentum of every body."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import (
    EXACT,
    ROUNDING,
    SMALLEST_SCALE,
    Figure,
    Worst,
    judged,
    missing,
    whole,
)
from sandbox.model.supports import LARGEST_GROUP, shared_joints
from sandbox.samples.samples import OLDER

POSES = 5
"""In so many poses joints have to share a load to be told: in a dead centre some do for once."""


def balance_figures(evidence: Evidence) -> Iterator[Figure]:
    """Reactions, momentum."""
    yield _reaction_sizes(evidence)
    yield _shared(evidence)
    yield from _momentum(evidence)


def _reaction_sizes(evidence: Evidence) -> Figure:
    """The recorded sizes of reactions against the recorded vectors."""
    a, worst = evidence.run.arrays, Worst()
    if not evidence.vectors:
        return missing("reaction.size", why=OLDER, source="|R|")
    vector = np.hypot(a["joint_force"][:, :, 0], a["joint_force"][:, :, 1])
    for j, name in enumerate(evidence.model.joints.name):
        scale = whole(a["joint_reaction"][:, j])
        worst.add(name, np.abs(vector[:, j] - a["joint_reaction"][:, j]) / scale, ROUNDING)
    return worst.figure(
        "reaction.size", "", source="|R|", none="there is no joint",
        why="magnitude of each reaction against its components, relative to the largest of its "
            "joint, {count:joint}, worst: {where}")


def _shared(evidence: Evidence) -> Figure:
    """Joints whose reactions the laws of mechanics leave open, in all of a few poses."""
    name, source = "reaction.shared", "rank of J"
    model, poses = evidence.model, evidence.run.arrays["body_pose"]
    if not len(model.joints.name):
        return missing(name, why="there is no joint", source=source)
    if not evidence.joints_hold.all():
        return missing(name, why="joints were released: others share the load",
                       source=source)
    few = np.unique(np.linspace(0, len(poses) - 1, min(len(poses), POSES)).astype(int))
    found = [shared_joints(model, poses[i]) for i in few]
    shared = [model.joints.name[j] for j in sorted(set.intersection(*(f.joints for f in found)))]
    asked = found[0].asked
    if not asked:
        return missing(name, source=source, why=f"more than {LARGEST_GROUP} forces are connected")
    return judged(
        name, float(len(shared)), "", 0.0, source=source,
        why="joints whose reactions statics does not determine: " + (_named(shared, 6) or "none"))


def _named(items: list[str], most: int = 3) -> str:
    return "; ".join(items[:most]) + (f" and {len(items) - most} more" if len(items) > most else "")


def _momentum(evidence: Evidence) -> Iterator[Figure]:
    """What is left of m a - sum F and of I alpha - sum M on every body in every sample."""
    model = evidence.model
    names = ("momentum.force", "m a = Σ F"), ("momentum.moment", "I α = Σ M")
    if not evidence.vectors:
        for name, source in names:
            yield missing(name, why=OLDER, source=source)
        return
    loads = evidence.loads
    for row, (name, source) in enumerate(names):
        left_over = Worst()
        for b in np.flatnonzero(model.bodies.free).tolist():
            force, moment = (float(loads.largest[k, b]) for k in (0, 1))
            scale = max(moment, force * ROUNDING / EXACT) if row else force
            scale = max(scale, SMALLEST_SCALE)
            left = loads.left[:, b]
            error = np.abs(left[2]) if row else np.hypot(left[0], left[1])
            left_over.add(model.bodies.name[b], error / scale,
                          float(evidence.left_allowed[row, b]) / scale)
        yield left_over.figure(
            name, "", source=source, none="nothing moves freely",
            why=f"difference between {'I alpha' if row else 'm a'} and the sum of all "
                f"{'moments' if row else 'forces'} on a body, relative to the largest, "
                "{count:body|bodies}, worst: {where}")
