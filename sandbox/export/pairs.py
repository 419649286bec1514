"""Which bodies may touch, pair by pair, and with what friction."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase

from sandbox.scene.elements.bodies import Body, Material
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.values.planes import share


@dataclass(frozen=True)
class Pair:
    """Two bodies with shapes that may touch."""

    a: Body
    b: Body
    friction: float


def material_of(mechanism: Mechanism, body: Body) -> Material:
    """A body's surface; the default one if it names none."""
    return mechanism.materials.get(body.material or "", Material())


def touching_pairs(mechanism: Mechanism) -> Iterator[Pair]:
    """Every pair of bodies that may touch, in the order of the mechanism.

    Contact rules count in their order, the last one wins; bodies that share no
    plane pass each other; a joint keeps its two bodies apart unless it says
    ``collide``; of two bodies that do not move freely neither can be pushed.
    Friction is a rule's, else the geometric mean of the two materials.
    """
    solid = [body for body in mechanism.bodies if body.shapes]
    jointed = {frozenset((joint.a, joint.b)) for joint in mechanism.joints if not joint.collide}
    rules = [
        ({body.name for body in solid if fnmatchcase(body.name, rule.between[0])},
         {body.name for body in solid if fnmatchcase(body.name, rule.between[1])}, rule)
        for rule in mechanism.contacts
    ]
    for i, a in enumerate(solid):
        for b in solid[i + 1:]:
            if a.motion != "dynamic" and b.motion != "dynamic":
                continue
            if not share(a.plane, b.plane):
                continue
            if frozenset((a.name, b.name)) in jointed:
                continue
            collide, friction = True, math.sqrt(
                material_of(mechanism, a).friction * material_of(mechanism, b).friction)
            for first, second, rule in rules:
                if ((a.name in first and b.name in second)
                        or (b.name in first and a.name in second)):
                    collide = rule.collide
                    friction = friction if rule.friction is None else rule.friction
            if collide:
                yield Pair(a, b, friction)
