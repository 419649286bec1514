"""The base of all elements: lists of a mechanism, references between elements, quantities.

The class of an element is its schema (a pydantic model) with all facts about its kind. Other
modules call its methods; none of them names a kind.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, get_args, get_origin

from pydantic import AfterValidator

from sandbox.errors import Problem
from sandbox.values.numbers import Name, Number, Pair
from sandbox.values.spec import Spec
from sandbox.values.units import size_fault
from sandbox.wording import quoted, refuse_if

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft
    from sandbox.scene.mechanism import Mechanism
    from sandbox.scene.parts.placement import Mover

Vec = tuple[float, float]
Turn = Literal["counterclockwise", "clockwise"]
RELEASED = "elements that are released, break or are engaged again"  # why MuJoCo has none of these
ATMOSPHERE = 101325.0  # ambient pressure [Pa], to which recorded pressures are relative
GRAZE = 1e-9  # wrap angle [rad] below which a tendon touches its wheel in one point
HELD_ABOVE = 0.5  # value above which a hold drive engages its element
NO_POINT: Vec = (float("nan"), float("nan"))


@dataclass(frozen=True)
class Named:
    """A list of a mechanism whose elements have names; all names are in one space."""

    one: str  # singular, such as ``body``
    axis: str = ""  # the axis of recorded arrays that counts them; empty where no array has it


NAMED: Mapping[str, Named] = {
    "bodies": Named("body", "nb"), "joints": Named("joint", "nj"), "springs": Named("spring", "ns"),
    "tendons": Named("tendon", "nt"), "lines": Named("line", "nl"),
    "valves": Named("valve", "nv"), "loads": Named("load", "nk"), "drives": Named("drive", "nd"),
    "controllers": Named("controller"), "events": Named("event"), "groups": Named("group"),
    "meters": Named("meter", "nm"),
}
RELEASABLES = "releasables"  # in a :class:`Reference`: all lists of :data:`RELEASABLE`
# all lists of a mechanism, in its order
LISTS = ("bodies", "joints", "springs", "tendons", "lines", "valves", "loads", "drives",
         "controllers", "events", "contacts", "groups", "meters", "expect")
RELEASABLE = ("joints", "springs", "tendons")  # in the order in which recordings have them


@dataclass(frozen=True)
class Reference:
    """Marks a field that names another element: ``Annotated[Name, Reference("bodies")]``."""

    among: str  # the list of that element, or :data:`RELEASABLES`
    hinge: bool = False  # only a joint with an angle is allowed
    line: bool = False  # only a joint with a length that drives set is allowed


BODY, HINGE, ACTUATOR = (Reference("bodies"), Reference("joints", hinge=True),
                         Reference("joints", line=True))
SPRING, TENDON, LINE, VALVE = (Reference(name) for name in (
    "springs", "tendons", "lines", "valves"))
HELD = Reference(RELEASABLES)
BodyName = Annotated[Name, BODY]
HingeName = Annotated[Name, HINGE]


@dataclass(frozen=True)
class Placed:
    """Marks a field that an assembly's placement changes in another way than its type says."""

    # kept: a hinge counts it in its own sense, or Element.placed changes it
    how: Literal["place", "turn", "sign", "vector", "nodes", "other", "kept"]


KEPT, OTHER_SIDE = Placed("kept"), Placed("other")


def _with_length(direction: Vec) -> Vec:
    refuse_if(direction == (0.0, 0.0), "[0, 0] is no direction", "out-of-range")
    fault = size_fault(math.hypot(*direction), "ratio")
    refuse_if(fault, f"as a direction its length is {fault}", "out-of-range",
              allowed="a direction such as [1, 0]; its length does not count")
    return direction


# a vector of which only the direction counts
Direction = Annotated[Pair[Number], AfterValidator(_with_length), KEPT]


