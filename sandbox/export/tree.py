"""The kinematic tree of a mechanism: which joint carries which body, and which close loops.

A body that slides in a groove, is welded or pinned to a body of the tree
becomes its child; a body that nothing carries moves freely. Grooves come
first, since a groove can't close a loop in MuJoCo, then welds, then pins, each
in the order of the scene. Rods and ropes carry nothing: they are tendons.

Bodies and joints are the model's numbers; the world is ``NONE``.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sandbox.model.model import NONE, Model
from sandbox.numeric import Array
from sandbox.scene.geometry import Pose, Vec, to_body, to_world


@dataclass(frozen=True)
class Link:
    """A body in the tree."""

    body: int
    parent: int
    """``NONE`` for the world."""
    pose: Pose
    """In its parent's frame at t = 0, with the joint assembled: x, y [m], angle [rad]."""
    joint: int = NONE
    """What carries it; ``NONE`` for a body that is fixed or free."""
    backwards: bool = False
    """Whether the body is the joint's ``a``, its parent ``b``."""


@dataclass(frozen=True)
class Tree:
    """All bodies, parents before their children, and the joints that close loops."""

    links: dict[int, Link]
    loops: tuple[int, ...]

    def line(self, body: int) -> Iterator[Link]:
        """A body's link, its parent's, and so on to the world."""
        while body != NONE:
            yield self.links[body]
            body = self.links[body].parent


def _rank(model: Model, joint: int) -> int | None:
    """The lower, the sooner a joint carries a body; None if it never does."""
    kind = model.joints.kind[joint]
    if kind.along_line:
        return None
    if kind.mujoco_loop:
        return 0
    return 2 if model.joints.turns[joint] else 1


def grow(model: Model) -> Tree:
    """The tree of a mechanism; one that nothing fixes hangs on its first free body."""
    ends: list[list[int]] = model.joints.bodies.tolist()
    ranks = {joint: rank for joint in range(len(ends))
             if (rank := _rank(model, joint)) is not None}
    links: dict[int, Link] = {}
    used: set[int] = set()
    waiting: list[tuple[int, int]] = []

    def place(link: Link) -> None:
        links[link.body] = link
        for joint, _ in model.neighbours[link.body]:
            if joint in ranks:
                heapq.heappush(waiting, (ranks[joint], joint))

    unmoved = np.flatnonzero(~model.bodies.free).tolist()
    for body in unmoved:
        place(Link(body, NONE, pose(model, body)))
    for root in (NONE, *range(len(model.bodies.name))):
        if root != NONE and root not in links:
            place(Link(root, NONE, pose(model, root)))
        while waiting:
            _, joint = heapq.heappop(waiting)
            a, b = ends[joint]
            if a in links and b in links:
                continue
            used.add(joint)
            place(_carried(model, joint, backwards=b in links))
    loops = tuple(joint for joint in ranks
                  if joint not in used and not set(ends[joint]) <= set(unmoved))
    return Tree(links, loops)


def _carried(model: Model, joint: int, *, backwards: bool) -> Link:
    a, b = model.joints.bodies[joint].tolist()
    on_a, on_b = meeting_points(model, joint)
    child, parent = (a, b) if backwards else (b, a)
    there, here = (on_b, on_a) if backwards else (on_a, on_b)
    angle = pose(model, child)[2] - pose(model, parent)[2]
    x, y = to_world((0.0, 0.0, angle), here)
    return Link(child, parent, (there[0] - x, there[1] - y, angle), joint, backwards)


def pose(model: Model, body: int) -> Pose:
    """Of a body's frame at t = 0: x, y [m], angle [rad]."""
    x, y, angle = model.bodies.pose[body].tolist()
    return x, y, angle


def vec(row: Array) -> Vec:
    """A row of two numbers as a point."""
    x, y = row.tolist()
    return x, y


def anchors(model: Model, joint: int) -> tuple[Vec, Vec]:
    """The points of ``a`` and ``b`` that a joint holds, in their frames [m]."""
    on_a, on_b = model.joints.anchor[joint]
    return vec(on_a), vec(on_b)


def meeting_points(model: Model, joint: int) -> tuple[Vec, Vec]:
    """Where ``a`` and ``b`` meet at t = 0: a point of each, in its own frame [m]."""
    on_a, on_b = anchors(model, joint)
    if model.joints.kind[joint].keeps == "groove":
        (x, y), (along, _) = vec(model.joints.groove[joint, 0]), groove(model, joint)
        s = displacement(model, joint)
        on_a = x + s * along[0], y + s * along[1]
    return on_a, on_b


def groove(model: Model, joint: int) -> tuple[Vec, float]:
    """Direction, in the frame of ``a``, and length [m] of a groove."""
    start, end = (vec(row) for row in model.joints.groove[joint])
    length = math.dist(start, end)
    if not length:
        return (1.0, 0.0), 0.0
    return ((end[0] - start[0]) / length, (end[1] - start[1]) / length), length


def displacement(model: Model, joint: int) -> float:
    """How far from its groove's start a point is at t = 0 [m], never beyond the groove's ends."""
    along, length = groove(model, joint)
    start = vec(model.joints.groove[joint, 0])
    a, b = model.joints.bodies[joint].tolist()
    _, on_b = anchors(model, joint)
    x, y = to_body(pose(model, a), to_world(pose(model, b), on_b))
    s = (x - start[0]) * along[0] + (y - start[1]) * along[1]
    return min(max(s, 0.0), length)
