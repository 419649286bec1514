"""Elements of an assembly where the assembly is: scaled, then mirrored, then turned, then moved.

Let k be the scale, F the mirror (the identity without one), s = -1 in a mirror and 1 without,
R(g) the turn by the assembly's angle g, and c its position. A point p of the assembly is then at

    G(p) = c + R(g) k F p.

A body whose frame is at p, turned by a, gets G(p) and s a + g. Since F R(a) = R(-a) F for a mirror
through the origin, a point q of the body's own frame becomes k F q: points of a body are scaled and
mirrored, not turned. A hinge in a mirror counts the other turn as positive, so that its angle, its
stops and its drives do not change. A point q on a body of the scene with the pose B becomes
B^-1(G(B(q))).

Numbers change by their dimension: lengths and speeds by k (else links would leave their joints),
inertias by k^2; masses, forces, stiffnesses and times do not. Marks of fields
(:class:`sandbox.elements.element.Placed`) give further changes by a turn or a mirror.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property
from itertools import accumulate
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

import numpy as np

from sandbox.elements.element import Element, Placed
from sandbox.errors import Problem
from sandbox.scene.bodies import Body
from sandbox.scene.geometry import Pose, Vec, pose_of, to_body, to_world
from sandbox.scene.outlines.curves import Node
from sandbox.scene.parts.expansion import Elements, PartError
from sandbox.scene.settings import Group
from sandbox.values.expressions import RESERVED, is_expression
from sandbox.values.numbers import Dimension, Point
from sandbox.values.signals import AnySignal, Constant, Formula, OverTime, Ramp, Table, values
from sandbox.values.spec import Spec, mark_of
from sandbox.wording import WrongValueError, is_pattern, near, refuse_if

Mirror = Literal["left-right", "up-down"]
OTHER = {"left": "right", "right": "left",
         "clockwise": "counterclockwise", "counterclockwise": "clockwise"}
HOLDERS = {"on_a": "a", "on_b": "b", "start": "a", "end": "a", "at": "body"}
"""For fields of points, the field that names the body in whose frame they are."""
POWERS = {"length": 1, "speed": 1, "inertia": 2}  # of the scale, by dimension
TINY = 1e-15  # a sine or cosine below this is 0: rounding of a quarter turn

PLACED = ("bodies", "joints", "springs", "tendons", "lines", "loads", "drives")
TEXTS = ("because", "unit", "title", "about")  # fields of plain text
_DOTTED = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*(?!\w|\s*\()")
SpecType = TypeVar("SpecType", bound=Spec)


@dataclass
class Mover:
    """Places and renames the elements of an assembly."""

    prefix: str
    inner: Elements
    outside: Callable[[str], Body | None]
    at: Vec = (0.0, 0.0)
    angle: float = 0.0
    mirror: Mirror | None = None
    scale: float = 1.0

    @cached_property
    def own(self) -> dict[str, Body]:
        """Its bodies by name."""
        return {body.name: body for body in self.inner["bodies"]}

    @cached_property
    def names(self) -> frozenset[str]:
        """Names of all its elements."""
        return frozenset(name for name, _ in self.inner["materials"]).union(
            each.name for kind, elements in self.inner.items()
            if kind not in ("materials", "contacts") for each in elements)

    @property
    def sign(self) -> float:
        """-1 in a mirror, which reverses every turn."""
        return -1.0 if self.mirror else 1.0

    def linear(self) -> tuple[Vec, Vec]:
        """R(g) F, by rows."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        c, s = (0.0 if abs(c) < TINY else c), (0.0 if abs(s) < TINY else s)
        fx, fy = self.flip((1.0, 1.0))
        return (c * fx, -s * fy), (s * fx, c * fy)

    def flip(self, vector: Vec) -> Vec:
        """F of a vector."""
        x, y = vector
        return (0.0 - x if self.mirror == "left-right" else x,
                0.0 - y if self.mirror == "up-down" else y)

    def vector(self, vector: Vec) -> Vec:
        """R(g) F of a vector, not scaled."""
        (a, b), (c, d) = self.linear()
        return a * vector[0] + b * vector[1], c * vector[0] + d * vector[1]

    def point(self, point: Vec) -> Vec:
        """G of a point."""
        x, y = self.vector(point)
        return self.at[0] + self.scale * x, self.at[1] + self.scale * y

    def within(self, point: Vec) -> Vec:
        """K F of a point of a body's frame."""
        x, y = self.flip(point)
        return self.scale * x, self.scale * y

    def on(self, pose: Pose, point: Vec) -> Vec:
        """A point of a body that stays where it is."""
        return to_body(pose, self.point(to_world(pose, point)))

    def element(self, element: Spec, path: str) -> Spec:
        """An element of the assembly at a path of it."""
        moved, changed = self.spec(element, path), {}
        if isinstance(element, Element):
            changed = dict(element.placed(self))
        elif isinstance(element, Body) and element.path:
            try:
                changed = {"path": self._path(element)}
            except WrongValueError as error:
                raise PartError([Problem.of(error, f"{path}.path")]) from None
        return moved.model_copy(update=changed) if changed else moved

    def spec(self, spec: SpecType, path: str = "") -> SpecType:
        """Any record, field by field."""
        changed: dict[str, Any] = {}
        for name, field in type(spec).model_fields.items():
            value, mark = getattr(spec, name), mark_of(field.metadata, Placed)
            holder = getattr(spec, HOLDERS.get(name, ""), None)
            if value is None or name in TEXTS or name in spec.LOCAL or (
                    mark is not None and mark.how == "kept"):
                continue
            new: Any
            if name == "name":
                new = f"{self.prefix}.{value}"
            elif mark is not None:
                new = self._marked(mark.how, value)
            elif isinstance(holder, str) and holder not in self.own:
                body = self.outer_body(holder, f"{path}.{HOLDERS[name]}")
                new = self.on(pose_of(body), value)
            else:
                new = self._value(value, field.annotation, tuple(field.metadata),
                                  f"{path}.{field.alias or name}")
            if new is not value:
                changed[name] = new
        return spec.model_copy(update=changed) if changed else spec

    def _name(self, name: str) -> str:
        """A name in the scene: it, or its first part up to a dot, may be the assembly's."""
        own = any(begin in self.names for begin in accumulate(name.split("."), "{}.{}".format))
        return f"{self.prefix}.{name}" if own else name

    def _text(self, text: str) -> str:
        """A field's text: a name, a pattern of names, a pair, a quantity, an expression."""
        if is_expression(text):
            return _DOTTED.sub(lambda match: match.group() if match.group() in RESERVED else
                               self._name(match.group()), text)
        if "/" in text:
            return "/".join(self._text(side) for side in text.split("/"))
        if is_pattern(text):
            fits = any(fnmatchcase(name, text) or fnmatchcase(f"{name}.x", text)
                       for name in self.names)
            return f"{self.prefix}.{text}" if fits else text
        return self._name(text)

    def outer_body(self, name: str, path: str) -> Body:
        """A body outside of the assembly."""
        body = self.outside(name)
        if body is None:
            raise PartError([Problem("name-not-found", "no body of this assembly or before it is "
                                     f"named {name!r}", path=path, hint=near(name, self.own))])
        return body

    def _marked(self, how: str, value: Any) -> Any:
        def node(node: Node) -> Node:
            x, y, direction, bend = node
            if self.mirror:
                direction = (math.pi if self.mirror == "left-right" else 0.0) - direction
            return *self.within((x, y)), direction, self.sign * bend / self.scale

        if how == "place":
            return self.point(value)
        if how == "turn":
            return self.sign * value + self.angle
        if how == "sign":
            return self.sign * value if value else value
        if how == "vector":
            x, y = self.vector(value)
            return self.scale * x, self.scale * y
        if how == "nodes":
            return tuple(tuple(map(node, curve)) for curve in value)
        return OTHER[value] if self.mirror else value

    def _value(self, value: Any, annotation: Any, metadata: tuple[Any, ...], path: str) -> Any:
        if value is None:
            return None
        if (signal := mark_of(metadata, OverTime)) is not None:
            return scaled(value, self.scale ** POWERS.get(signal.dimension or "", 0))
        if get_origin(annotation) is Annotated:
            inner, *more = get_args(annotation)
            return self._value(value, inner, (*more, *metadata), path)
        if isinstance(value, Spec):
            return self.spec(value, path)
        kinds = [each for each in get_args(annotation) if each is not NoneType]
        if get_origin(annotation) in (Union, UnionType):
            if len(kinds) == 1:
                return self._value(value, kinds[0], metadata, path)
            if any(get_origin(kind) is Literal for kind in kinds):
                return value
            annotation, kinds = None, [None, ...]
        if annotation == Point:
            return self.within(value)
        if isinstance(value, str):
            return value if get_origin(annotation) is Literal else self._text(value)
        if isinstance(value, dict):
            return {self._text(key): each for key, each in value.items()}
        if isinstance(value, tuple) and kinds:
            kinds = [kinds[0]] * len(value) if kinds[-1] is Ellipsis else kinds
            return tuple(self._value(entry, kind, (), f"{path}[{i}]")
                         for i, (entry, kind) in enumerate(zip(value, kinds, strict=True)))
        number = mark_of(metadata, Dimension)
        power = POWERS.get(number.name or "", 0) if number is not None else 0
        return value * self.scale**power if power else value

    def direction(self, body: str, direction: Vec) -> Vec:
        """A direction in a body's frame, placed."""
        if body in self.own:
            return self.flip(direction)
        turn = (0.0, 0.0, self.outer_body(body, "").angle)
        return to_body(turn, self.vector(to_world(turn, direction)))

    def _path(self, body: Body) -> Any:
        path = body.path
        assert path is not None
        (a, b), (c, d) = ((self.scale * x, self.scale * y) for x, y in self.linear())
        x = path.x or Constant(constant=body.at[0])
        y = path.y or Constant(constant=body.at[1])

        def along(p: float, q: float, offset: float) -> AnySignal:
            return scaled(added(scaled(x, p), scaled(y, q)) if p and q else
                          scaled(x, p) if p else scaled(y, q), 1.0, offset)

        moves = path.x is not None or path.y is not None
        return path.model_copy(update={
            "x": along(a, b, self.at[0]) if moves else None,
            "y": along(c, d, self.at[1]) if moves else None,
            "angle": scaled(path.angle, self.sign, self.angle) if path.angle else None})