@dataclass(frozen=True)
class Quantity:
    """A number that an element has in every sample."""

    array: str  # the recorded array that has it; empty for what is computed from others
    unit: str  # empty where it depends on the element's kind
    about: str
    component: int | None = None  # index in the array's last axis, where it has several components
    live: bool = False  # whether it can be read during a run; the rest is computed afterwards
    nothing: str = ""  # when it has no value, if that can be
    of_free: bool = False  # whether only bodies that move freely have it
    yes_no: bool = False  # whether it is only 1 or 0
    count: bool = False  # whether it is a whole number


computed = partial(Quantity, "")
live = partial(Quantity, live=True)


class Element(Spec):
    """The base of all kinds of element."""

    RECORDED: ClassVar[Mapping[str, Quantity]] = {}
    PYMUNK: ClassVar[str] = ""  # why pymunk has no counterpart of the kind, if it has none
    LACKS: ClassVar[Mapping[str, str]] = {}  # why it has none if a field is not the default

    def quantities(self, mechanism: Mechanism) -> dict[str, str]:
        """The quantities that it records, with their units."""
        names = getattr(getattr(self, "facts", None), "records", self.RECORDED)
        return {name: self.RECORDED[name].unit for name in names}

    def needed(self, quantity: str) -> str:
        """The field that it needs to record a quantity; empty where no field adds it."""
        return ""

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        """Errors that need the whole mechanism, besides names that are not found."""
        return iter(())

    def columns(self, mechanism: Mechanism) -> dict[str, Any]:
        """Its numbers in columns of the model that are no attributes of it."""
        return {}

    def placed(self, mover: Mover) -> Mapping[str, Any]:
        """New values of ``kept`` fields that a placement changes."""
        return {}

    def without_pymunk(self, mechanism: Mechanism) -> str:
        """Why pymunk has no counterpart of the element; empty where it has one."""
        fields = type(self).model_fields
        return next((why for field, why in self.LACKS.items()
                     if getattr(self, field) != fields[field].default), self.PYMUNK)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """Add the calls that the element is in plain pymunk."""
        raise NotImplementedError


def references(element: Spec, path: str) -> Iterator[tuple[str, Reference, str]]:
    """All fields of an element that name others: path, mark and name."""
    for field, key, mark, models in _marked(type(element)):
        value = getattr(element, field)
        entries = [(f"{path}.{key}", value)]
        if isinstance(value, tuple):
            entries = [(f"{path}.{key}[{i}]", each) for i, each in enumerate(value)]
        for place, entry in entries:
            if mark is not None and isinstance(entry, str):
                yield place, mark, entry
            if isinstance(entry, models):
                yield from references(entry, place)


@cache
def _marked(model: type[Spec]) -> list[tuple[str, str, Reference | None, tuple[type[Spec], ...]]]:
    """Fields with references: name, key, mark, and classes of records with references."""
    found = []
    for name, field in model.model_fields.items():
        parts = [*field.metadata, *_parts(field.annotation)]
        mark = next((part for part in parts if isinstance(part, Reference)), None)
        models = tuple(part for part in parts if isinstance(part, type)
                       and issubclass(part, Spec) and _marked(part))
        if mark is not None or models:
            found.append((name, field.alias or name, mark, models))
    return found


def _parts(annotation: Any) -> Iterator[Any]:
    """An annotation's types and marks, those inside of unions and tuples too."""
    if get_origin(annotation) is None:
        yield annotation
    for part in get_args(annotation):
        yield from _parts(part)


def tag_of(model: type[Spec]) -> str:
    """The ``type`` of a model, such as ``motor``; empty where it has none."""
    field = model.model_fields.get("type")
    return str(get_args(field.annotation)[0]) if field else ""


def no_mesh(name: str, path: str) -> Problem:
    """The problem of wheels that are engaged during a run."""
    return Problem("not-releasable", f"{quoted(name)} joins wheels where they meet at t = 0, so "
                   "events cannot engage it again", path, allowed="a joint that joins points")
