"""From a file to a Scene that can be used, or to every problem that it has.

The order: read the text, apply ``--set`` overrides, merge templates, resolve
parameters, validate by the models, spell out the parts, follow every name.
A step that fails does not hide what later steps would find: what could not be
read is left out, and the rest is checked.
"""

from __future__ import annotations

import numbers
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sandbox.errors import Problem, SceneError
from sandbox.kinds.elements import LISTS as MECHANISM_LISTS
from sandbox.scene.check.references import check_references
from sandbox.scene.check.units import control_units
from sandbox.scene.document import Scene
from sandbox.scene.expand import expand
from sandbox.scene.library import shipped_scenes
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.findings import Finding
from sandbox.scene.read.limits import Limits, check_limits, check_lists
from sandbox.scene.read.messages import explain
from sandbox.scene.read.overrides import apply_overrides
from sandbox.scene.read.parameters import Parameters, resolve_parameters
from sandbox.scene.read.paths import JsonPath, parse_path, path_text
from sandbox.scene.read.source import SceneSource, read_source
from sandbox.scene.read.templates import Merged, merge_templates
from sandbox.wording import kind_of, quoted

FORMAT = 1
"""The version of the scene format that is read."""
LISTS = (*MECHANISM_LISTS, "parts")


def load_scene(
    source: str | Path | Mapping[str, Any],
    *,
    overrides: Mapping[str, Any] | None = None,
    limits: Limits | None = None,
) -> Scene:
    """Load a scene from a file, or from data as a file would hold it.

    Args:
        source: a path, the name of a shipped scene (``"adaptive_grasp"``), or
            a mapping.
        overrides: values that replace those of the scene, by path:
            ``{"run.step": "1 ms", "parts[finger1].lengths[0]": 0.045}``.
        limits: how large a scene may be.

    Raises:
        SceneError: every problem of the scene, each with its place.
    """
    limits = limits or Limits()
    found = _source(source, limits)
    if not isinstance(found.data, dict):
        raise SceneError([Problem(f"a scene is an object {{…}}, not {kind_of(found.data)}", "$",
                                  *found.where(()))], found.name)
    loading = _Loading(found, limits)
    scene = loading.scene(found.data, overrides or {})
    if loading.problems or scene is None:
        raise SceneError(loading.told(), found.name)
    return scene


def _source(source: str | Path | Mapping[str, Any], limits: Limits) -> SceneSource:
    if isinstance(source, Mapping):
        problems: list[Problem] = []
        data = _plain(source, (), limits.nesting, problems)
        if problems:
            raise SceneError(problems)
        return SceneSource(data)
    path = Path(source)
    if path.suffix != ".json" and len(path.parts) == 1 and not path.exists():
        path = shipped_scenes().get(path.name, path)
    found = read_source(path, limits=limits)
    if isinstance(found.data, dict):
        found.data.setdefault("name", path.stem)
    return found


def _plain(value: Any, path: JsonPath, nesting: int, problems: list[Problem]) -> Any:
    """A copy of Python data as a JSON file would give it."""
    if isinstance(value, (Mapping, list, tuple)) and len(path) >= nesting:
        if not problems:
            problems.append(Problem(
                f"nested deeper than the limit 'nesting' of {nesting}", path_text(path)))
        return None
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                problems.append(Problem(f"a key is text, not {kind_of(key)}", path_text(path)))
        return {key: _plain(entry, (*path, key), nesting, problems)
                for key, entry in value.items() if isinstance(key, str)}
    if isinstance(value, (list, tuple)):
        return [_plain(entry, (*path, i), nesting, problems) for i, entry in enumerate(value)]
    if isinstance(value, numbers.Real) and not isinstance(value, (bool, int, float)):
        return float(value)
    return value


