"""Differentials that ran out of travel in a run, in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.samples.stored import Stored

AT_END = 1e-6
"""A pivot that is nearer to an end of its slot stands there [m]; the solve keeps ends closer."""


def ended(run: Stored) -> Iterator[str]:
    """A sentence for each pivot of a tree that came to an end of its slot, in order of time."""
    found = []
    for group in run.mechanism.groups:
        if group.kind in ("rocker_tree", "pulley_tree"):
            for name in group.bodies:
                found += [(at, f"{name} reached the end of its slot, {1e3 * way:.4g} mm from where "
                               f"it started, at t = {at:.6g} s; there it shares the pull no longer")
                          for at, way in _end(run, run.model.names.body[name])]
    return (words for _, words in sorted(found))


def _end(run: Stored, body: int) -> Iterator[tuple[float, float]]:
    """When the pivot came to an end of its slot first [s], and how far that is from t = 0 [m]."""
    joints = run.model.joints
    for joint in joints.keeping("groove"):
        if joints.bodies[joint, 1] != body or len(run) < 2:
            continue
        gone, length = _along(run.model, run.arrays["body_pose"], joint)
        stands = np.minimum(gone, length - gone) <= AT_END
        if stands.any() and not stands[0]:
            first = int(np.argmax(stands))
            (before,), _ = _along(run.model, run.model.bodies.pose[None], joint)
            yield float(run.time[first]), abs(float(gone[first] - before))


def _along(model: Model, pose: Array, joint: int) -> tuple[Array, float]:
    """How far from the start of a groove its pivot is [n] m, and how long the groove is [m]."""
    frame, slider = model.joints.bodies[joint].tolist()
    start, end = model.joints.groove[joint]
    length = float(np.hypot(*(end - start)))

    def turned(point: Array, body: int) -> Array:
        c, s = np.cos(pose[:, body, 2]), np.sin(pose[:, body, 2])
        return np.stack((c * point[0] - s * point[1], s * point[0] + c * point[1]), axis=1)

    apart = (pose[:, slider, :2] + turned(model.joints.anchor[joint, 1], slider)
             - pose[:, frame, :2] - turned(start, frame))
    way: Array = np.einsum("ij,ij->i", apart, turned((end - start) / length, frame))
    return way, length
