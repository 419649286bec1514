"""Checks of hands: fingers too short for their objects, travel of differential mechanisms.

A finger reaches as far from its first hinge as the sum of its phalanges.

The pivot of a rocker or pulley moves by the mean of the displacements of its strings, weighted by
the other's arm, equations (4) to (7). A finger draws its string in until its hinges are at their
stops. The ends of a rocker with arms a and b, at a tilt theta from across the pull, are
(a + b) sin(theta) apart along it. So the displacements of its two strings can differ by a + b at
most; beyond, it turns over. Before that the strings slant: the end on the arm a has come in by
a (1 - cos(theta)), which is atan(a (1 - cos(theta)) / l) over a string of length l, and the
torques about the pivot balance with

    T1 a cos(theta + slant1) = T2 b cos(theta - slant2)

where 1 is the string that lags. The longer the strings, the better T1 a = T2 b.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
import pymunk

from sandbox.engine.inspect_words import NEGLIGIBLE, STRAIGHT, look, mm
from sandbox.engine.world import make_shape
from sandbox.errors import Problem
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.geometry import outline, pose_of, reach_of, solids, to_body, to_world
from sandbox.wording import listed

MOST_LOOKED = 100
"""Objects with which a finger's reach is compared; nothing is reported if another may be nearer."""


class Phalanx(NamedTuple):
    """A phalanx and its near hinge."""

    body: int
    hinge: int


def chains(model: Model) -> dict[str, list[Phalanx]]:
    """The phalanges of each finger with their hinges, the proximal one first.

    Fingers that are not a chain of pins are left out.
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
    """Whether its base is fixed and no object that was left out may be nearer."""
    reach: float
    nearest: int
    distance: float
    """Of that object from the first hinge [m]."""

    @property
    def short(self) -> bool:
        """Whether it ends before that object, at all times."""
        return self.certain and self.distance > self.reach + NEGLIGIBLE


def hand_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """Fingers on a fixed palm that are too short for their objects.

    ``allowed`` are the pairs of bodies that may touch, [nb, nb]. Moving objects may come within
    reach. Free objects are reported if no finger reaches any of them, so that they only fall.
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
    """The finger that is farthest from an object, and the names of the others."""
    worst = max(fingers, key=lambda finger: finger.distance - finger.reach)
    others = [finger.name for finger in fingers if finger is not worst]
    lack, loose = mm(worst.distance - worst.reach), bool(model.bodies.free[worst.nearest])
    return look(
        "no-effect", f"$.bodies[{worst.body}]", worst.name,
        f"reaches {mm(worst.reach)} from its first hinge, and the nearest object that it "
        f"may touch, {model.bodies.name[worst.nearest]!r}, is {mm(worst.distance)} from it"
        + (" and does not approach as it falls" if loose else "")
        + (f" (the same for {len(others)} more: {listed(others)})"
           if others else ""),
        f"move either by {lack} or more, or make it longer"
        + ("; other loads on it are ignored" if loose else ""))


def _only_fall(model: Model, objects: Integers) -> bool:
    """Whether only gravity and contacts move the objects that are not fixed."""
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
        others = order[MOST_LOOKED:]  # none is nearer than its circle, if it is fixed
        certain = bool(model.bodies.fixed[objects[touched][others]].all()
                       and distance <= apart[others].min(initial=math.inf))
        yield _Reaching(name, links[0].body, bool(model.bodies.fixed[palm]) and certain, reach,
                      nearest, distance)


def _on_its_way(model: Model, body: int, circle: Array, hinge: Array) -> float:
    """Distance of a hinge from an object [m]; for a falling one the minimum along its path."""
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
    """Bounding circle of a body: centre in the world and radius [m]."""
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


class StringEnd(NamedTuple):
    """A string of a rocker or wheel of a tree: a tendon that ends on it, or a rope."""

    tendon: int
    """Its index; -1 for a rope."""
    source: int
    """The body at its other end."""
    at: Array
    """Its end in the frame of the rocker or wheel [m]."""
    radius: float
    """Radius of the wheel; 0 for an end at a point [m]."""
    length: float
    """Length of its last straight piece at t = 0 [m]."""

    @property
    def arm(self) -> float:
        """Moment arm about the pivot [m]."""
        return self.radius or float(np.hypot(*self.at))


