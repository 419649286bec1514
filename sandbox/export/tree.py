"""The kinematic tree of a mechanism: which joint carries which body, and which close loops.

A body that slides in a groove, is welded or pinned to a body of the tree
becomes its child; a body that nothing carries moves freely. Grooves come
first, since a groove can't close a loop in MuJoCo, then welds, then pins, each
in the order of the scene. Rods and ropes carry nothing: they are tendons.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass

from sandbox.scene.elements.bodies import Body
from sandbox.scene.elements.joints import Joint, Pin, Rod, Rope, Slot, Weld
from sandbox.scene.geometry import Pose, Vec, anchors, pose_of, to_body, to_world
from sandbox.scene.mechanism import Mechanism

Carrier = Slot | Weld | Pin


@dataclass(frozen=True)
class Link:
    """A body in the tree.

    ``parent`` is "" for the world; ``pose`` is that of the body in its
    parent's frame at t = 0, with the joint assembled; ``joint`` is what
    carries it, None for a body that is fixed or free; ``turned`` says that the
    body is the joint's ``a``, its parent ``b``.
    """

    body: Body
    parent: str
    pose: Pose
    joint: Carrier | None = None
    turned: bool = False


@dataclass(frozen=True)
class Tree:
    """All bodies, parents before their children, and the joints that close loops."""

    links: dict[str, Link]
    loops: tuple[Carrier, ...]

    def line(self, body: str) -> Iterator[Link]:
        """A body's link, its parent's, and so on to the world."""
        while body:
            yield self.links[body]
            body = self.links[body].parent


def _rank(joint: Joint) -> int | None:
    match joint:
        case Slot():
            return 0
        case Weld():
            return 1
        case Pin():
            return 2
        case Rod() | Rope():
            return None


def grow(mechanism: Mechanism) -> Tree:
    """The tree of ``mechanism``; one that nothing fixes hangs on its first free body."""
    bodies = {body.name: body for body in mechanism.bodies}
    meeting: dict[str, list[tuple[int, int]]] = {name: [] for name in bodies}
    carriers: dict[int, Carrier] = {}
    for i, joint in enumerate(mechanism.joints):
        rank = _rank(joint)
        if rank is not None and not isinstance(joint, (Rod, Rope)):
            carriers[i] = joint
            for name in (joint.a, joint.b):
                meeting[name].append((rank, i))
    links: dict[str, Link] = {}
    used: set[int] = set()
    waiting: list[tuple[int, int]] = []

    def place(link: Link) -> None:
        links[link.body.name] = link
        for entry in meeting[link.body.name]:
            heapq.heappush(waiting, entry)

    still = [body for body in mechanism.bodies if body.motion != "dynamic"]
    for body in still:
        place(Link(body, "", pose_of(body)))
    for root in (None, *mechanism.bodies):
        if root is not None and root.name not in links:
            place(Link(root, "", pose_of(root)))
        while waiting:
            _, i = heapq.heappop(waiting)
            joint = carriers[i]
            if joint.a in links and joint.b in links:
                continue
            used.add(i)
            place(_carried(joint, bodies, turned=joint.b in links))
    unmoved = {body.name for body in still}
    loops = tuple(joint for i, joint in carriers.items()
                  if i not in used and not {joint.a, joint.b} <= unmoved)
    return Tree(links, loops)


def _carried(joint: Carrier, bodies: dict[str, Body], *, turned: bool) -> Link:
    a, b = bodies[joint.a], bodies[joint.b]
    on_a, on_b = meeting_points(joint, a, b)
    child, parent = (a, b) if turned else (b, a)
    there, here = (on_b, on_a) if turned else (on_a, on_b)
    angle = child.angle - parent.angle
    x, y = to_world((0.0, 0.0, angle), here)
    return Link(child, parent.name, (there[0] - x, there[1] - y, angle), joint, turned)


def meeting_points(joint: Carrier, a: Body, b: Body) -> tuple[Vec, Vec]:
    """Where ``a`` and ``b`` meet at t = 0: a point of each, in its own frame [m]."""
    if not isinstance(joint, Slot):
        return anchors(joint, a, b)
    along, _ = groove(joint)
    way = travel(joint, a, b)
    return (joint.start[0] + way * along[0], joint.start[1] + way * along[1]), _on_b(joint)


def groove(slot: Slot) -> tuple[Vec, float]:
    """Direction, in the frame of ``a``, and length [m] of a groove."""
    length = math.dist(slot.start, slot.end)
    if not length:
        return (1.0, 0.0), 0.0
    return ((slot.end[0] - slot.start[0]) / length, (slot.end[1] - slot.start[1]) / length), length


def travel(slot: Slot, a: Body, b: Body) -> float:
    """How far from the groove's start its point is at t = 0 [m], never beyond its ends."""
    along, length = groove(slot)
    x, y = to_body(pose_of(a), to_world(pose_of(b), _on_b(slot)))
    way = (x - slot.start[0]) * along[0] + (y - slot.start[1]) * along[1]
    return min(max(way, 0.0), length)


def _on_b(slot: Slot) -> Vec:
    return slot.on_b or (0.0, 0.0)
