"""The elements of a mechanism that a MuJoCo model can hold, and those to leave out."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from sandbox.elements.element import RELEASED, references
from sandbox.elements.fluids import FLUID
from sandbox.errors import Problem, SceneError
from sandbox.model.model import Model
from sandbox.model.pairs import allowed_pairs, friction_of
from sandbox.numeric import Array
from sandbox.samples.cables import Frames, Stretches, lifted_at_start, wraps_at_start
from sandbox.scene.bodies import Material, Polyline
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import ContactRule
from sandbox.values.signals import Constant
from sandbox.wording import listed, near, quoted

# lists of elements, in an order in which each needs only those before it
ACTING = ("bodies", "joints", "springs", "tendons", "lines", "valves", "loads", "drives")
MATERIAL = "materials."  # leaving one out removes its restitution, static friction and skin


@dataclass(frozen=True)
class Export:
    """A model in another program's format."""

    text: str
    notes: tuple[str, ...] = ()  # differences from the scene, a sentence each
    left_out: tuple[str, ...] = ()  # names of the elements that the model lacks


def rule_name(rule: ContactRule) -> str:
    """The name of a contact rule. Leaving it out removes its static friction."""
    return f"contacts.{'/'.join(rule.between)}"


def leave_out(mechanism: Mechanism, patterns: Sequence[str]) -> tuple[Mechanism, tuple[str, ...]]:
    """The mechanism without some elements and all that need them, and the names of both."""
    needed = {body.name: set[str]() for body in mechanism.bodies} | {
        element.name: {name for _, _, name in references(element, "")}
        for kind in ACTING[1:] for element in getattr(mechanism, kind)}
    # a load may lose all its bodies, which patterns name
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
        name: material.model_copy(update={"restitution": 0.0, "static": 1.0, "skin": None})
        if MATERIAL + name in gone else material
        for name, material in mechanism.materials.items()
    }
    rules = tuple(rule.model_copy(update={"static": 1.0}) if rule_name(rule) in gone else rule
                  for rule in mechanism.contacts)
    left = mechanism.model_copy(update={**kept, "materials": materials, "contacts": rules})
    return left, tuple(name for name in names if name in gone)


def contact_pairs(model: Model) -> list[tuple[int, int, float]]:
    """The pairs of bodies with shapes that may touch, and their coefficients of friction."""
    solid = np.array([bool(body.shapes) for body in model.mechanism.bodies], dtype=bool)
    allowed = np.triu(allowed_pairs(model) & solid & solid[:, None])
    return [(a, b, friction_of(model.mechanism, a, b)) for a, b in np.argwhere(allowed).tolist()]


STATIC = "static friction above that of sliding"


def without_counterpart(model: Model, loops: Collection[int]) -> list[Problem]:
    """A problem for each element without a counterpart in MuJoCo; ``loops`` are closing joints."""
    return [
        Problem("no-counterpart",
                f"MuJoCo has no counterpart of {what}; --without {name} leaves it out", path=name)
        for name, what in [*_elements(model, loops), *_surfaces(model)] if what
    ]


def _elements(model: Model, loops: Collection[int]) -> Iterator[tuple[str, str]]:
    """Names of elements and what has no counterpart, empty if they have one."""
    for body in np.flatnonzero(model.bodies.scheduled):
        yield model.bodies.name[body], "a body that moves on a schedule"
    for spec in model.mechanism.bodies:
        if any(isinstance(shape, Polyline) and not shape.radius for shape in spec.shapes):
            yield spec.name, "a polyline without a radius"
    for joint, (name, joints) in enumerate(zip(model.joints.name, model.joints.kind, strict=True)):
        curved = "a slot with a path" if model.joints.path[joint] else ""
        yield name, (joints.mujoco or curved or (joints.mujoco_loop if joint in loops else "")
                     or ("joint friction that depends on the reaction"
                         if model.joints.coefficient[joint] else
                         STATIC if model.joints.static[joint] > 1 else ""))
    for name, law, straight in zip(
            model.springs.name, model.springs.law, model.springs.straight, strict=True):
        yield name, "" if law is None else (
            "a spring with a force law" if law.own is not None else
            "a damper that acts on one side only" if law.damping else
            "" if straight else "a spring about a hinge that acts on one side only")
    for tendon, name in enumerate(model.tendons.name):
        yield name, _wheel(model, tendon)
    for name in (*model.lines.name, *model.valves.name):
        yield name, FLUID
    for load in model.mechanism.loads:
        yield load.name, "a load by a law of a body's own motion"
    for name in model.bonds.name:
        yield name, RELEASED
    for drive, kind, stiffness in zip(
            model.mechanism.drives, model.drives.kind, model.drives.stiffness, strict=True):
        varies = not isinstance(drive.signal(model.mechanism), Constant)
        yield drive.name, kind.mujoco or (kind.mujoco_varied if varies else "") or (
            "a rigid servo or length" if kind.places and np.isnan(stiffness) else "")


