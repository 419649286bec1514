"""Leaving elements out of a mechanism, with everything that hangs on them."""

from __future__ import annotations

from collections.abc import Sequence
from fnmatch import fnmatchcase

from sandbox.errors import Problem, SceneError
from sandbox.scene.elements.bodies import Body
from sandbox.scene.elements.drives import (
    BrakeDrive,
    Drive,
    ForceDrive,
    MotorDrive,
    PullDrive,
    RadiusDrive,
    StiffnessDrive,
    TorqueDrive,
)
from sandbox.scene.elements.joints import Joint
from sandbox.scene.elements.springs import LinearSpring, Spring
from sandbox.scene.elements.tendons import Tendon
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import listed, near, quoted

Element = Body | Joint | Spring | Tendon | Drive
MATERIAL = "materials."
"""Stands before a material's name; without it a material has no restitution."""


def elements(mechanism: Mechanism) -> list[Element]:
    """Everything of a mechanism that has a name of its own and does something."""
    return [*mechanism.bodies, *mechanism.joints, *mechanism.springs, *mechanism.tendons,
            *mechanism.drives]


def needs(element: Element) -> set[str]:
    """Names of the elements without which this one is nothing."""
    match element:
        case Tendon():
            return {guide.body for guide in element.guides}
        case ForceDrive() | RadiusDrive():
            return {element.body}
        case PullDrive():
            return {element.tendon}
        case Body():
            return set()
        case TorqueDrive() | MotorDrive() | BrakeDrive():
            return {element.joint}
        case StiffnessDrive():
            return {element.spring}
        case LinearSpring():
            return {element.a, element.b}
    if element.type == "rotary":
        return {element.joint}
    return {element.a, element.b}


def leave_out(
    mechanism: Mechanism, patterns: Sequence[str],
) -> tuple[Mechanism, tuple[str, ...]]:
    """The mechanism without the elements that ``patterns`` name, and the names of what has gone.

    A joint goes with its bodies, a rotary spring with its hinge, a tendon with
    any body that guides it, a drive with what it drives.

    Raises:
        SceneError: patterns that fit no name.
    """
    present = elements(mechanism)
    names = [element.name for element in present] + [MATERIAL + m for m in mechanism.materials]
    unknown = [word for word in patterns if not any(fnmatchcase(name, word) for name in names)]
    if unknown:
        raise SceneError([
            Problem(f"there is no element {quoted(word)} to leave out", path="--without",
                    allowed=listed(names), hint=near(word, names))
            for word in unknown])
    gone = {name for name in names if any(fnmatchcase(name, word) for word in patterns)}
    for element in present:  # in the order in which one kind can need another
        if needs(element) & gone:
            gone.add(element.name)
    kept = {
        kind: tuple(e for e in getattr(mechanism, kind) if e.name not in gone)
        for kind in ("bodies", "joints", "springs", "tendons", "drives")
    }
    materials = {
        name: material.model_copy(update={"restitution": 0.0})
        if MATERIAL + name in gone else material
        for name, material in mechanism.materials.items()
    }
    left = mechanism.model_copy(update={**kept, "materials": materials})
    return left, tuple(name for name in names if name in gone)