def ways(model: Model, names: tuple[str, ...]) -> dict[str, float]:
    """Displacement of each pivot of a tree until all fingers are closed [m].

    nan where it is unknown: for leaves other than fingers, and fingers without stops.
    """
    shortenings = _shortenings(model, chains(model))
    strings, found = strings_of(model, names), dict[int, float]()

    def way(node: int) -> float:
        if node not in found:
            found[node] = math.nan  # for cycles
            if len(strings[node]) == 2:
                a, b = (string.arm for string in strings[node])
                one, two = (way(string.source) if string.source in strings
                            else shortenings.get(string.tendon, math.nan)
                            for string in strings[node])
                found[node] = (b * one + a * two) / (a + b) if a + b else math.nan
        return found[node]

    return {name: way(model.names.body[name]) for name in names}


def _shortenings(model: Model, chains: Mapping[str, list[Phalanx]]) -> dict[int, float]:
    """Shortening of each tendon while its finger closes from t = 0 to its stops [m].

    Only tendons through points of one finger and of fixed bodies, and fingers with all stops.
    """
    tendons, found = model.tendons, dict[int, float]()
    owner = {link.body: chain for chain in chains.values() for link in chain}
    for tendon in range(len(tendons.name)):
        guides = range(*tendons.guides(tendon).indices(len(tendons.guide_body)))
        held = [owner[body] for g in guides if (body := int(tendons.guide_body[g])) in owner]
        if held and all(chain is held[0] for chain in held):
            way = _shortening(model, held[0], list(guides))
            if way is not None:
                found[tendon] = way
    return found


def _shortening(model: Model, chain: list[Phalanx], guides: list[int]) -> float | None:
    tendons, joints = model.tendons, model.joints
    hinges = [link.hinge for link in chain]
    stops, sense, start = joints.stops[hinges], joints.sense[hinges], joints.start[hinges]
    if not np.isfinite(stops).all():
        return None
    own = {link.body: k for k, link in enumerate(chain)}
    paths = []
    for angles in (start, stops[:, 1], stops[:, 0]):
        poses = _poses(model, chain, sense * (angles - start))
        length = 0.0
        for one, two in itertools.pairwise(guides):
            bodies = [int(tendons.guide_body[g]) for g in (one, two)]
            if not any(body in own for body in bodies):
                continue
            if tendons.guide_radius[[one, two]].any():
                return None
            length += math.dist(*(to_world(poses.get(body, tuple(model.bodies.pose[body])),
                                           tuple(tendons.guide_at[g]))
                                  for body, g in zip(bodies, (one, two), strict=True)))
        paths.append(length)
    return paths[0] - min(paths)


def _poses(
    model: Model, chain: list[Phalanx], turns: Array,
) -> dict[int, tuple[float, float, float]]:
    """Poses of the phalanges after each hinge has turned counter-clockwise [rad] from t = 0."""
    joints, poses = model.joints, dict[int, tuple[float, float, float]]()
    total = 0.0
    for link, turn in zip(chain, turns.tolist(), strict=True):
        before = int(joints.bodies[link.hinge, 0])
        x, y = to_world(poses.get(before, tuple(model.bodies.pose[before])),
                        tuple(joints.anchor[link.hinge, 0]))
        total += turn
        angle = float(model.bodies.pose[link.body, 2]) + total
        ax, ay = joints.anchor[link.hinge, 1]
        poses[link.body] = (x - ax * math.cos(angle) + ay * math.sin(angle),
                            y - ax * math.sin(angle) - ay * math.cos(angle), angle)
    return poses


def strings_of(model: Model, names: tuple[str, ...]) -> dict[int, list[StringEnd]]:
    """The strings that end on each pivot: tendons, then ropes."""
    tendons, joints = model.tendons, model.joints
    found: dict[int, list[StringEnd]] = {model.names.body[name]: [] for name in names}
    for tendon in range(len(tendons.name)):
        guides = range(*tendons.guides(tendon).indices(len(tendons.guide_body)))
        bodies, at = tendons.guide_body[guides], tendons.guide_at[guides]
        if (node := int(bodies[-1])) in found:
            found[node].append(StringEnd(
                tendon, int(bodies[0]), at[-1], abs(float(tendons.guide_radius[guides[-1]])),
                _apart(model, bodies[-2:], at[-2:])))
    for joint in joints.keeping("range"):
        if (node := int(joints.bodies[joint, 1])) in found:
            found[node].append(StringEnd(
                NONE, int(joints.bodies[joint, 0]), joints.anchor[joint, 1], 0.0,
                _apart(model, joints.bodies[joint], joints.anchor[joint])))
    return found


