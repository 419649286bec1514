"""Where each piece of a spelled-out scene was written: file, path, and which copy it is."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from sandbox.errors import Problem
from sandbox.scene.document import Scene
from sandbox.scene.read.source import SceneSource
from sandbox.values.messages import fields_at
from sandbox.values.paths import JsonPath, path_text

Layered = dict[str, tuple[Any, "Origin", bool]]
"""An object's keys: the value, where it is written, and whether the value is itself layered."""


@dataclass(frozen=True)
class Origin:
    """A place of a scene's text, or of a file that it includes."""

    source: SceneSource
    path: JsonPath = ()
    included: str = ""
    """What includes this file, as messages say it; empty for the file that was asked for."""
    copy: str = ""
    """Which copy of a ``repeat``: ``i = 3``; empty outside of one."""

    def to(self, *steps: str | int) -> Origin:
        """The place further down."""
        return Origin(self.source, (*self.path, *steps), self.included, self.copy)

    def copied(self, other: Origin) -> Origin:
        """The same place in the copy that another place is of."""
        return replace(self, copy=other.copy)

    def problem(self, code: str, message: str, **more: Any) -> Problem:
        """A problem of the value here."""
        return self.located(Problem(code, message, **more))

    def located(self, problem: Problem) -> Problem:
        """A problem with this place: path, line and column, file, which copy, whose fields."""
        line, column = self.source.where(self.path, key=problem.key)
        notes = [note for note in (f"for {self.copy}" if self.copy else "", self.included) if note]
        message = f"{problem.message} ({'; '.join(notes)})" if notes else problem.message
        fields = fields_at(Scene, self.source.data, self.path) if problem.blocks else ""
        return replace(problem, message=message, path=path_text(self.path), line=line,
                       column=column, file=self.source.name if self.included else "",
                       fields=fields)


@dataclass
class OriginMap:
    """Of the containers of spelled-out data, the children that stand elsewhere in the text."""

    root: Origin
    moved: dict[tuple[int, str | int], Origin] = field(default_factory=dict)
    """By the container's identity and the step from it."""
    kept: dict[int, Any] = field(default_factory=dict)
    """The containers, so that no other can take the identity of one that is gone."""

    told: dict[tuple[str, JsonPath], Origin] = field(default_factory=dict)
    """Of places that may be copied or included: that of which something was told first."""

    def first(self, place: Origin) -> bool:
        """Whether nothing was told yet of another copy of what is written at a place."""
        return self.told.setdefault((place.source.name, place.path), place) == place

    def put(self, container: Any, step: str | int, place: Origin) -> None:
        """Say where a child of a container stands."""
        self.moved[id(container), step] = place
        self.kept[id(container)] = container

    def find(self, data: Any, path: JsonPath) -> Origin:
        """Where the value at a path of the spelled-out data was written."""
        place, value = self.root, data
        for step in path:
            place = self.moved.get((id(value), step)) or place.to(step)
            try:
                value = value[step]
            except (LookupError, TypeError):
                value = None
        return place
