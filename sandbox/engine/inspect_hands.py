"""Checks of hands: fingers too short for their objects, travel of differential mechanisms.

The reach of a finger from its first hinge is the sum of its phalanges.

The pivot of a rocker or pulley moves by the mean of the displacements of its strings, weighted by
the other's arm, equations (4) to (7). A finger draws its string in until its hinges are at their
stops. The ends of a rocker with arms a and b, tilted by theta from across the pull, are
(a + b) sin(theta) apart along it; beyond a + b it turns over. Before that the strings slant, over a
length l by atan(a (1 - cos(theta)) / l), and the torques about the pivot balance with

    T1 a cos(theta + slant1) = T2 b cos(theta - slant2)

where 1 is the string that lags. The longer the strings, the better T1 a = T2 b.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sandbox.engine.inspect_elements import NEGLIGIBLE, STRAIGHT, look, mm, placed_shapes
from sandbox.errors import Problem
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array, Flags
from sandbox.scene.geometry import Pose, pose_of, reach_of, to_body, to_world
from sandbox.wording import listed

Chain = dict[int, int]  # the phalanges of a finger with their near hinges, the proximal one first


def chains(model: Model) -> dict[str, Chain]:
    """The fingers that are chains of pins, by name."""
    joints, found = model.joints, dict[str, Chain]()
    pins = {int(joints.bodies[j, 1]): int(j) for j in joints.hinges}
    for group in model.mechanism.groups:
        bodies = [model.names.body[name] for name in group.bodies]
        if group.kind == "finger" and bodies and all(body in pins for body in bodies) and all(
                joints.bodies[pins[after], 0] == body
                for body, after in itertools.pairwise(bodies)):
            found[group.name] = {body: pins[body] for body in bodies}
    return found


def hand_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """Fingers on a fixed palm too short for all objects, if these do not move by themselves."""
    bodies, joints, fixed = model.mechanism.bodies, model.joints, model.bodies.fixed.tolist()
    objects = [i for i, body in enumerate(bodies) if body.role == "object" and body.shapes]
    tied = {*joints.bodies.ravel().tolist(), *model.springs.bodies.ravel().tolist(),
            *model.tendons.guide_body.tolist()}
    if not objects or not all(fixed[i] or (model.bodies.free[i] and i not in tied and not any(
            (*model.mechanism.gravity, *bodies[i].velocity, bodies[i].angular_velocity)))
            for i in objects):
        return
    _space, owner = placed_shapes(bodies[i] for i in objects)
    fingers, short = 0, []
    for name, chain in chains(model).items():
        own, hinges = list(chain), list(chain.values())
        may_touch = np.asarray(allowed[np.ix_(own, objects)].any(axis=0)).tolist()
        if not any(may_touch):
            continue
        fingers += 1
        hinge = model.ends(hinges[0])[0]
        reach = sum(math.dist(joints.anchor[one, 1], joints.anchor[after, 0])
                    for one, after in itertools.pairwise(hinges)) + reach_of(
            bodies[own[-1]], tuple(joints.anchor[hinges[-1], 1]))
        distance, nearest = min((max(piece.point_query(hinge).distance, 0.0), objects[k])
                                for piece, k in owner.items() if may_touch[k])
        if fixed[joints.bodies[hinges[0], 0]] and distance - reach > NEGLIGIBLE:
            short.append(look(
                "no-effect", f"$.bodies[{own[0]}]", name, f"reaches {mm(reach)} from its first "
                "hinge, and the nearest object that it may touch, "
                f"{model.bodies.name[nearest]!r}, is {mm(distance)} from it",
                f"move either by {mm(distance - reach)} or more, or make it longer"))
    if len(short) == fingers or all(fixed[i] for i in objects):
        yield from short


class StringEnd(NamedTuple):
    """A string of a rocker or wheel of a tree: a tendon that ends on it, or a rope."""

    tendon: int  # its index; -1 for a rope
    source: int  # the body at its other end
    at: Array  # its end in the frame of the rocker or wheel [m]
    radius: float  # of the wheel; 0 for an end at a point [m]
    length: float  # of its last straight piece at t = 0 [m]

    @property
    def arm(self) -> float:
        """Moment arm about the pivot [m]."""
        return self.radius or float(np.hypot(*self.at))


def ways(model: Model, names: tuple[str, ...]) -> dict[str, float]:
    """Displacement of each pivot of a tree until all fingers are closed [m]; nan if unknown."""
    fingers = list(chains(model).values())
    strings, found = strings_of(model, names), dict[int, float]()

    def way(node: int) -> float:
        if node not in found:
            found[node] = math.nan  # for cycles
            if len(strings[node]) == 2:
                a, b = (string.arm for string in strings[node])
                one, two = (way(string.source) if string.source in strings
                            else _shortening(model, fingers, string.tendon)
                            for string in strings[node])
                found[node] = (b * one + a * two) / (a + b) if a + b else math.nan
        return found[node]

    return {name: way(model.names.body[name]) for name in names}


def _shortening(model: Model, fingers: list[Chain], tendon: int) -> float:
    """Shortening of a tendon while its one finger closes to its stops [m]; nan if unknown."""
    tendons, joints = model.tendons, model.joints
    guides = list(range(len(tendons.guide_body))[tendons.guides(tendon)]) if tendon != NONE else []
    passed = tendons.guide_body[guides].tolist()
    own = [chain for chain in fingers if not chain.keys().isdisjoint(passed)]
    if len(own) != 1:
        return math.nan
    chain, = own
    hinges = list(chain.values())
    stops, sense, start = joints.stops[hinges], joints.sense[hinges], joints.start[hinges]
    pieces = [pair for pair in itertools.pairwise(zip(passed, guides, strict=True))
              if not chain.keys().isdisjoint(body for body, _ in pair)]
    if not np.isfinite(stops).all() or any(
            tendons.guide_radius[guide] for pair in pieces for _, guide in pair):
        return math.nan
    lengths = []
    for angles in (start, stops[:, 1], stops[:, 0]):
        poses = dict[int, Pose]()  # of the phalanges after each hinge has turned
        for (body, hinge), turn in zip(chain.items(), np.cumsum(sense * (angles - start)).tolist(),
                                       strict=True):
            before = int(joints.bodies[hinge, 0])
            x, y = to_world(poses.get(before, tuple(model.bodies.pose[before])),
                            tuple(joints.anchor[hinge, 0]))
            angle = float(model.bodies.pose[body, 2]) + turn
            dx, dy = to_world((0.0, 0.0, angle), tuple(joints.anchor[hinge, 1]))
            poses[body] = x - dx, y - dy, angle
        lengths.append(sum(math.dist(*(to_world(
            poses.get(body, tuple(model.bodies.pose[body])), tuple(tendons.guide_at[guide]))
            for body, guide in pair)) for pair in pieces))
    return lengths[0] - min(lengths)


def strings_of(model: Model, names: tuple[str, ...]) -> dict[int, list[StringEnd]]:
    """The strings that end on each pivot: tendons, then ropes."""
    tendons, joints = model.tendons, model.joints
    found: dict[int, list[StringEnd]] = {model.names.body[name]: [] for name in names}
    ends = [(i, tendons.guide_body[guides], tendons.guide_at[guides][-2:],
             abs(float(tendons.guide_radius[guides][-1])))
            for i, guides in enumerate(map(tendons.guides, range(len(tendons.name))))]
    ends += [(NONE, joints.bodies[i], joints.anchor[i], 0.0) for i in joints.keeping("range")]
    for tendon, passed, at, radius in ends:
        source, before, last = (int(passed[k]) for k in (0, -2, -1))
        if last in found:
            found[last].append(StringEnd(tendon, source, at[1], radius, math.dist(
                *map(model.at_start, (before, last), at))))
    return found


MAX_ERROR = 0.01  # of a rocker's shares, beyond which it is reported


def reaches(model: Model) -> Iterator[str]:
    """A line for every tree of rockers or pulleys: ``tree: …``."""
    for group in model.mechanism.groups:
        words = [*_rockers(model, group.bodies), *_slots(model, group.bodies)] if group.tree else []
        if words:
            yield f"{group.name}: {'; '.join(words)}"


def _rockers(model: Model, names: tuple[str, ...]) -> Iterator[str]:
    differences: dict[str, list[str]] = {}
    for name, strings in zip(names, strings_of(model, names).values(), strict=True):
        ends = [end for end in strings if not end.radius]
        if len(ends) == 2:
            width = float(np.hypot(*(ends[0].at - ends[1].at)))
            differences.setdefault(f"by {mm(_off(*ends))} and {mm(width)}", []).append(name)
    if differences:
        where = ", ".join(f"{way} ({listed(named, most=4)})" for way, named in differences.items())
        yield (f"the shares of a rocker are {100 * MAX_ERROR:g} % off, and it turns over, where "
               f"the displacements of its strings differ {where}")


def _off(one: StringEnd, two: StringEnd) -> float:
    """Difference of the displacements at which the error of the shares is :data:`MAX_ERROR` [m]."""
    from scipy.optimize import bisect

    a, b = one.arm, two.arm
    k, m = (max(end.length, STRAIGHT) for end in (one, two))
    return (a + b) * math.sin(bisect(lambda tilt: max(
        _error(tilt, a, b, k, m), _error(tilt, b, a, m, k)) - MAX_ERROR, 0.0, math.pi / 2))


def _error(tilt: float, a: float, b: float, lags: float, leads: float) -> float:
    """Relative error of T1 / T2 against b / a, where the string of ``a`` lags; an upper bound."""
    slant1 = math.atan2(a * (1 - math.cos(tilt)), lags)
    slant2 = math.atan2(b * (1 - math.cos(tilt)), leads)
    carries = math.cos(tilt + slant1)
    return math.cos(tilt - slant2) / carries - 1 if carries > 0 else math.inf


def _slots(model: Model, names: tuple[str, ...]) -> Iterator[str]:
    """Travel of the pivots in their slots from t = 0, forwards and backwards."""
    joints, rooms = model.joints, dict[str, tuple[float, float]]()
    for joint in joints.keeping("groove").tolist():
        frame, slider = joints.bodies[joint].tolist()
        name = model.bodies.name[slider]
        if name in names and name not in rooms:
            start, end = joints.groove[joint]
            point = to_body(pose_of(model.mechanism.bodies[frame]), model.ends(joint)[1])
            length = float(np.hypot(*(end - start)))
            gone = float((point - start) @ (end - start)) / length
            rooms[name] = length - gone, gone
    if rooms:
        ahead, behind = (min(way) for way in zip(*rooms.values(), strict=True))
        yield f"its slots end after {mm(ahead)} along the pull and {mm(behind)} against it"
        lacks = {name: (way - rooms[name][0], way) for name, way in ways(model, names).items()
                 if name in rooms and way > rooms[name][0] + NEGLIGIBLE}
        if lacks:
            farthest = max(lacks, key=lambda name: lacks[name][0])
            yield (f"to close the empty hand up to its stops, {farthest!r} would have to move "
                   f"{mm(lacks[farthest][1])}")