def _apart(model: Model, bodies: Integers, points: Array) -> float:
    """Between points of two bodies at t = 0 [m]."""
    return math.dist(*(to_world(tuple(model.bodies.pose[body]), tuple(point))
                       for body, point in zip(bodies, points, strict=True)))


OFF = 0.01
"""Smallest reported error of a rocker's shares."""


def reaches(model: Model) -> Iterator[str]:
    """A line for every tree of rockers or pulleys: ``tree: …``."""
    for group in model.mechanism.groups:
        if not group.tree:
            continue
        words = [*_rockers(model, group.bodies), *_slots(model, group.bodies)]
        if words:
            yield f"{group.name}: {'; '.join(words)}"


def _rockers(model: Model, names: tuple[str, ...]) -> Iterator[str]:
    differences: dict[str, list[str]] = {}
    strings = strings_of(model, names)
    for name in names:
        ends = [end for end in strings[model.names.body[name]] if not end.radius]
        if len(ends) == 2:
            one, two = ends
            width = float(np.hypot(*(one.at - two.at)))
            differences.setdefault(f"by {mm(_off(one, two))} and {mm(width)}", []).append(name)
    if differences:
        where = ", ".join(f"{way} ({listed(named, most=4)})" for way, named in differences.items())
        yield (f"the shares of a rocker are {100 * OFF:g} % off, and it turns over, where the "
               f"displacements of its strings differ {where}")


def _off(one: StringEnd, two: StringEnd) -> float:
    """Difference of the displacements at which the shares are :data:`OFF` off [m]."""
    a, b = one.arm, two.arm
    k, m = (max(end.length, STRAIGHT) for end in (one, two))
    least, most = 0.0, math.pi / 2
    for _ in range(50):  # halvings: to rounding
        tilt = (least + most) / 2
        if max(_error(tilt, a, b, k, m), _error(tilt, b, a, m, k)) > OFF:
            most = tilt
        else:
            least = tilt
    return (a + b) * math.sin(least)


def _error(tilt: float, a: float, b: float, lags: float, leads: float) -> float:
    """Relative error of T1 / T2 against b / a, where the string of ``a`` lags.

    It is an upper bound: the last piece of a string at a point grows, and it slants less.
    """
    slant1 = math.atan2(a * (1 - math.cos(tilt)), lags)
    slant2 = math.atan2(b * (1 - math.cos(tilt)), leads)
    carries = math.cos(tilt + slant1)
    return math.cos(tilt - slant2) / carries - 1 if carries > 0 else math.inf


def _slots(model: Model, names: tuple[str, ...]) -> Iterator[str]:
    rooms = {name: room for name in names if (room := _room(model, model.names.body[name]))}
    if rooms:
        ahead, behind = (min(way) for way in zip(*rooms.values(), strict=True))
        yield f"its slots end after {mm(ahead)} along the pull and {mm(behind)} against it"
        short = {name: way for name, way in ways(model, names).items()
                 if name in rooms and way > rooms[name][0] + NEGLIGIBLE}
        if short:
            most = max(short, key=lambda name: short[name] - rooms[name][0])
            yield (f"to close the empty hand up to its stops, {most!r} would have to move "
                   f"{mm(short[most])}")


def _room(model: Model, body: int) -> tuple[float, float] | None:
    """Travel of a pivot in its slot from t = 0, forwards and backwards [m]."""
    joints, pose = model.joints, model.bodies.pose
    for joint in joints.keeping("groove"):
        frame, slider = joints.bodies[joint].tolist()
        if slider == body:
            start, end = joints.groove[joint]
            point = to_world(tuple(pose[slider]), tuple(joints.anchor[joint, 1]))
            length = float(np.hypot(*(end - start)))
            gone = float((to_body(tuple(pose[frame]), point) - start) @ (end - start)) / length
            return length - gone, gone
    return None
