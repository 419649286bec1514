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
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.geometry import outline, pose_of, reach_of, solids, to_world
from sandbox.wording import listed

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


class _Reaching(NamedTuple):
    """A finger that may touch objects, and the nearest of these."""

    name: str
    body: int
    """The proximal phalanx."""
    certain: bool
    """Whether the body that its first hinge is on stays, and no object that was not looked at may
    be nearer."""
    reach: float
    nearest: int
    distance: float
    """Of that object from the first hinge [m]."""

    @property
    def short(self) -> bool:
        """Whether it ends before that object, and stays so."""
        return self.certain and self.distance > self.reach + NEGLIGIBLE


def hand_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """Fingers on a palm that stays, and objects that lie beyond their tips.

    ``allowed`` are the pairs of bodies that may touch, [nb, nb]. What moves may come within reach.
    Objects that are free are told of where no finger reaches any, and so can not move them, and
    they only fall.
    """
    objects = np.array([i for i, body in enumerate(model.mechanism.bodies)
                        if body.role == "object" and body.shapes], dtype=np.int64)
    free = bool(len(objects)) and not model.bodies.fixed[objects].all()
    if not len(objects) or (free and not _only_fall(model, objects)):
        return
    fingers = list(_fingers(model, allowed, objects))
    if free and not all(finger.short for finger in fingers):
        return
    short = [finger for finger in fingers if finger.short]
    for nearest in dict.fromkeys(finger.nearest for finger in short):
        yield _too_short(model, [finger for finger in short if finger.nearest == nearest])


def _too_short(model: Model, fingers: list[_Reaching]) -> Problem:
    """Of those that lack one and the same object, the one that lacks most; the others' names."""
    worst = max(fingers, key=lambda finger: finger.distance - finger.reach)
    others = [finger.name for finger in fingers if finger is not worst]
    lack, loose = mm(worst.distance - worst.reach), bool(model.bodies.free[worst.nearest])
    return look(
        "no-effect", f"$.bodies[{worst.body}]", worst.name,
        f"reaches {mm(worst.reach)} from its first hinge, and the nearest object that it "
        f"may touch, {model.bodies.name[worst.nearest]!r}, is {mm(worst.distance)} from it"
        + (" and comes no nearer as it falls" if loose else "")
        + (f" (and so for {len(others)} more, which lack less or as much: {listed(others)})"
           if others else ""),
        f"move either by {lack} or more, or make it longer"
        + ("; what else may push it there is not looked at" if loose else ""))


def _only_fall(model: Model, objects: Integers) -> bool:
    """Whether nothing but gravity and contacts moves the objects that do not stay."""
    bodies = model.mechanism.bodies
    tied = np.concatenate([model.joints.bodies.ravel(), model.springs.bodies.ravel(),
                           model.tendons.guide_body])
    return not (np.isin(objects, tied).any() or model.bodies.scheduled[objects].any() or any(
        any(bodies[i].velocity) or bodies[i].angular_velocity for i in objects.tolist()))


def _fingers(model: Model, allowed: Flags, objects: Integers) -> Iterator[_Reaching]:
    rounds = np.array([_round(model, i) for i in objects.tolist()])
    for name, links in chains(model).items():
        palm = int(model.joints.bodies[links[0].hinge, 0])
        phalanges = np.array([link.body for link in links])
        touched = allowed[np.ix_(phalanges, objects)].any(axis=0)
        if not touched.any():
            continue
        hinge, reach = _hinge_at(model, links[0].hinge), _reach(model, links)
        apart = np.hypot(*(rounds[touched, :2] - hinge).T) - rounds[touched, 2]
        order = np.argsort(apart)
        distance, nearest = min(
            (_on_its_way(model, body, circle, hinge), body) for body, circle in zip(
                objects[touched][order[:MOST_LOOKED]].tolist(),
                rounds[touched][order[:MOST_LOOKED]], strict=True))
        others = order[MOST_LOOKED:]  # none of them is nearer than the circle about it, if it stays
        certain = bool(model.bodies.fixed[objects[touched][others]].all()
                       and distance <= apart[others].min(initial=math.inf))
        yield _Reaching(name, links[0].body, bool(model.bodies.fixed[palm]) and certain, reach,
                      nearest, distance)


def _on_its_way(model: Model, body: int, circle: Array, hinge: Array) -> float:
    """From a hinge to an object [m]; of one that falls towards it that of its circle, at least."""
    distance, gravity = _distance(model, body, hinge), np.array(model.mechanism.gravity)
    ahead = float((hinge - circle[:2]) @ gravity)
    if not model.bodies.free[body] or ahead <= 0:
        return distance
    across = (hinge - circle[:2]) - ahead * gravity / float(gravity @ gravity)
    return min(distance, max(float(np.hypot(*across)) - float(circle[2]), 0.0))


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
