"""A mechanism as calls that build a plain pymunk scene.

Each element says by ``write_pymunk`` which calls it becomes, or by ``without_pymunk`` why there are
none. :func:`to_pymunk` makes the calls; ``sandbox export --to pymunk`` prints them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.elements.element import RELEASED
from sandbox.engine import pymunk_scene
from sandbox.engine.inspect_control import Runnable, checked
from sandbox.engine.pymunk_scene import Scene
from sandbox.engine.world import Filters, make_filters
from sandbox.errors import Problem, SceneError
from sandbox.model.compile import compile_mechanism
from sandbox.model.model import Model
from sandbox.scene.bodies import Body, Box, Capsule, Circle, Material, Polygon
from sandbox.scene.geometry import corners, solids
from sandbox.scene.mechanism import Mechanism
from sandbox.values.expressions import parse_expression
from sandbox.values.signals import AnySignal, Constant, Ramp, Table

DIGITS = 12  # significant digits of numbers in a script; the calls have no more
LISTS = ("joints", "springs", "tendons", "lines", "valves", "loads", "drives", "controllers")
"""Lists of elements in the order of their calls."""


@dataclass(frozen=True)
class Call:
    """A call of a method of :class:`Scene`, or of a function that makes an argument of one."""

    name: str
    arguments: tuple[Any, ...]
    settings: Mapping[str, Any]


@dataclass(frozen=True)
class Formula:
    """A value over time as an expression of ``t``."""

    text: str

    def __call__(self, t: float) -> float:
        """The value at the time ``t`` [s]."""
        return float(parse_expression(self.text).evaluate({"t": t}))


class PymunkDraft:
    """The calls of a mechanism, in order.

    Raises:
        SceneError: elements without a counterpart in pymunk.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism, self.model = mechanism, compile_mechanism(mechanism)
        self.calls: list[Call] = []
        filters = make_filters(self.model)
        problems = [Problem(
            "no-counterpart", f"pymunk has no counterpart of {what}", path=name, allowed="the "
            "solver 'direct', or a scene without it (--without NAME of 'sandbox export')")
            for name, what in _without_counterpart(self.model, filters)]
        if problems:
            raise SceneError(problems)
        for index, body in enumerate(mechanism.bodies):
            self._add_body(index, body, filters)
        # pairs of bodies whose friction is not the product of that of their shapes
        own = np.sqrt([mechanism.materials.get(body.material or "", Material()).friction
                       for body in mechanism.bodies])
        solid = np.array([bool(body.shapes) for body in mechanism.bodies], dtype=bool)
        other = np.abs(filters.friction - own * own[:, None]) > 1e-12
        for a, b in np.argwhere(np.triu(other & filters.allowed & solid & solid[:, None])):
            self.add("pair_friction", self.model.bodies.name[a], self.model.bodies.name[b],
                     filters.friction[a, b])
        for kind in LISTS:
            for index, element in enumerate(getattr(mechanism, kind)):
                element.write_pymunk(self, index)

    def add(self, method: str, *arguments: Any, **settings: Any) -> None:
        """Add a call of a method of :class:`Scene`."""
        self.calls.append(Call(method, _rounded(arguments), {
            key: _rounded(value) for key, value in settings.items()}))

    def joint(self, index: int, kind: str, *arguments: Any, **settings: Any) -> None:
        """Add the main constraint of a joint."""
        spec = self.mechanism.joints[index]
        if not spec.collide:
            settings["collide_bodies"] = False
        self.add("constraint", spec.name, kind, spec.a, spec.b, *arguments, **settings)

    def anchors(self, joint: int) -> list[tuple[float, float]]:
        """Both points of a joint in the frames of its bodies [m]."""
        return [(float(x), float(y)) for x, y in self.model.joints.anchor[joint]]

    def hold_angle(self, joint: int) -> None:
        """Keep the angle between the bodies of a joint as it is at t = 0."""
        spec, (a, b) = self.mechanism.joints[joint], self.model.joints.bodies[joint]
        self.add("constraint", f"{spec.name}.angle", "GearJoint", spec.a, spec.b,
                 float(self.model.bodies.pose[b, 2] - self.model.bodies.pose[a, 2]), 1.0)

    def value(self, drive: int) -> Any:
        """The value of a drive over time, as an argument."""
        return _value(self.mechanism.drives[drive].signal(self.mechanism))

    def target(self, drive: int) -> tuple[int, Any]:
        """Number and element of the joint that a drive acts on."""
        number = int(self.model.drives.target[drive])
        return number, self.mechanism.joints[number]

    def first_solid(self, body: str, shape: int) -> int:
        """Number of the first convex shape of a shape of a body."""
        shapes = self.mechanism.bodies[self.model.names.body[body]].shapes[:shape]
        return sum(len(solids(each)) for each in shapes)

    def _add_body(self, index: int, body: Body, filters: Filters) -> None:
        bodies = self.model.bodies
        material = self.mechanism.materials.get(body.material or "", Material())
        shapes: list[tuple[Any, ...]] = []
        for solid in (solid for shape in body.shapes for solid, _ in solids(shape)):
            match solid:
                case Circle():
                    shapes.append(("Circle", solid.radius, solid.at))
                case Capsule():
                    shapes.append(("Segment", solid.start, solid.end, solid.radius))
                case Box() | Polygon():
                    shapes.append(("Poly", tuple(corners(solid))))
        settings: dict[str, Any] = {"moves": bool(bodies.scheduled[index])}
        if bodies.free[index]:
            settings = {"mass": bodies.mass[index], "moment": bodies.inertia[index],
                        "centre": tuple(bodies.centre[index]), "velocity": body.velocity,
                        "spin": body.angular_velocity}
        if shapes:
            settings |= {"friction": material.friction**0.5,
                         "elasticity": material.restitution**0.5,
                         "collides": tuple(int(each[index]) & 0xFFFFFFFF for each in (
                             filters.group, filters.category, filters.mask))}
        self.add("body", body.name, body.at, body.angle, *shapes, **{
            key: value for key, value in settings.items() if np.any(value)})
        if body.path is not None:
            self.add("move", body.name, **{
                key: _value(signal) for key in ("x", "y", "angle")
                if (signal := getattr(body.path, key)) is not None})


