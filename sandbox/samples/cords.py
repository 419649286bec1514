"""Tendons in recorded poses: the stretches between guides, and the length along them.

A guide is a circle of radius r >= 0. Walking along u with left normal n, a
wheel whose centre lies right of the path has s = +1, left s = -1; the cord
touches it at c + s r n, and n . (c2 - c1) = s1 r1 - s2 r2 for a stretch. A plain
eye has r = 0. On a wheel between two stretches lies r times the angle of wrap;
from one at an end the cord pays out as the wheel turns.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.kinds.arrays import Array, Integers
from sandbox.samples.frames import Frames, Layout, Places
from sandbox.scene.geometry import Pose, pose_of, to_world

GRAZE = 1e-9
"""An angle of wrap [rad] below which a cord touches its wheel in one point."""


class Guides(NamedTuple):
    """All guides of all tendons in a row, [k], and the stretches between them, [m]."""

    body: Integers
    at: Array
    """In the bodies' frames [m], [k, 2]."""
    radius: Array
    """s r [m]."""
    tendon: Integers
    """Of every stretch, which tendon it is of."""
    first: Integers
    """Of every stretch, the guide where it begins; the next one is where it ends."""


def guides_of(layout: Layout) -> Guides:
    """The guides of a mechanism's tendons."""
    body: list[int] = []
    tendon: list[int] = []
    first: list[int] = []
    at, radius = [], []
    for number, cord in enumerate(layout.mechanism.tendons):
        first += range(len(body), len(body) + len(cord.guides) - 1)
        tendon += [number] * (len(cord.guides) - 1)
        for guide in cord.guides:
            body.append(layout.number[guide.body])
            at.append(guide.at)
            radius.append((1.0 if guide.side == "right" else -1.0) * guide.radius)
    return Guides(np.array(body, dtype=np.int64), np.array(at).reshape(-1, 2), np.array(radius),
                  np.array(tendon, dtype=np.int64), np.array(first, dtype=np.int64))


class Stretches(NamedTuple):
    """Straight pieces of cord, [m, n]."""

    length: Array
    """[m]"""
    x: Array
    """Unit vector along it."""
    y: Array
    start: Places
    """The guides' centres where the stretches begin and end."""
    end: Places


def stretches(frames: Frames, guides: Guides) -> Stretches:
    """All stretches in all samples."""
    one, two = guides.first, guides.first + 1
    start = frames.places(guides.body[one], guides.at[one])
    end = frames.places(guides.body[two], guides.at[two])
    return _straight(start, end, guides)


def _straight(start: Places, end: Places, guides: Guides) -> Stretches:
    dx, dy = end.x - start.x, end.y - start.y
    square = dx * dx + dy * dy
    if not guides.radius.any():
        length = np.sqrt(square)
        safe = np.where(length > 0, length, 1.0)
        return Stretches(length, dx / safe, dy / safe, start, end)
    offset = (guides.radius[guides.first] - guides.radius[guides.first + 1])[:, None]
    length = np.sqrt(np.maximum(square - offset * offset, 1e-24))
    square = length * length + offset * offset
    return Stretches(length, (length * dx + offset * dy) / square,
                     (length * dy - offset * dx) / square, start, end)


def lengths(frames: Frames, guides: Guides, cords: Stretches) -> Array:
    """Length of every tendon along its path [m], [nt, n], as the poses have it.

    How often a cord goes round its wheels is counted from t = 0 through all
    samples, which must not be further apart than half a turn.
    """
    count = len(frames.layout.mechanism.tendons)
    total = np.zeros((count, frames.samples))
    for row, tendon in enumerate(guides.tendon):
        total[tendon] += cords.length[row]
    if guides.radius.any():
        first = _at_start(frames, guides)
        for tendon in range(count):
            rows = np.flatnonzero(guides.tendon == tendon)
            nodes = [*guides.first[rows], guides.first[rows[-1]] + 1]
            if guides.radius[nodes].any():
                total[tendon] += _on_wheels(frames, guides, cords, first, rows)
    return total


def _at_start(frames: Frames, guides: Guides) -> Stretches:
    """The stretches at t = 0, [m, 1]."""
    poses: list[Pose] = [pose_of(body) for body in frames.layout.mechanism.bodies]
    at = np.array([to_world(poses[body], (float(x), float(y)))
                   for body, (x, y) in zip(guides.body, guides.at, strict=True)])
    nothing = np.zeros((len(guides.first), 1))
    ends = [Places(at[nodes, :1], at[nodes, 1:], nothing, nothing)
            for nodes in (guides.first, guides.first + 1)]
    return _straight(ends[0], ends[1], guides)


def _on_wheels(
    frames: Frames, guides: Guides, cords: Stretches, first: Stretches, rows: Integers,
) -> Array:
    """Length of cord on the wheels of one tendon [m], [n]; of wheels at its ends, what they let go.

    ``rows`` are its stretches.
    """
    angle = np.concatenate([np.arctan2(s.x[rows], -s.y[rows]) for s in (first, cords)], axis=1)
    result = np.zeros(frames.samples)
    nodes = [*guides.first[rows], guides.first[rows[-1]] + 1]
    bodies = frames.layout.mechanism.bodies
    for place, node in enumerate(nodes):
        radius, body = guides.radius[node], guides.body[node]
        if radius == 0.0:
            continue
        if 0 < place < len(nodes) - 1:
            side = np.sign(radius)
            wrap = side * (angle[place - 1] - angle[place])
            wrap[0] = (wrap[0] + GRAZE) % (2 * np.pi) - GRAZE
            result += abs(radius) * np.unwrap(wrap)[1:]
        else:
            own = np.concatenate([[bodies[body].angle], frames.angle[body]])
            turned = np.unwrap(angle[0 if place == 0 else -1] - own)
            sign = -1.0 if place == 0 else 1.0
            result += sign * radius * (turned[1:] - turned[0])
    return result