@dataclass
class _Loading:
    """One file on its way: its problems so far, and what is needed to say where they are."""

    source: SceneSource
    limits: Limits
    problems: list[Problem] = field(default_factory=list)
    overridden: set[JsonPath] = field(default_factory=set)
    merged: Merged = field(default_factory=lambda: Merged({}))
    parameters: Parameters = field(default_factory=Parameters)
    ignored: set[JsonPath] = field(default_factory=set)
    """What is not complained about, since the complaint is made elsewhere."""

    def scene(self, data: dict[str, Any], overrides: Mapping[str, Any]) -> Scene | None:
        """The scene, or what could be read of it; None when nothing could."""
        data, self.overridden, findings = apply_overrides(
            data, overrides, nesting=self.limits.nesting)
        self.tell(findings)
        if too_long := check_lists(data, self.limits):
            self.tell(_as_finding(problem) for problem in too_long)
            return None
        self.merged = merge_templates(data)
        self.tell(self.merged.findings)
        data = self.merged.data
        self.ignored = {("parts", i) for i in self.merged.broken}
        self.parameters = resolve_parameters(data.get("parameters"))
        self.tell(self.parameters.findings)
        self.tell(control_units(data))
        if isinstance(data.get("parameters"), dict):
            data = {**data, "parameters": dict(self.parameters.values)}
        return self._validated(data)

    def _validated(self, data: dict[str, Any]) -> Scene | None:
        context = {"parameters": self.parameters.values}
        if newer := list(_newer_format(data)):
            self.tell(newer)
            self.ignored.add(("format",))
        try:
            scene = Scene.model_validate(data, context=context)
        except ValidationError as error:
            findings = explain(error, data, Scene)
            self.tell(self._worth_telling(findings, data))
            rest = _Rest(data, {f.path[:2] for f in findings} | self.ignored)
            try:
                scene = Scene.model_validate(rest.data, context=context)
            except ValidationError:
                return None
        else:
            rest = _Rest(data, self.ignored)
        self._check_whole(scene, rest)
        return scene

    def _worth_telling(self, findings: Iterable[Finding], data: Any) -> Iterable[Finding]:
        for finding in findings:
            if finding.path[:2] in self.ignored:
                continue
            value = data
            for step in finding.path:
                value = value[step]
            if not self.parameters.reads_failed(value):
                yield finding

    def _check_whole(self, scene: Scene, rest: _Rest) -> None:
        """What only shows when all elements are there: parts, names, sizes."""
        self.tell(twice := list(_twice(scene, rest)))
        try:
            mechanism = expand(scene)
        except SceneError as error:
            if not rest.assumed:
                self.tell(rest.located(_as_finding(problem)) for problem in error.problems)
            rest.assumed |= {part.name for part in scene.parts}
            mechanism = scene
        relocate = _Relocation(mechanism, scene)
        for problem in [*check_references(mechanism, assumed=rest.assumed),
                        *check_limits(mechanism, self.limits)]:
            finding = relocate(_as_finding(problem))
            if not (twice and finding.path[:1] == ("parts",)):  # said already, once a part
                self.tell([rest.located(finding)])

    def tell(self, findings: Iterable[Finding]) -> None:
        """Turn findings into problems with a place in the file; each is told once."""
        for finding in findings:
            path = self.merged.origin(finding.path)
            line, column = self.source.where(path, key=finding.key) if finding.placed else (0, 0)
            message = finding.message
            if any(path[:len(set_path)] == set_path for set_path in self.overridden):
                line, column, message = 0, 0, f"{message} (set by an override)"
            problem = Problem(message, path_text(path), line, column,
                              finding.allowed, finding.hint)
            if problem not in self.problems:
                self.problems.append(problem)

    def told(self) -> list[Problem]:
        """The problems in the order of the file, the first ones if there are very many."""
        ordered = sorted(self.problems, key=lambda problem: (problem.line, problem.column))
        if len(ordered) <= self.limits.problems:
            return ordered
        more = len(ordered) - self.limits.problems
        return [*ordered[:self.limits.problems], Problem(f"and {more} more problems")]


