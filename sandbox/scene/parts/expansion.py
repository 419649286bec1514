"""The expansion of a part: plain elements by kind, in order."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from sandbox.errors import Problem
from sandbox.scene.bodies import Body
from sandbox.scene.mechanism import ElementLists
from sandbox.values.numbers import Name, Point
from sandbox.values.spec import Spec
from sandbox.wording import NearMisses


class Elements(dict[str, tuple[Any, ...]]):
    """Plain elements of a mechanism by kind, in order; materials are pairs of name and material."""

    def __init__(self, **lists: tuple[Any, ...]) -> None:
        super().__init__({kind: lists.get(kind, ()) for kind in ElementLists.model_fields})

    def __add__(self, other: Elements) -> Elements:
        return Elements(**{kind: self[kind] + other[kind] for kind in self})

    def body(self, name: str) -> Body | None:
        """The body of that name."""
        return next((body for body in self["bodies"] if body.name == name), None)


@dataclass
class PartError(Exception):
    """Problems of one part; their paths start at the part itself."""

    problems: list[Problem]


@dataclass(frozen=True)
class Known:
    """Elements and names that a part may refer to while it is expanded."""

    elements: Elements = field(default_factory=Elements)  # all elements so far
    tendon_of: Mapping[str, str] = field(default_factory=dict)
    """The tendon of each finger and tree, by the part's name."""
    failed: frozenset[str] = frozenset()
    """Parts that could not be built; parts that depend on them are not reported."""
    pulled: frozenset[str] = frozenset()  # parts and tendons that trees pull, by their names here
    outside: Callable[[str], Body | None] = lambda name: None
    """Returns a body outside an assembly, in the frame of its surroundings."""
    near: NearMisses = field(default_factory=NearMisses)


class Leaf(Spec):
    """A leaf of a tree: a finger, a tendon (at its last guide), or a point of a body."""

    name: Name
    """Name of a finger, a tendon, a tree or a body."""
    at: Point = (0.0, 0.0)
    """Of a body: the point that is pulled, in its frame [m]."""


class PartSpec(Spec):
    """The base of parts."""

    name: Name
    """Its name, with which those of its elements begin."""

    @property
    def leaves(self) -> tuple[Leaf, ...]:
        """What it pulls; a part that pulls others is expanded after them."""
        return ()

    @property
    def tendon_names(self) -> dict[str, str]:
        """The tendons that drives and trees pull, by the names that they may use."""
        return {}

    def expand(self, known: Known) -> Elements:
        """All elements so far, and those of the part."""
        raise NotImplementedError
