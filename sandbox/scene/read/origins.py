"""Where each piece of a scene was written, and the way back from a problem to that place.

A problem of the mechanism has a path there. The part that an element comes from, a template, a
repeat or an include, and the text of a file are each one step back.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

from sandbox.errors import Problem
from sandbox.scene.document import Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.parts.expansion import Known, expand_parts
from sandbox.scene.read.source import SceneSource
from sandbox.values.messages import fields_at
from sandbox.values.paths import JsonPath, holds, parse_path, path_text
from sandbox.wording import NearMisses, WrongValueError, quoted


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
        return replace(moved, copy=place.copy) if moved else place.to(step)

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


def relocated(
    problems: Sequence[Problem], mechanism: Mechanism, scene: Scene,
) -> Iterator[Problem]:
    """Problems of the mechanism with their paths in the scene; of a part, the part's path."""
    paths = expand_parts(scene, Known()).paths if problems and mechanism is not scene else {}
    for problem in problems:
        kind, index, *rest = (*parse_path(problem.path), "", "")
        if kind not in paths or not isinstance(index, int):
            yield problem
            continue
        path, name = paths[kind][index], getattr(getattr(mechanism, kind)[index], "name", "")
        if path[-2] == kind:
            yield replace(problem, path=path_text((*path, *rest[:-2])))
        else:
            named = f"{quoted(name)}: " if name and not problem.element else ""
            yield replace(problem, message=f"{named}{problem.message}", path=path_text(path))
