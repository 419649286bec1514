"""Helpers of all checks: messages, formatted numbers, tolerances, connected bodies."""

from __future__ import annotations

import math

import numpy as np

from sandbox.errors import Problem
from sandbox.model.model import Model
from sandbox.numeric import Flags, Integers, connected_components

NEGLIGIBLE = 1e-5
"""Gaps and overlaps up to this [m] are accepted: scenes may be written in hundredths of a mm."""
STRAIGHT = 1e-9  # two points nearer than this coincide [m]


def error(code: str, path: str, element: str, message: str, advice: str) -> Problem:
    """An error: the scene cannot be simulated."""
    return Problem(code, message, path, element=element, advice=advice)


def look(code: str, path: str, element: str, message: str, advice: str = "") -> Problem:
    """A warning: the scene can be simulated, but probably not as intended."""
    return Problem(code, message, path, element=element, advice=advice, severity="warning")


def mm(length: float) -> str:
    """A length [m] in millimetres."""
    return f"{length * 1e3:.4g} mm"


def fitting(length: float) -> str:
    """A length [m] in millimetres with enough digits to be copied into a scene."""
    return f"{length * 1e3:.8g} mm"


def deg(angle: float) -> str:
    """An angle [rad] in degrees."""
    return f"{math.degrees(angle):.4g} deg"


def groups(
    model: Model, *, springs: bool = False, contacts: Flags | None = None,
) -> list[Integers]:
    """Groups of free bodies that joints, tendons, and optionally springs and contacts connect."""
    tendons, free = model.tendons, np.flatnonzero(model.bodies.free)
    found = np.zeros((len(model.bodies.name),) * 2, dtype=bool)
    for pairs in (model.joints.bodies, *([model.springs.bodies] if springs else [])):
        found[pairs[:, 0], pairs[:, 1]] = found[pairs[:, 1], pairs[:, 0]] = True
    for tendon in range(len(tendons.name)):
        guides = tendons.guide_body[tendons.guides(tendon)]
        found[np.ix_(guides, guides)] = True
    if contacts is not None:
        shaped = np.array([bool(body.shapes) for body in model.mechanism.bodies])
        found |= contacts & shaped & shaped[:, None]
    return [free[group] for group in connected_components(found[np.ix_(free, free)])]
