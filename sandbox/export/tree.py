"""The kinematic tree of a mechanism for MuJoCo: parents of bodies, coordinates, closed loops."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sandbox.model.joints import place_in_slot, sliding, slot_length, turning
from sandbox.model.model import NONE, Model
from sandbox.scene.geometry import Pose, Vec, to_body, to_world


@dataclass(frozen=True)
class Link:
    """A body in the tree."""

    body: int
    parent: int  # ``NONE`` for the world
    pose: Pose  # in the parent's frame at t = 0, with the joint assembled: x, y [m], angle [rad]
    joint: int = NONE  # the joint that carries it; ``NONE`` for a body that is fixed or free
    backwards: bool = False  # whether the body is the joint's ``a``, its parent ``b``


def grow(model: Model) -> tuple[dict[int, Link], list[int]]:
    """All bodies, parents before their children, and the joints that close loops.

    Fixed bodies are roots, and the first body of each group that joints do not connect to them.
    """
    ends: list[list[int]] = model.joints.bodies.tolist()
    poses: list[Pose] = model.bodies.pose.tolist()
    ranks = {joint: 0 if kind.mujoco_loop else 2 if model.joints.turns[joint] else 1
             for joint, kind in enumerate(model.joints.kind) if not kind.along_line}
    unmoved = np.flatnonzero(~model.bodies.free).tolist()
    links = {body: Link(body, NONE, poses[body]) for body in unmoved}
    while len(links) < len(poses):
        ready = [(rank, joint) for joint, rank in ranks.items()
                 if (ends[joint][0] in links) != (ends[joint][1] in links)]
        if not ready:
            root = min(set(range(len(poses))) - links.keys())
            links[root] = Link(root, NONE, poses[root])
            continue
        _, joint = min(ready)
        a, b = ends[joint]
        backwards = b in links
        there, here = meeting_points(model, joint)[::-1 if backwards else 1]
        child, parent = (a, b) if backwards else (b, a)
        angle = poses[child][2] - poses[parent][2]
        x, y = to_world((0.0, 0.0, angle), here)
        links[child] = Link(child, parent, (there[0] - x, there[1] - y, angle), joint, backwards)
    used = {link.joint for link in links.values()}
    return links, [joint for joint in ranks
                   if joint not in used and not set(ends[joint]) <= set(unmoved)]


def groove(model: Model, joint: int) -> tuple[Vec, float]:
    """Direction of a groove in the frame of ``a``, and the place in it at t = 0 [m]."""
    place = place_in_slot(model, joint, model.bodies.pose)
    turned = float(model.bodies.pose[model.joints.bodies[joint, 0], 2])
    along = to_body((0.0, 0.0, turned), (float(place.x), float(place.y)))
    return along, min(max(float(place.along), 0.0), slot_length(model, joint))


def meeting_points(model: Model, joint: int) -> tuple[Vec, Vec]:
    """The points of ``a`` and ``b`` that coincide at t = 0, in their frames [m]."""
    on_a, on_b = model.joints.anchor[joint].tolist()
    if model.joints.kind[joint].keeps == "groove":
        (x, y), (along, s) = model.joints.groove[joint, 0].tolist(), groove(model, joint)
        on_a = x + s * along[0], y + s * along[1]
    return on_a, on_b


@dataclass(frozen=True)
class Freedom:
    """One coordinate of a body; point and axis in the body's frame."""

    name: str
    kind: Literal["hinge", "slide"]
    axis: tuple[float, float, float]
    at: Vec = (0.0, 0.0)  # a point of its axis [m]
    start: float = 0.0  # value at t = 0 [rad or m]
    rate: float = 0.0  # rate at t = 0 [rad/s or m/s]
    limits: tuple[float, float] | None = None  # hard stops [rad or m]
    joint: int = NONE  # index of the hinge, if it is one
    loss: float = 0.0  # dry friction of a slide [N]
    made: bool = False  # whether the name is not that of an element of the scene


def freedoms(model: Model, link: Link) -> list[Freedom]:
    """The coordinates of a body, from parent to child; none for a fixed body."""
    joints, joint, body = model.joints, link.joint, link.body
    if not model.bodies.free[body]:
        return []
    if joint == NONE:
        name, spec = model.bodies.name[body], model.mechanism.bodies[body]
        place, centre = model.bodies.pose[body].tolist(), model.bodies.centre[body].tolist()
        x, y = to_world(place, centre)
        c, s = math.cos(place[2]), math.sin(place[2])
        return [
            Freedom(f"{name}.x", "slide", (c, -s, 0.0), start=x, rate=spec.velocity[0], made=True),
            Freedom(f"{name}.y", "slide", (s, c, 0.0), start=y, rate=spec.velocity[1], made=True),
            Freedom(f"{name}.angle", "hinge", (0.0, 0.0, 1.0), at=centre, start=place[2],
                    rate=spec.angular_velocity, made=True)]
    name, side = joints.name[joint], -1.0 if link.backwards else 1.0
    at = meeting_points(model, joint)[0 if link.backwards else 1]
    if joints.kind[joint].keeps != "groove":
        sense = float(joints.sense[joint])
        return [Freedom(
            name, "hinge", (0.0, 0.0, side * sense), at=at, start=float(joints.start[joint]),
            rate=sense * turning(model, joint), joint=joint,
            limits=joints.stops[joint].tolist() if joint in joints.stopped else None,
        )] if joints.angle[joint] else []
    a, b = joints.bodies[joint].tolist()
    angle = float(model.bodies.pose[b, 2] - model.bodies.pose[a, 2])
    along, start = groove(model, joint)
    ahead = along if link.backwards else to_body((0.0, 0.0, angle), along)
    slide = Freedom(
        name, "slide", (side * ahead[0], side * ahead[1], 0.0), start=start,
        limits=(0.0, slot_length(model, joint)), loss=float(joints.friction[joint]),
        rate=sliding(model, joint))
    if not joints.turns[joint]:
        return [slide]
    hinge = Freedom(f"{name}.turn", "hinge", (0.0, 0.0, side), at=at, start=angle,
                    rate=turning(model, joint), made=True)
    return [hinge, slide] if link.backwards else [slide, hinge]
