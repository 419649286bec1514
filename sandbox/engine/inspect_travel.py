"""How far a hand that closes on nothing draws the pivots of its tree.

A pivot goes by the mean of its strings' ways, weighted by the other's arm, equations (4) to (7). A
finger draws its string in by what its tendon's path shortens until its hinges are at their stops.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from sandbox.engine.inspect_hands import Phalanx, chains
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array, Integers
from sandbox.scene.geometry import to_world


class StringEnd(NamedTuple):
    """What draws at a rocker or wheel of a tree: a tendon that ends on it, or a rope."""

    tendon: int
    """By number; none of a rope."""
    source: int
    """The body that it comes from."""
    at: Array
    """Where it ends, in the frame of the rocker or wheel [m]."""
    radius: float
    """Of the wheel that it is wound on, 0 where it ends in an eye [m]."""
    length: float
    """Of its last stretch at t = 0 [m]."""

    @property
    def arm(self) -> float:
        """About the pivot [m]."""
        return self.radius or float(np.hypot(*self.at))


def ways(model: Model, names: tuple[str, ...]) -> dict[str, float]:
    """Of each rocker or wheel of a tree, how far its pivot goes until all fingers are closed [m].

    nan where that is not known: for leaves that are no fingers, and fingers without stops.
    """
    shortenings = _shortenings(model, chains(model))
    strings, found = strings_of(model, names), dict[int, float]()

    def way(node: int) -> float:
        if node not in found:
            found[node] = math.nan  # of what leads back to itself
            if len(strings[node]) == 2:
                a, b = (string.arm for string in strings[node])
                one, two = (way(string.source) if string.source in strings
                            else shortenings.get(string.tendon, math.nan)
                            for string in strings[node])
                found[node] = (b * one + a * two) / (a + b) if a + b else math.nan
        return found[node]

    return {name: way(model.names.body[name]) for name in names}


def _shortenings(model: Model, chains: Mapping[str, list[Phalanx]]) -> dict[int, float]:
    """By tendon, how far a finger draws it in from where it starts to its stops [m].

    Only tendons over eyes of one finger and of what stays, and fingers with stops at every hinge.
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
    """Where the phalanges are once each hinge has turned, counter-clockwise [rad], from t = 0."""
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
    """What ends on the pivots' bodies: tendons, then ropes."""
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
