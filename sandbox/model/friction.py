"""Friction and restitution of a pair of bodies, from materials and contact rules."""

from __future__ import annotations

import math
from fnmatch import fnmatchcase

from sandbox.scene.elements.bodies import Material
from sandbox.scene.mechanism import Mechanism


def friction_of(mechanism: Mechanism, one: int, two: int) -> float:
    """Coefficient of friction of two bodies: of the last rule that names it, else of materials."""
    bodies = mechanism.bodies
    names = bodies[one].name, bodies[two].name
    for rule in reversed(mechanism.contacts):
        if rule.friction is not None and any(
            fnmatchcase(p, rule.between[0]) and fnmatchcase(q, rule.between[1])
            for p, q in (names, names[::-1])
        ):
            return rule.friction
    found = [mechanism.materials.get(bodies[i].material or "", Material()).friction
             for i in (one, two)]
    return math.sqrt(found[0]) * math.sqrt(found[1])


def restitution_of(mechanism: Mechanism, one: int, two: int) -> float:
    """Rebound speed over approach speed of two bodies."""
    found = [mechanism.materials.get(mechanism.bodies[i].material or "", Material()).restitution
             for i in (one, two)]
    return math.sqrt(found[0]) * math.sqrt(found[1])
