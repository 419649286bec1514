"""Friction and restitution of a pair of bodies, from materials and contact rules."""

from __future__ import annotations

import math
from fnmatch import fnmatchcase
from typing import Literal

from sandbox.scene.bodies import Material
from sandbox.scene.mechanism import Mechanism


def friction_of(mechanism: Mechanism, one: int, two: int) -> float:
    """Coefficient of sliding friction of two bodies."""
    return _of_pair(mechanism, one, two, "friction")


def static_friction_of(mechanism: Mechanism, one: int, two: int) -> float:
    """Coefficient of static friction of two bodies."""
    return friction_of(mechanism, one, two) * _of_pair(mechanism, one, two, "static")


def _of_pair(
    mechanism: Mechanism, one: int, two: int, field: Literal["friction", "static"],
) -> float:
    """Of the last rule that names two bodies and the field, else the mean of their materials."""
    bodies = mechanism.bodies
    names = bodies[one].name, bodies[two].name
    for rule in reversed(mechanism.contacts):
        value: float | None = getattr(rule, field)
        if value is not None and any(
            fnmatchcase(p, rule.between[0]) and fnmatchcase(q, rule.between[1])
            for p, q in (names, names[::-1])
        ):
            return value
    found = [getattr(mechanism.materials.get(bodies[i].material or "", Material()), field)
             for i in (one, two)]
    return math.sqrt(found[0]) * math.sqrt(found[1])


def restitution_of(mechanism: Mechanism, one: int, two: int) -> float:
    """Rebound speed over approach speed of two bodies."""
    found = [mechanism.materials.get(mechanism.bodies[i].material or "", Material()).restitution
             for i in (one, two)]
    return math.sqrt(found[0]) * math.sqrt(found[1])
