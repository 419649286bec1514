"""Fingers that are too short for what they are to hold.

A finger reaches no further from its first hinge than its phalanges are long together.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pymunk

from sandbox.engine.inspect_words import NEGLIGIBLE, look, mm
from sandbox.engine.world import make_shape
from sandbox.errors import Problem
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags
from sandbox.scene.geometry import outline, pose_of, reach_of, solids, to_world

MOST_LOOKED = 100
"""Objects that a finger's reach is held against; if another may be nearer, none is told."""


class Phalanx(NamedTuple):
    """A phalanx and its near hinge."""

    body: int
    hinge: int


def chains(model: Model) -> dict[str, list[Phalanx]]:
    """Of each finger the phalanges with their hinges, the proximal one first.

    Left out are those that are no chain of pins, each phalanx on the one before.
    """
    joints, found = model.joints, dict[str, list[Phalanx]]()
    pins = {int(joints.bodies[j, 1]): int(j) for j in joints.keeping("point") if joints.angle[j]}
    for group in model.mechanism.groups:
        bodies = [model.names.body[name] for name in group.bodies]
        if group.kind != "finger" or not bodies or any(body not in pins for body in bodies):
            continue
        links = [Phalanx(body, pins[body]) for body in bodies]
        if all(int(joints.bodies[after.hinge, 0]) == link.body
               for link, after in itertools.pairwise(links)):
            found[group.name] = links
    return found


def hand_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """Fingers on a palm that stays, where the objects stay, too, and lie beyond their tips.

    ``allowed`` are the pairs of bodies that may touch, [nb, nb]. What moves may come within reach.
    """
    objects = np.array([i for i, body in enumerate(model.mechanism.bodies)
                        if body.role == "object" and body.shapes], dtype=np.int64)
    if not len(objects) or not model.bodies.fixed[objects].all():
        return
    rounds = np.array([_round(model, i) for i in objects.tolist()])
    for name, links in chains(model).items():
        palm = int(model.joints.bodies[links[0].hinge, 0])
        phalanges = np.array([link.body for link in links])
        touched = allowed[np.ix_(phalanges, objects)].any(axis=0)
        if not touched.any() or not model.bodies.fixed[palm]:
            continue
        hinge, reach = _hinge_at(model, links[0].hinge), _reach(model, links)
        apart = np.hypot(*(rounds[touched, :2] - hinge).T) - rounds[touched, 2]
        order = np.argsort(apart)
        nearer = objects[touched][order[:MOST_LOOKED]].tolist()
        distance, nearest = min((_distance(model, body, hinge), body) for body in nearer)
        # no other one is nearer than the circle about it
        certain = distance <= apart[order[MOST_LOOKED:]].min(initial=math.inf)
        if distance > reach + NEGLIGIBLE and certain:
            yield look(f"$.bodies[{links[0].body}]", name,
                       f"reaches {mm(reach)} from its first hinge, and the nearest object that it "
                       f"may touch, {model.bodies.name[nearest]!r}, is {mm(distance)} from it",
                       f"move either by {mm(distance - reach)} or more, or make it longer")


def _reach(model: Model, links: list[Phalanx]) -> float:
    """From the first hinge to the tip of the straight finger [m]."""
    joints = model.joints
    way = sum(math.dist(joints.anchor[link.hinge, 1], joints.anchor[after.hinge, 0])
              for link, after in itertools.pairwise(links))
    last = links[-1]
    return way + reach_of(model.mechanism.bodies[last.body], tuple(joints.anchor[last.hinge, 1]))


def _hinge_at(model: Model, hinge: int) -> Array:
    palm = model.joints.bodies[hinge, 0]
    pose = model.bodies.pose[palm]
    return np.array(to_world(tuple(pose), tuple(model.joints.anchor[hinge, 0])))


def _round(model: Model, body: int) -> tuple[float, float, float]:
    """A circle about all of a body: its centre in the world and its radius [m]."""
    written = model.mechanism.bodies[body]
    points = np.array([to_world(pose_of(written), point)
                       for shape in written.shapes for point in outline(shape)])
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    return (float(centre[0]), float(centre[1]),
            float(np.hypot(*(points - centre).T).max()))


def _distance(model: Model, body: int, point: Array) -> float:
    """From a point of the world to a body's shapes; 0 inside [m]."""
    written = model.mechanism.bodies[body]
    holder = pymunk.Body(body_type=pymunk.Body.STATIC)
    holder.position, holder.angle = written.at, written.angle
    found = math.inf
    for shape in written.shapes:
        for piece, _ in solids(shape):
            solid = make_shape(holder, piece, (0.0, 0.0))
            solid.cache_bb()
            found = min(found, solid.point_query((float(point[0]), float(point[1]))).distance)
    return max(found, 0.0)
