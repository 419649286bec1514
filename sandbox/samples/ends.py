"""Which points came to an end of their groove in a run, in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.numeric import Array, Flags
from sandbox.samples.stored import Stored

MOST = 8
"""How many are told one by one."""
AT_END = 1e-5
"""A point nearer to an end than this [m], which presses against it, is there."""
PRESSES = 1e-9
"""Of a joint's largest force the share along the groove that is no rounding."""
TREES = ("rocker_tree", "pulley_tree")


def ended(run: Stored) -> Iterator[str]:
    """A sentence for each point that came to an end of its groove, in order of time.

    What is at an end from the start on does not come to it.
    """
    joints = run.model.joints
    slots = joints.keeping("groove").tolist()
    if not slots or not len(run):
        return
    divide = {name for group in run.mechanism.groups if group.kind in TREES
              for name in group.bodies}
    told = []
    for joint in slots:
        way, pressed, length = _along(run, joint)
        for left in (way, length - way):
            there = np.flatnonzero((left < AT_END) & pressed)
            if len(there) and left[0] >= AT_END:
                told.append((int(there[0]), joint, float(left[0])))
    for sample, joint, gone in sorted(told)[:MOST]:
        name = run.model.bodies.name[int(joints.bodies[joint, 1])]
        more = ", and divides its pull no longer while it is there" if name in divide else ""
        yield (f"{joints.name[joint]}: {name} came to the end of its slot, {1e3 * gone:.4g} mm "
               f"from where it began, t = {run.time[sample]:.6g} s{more}")
    if len(told) > MOST:
        yield f"{len(told) - MOST} more came to the ends of their slots after that"


def _along(run: Stored, joint: int) -> tuple[Array, Flags, float]:
    """How far a point is on its groove [m], [n], whether it presses along it, [n], its length."""
    joints, pose = run.model.joints, run.arrays["body_pose"]
    groove, (a, b) = joints.groove[joint], joints.bodies[joint].tolist()
    length = float(np.hypot(*(groove[1] - groove[0])))
    way = _turned(pose[:, a], (groove[1] - groove[0]) / length)
    start = pose[:, a, :2] + _turned(pose[:, a], groove[0])
    point = pose[:, b, :2] + _turned(pose[:, b], joints.anchor[joint, 1])
    force = np.nan_to_num(run.arrays["joint_force"][:, joint])
    pressed = np.abs(np.einsum("ij,ij->i", force, way))
    return (np.einsum("ij,ij->i", point - start, way),
            pressed > PRESSES * np.abs(force).max(initial=0.0), length)


def _turned(pose: Array, arm: Array) -> Array:
    """An arm of a body's frame along the world's axes, in poses [n, 3], [n, 2]."""
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    return np.stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]], axis=1)
