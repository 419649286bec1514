"""What MuJoCo has no counterpart for, element by element."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.errors import Problem
from sandbox.export.omission import MATERIAL, rule_name
from sandbox.export.pairs import material_of, touching_pairs
from sandbox.export.tree import Tree, pose, vec
from sandbox.export.wheels import wrap_round
from sandbox.kinds.elements import FLUID, LAW, LOOSE
from sandbox.model.lifts import lifted_at_start
from sandbox.model.model import Joints, Model, Springs
from sandbox.scene.elements.bodies import Polyline
from sandbox.scene.geometry import to_world
from sandbox.scene.mechanism import Mechanism, signal_of
from sandbox.scene.values.signals import Constant

STATIC = "static friction above that of sliding"


def without_counterpart(model: Model, tree: Tree) -> list[Problem]:
    """A problem for each element that a MuJoCo model cannot hold."""
    return [
        Problem("no-counterpart",
                f"MuJoCo has no counterpart of {what}; --without {name} leaves it out", path=name)
        for name, what in [*_elements(model, tree), *_surfaces(model.mechanism)] if what
    ]


def _elements(model: Model, tree: Tree) -> Iterator[tuple[str, str]]:
    """Names and what has no counterpart; nothing where there is one."""
    for body in np.flatnonzero(~model.bodies.free & ~model.bodies.fixed):
        yield model.bodies.name[body], "a body that moves on a schedule"
    for spec in model.mechanism.bodies:
        if any(isinstance(shape, Polyline) and not shape.radius for shape in spec.shapes):
            yield spec.name, "a polyline without a radius"
    for joint, (name, joints) in enumerate(zip(model.joints.name, model.joints.kind, strict=True)):
        yield name, (joints.mujoco or (joints.mujoco_loop if joint in tree.loops else "")
                     or _friction(model.joints, joint))
    for spring, name in enumerate(model.springs.name):
        yield name, model.springs.kind[spring].mujoco or _law(model.springs, spring)
    for tendon, name in enumerate(model.tendons.name):
        yield name, _wheel(model, tendon)
    for name in (*model.lines.name, *model.valves.name):
        yield name, FLUID
    for load in model.mechanism.loads:
        yield load.name, LAW
    for name in model.ties.name:
        yield name, LOOSE
    for drive, kind in zip(model.mechanism.drives, model.drives.kind, strict=True):
        varies = not isinstance(signal_of(drive, model.mechanism), Constant)
        rigid = kind.places and getattr(drive, "stiffness", None) is None
        yield drive.name, (kind.mujoco or (kind.mujoco_varied if varies else "")
                           or ("a drive that goes rigidly to a place" if rigid else ""))


def _friction(joints: Joints, joint: int) -> str:
    if joints.rubbing[joint]:
        return "dry friction that hangs on what its joint carries"
    return STATIC if joints.static[joint] > 1 else ""


def _law(springs: Springs, spring: int) -> str:
    law = springs.law[spring]
    if law is None:
        return ""
    if law.own is not None:
        return "a spring whose force is a law of its own"
    if law.damping:
        return "a damper that acts on one side only"
    return "" if springs.straight[spring] else "a spring about a hinge that acts on one side only"


def _wheel(model: Model, tendon: int) -> str:
    if len(model.tendons.gripped(tendon)):
        return "a tendon that guides hold by friction"
    if model.tendons.closed[tendon]:
        return "a tendon that is a loop"
    path = model.tendons.guides(tendon)
    bodies, radii = model.tendons.guide_body[path].tolist(), model.tendons.guide_radius[path]
    if radii[0] or radii[-1]:
        wound = bodies[0] if radii[0] else bodies[-1]
        return f"a tendon wound on a wheel that it turns, here {model.bodies.name[wound]!r}"
    points = [to_world(pose(model, body), vec(at))
              for body, at in zip(bodies, model.tendons.guide_at[path], strict=True)]
    off = lifted_at_start(model)
    for i, radius in enumerate(radii.tolist()):
        if not radius:
            continue
        if model.tendons.guide_turns[path.start + i]:
            return "a tendon that goes whole turns round a wheel"
        if radii[i - 1] or radii[i + 1]:
            return "a tendon that goes from wheel to wheel without an eye between them"
        wrap = wrap_round(points[i - 1], points[i], points[i + 1], radius,
                          past=bool(off[path.start + i]))
        body = model.bodies.name[bodies[i]]
        if wrap is None:
            return f"a tendon with an eye inside its wheel, here {body!r}"
        if wrap.crosses:
            return f"a tendon that crosses itself behind a wheel, here {body!r}"
    return ""


def _surfaces(mechanism: Mechanism) -> Iterator[tuple[str, str]]:
    meeting: set[str] = set()
    bouncing: set[str] = set()
    for pair in touching_pairs(mechanism):
        both = {body.material for body in (pair.a, pair.b) if body.material}
        meeting |= both
        if all(material_of(mechanism, body).restitution for body in (pair.a, pair.b)):
            bouncing |= both
    for name, material in mechanism.materials.items():
        if name in bouncing:
            yield MATERIAL + name, "a coefficient of restitution"
        if name in meeting and material.static > 1:
            yield MATERIAL + name, STATIC
    for rule in mechanism.contacts:
        if (rule.static or 1) > 1:
            yield rule_name(rule), STATIC
