"""Leaving elements out of a mechanism, with everything that hangs on them."""

from __future__ import annotations

from collections.abc import Sequence
from fnmatch import fnmatchcase

from sandbox.errors import Problem, SceneError
from sandbox.kinds.elements import SPRINGS
from sandbox.scene.elements.drives import kind_of
from sandbox.scene.elements.settings import ContactRule
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import listed, near, quoted

ACTING = ("bodies", "joints", "springs", "tendons", "lines", "valves", "loads", "drives")
"""What has a name and does something, in the order in which one can need another."""
MATERIAL = "materials."
"""Stands before a material's name; without it a material has no restitution, and no static friction
above that of sliding."""


def rule_name(rule: ContactRule) -> str:
    """The name of a contact rule; without it its two bodies have no such static friction."""
    return f"contacts.{'/'.join(rule.between)}"


def needs(mechanism: Mechanism) -> dict[str, set[str]]:
    """Of every element, by name and in the order of :data:`ACTING`: those that it needs."""
    found: dict[str, set[str]] = {body.name: set() for body in mechanism.bodies}
    for joint in mechanism.joints:
        found[joint.name] = {joint.a, joint.b}
    for spring in mechanism.springs:
        found[spring.name] = {getattr(spring, target.field)
                              for target in SPRINGS[spring.type].targets}
    for tendon in mechanism.tendons:
        found[tendon.name] = {guide.body for guide in tendon.guides}
    for line in mechanism.lines:
        found[line.name] = {name for chamber in line.chambers
                            for name in (getattr(chamber, field, None)
                                         for field in ("a", "b", "joint")) if name}
    for valve in mechanism.valves:
        found[valve.name] = {line for line in (valve.a, valve.b) if line is not None}
    for load in mechanism.loads:  # one that is left without bodies goes with them
        found[load.name] = set()
    for drive in mechanism.drives:
        found[drive.name] = {getattr(drive, kind_of(drive).target.field)}
    return found


def leave_out(
    mechanism: Mechanism, patterns: Sequence[str],
) -> tuple[Mechanism, tuple[str, ...]]:
    """The mechanism without the elements that ``patterns`` name, and the names of what has gone.

    A joint goes with its bodies, a rotary spring with its hinge, a tendon with
    any body that guides it, a line with any that its chambers move, a drive with what it drives.

    Raises:
        SceneError: patterns that fit no name.
    """
    needed = needs(mechanism)
    names = [*needed, *(MATERIAL + material for material in mechanism.materials),
             *(rule_name(rule) for rule in mechanism.contacts if rule.static)]
    unknown = [word for word in patterns if not any(fnmatchcase(name, word) for name in names)]
    if unknown:
        raise SceneError([
            Problem("name-not-found",
                    f"there is no element {quoted(word)} to leave out", path="--without",
                    allowed=listed(names), hint=near(word, names))
            for word in unknown])
    gone = {name for name in names if any(fnmatchcase(name, word) for word in patterns)}
    for name, others in needed.items():
        if others & gone:
            gone.add(name)
    kept = {kind: tuple(element for element in getattr(mechanism, kind) if element.name not in gone)
            for kind in ACTING}
    materials = {
        name: material.model_copy(update={"restitution": 0.0, "static": 1.0})
        if MATERIAL + name in gone else material
        for name, material in mechanism.materials.items()
    }
    rules = tuple(rule.model_copy(update={"static": 1.0}) if rule_name(rule) in gone else rule
                  for rule in mechanism.contacts)
    left = mechanism.model_copy(update={**kept, "materials": materials, "contacts": rules})
    return left, tuple(name for name in names if name in gone)
