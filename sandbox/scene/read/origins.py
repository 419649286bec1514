"""Where each piece of a scene was written, and the way back from a problem to that place.

A problem of the mechanism has a path there. The part that an element comes from, a template, a
repeat or an include, and the text of a file are each one step back. The same steps serve problems
that reading finds and problems that an inspection finds later.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from sandbox.elements.element import LISTS
from sandbox.errors import Problem
from sandbox.scene.document import Assembly, Part, Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.source import SceneSource
from sandbox.scene.settings import ContactRule
from sandbox.values.messages import fields_at
from sandbox.values.paths import JsonPath, parse_path, path_text
from sandbox.wording import quoted


@dataclass(frozen=True)
class Origin:
    """A place in the text of a scene, or of a file that it includes."""

    source: SceneSource
    path: JsonPath = ()
    included: str = ""
    """For messages: where this file is included; empty for the scene's own file."""
    copy: str = ""
    """The copy of a ``repeat``, as ``i = 3``; empty outside of one."""

    def to(self, *steps: str | int) -> Origin:
        """The place further down."""
        return Origin(self.source, (*self.path, *steps), self.included, self.copy)

    @property
    def including(self) -> str:
        """For messages of a file that is included here."""
        line, column = self.source.where(self.path)
        return f"included by {self.source.name}:{line}:{column}"

    def copied(self, other: Origin) -> Origin:
        """The same place in the copy of another place."""
        return self if self.copy == other.copy else replace(self, copy=other.copy)

    def problem(self, code: str, message: str, **more: Any) -> Problem:
        """A problem of the value here."""
        return self.located(Problem(code, message, **more))

    def located(self, problem: Problem) -> Problem:
        """A problem with this place: path, line and column, file, copy, section of the docs."""
        line, column = self.source.where(self.path, key=problem.key)
        notes = [note for note in (f"for {self.copy}" if self.copy else "", self.included) if note]
        message = f"{problem.message} ({'; '.join(notes)})" if notes else problem.message
        fields = fields_at(Scene, self.source.data, self.path) if problem.blocks else ""
        return replace(problem, message=message, path=path_text(self.path), line=line,
                       column=column, file=self.source.name if self.included else "",
                       fields=fields)


@dataclass
class OriginMap:
    """The children of containers that were written elsewhere than their container."""

    root: Origin
    moved: dict[tuple[int, str | int], Origin] = field(default_factory=dict)
    """By the container's identity and the key or index in it."""
    kept: dict[int, Any] = field(default_factory=dict)
    """The containers, so that no other object takes the identity of one that is gone."""
    reported: dict[tuple[str, JsonPath], Origin] = field(default_factory=dict)
    """The copy of a place of which a problem was reported first."""

    def first(self, place: Origin) -> bool:
        """Whether no problem of another copy of a place was reported yet."""
        return self.reported.setdefault((place.source.name, place.path), place) == place

    def put(self, container: Any, step: str | int, place: Origin) -> None:
        """Note where a child of a container was written."""
        self.moved[id(container), step] = place
        self.kept[id(container)] = container

    def copy(self, container: Any, other: Any) -> None:
        """Note the same places for another container with the same keys."""
        for key in other if other is not container else ():
            if (id(container), key) in self.moved:
                self.put(other, key, self.moved[id(container), key])

    def at(self, container: Any, step: str | int, place: Origin) -> Origin:
        """Where a child of a container at a place was written, in the copy of that place."""
        moved = self.moved.get((id(container), step))
        return moved.copied(place) if moved else place.to(step)

    def find(self, data: Any, path: JsonPath) -> Origin:
        """Where the value at a path of the composed data was written."""
        place, value = self.root, data
        for step in path:
            place = self.moved.get((id(value), step)) or place.to(step)
            try:
                value = value[step]
            except (LookupError, TypeError):
                value = None
        return place


