"""What is spelled out so far: its problems, what it counts for, where each piece was written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sandbox.errors import Problem
from sandbox.scene.read.includes import Library
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.origin_map import Origin, OriginMap
from sandbox.scene.read.scopes import Scope
from sandbox.values.paths import JsonPath
from sandbox.wording import NearMisses, WrongValueError

CONTAINER = 40
"""Characters that an object or a list counts for: they take more time than room."""
Trail = JsonPath


@dataclass
class Composed:
    """A scene's data spelled out."""

    data: dict[str, Any]
    places: OriginMap
    problems: list[Problem] = field(default_factory=list)
    """Each with its place."""
    broken: set[JsonPath] = field(default_factory=set)
    """Entries of the data that could not be spelled out."""
    failed: bool = False
    """Whether there is no data worth validating."""
    files: tuple[Path, ...] = ()
    """What was included."""

    def place(self, path: JsonPath) -> Origin:
        """Where the value at a path of the data was written."""
        return self.places.find(self.data, path)


@dataclass(frozen=True)
class Context:
    """What holds where a piece of data is spelled out."""

    scope: Scope
    templates: Any
    home: Origin
    """Of the templates."""
    files: tuple[Path, ...]
    """Files that include one another, down to this one."""
    inside: tuple[str, ...] = ()
    """Templates of the file whose content this is."""


class TooLargeError(Exception):
    """What is written out is beyond a limit; why is among the problems."""


@dataclass
class Writer:
    """Keeps count of what is written out, and of what is wrong with it."""

    library: Library
    limits: Limits
    places: OriginMap
    problems: list[Problem] = field(default_factory=list)
    broken: set[JsonPath] = field(default_factory=set)
    failed: bool = False
    near: NearMisses = field(default_factory=NearMisses)
    size: int = 0
    """Characters that what is written out would take, about."""
    copies_made: int = 0
    """Entries that repeat, like and include have led to."""

    def text(
        self, text: str, place: Origin, context: Context, trail: Trail = (),
    ) -> str | None:
        """A text with the scope's names put in; None, and its entry left out, if that fails."""
        self.grow(len(text))
        try:
            return context.scope.text(text)
        except WrongValueError as error:
            self.tell(place, error)
            if trail:
                self.broken.add(trail[:2])
            return None

    def grow(self, characters: int) -> None:
        """Count characters for the limit of a file's bytes."""
        self.size += characters
        if self.size > self.limits.file_bytes:
            raise TooLargeError

    def few_enough(self, count: int, among: str, place: Origin) -> None:
        """See that a list does not become longer than it may, before any copy is made."""
        name = "bodies" if among in ("bodies", "parts") else "elements"
        most = getattr(self.limits, name)
        if count > most:
            self.problems.append(place.problem(
                "limit-exceeded", f"with these copies there are {count} {among or 'entries'}",
                allowed=f"at most {most} (the limit '{name}', raised by --limit {name}=N)"))
            raise TooLargeError

    def too_large(self, place: Origin) -> None:
        """Tell that what is written out, from a place on, takes more than a file may."""
        self.problems.append(place.problem(
            "limit-exceeded", "spelled out, the scene is larger than the limit 'file_bytes' of "
            f"{self.limits.file_bytes} bytes", allowed="a larger one when the limit is raised"))

    def count(self, place: Origin) -> None:
        """One more entry that the file does not hold by itself."""
        self.copies_made += 1
        if self.copies_made > self.limits.elements:
            self.problems.append(place.problem(
                "limit-exceeded", f"here the scene's repeats and templates come to more than "
                f"{self.limits.elements} copies", allowed=f"at most {self.limits.elements} (the "
                "limit 'elements', raised by --limit elements=N)"))
            raise TooLargeError

    def tell(self, place: Origin, error: WrongValueError, *, key: bool = False) -> None:
        """Add what is wrong at a place, once for all copies of it."""
        if self.places.first(place):
            self.problems.append(place.located(Problem.of(error, "$", key=key)))

    def append(self, out: list[Any], value: Any, place: Origin) -> None:
        """Put an entry into a list that may have others before it than the text has."""
        self.places.put(out, len(out), place)
        out.append(value)

    def leave_out(
        self, out: list[Any], item: Mapping[str, Any], place: Origin, trail: Trail,
    ) -> None:
        """Put an entry into the list that stands for one that cannot be spelled out."""
        self.broken.add((*trail, len(out)))
        name = item.get("name")
        plainly = isinstance(name, str) and "{" not in name and "repeat" not in item
        self.append(out, {"name": name} if plainly else {}, place)
