"""Which bodies stay with a mechanism, and which leave it: what a picture has to show of them.

What joints, springs, cords or cylinders tie to something that does not move freely stays. What is
tied to nothing of the kind may leave: a shelf that drops away, a ball that rolls off. To these a
picture is fitted up to their leaving; on the rest of their way they may be out of sight.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from sandbox.model.model import NONE
from sandbox.numeric import Array, Flags
from sandbox.picture.run_data import RunData

ROOM = 0.25
"""How far beside what stays a body may be and still be with it, in sizes of what stays."""
FLIGHT = 12.0
"""The same where nothing stays, in sizes of what is there at the start: what flies off alone is
seen on its way while it is no speck in the picture."""


def groups_of(run: RunData) -> list[int]:
    """The number of each body's group: of bodies that move, those tied together at the run's end.

    What does not move freely is a group of its own each and ties nothing together.
    """
    model = run.model
    parent = list(range(len(model.mechanism.bodies)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    still = _held(run)
    for bodies in _tied(run):
        free = [b for b in bodies if not still[b]]
        for one, other in pairwise(free):
            parent[root(one)] = root(other)
    return [root(i) for i in range(len(parent))]


def _held(run: RunData) -> Flags:
    """Which bodies do not move freely."""
    return np.array([body.motion != "dynamic" for body in run.mechanism.bodies], dtype=bool)


def _tied(run: RunData) -> Iterable[set[int]]:
    """Sets of bodies that hold on to one another, leaving out what is let go at the end."""
    model, held = run.model, run.arrays["held"]
    joints, springs, tendons, lines = model.joints, model.springs, model.tendons, model.lines

    def holds(tie: int) -> bool:
        return tie == NONE or not len(held) or bool(held[-1, tie])

    for k, pair in enumerate(joints.bodies.tolist()):
        if holds(int(model.ties.joint[k])):
            yield set(pair)
    for k, pair in enumerate(springs.bodies.tolist()):
        if holds(int(model.ties.spring[k])):
            yield set(pair)
    for k in range(len(model.mechanism.tendons)):
        if holds(int(model.ties.tendon[k])):
            yield set(tendons.guide_body[tendons.guides(k)].tolist())
    for pair in lines.bodies[lines.joint == NONE].tolist():
        yield set(pair)


def anchored(run: RunData) -> Flags:
    """Which bodies stay, [nb]: those that are fixed, and what is tied to what does not move freely.

    A scheduled body that holds nothing, such as a shelf that goes away, does not.
    """
    still, groups = _held(run), groups_of(run)
    stays = run.model.bodies.fixed.copy()
    fast = {groups[b] for bodies in _tied(run) if still[list(bodies)].any() for b in bodies}
    stays |= np.isin(groups, list(fast))
    return np.asarray(stays, dtype=bool)


def with_it(boxes: Array, stays: Flags) -> Flags:
    """In which samples each body is with the mechanism, [n, nb].

    A body that stays always is, and so is one that comes near for the first time later on. One
    that goes farther than :data:`ROOM` allows from what stays, and from where all bodies began, has
    left, if it does not come back. Where nothing stays, it may go as far as :data:`FLIGHT` allows.

    Args:
        boxes: left, bottom, right and top of every body in every sample, [n, nb, 4] m; nan of a
            body that has no extent.
        stays: those that stay, [nb].
    """
    n, count = boxes.shape[:2]
    found = np.ones((n, count), dtype=bool)
    home = np.concatenate([boxes[:, stays].reshape(-1, 4), boxes[0]])
    home = home[np.isfinite(home).all(axis=1)]
    if not len(home):
        return found
    low, high = home[:, :2].min(axis=0), home[:, 2:].max(axis=0)
    held = np.isfinite(boxes[:, stays]).any()
    room = (ROOM if held else FLIGHT) * float((high - low).max())
    if not room > 0:
        return found
    near = ((boxes[..., :2] <= high + room) & (boxes[..., 2:] >= low - room)).all(axis=-1)
    for body in np.flatnonzero(~stays):
        there = np.flatnonzero(near[:, body])
        if len(there):
            found[there[-1] + 1:, body] = False
    return found
