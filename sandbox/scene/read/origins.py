"""Where each piece of a scene was written, and the way back from a problem to that place.

A problem of the mechanism has a path there. The part that an element comes from, a template, a
repeat or an include, and the text of a file are each one step back.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, cast

from sandbox.elements.element import LISTS
from sandbox.errors import Problem
from sandbox.scene.document import Assembly, Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.source import SceneSource
from sandbox.scene.settings import ContactRule
from sandbox.values.messages import fields_at
from sandbox.values.paths import JsonPath, holds, parse_path, path_text
from sandbox.wording import NearMisses, WrongValueError, quoted

LAST = ("contacts", "groups")
"""Lists of a mechanism in which the scene's own elements come last; in the others, first."""


@dataclass(frozen=True)
class Origin:
    """A place in the text of a scene, or of a file that it includes."""

    source: SceneSource
    path: JsonPath = ()
    included: str = ""  # for messages: where this file is included; empty for the scene's own file
    copy: str = ""  # the copy of a repeat, as i = 3; empty outside of one

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

    @contextmanager
    def refusing(self, *, key: bool = False) -> Iterator[None]:
        """Give a wrong value this place."""
        try:
            yield
        except WrongValueError as error:
            raise RefusedError(self, [self.located(Problem.of(error, "$", key=key))]) from None


@dataclass
class RefusedError(Exception):
    """A piece that cannot be composed: its place, and problems with places of their own."""

    place: Origin
    problems: list[Problem]


@dataclass
class Composed:
    """Composed data of a scene, and where its pieces were written."""

    data: dict[str, Any]
    root: Origin
    problems: list[Problem] = field(default_factory=list)  # each with its place
    broken: set[JsonPath] = field(default_factory=set)
    """Entries of the data that could not be composed."""
    failed: bool = False  # whether the data is not worth validating
    files: tuple[Path, ...] = ()  # included files
    moved: dict[int, tuple[Any, dict[str | int, Origin]]] = field(default_factory=dict)
    """Containers by their id, with the children that were written elsewhere than them."""
    near: NearMisses = field(default_factory=NearMisses)  # suggestions of templates
    reported: dict[tuple[str, JsonPath], Origin] = field(default_factory=dict)
    """For each place, the copy of which a problem was reported first."""

    @property
    def source(self) -> SceneSource:
        """The scene's own file."""
        return self.root.source

    def first(self, place: Origin) -> bool:
        """Whether no problem of another copy of a place was reported yet."""
        return self.reported.setdefault((place.source.name, place.path), place) == place

    def put(self, container: Any, step: str | int, place: Origin) -> None:
        """Note where a child of a container was written."""
        self.moved.setdefault(id(container), (container, {}))[1][step] = place

    def at(self, container: Any, step: str | int, place: Origin) -> Origin:
        """Where a child of a container at a place was written, in the copy of that place."""
        moved = self.of(container).get(step)
        return moved.copied(place) if moved else place.to(step)

    def place(self, path: JsonPath) -> Origin:
        """Where the value at a path of the data was written."""
        place, value = self.root, cast(Any, self.data)
        for step in path:
            place = self.of(value).get(step) or place.to(step)
            value = value[step] if holds(value, step) else None
        return place

    def located(self, problem: Problem) -> Problem:
        """A problem of the data with its path, line and column in the file."""
        return self.place(parse_path(problem.path)).located(problem)

    def of(self, container: Any) -> dict[str | int, Origin]:
        """Where the children of a container were written, if elsewhere than it."""
        return self.moved[id(container)][1] if id(container) in self.moved else {}


class Relocation:
    """From a path of the mechanism to the path of the scene that led to it."""

    def __init__(self, mechanism: Mechanism, scene: Scene) -> None:
        self.mechanism, self.scene = mechanism, scene

    @cached_property
    def _written(self) -> list[tuple[str, str, Any, JsonPath]]:
        return list(_elements(self.scene, "", ()))

    @cached_property
    def _named(self) -> dict[tuple[str, str], JsonPath]:
        return {(kind, name): path for kind, name, _, path in reversed(self._written)}

    def __call__(self, problem: Problem) -> Problem:
        """The problem with its path in the scene; of a part, the part's path."""
        kind, index, *rest = (*parse_path(problem.path), "", "")
        if kind not in LISTS or not isinstance(index, int):
            return problem
        elements, own = getattr(self.mechanism, str(kind)), len(getattr(self.scene, str(kind)))
        first = len(elements) - own if kind in LAST else 0
        if first <= index < first + own:
            return replace(problem, path=path_text((kind, index - first, *rest[:-2])))
        element = elements[index]
        if isinstance(element, ContactRule):
            path = next((path for kind, prefix, rule, path in self._written if kind == "contacts"
                         and all(there in (here, f"{prefix}{here}") for here, there in zip(
                             rule.between, element.between, strict=True))), None)
        else:
            path = self._named.get((str(kind), element.name))
        if path is not None:
            return replace(problem, path=path_text((*path, *rest[:-2])))
        name = getattr(element, "name", "")
        message = problem.message if problem.element or not name else \
            f"{quoted(name)}: {problem.message}"
        while name and path is None:
            path = self._named.get(("parts", name))
            name = name.rpartition(".")[0]
        return replace(problem, message=message, path=path_text(path or ("parts",)))


def _elements(
    holder: Scene | Assembly, prefix: str, path: JsonPath,
) -> Iterator[tuple[str, str, Any, JsonPath]]:
    """List, full name and path of each element and part, those of assemblies included."""
    for kind in (*LISTS, "parts"):
        for i, element in enumerate(getattr(holder, kind, ())):
            here, name = (*path, kind, i), f"{prefix}{getattr(element, 'name', '')}"
            yield kind, name, element, here
            if isinstance(element, Assembly):
                yield from _elements(element, f"{name}.", here)