def placed(mover: Mover) -> Elements:
    """The elements of an assembly, placed and under their names outside."""
    name, inner, problems = mover.prefix, mover.inner, list[Problem]()
    resizer = Mover(name, inner, mover.outside, scale=mover.scale)
    found: dict[str, Any] = {"materials": tuple(
        (f"{name}.{key}", each) for key, each in inner["materials"])}
    for kind in (kind for kind in inner if kind != "materials"):
        moved = []
        for i, element in enumerate(inner[kind]):
            try:
                moved.append((mover if kind in PLACED else resizer).element(
                    element, f".{kind}[{i}]"))
            except PartError as error:
                problems += error.problems
        found[kind] = tuple(moved)
    if problems:
        raise PartError(problems)
    return Elements(inner.paths, **found) + Elements(
        groups=(Group(name=name, bodies=tuple(body.name for body in found["bodies"])),))


def scaled(signal: AnySignal, factor: float, offset: float = 0.0) -> AnySignal:
    """The signal ``factor`` s(t) + ``offset``."""
    if factor == 1.0 and offset == 0.0:
        return signal
    if isinstance(signal, Constant):
        return Constant(constant=factor * signal.constant + offset)
    if isinstance(signal, Ramp):
        return signal.model_copy(update={"start_value": factor * signal.start_value + offset,
                                         "to": factor * signal.to + offset})
    if isinstance(signal, Table):
        return signal.model_copy(update={
            "table": tuple((t, factor * value + offset) for t, value in signal.table)})
    return Formula(expression=f"={factor!r} * ({_text(signal)}) + {offset!r}")


