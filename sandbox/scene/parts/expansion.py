"""What a part becomes: plain elements by kind, in order."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, TypeVar

from pydantic import BeforeValidator, WithJsonSchema

from sandbox.elements.fluids import Line, Valve
from sandbox.elements.loads import Load
from sandbox.elements.registry import Controller, Drive, Joint
from sandbox.elements.springs import Spring
from sandbox.elements.tendons import Guide, Tendon
from sandbox.errors import Problem
from sandbox.scene.bodies import Body, Material
from sandbox.scene.events import Event
from sandbox.scene.settings import ContactRule, Group, Meter
from sandbox.values.numbers import (
    Angle,
    Coordinate,
    Damping,
    Items,
    Name,
    Point,
    RotaryDamping,
    Stiffness,
)
from sandbox.values.spec import Spec
from sandbox.wording import NearMisses


@dataclass(frozen=True)
class Elements:
    """Plain elements of a mechanism; two sets are added kind by kind."""

    bodies: tuple[Body, ...] = ()
    joints: tuple[Joint, ...] = ()
    springs: tuple[Spring, ...] = ()
    tendons: tuple[Tendon, ...] = ()
    lines: tuple[Line, ...] = ()
    valves: tuple[Valve, ...] = ()
    loads: tuple[Load, ...] = ()
    contacts: tuple[ContactRule, ...] = ()
    groups: tuple[Group, ...] = ()
    drives: tuple[Drive, ...] = ()
    controllers: tuple[Controller, ...] = ()
    events: tuple[Event, ...] = ()
    meters: tuple[Meter, ...] = ()
    materials: tuple[tuple[str, Material], ...] = ()

    def __add__(self, other: Elements) -> Elements:
        return Elements(**{
            kind.name: getattr(self, kind.name) + getattr(other, kind.name)
            for kind in dataclasses.fields(Elements)
        })

    def body(self, name: str) -> Body | None:
        """The body of that name."""
        return next((body for body in self.bodies if body.name == name), None)

    def tendon(self, name: str) -> Tendon | None:
        """The tendon of that name."""
        return next((tendon for tendon in self.tendons if tendon.name == name), None)

    def with_tendon_led_to(self, name: str, *guides: Guide) -> Elements:
        """The same elements with more guides at the end of tendon ``name``."""
        tendons = tuple(
            tendon.model_copy(update={"guides": (*tendon.guides, *guides)})
            if tendon.name == name else tendon
            for tendon in self.tendons
        )
        return dataclasses.replace(self, tendons=tendons)


@dataclass
class PartError(Exception):
    """What is wrong with one part; ``path`` of each problem starts at the part itself."""

    problems: list[Problem]


@dataclass(frozen=True)
class Known:
    """What a part may refer to while it is expanded."""

    elements: Elements
    """All elements so far."""
    tendon_of: Mapping[str, str]
    """The tendon of each finger and tree, by the part's name."""
    failed: frozenset[str] = frozenset()
    """Parts that could not be built; only they are reported, not the parts that depend on them."""
    pulled: frozenset[str] = frozenset()
    """Parts and tendons that trees pull, by their names here."""
    outside: Callable[[str], Body | None] = lambda name: None
    """Finds a body around an assembly, in the frame of its surroundings."""
    near: NearMisses = field(default_factory=NearMisses)


class Leaf(Spec):
    """What a tree pulls: a finger, a tendon (at its last guide), or a point of a body."""

    name: Name
    """Name of a finger, a tendon, a tree or a body."""
    at: Point = (0.0, 0.0)
    """Of a body: where the string is tied, in its frame [m]."""


class PartSpec(Spec):
    """The base of parts."""

    name: Name
    """Its name, with which those of its elements begin."""

    @property
    def body_count(self) -> int:
        """Number of bodies that it adds, at least; 0 where it adds none or few."""
        return 0

    @property
    def leaves(self) -> tuple[Leaf, ...]:
        """What it pulls; a part that pulls others is expanded after them."""
        return ()

    @property
    def tendon_names(self) -> dict[str, str]:
        """The tendons that drives and trees pull, by the names that they may use."""
        return {}

    def expand(self, known: Known) -> Elements:
        """All elements so far, and those of the part.

        Raises:
            PartError: it refers to something unknown.
        """
        raise NotImplementedError


_NUMBER: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string"}]}
_PAIR: dict[str, Any] = {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2}

T = TypeVar("T")


def each(given: Sequence[T], count: int) -> tuple[T, ...]:
    """``given`` for ``count`` joints: as it is, or its one entry for all of them."""
    return tuple(given) * count if len(given) == 1 else tuple(given)


def _lift(value: Any) -> Any:
    return value if isinstance(value, (list, tuple)) else [value]


def _lift_point(value: Any) -> Any:
    listed = isinstance(value, (list, tuple))
    return value if listed and value and isinstance(value[0], (list, tuple)) else [value]


def _lift_limit(value: Any) -> Any:
    if not isinstance(value, (list, tuple)):
        value = [value]
    return [limit if isinstance(limit, (list, tuple)) else [0.0, limit] for limit in value]


def _schema(item: dict[str, Any], *, single: bool = True) -> WithJsonSchema:
    several = {"type": "array", "items": item, "minItems": 1}
    return WithJsonSchema({"anyOf": [item, several]} if single else several)


Stiffnesses = Annotated[Items[Stiffness], BeforeValidator(_lift), _schema(_NUMBER)]
Dampings = Annotated[Items[Damping], BeforeValidator(_lift), _schema(_NUMBER)]
RotaryDampings = Annotated[Items[RotaryDamping], BeforeValidator(_lift), _schema(_NUMBER)]
Coordinates = Annotated[Items[Coordinate], BeforeValidator(_lift), _schema(_NUMBER)]
Angles = Annotated[Items[Angle], BeforeValidator(_lift), _schema(_NUMBER)]
Points = Annotated[Items[Point], BeforeValidator(_lift_point), _schema(_PAIR)]
Limits = Annotated[
    Items[tuple[Angle, Angle]], BeforeValidator(_lift_limit),
    _schema({"anyOf": [*_NUMBER["anyOf"], _PAIR]}),
]
