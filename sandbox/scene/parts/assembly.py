"""What an assembly becomes: its elements placed, under names that begin with its own."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from sandbox.errors import Problem
from sandbox.scene.bodies import Body
from sandbox.scene.parts.expansion import Elements, PartError
from sandbox.scene.parts.naming import Naming
from sandbox.scene.parts.placement import Mover, Placement
from sandbox.scene.settings import Group
from sandbox.values.spec import Spec

PLACED = ("bodies", "joints", "springs", "tendons", "lines", "loads", "drives")
SpecType = TypeVar("SpecType", bound=Spec)


def placed(
    name: str, inner: Elements, placement: Placement, outside: Callable[[str], Body | None],
) -> Elements:
    """The elements of the assembly ``name`` as the scene has them.

    Args:
        name: the assembly's.
        inner: its elements as they are written, its parts spelled out.
        placement: where it is.
        outside: finds a body of the scene by its name.

    Raises:
        PartError: elements on bodies that are not there; all of them.
    """
    moved = _moved(inner, placement, outside)
    naming = Naming(name, _names(inner))
    found = Elements(**{
        kind.name: tuple(naming.spec(each) for each in getattr(moved, kind.name))
        for kind in dataclasses.fields(Elements) if kind.name != "materials"
    }, materials=tuple((f"{name}.{key}", material) for key, material in inner.materials))
    whole = Group(name=name, bodies=tuple(body.name for body in found.bodies))
    return found + Elements(groups=(whole,))


def _moved(
    inner: Elements, placement: Placement, outside: Callable[[str], Body | None],
) -> Elements:
    """Where the placement says; joints to the scene are followed even by one that moves nothing."""
    own = {body.name: body for body in inner.bodies}
    place = Mover(placement, own, outside)
    resized = Mover(Placement(scale=placement.scale), own, outside)
    problems: list[Problem] = []
    changed: dict[str, Any] = {
        "controllers": tuple(resized.spec(each) for each in inner.controllers),
    }
    for kind in PLACED:
        elements = []
        for i, element in enumerate(getattr(inner, kind)):
            try:
                elements.append(place.body(element, f".bodies[{i}]") if kind == "bodies"
                                else place.element(element, f".{kind}[{i}]"))
            except PartError as error:
                problems += error.problems
        changed[kind] = tuple(elements)
    if problems:
        raise PartError(problems)
    return dataclasses.replace(inner, **changed)


def _names(inner: Elements) -> Iterable[str]:
    """All names that are the assembly's own."""
    for kind in dataclasses.fields(Elements):
        if kind.name == "materials":
            yield from (name for name, _ in inner.materials)
        elif kind.name != "contacts":
            yield from (each.name for each in getattr(inner, kind.name))