def _wheel(model: Model, tendon: int) -> str:
    if len(model.tendons.gripped(tendon)):
        return "a tendon with guide friction"
    if model.tendons.closed[tendon]:
        return "a closed tendon (belt)"
    path = model.tendons.guides(tendon)
    bodies, radii = model.tendons.guide_body[path].tolist(), model.tendons.guide_radius[path]
    if radii[0] or radii[-1]:
        wound = bodies[0] if radii[0] else bodies[-1]
        return f"a tendon wound on a wheel that it turns, here {model.bodies.name[wound]!r}"
    if model.tendons.guide_turns[path].any():
        return "a tendon with whole turns around a wheel"
    wheels = [path.start + i for i, radius in enumerate(radii) if radius]
    if any(model.tendons.guide_radius[wheel - 1] or model.tendons.guide_radius[wheel + 1]
           for wheel in wheels):
        return "a tendon from wheel to wheel without a via point between them"
    start = Frames.at_start(model).cables
    for wheel in wheels:
        if arc_of(model, start, wheel)[1]:
            body = model.bodies.name[model.tendons.guide_body[wheel]]
            return f"a tendon with an eye in a wheel or crossing itself behind it, here {body!r}"
    return ""


def arc_of(model: Model, start: Stretches, wheel: int) -> tuple[float, bool]:
    """The middle of an arc between two eyes [rad]; whether an eye is inside, or the parts cross."""
    tendons, (one, two) = model.tendons, (
        int(np.flatnonzero(model.tendons.stretch_first == wheel - k)[0]) for k in (1, 0))
    radius, tendon = float(tendons.guide_radius[wheel]), int(tendons.stretch_tendon[one])
    on = not lifted_at_start(model)[wheel]
    a, centre, d = (np.array([at.x[row, 0], at.y[row, 0]]) for at, row in (
        (start.start, one), (start.end, one), (start.end, two)))
    b, c = (centre + radius * np.array([-start.y[row, 0], start.x[row, 0]]) for row in (one, two))
    angle = wraps_at_start(model, tendon)[wheel - int(tendons.first[tendon])]
    x, y = radius * -start.y[one, 0], radius * start.x[one, 0]

    def side(p: Array, q: Array, r: Array) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    inside = min(np.hypot(*(a - centre)), np.hypot(*(d - centre))) <= abs(radius)
    crosses = side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
    return (float(np.arctan2(y, x) - np.sign(radius) * angle / 2), bool(on and (inside or crosses)))


def _surfaces(model: Model) -> Iterator[tuple[str, str]]:
    mechanism = model.mechanism
    materials = [mechanism.materials.get(body.material or "", Material())
                 for body in mechanism.bodies]
    meeting, bouncing = set[str | None](), set[str | None]()
    for a, b, _ in contact_pairs(model):
        both = {mechanism.bodies[a].material, mechanism.bodies[b].material}
        meeting |= both
        if materials[a].restitution and materials[b].restitution:
            bouncing |= both
    for name, material in mechanism.materials.items():
        if name in bouncing:
            yield MATERIAL + name, "a coefficient of restitution"
        if name in meeting and material.static > 1:
            yield MATERIAL + name, STATIC
        if name in meeting and material.skin:
            yield MATERIAL + name, "soft skin"
    for rule in mechanism.contacts:
        if (rule.static or 1) > 1:
            yield rule_name(rule), STATIC