@dataclass
class Composed:
    """Composed data of a scene."""

    data: dict[str, Any]
    places: OriginMap
    problems: list[Problem] = field(default_factory=list)
    """Each with its place."""
    broken: set[JsonPath] = field(default_factory=set)
    """Entries of the data that could not be composed."""
    failed: bool = False
    """Whether the data is not worth validating."""
    files: tuple[Path, ...] = ()
    """Included files."""

    def place(self, path: JsonPath) -> Origin:
        """Where the value at a path of the data was written."""
        return self.places.find(self.data, path)


class Relocation:
    """From a path of the mechanism to the path of the scene that led to it."""

    def __init__(self, mechanism: Mechanism, scene: Scene) -> None:
        self.mechanism, self.scene = mechanism, scene
        self.own = {id(element): (kind, i) for kind in LISTS
                    for i, element in enumerate(getattr(scene, kind))}
        self.named = {(kind, element.name): i for kind in LISTS
                      for i, element in enumerate(getattr(scene, kind))
                      if hasattr(element, "name")}
        self.parts = {part.name: i for i, part in enumerate(scene.parts)}

    def __call__(self, problem: Problem) -> Problem:
        """The problem with its path in the scene; of a part, the part's path."""
        path = parse_path(problem.path)
        kind, index = (*path, "", "")[:2]
        if kind not in LISTS or not isinstance(index, int):
            return problem
        element = getattr(self.mechanism, str(kind))[index]
        name = getattr(element, "name", "")
        if id(element) in self.own:
            return replace(problem, path=path_text((*self.own[id(element)], *path[2:])))
        if (where := self._part(name)) is not None:
            inner = _inside(self.scene.parts[where], str(kind), name, ("parts", where))
            if len(inner) > 2 and inner[-2] == kind:
                return replace(problem, path=path_text((*inner, *path[2:])))
            message = problem.message if problem.element else f"{quoted(name)}: {problem.message}"
            return replace(problem, message=message, path=path_text(inner))
        if (kind, name) in self.named:
            return replace(
                problem, path=path_text((kind, self.named[str(kind), name], *path[2:])))
        return replace(problem, path=path_text(self._rule(element) or ("parts",)))

    def _part(self, name: str) -> int | None:
        """The part that an element's name begins with; the longest one."""
        while name and name not in self.parts:
            name = name.rpartition(".")[0]
        return self.parts.get(name)

    def _rule(self, element: object) -> JsonPath:
        """Where an assembly has a contact rule, whose element has no name; () if it is not one."""
        if not isinstance(element, ContactRule):
            return ()
        return next(_rules(self.scene.parts, "", element, ("parts",)), ())


def _inside(part: Part, kind: str, name: str, path: JsonPath) -> JsonPath:
    """The path of an assembly's element, or of the part in it that the element comes from."""
    if not isinstance(part, Assembly):
        return path
    own = name.removeprefix(f"{part.name}.")
    for i, element in enumerate(getattr(part, kind, ())):
        if getattr(element, "name", "") == own:
            return (*path, kind, i)
    for i, inner in enumerate(part.parts):
        if own == inner.name or own.startswith(f"{inner.name}."):
            return _inside(inner, kind, own, (*path, "parts", i))
    return path


def _rules(
    parts: Sequence[Part], prefix: str, rule: ContactRule, path: JsonPath,
) -> Iterator[JsonPath]:
    """Paths of the rules of assemblies that may have become a rule."""
    for i, part in enumerate(parts):
        if not isinstance(part, Assembly):
            continue
        begin = f"{prefix}{part.name}."
        for j, own in enumerate(part.contacts):
            if all(there in (here, f"{begin}{here}") for here, there in
                   zip(own.between, rule.between, strict=True)):
                yield (*path, i, "contacts", j)
        yield from _rules(part.parts, begin, rule, (*path, i, "parts"))


@dataclass(frozen=True)
class Origins:
    """The places of a scene's data: its text, its templates, the files that it includes."""

    composed: Composed

    @property
    def source(self) -> SceneSource:
        """The scene file itself."""
        return self.composed.places.root.source

    def __call__(self, problem: Problem) -> Problem:
        """The problem with the path in the file, and the line and column there."""
        return self.composed.place(parse_path(problem.path)).located(problem)
