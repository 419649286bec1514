"""Back from where a problem was found to where its cause is written.

What is found in a mechanism has a path there; a part that was spelled out, a template
that was merged and the text of a file are each one step back. The same steps serve what
reading finds and what an inspection finds later.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from sandbox.errors import Problem
from sandbox.kinds.elements import LISTS
from sandbox.scene.document import Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.paths import JsonPath, parse_path, path_text
from sandbox.scene.read.source import SceneSource
from sandbox.scene.read.templates import Merged
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
            message = problem.message if problem.element else f"{quoted(name)}: {problem.message}"
            return replace(problem, message=message, path=f"$.parts[{where}]")
        if (kind, name) in self.named:
            return replace(
                problem, path=path_text((kind, self.named[str(kind), name], *path[2:])))
        return replace(problem, path="$.parts")

    def _part(self, name: str) -> int | None:
        """The part that an element's name begins with; the longest one."""
        while name and name not in self.parts:
            name = name.rpartition(".")[0]
        return self.parts.get(name)


@dataclass(frozen=True)
class Origins:
    """Where each piece of a scene's data was written: its text, and the templates in it."""

    source: SceneSource
    merged: Merged

    def __call__(self, problem: Problem) -> Problem:
        """The problem with the path in the file, and the line and column there."""
        path: JsonPath = self.merged.origin(parse_path(problem.path))
        line, column = self.source.where(path, key=problem.key)
        return replace(problem, path=path_text(path), line=line, column=column)
