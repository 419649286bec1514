"""Back from where a problem was found to where its cause is written.

What is found in a mechanism has a path there; a part that was spelled out, a template, repeat or
include that was written out and the text of a file are each one step back. The same steps serve
what reading finds and what an inspection finds later.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from sandbox.elements.element import LISTS
from sandbox.errors import Problem
from sandbox.scene.document import Assembly, Part, Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.source import SceneSource
from sandbox.scene.read.writing import Composed
from sandbox.scene.settings import ContactRule
from sandbox.values.paths import JsonPath, parse_path, path_text
from sandbox.wording import quoted


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
    """Where each piece of a scene's data was written: its text, templates, files it includes."""

    composed: Composed

    @property
    def source(self) -> SceneSource:
        """The file that was asked for."""
        return self.composed.places.root.source

    def __call__(self, problem: Problem) -> Problem:
        """The problem with the path in the file, and the line and column there."""
        return self.composed.place(parse_path(problem.path)).located(problem)