def added(one: AnySignal, other: AnySignal) -> AnySignal:
    """The sum of two signals."""
    if isinstance(one, Constant):
        return scaled(other, 1.0, one.constant)
    if isinstance(other, Constant):
        return scaled(one, 1.0, other.constant)
    if isinstance(one, Table) and isinstance(other, Table) and one.between == other.between:
        # at the times of both: between two of them both are linear, or both constant
        times = np.array(sorted({t for t, _ in (*one.table, *other.table)}))
        total = values(one, times) + values(other, times)
        return one.model_copy(update={"table": tuple(zip(
            times.tolist(), total.tolist(), strict=True))})
    refuse_if(isinstance(one, Table) or isinstance(other, Table), "a path with a table for one of "
              "x and y and something else for the other cannot be turned", "bad-part",
              allowed="tables for both, expressions for both, or a quarter turn")
    return Formula(expression=f"={_text(one)} + {_text(other)}")


def _text(signal: AnySignal) -> str:
    """A ramp or a formula as an expression of ``t``."""
    if isinstance(signal, Formula):
        return f"({signal.expression.removeprefix('=')})"
    assert isinstance(signal, Ramp)  # constants and tables do not come here
    start, rise = signal.start_value, signal.to - signal.start_value
    done = (f"clip((t - {signal.start!r}) / {signal.over!r}, 0, 1)" if signal.over
            else f"(t >= {signal.start!r})")
    return f"({start!r} + {rise!r} * {done})"