class _Rest:
    """Scene data without the elements that could not be read."""

    def __init__(self, data: dict[str, Any], broken: set[JsonPath]) -> None:
        self.assumed: set[str] = set()
        """Names of what is left out."""
        self.kept: dict[str, list[int]] = {}
        self.data = dict(data)
        whole = {path[0] for path in broken
                 if path and (len(path) == 1 or path[0] not in LISTS)}
        for key in whole:
            self.data.pop(str(key), None)
            if key in LISTS:
                self.assumed.add("*")
        for key in LISTS:
            entries = self.data.get(key)
            if not isinstance(entries, list):
                continue
            out = {path[1] for path in broken if len(path) == 2 and path[0] == key}
            self.kept[key] = [i for i in range(len(entries)) if i not in out]
            self.data[key] = [entries[i] for i in self.kept[key]]
            self._assume([entry for i, entry in enumerate(entries) if i in out])

    def _assume(self, entries: list[Any]) -> None:
        for entry in entries:
            name = entry.get("name") if isinstance(entry, dict) else None
            self.assumed.add(name if isinstance(name, str) else "*")

    def located(self, finding: Finding) -> Finding:
        """The same finding with its path in the whole data."""
        path = finding.path
        if len(path) > 1 and path[0] in self.kept and isinstance(path[1], int):
            path = (path[0], self.kept[str(path[0])][path[1]], *path[2:])
        return Finding(finding.message, path, finding.allowed, finding.hint, finding.key)


class _Relocation:
    """From a path of the mechanism to the path of the scene that led to it."""

    def __init__(self, mechanism: Mechanism, scene: Scene) -> None:
        self.mechanism, self.scene = mechanism, scene
        self.own = {id(element): (kind, i) for kind in MECHANISM_LISTS
                    for i, element in enumerate(getattr(scene, kind))}
        self.named = {(kind, element.name): i for kind in MECHANISM_LISTS
                      for i, element in enumerate(getattr(scene, kind))
                      if hasattr(element, "name")}

    def __call__(self, finding: Finding) -> Finding:
        """The finding with its path in the scene; of a part, the part's path."""
        kind, index = (*finding.path, "", "")[:2]
        if kind not in MECHANISM_LISTS or not isinstance(index, int):
            return finding
        element = getattr(self.mechanism, str(kind))[index]
        name = getattr(element, "name", "")
        if id(element) in self.own:
            path: JsonPath = (*self.own[id(element)], *finding.path[2:])
            return Finding(finding.message, path, finding.allowed, finding.hint)
        parts = [i for i, part in enumerate(self.scene.parts)
                 if name == part.name or name.startswith(f"{part.name}.")]
        if parts:
            where = max(parts, key=lambda i: len(self.scene.parts[i].name))
            return Finding(f"{quoted(name)}: {finding.message}", ("parts", where),
                           finding.allowed, finding.hint)
        if (kind, name) in self.named:
            return Finding(finding.message,
                           (kind, self.named[str(kind), name], *finding.path[2:]),
                           finding.allowed, finding.hint)
        return Finding(finding.message, ("parts",), finding.allowed, finding.hint)


def _as_finding(problem: Problem) -> Finding:
    return Finding(problem.message, parse_path(problem.path), problem.allowed, problem.hint)


def _twice(scene: Scene, rest: _Rest) -> Iterable[Finding]:
    """Parts that share a name."""
    first: dict[str, int] = {}
    for i, part in enumerate(scene.parts):
        if part.name in first:
            other = path_text(("parts", rest.kept["parts"][first[part.name]]))
            yield rest.located(Finding(
                f"the name {quoted(part.name)} is taken by {other}", ("parts", i, "name"),
                "a name of its own for every part"))
        first.setdefault(part.name, i)


def _newer_format(data: dict[str, Any]) -> Iterable[Finding]:
    given = data.get("format")
    if isinstance(given, int) and not isinstance(given, bool) and given > FORMAT:
        yield Finding(f"this scene has format {given}; this version of sandbox reads "
                      f"format {FORMAT}", ("format",))