def to_pymunk(scene: Runnable) -> Scene:
    """A scene in plain pymunk: a space with named bodies, shapes and constraints, and ``step()``.

    Args:
        scene: what :func:`sandbox.simulate` takes.

    Raises:
        SceneError: a scene that cannot be loaded; elements without a counterpart in pymunk.
    """
    mechanism = checked(scene, ())
    return build(mechanism, PymunkDraft(mechanism))


def build(mechanism: Mechanism, draft: PymunkDraft) -> Scene:
    """The scene that the calls of a draft make."""
    def made(value: Any) -> Any:
        return getattr(pymunk_scene, value.name)(*value.arguments, **value.settings) \
            if isinstance(value, Call) else value

    scene = Scene(*scene_arguments(mechanism))
    for call in draft.calls:
        getattr(scene, call.name)(*map(made, call.arguments), **{
            key: made(value) for key, value in call.settings.items()})
    return scene


def scene_arguments(mechanism: Mechanism) -> tuple[Any, ...]:
    """The arguments of :class:`Scene`."""
    gravity = (mechanism.gravity,) if any(mechanism.gravity) else ()
    return time_step(mechanism), mechanism.run.pymunk.iterations, *gravity


def time_step(mechanism: Mechanism) -> float:
    """Time step of pymunk [s]."""
    return mechanism.run.step / mechanism.run.pymunk.substeps


def _rounded(value: Any) -> Any:
    """An argument as plain Python numbers of :data:`DIGITS` digits, also in tuples."""
    if isinstance(value, tuple | list):
        return tuple(map(_rounded, value))
    if isinstance(value, float):
        return float(f"{value + 0.0:.{DIGITS}g}")
    return value


def _value(signal: AnySignal) -> Any:
    match signal:
        case Constant():
            return signal.constant
        case Ramp():
            return Call("ramp", _rounded(
                (signal.start, signal.over, signal.start_value, signal.to)), {})
        case Table():
            return Call("table", _rounded(zip(*signal.table, strict=True)), {
                "linear": False} if signal.between == "step" else {})
    return Formula(signal.expression)


def _without_counterpart(model: Model, filters: Filters) -> Iterator[tuple[str, str]]:
    mechanism = model.mechanism
    for kind in LISTS:
        for element in getattr(mechanism, kind):
            if what := element.without_pymunk(mechanism):
                yield getattr(element, "name", kind), what
    yield from ((event.name, "an event") for event in mechanism.events)
    yield from ((name, RELEASED) for name in model.bonds.name)
    pairs = {f"contacts.{'/'.join(rule.between)}": rule.static for rule in mechanism.contacts}
    own = {f"materials.{name}": material for name, material in mechanism.materials.items()}
    for name, static in [*((name, each.static) for name, each in own.items()), *pairs.items()]:
        if (static or 1) > 1:
            yield name, "static friction above that of sliding"
    yield from ((name, "soft skin") for name, material in own.items() if material.skin)
    if not filters.exact:
        yield "contacts", "contact rules with more than 32 kinds of bodies"
