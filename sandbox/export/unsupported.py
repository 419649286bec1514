"""What MuJoCo has no counterpart for, element by element."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.errors import Problem
from sandbox.export.omission import MATERIAL
from sandbox.export.pairs import material_of, touching_pairs
from sandbox.export.tree import Tree
from sandbox.export.wheels import wrap_round
from sandbox.scene.elements.drives import BrakeDrive, MotorDrive, RadiusDrive, StiffnessDrive
from sandbox.scene.elements.joints import Slot
from sandbox.scene.elements.tendons import Tendon
from sandbox.scene.geometry import pose_of, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.values.signals import Constant


def without_counterpart(mechanism: Mechanism, tree: Tree) -> list[Problem]:
    """A problem for each element that a MuJoCo model cannot hold."""
    return [
        Problem(f"MuJoCo has no counterpart of {what}; --without {name} leaves it out", path=name)
        for name, what in [*_elements(mechanism, tree), *_restitution(mechanism)]
    ]


def _elements(mechanism: Mechanism, tree: Tree) -> Iterator[tuple[str, str]]:
    for body in mechanism.bodies:
        if body.motion == "scheduled":
            yield body.name, "a body that moves on a schedule"
    for joint in tree.loops:
        if isinstance(joint, Slot):
            yield joint.name, "a groove that closes a loop"
    for tendon in mechanism.tendons:
        if why := _wheel(mechanism, tendon):
            yield tendon.name, why
    for drive in mechanism.drives:
        if isinstance(drive, RadiusDrive):
            yield drive.name, "a radius that changes"
        elif isinstance(drive, StiffnessDrive):
            yield drive.name, "a stiffness that is set"
        elif isinstance(drive, MotorDrive):
            yield drive.name, "a motor of a set speed"
        elif isinstance(drive, BrakeDrive) and not isinstance(drive.value, Constant):
            yield drive.name, "a brake that changes"


def _wheel(mechanism: Mechanism, tendon: Tendon) -> str:
    guides = tendon.guides
    if guides[0].radius or guides[-1].radius:
        wound = guides[0] if guides[0].radius else guides[-1]
        return f"a tendon wound on a wheel that it turns, here {wound.body!r}"
    bodies = {body.name: body for body in mechanism.bodies}
    points = [to_world(pose_of(bodies[guide.body]), guide.at) for guide in guides]
    for i, guide in enumerate(guides):
        if not guide.radius:
            continue
        if guides[i - 1].radius or guides[i + 1].radius:
            return "a tendon that goes from wheel to wheel without an eye between them"
        wrap = wrap_round(points[i - 1], points[i], points[i + 1], guide)
        if wrap is None:
            return f"a tendon with an eye inside its wheel, here {guide.body!r}"
        if wrap.crosses:
            return f"a tendon that crosses itself behind a wheel, here {guide.body!r}"
    return ""


def _restitution(mechanism: Mechanism) -> Iterator[tuple[str, str]]:
    bouncing: set[str] = set()
    for pair in touching_pairs(mechanism):
        if all(material_of(mechanism, body).restitution for body in (pair.a, pair.b)):
            bouncing |= {body.material for body in (pair.a, pair.b) if body.material}
    for name in mechanism.materials:
        if name in bouncing:
            yield MATERIAL + name, "a coefficient of restitution"
