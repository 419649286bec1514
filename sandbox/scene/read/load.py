"""From a file to a scene, or to every problem that it has.

Read the text, apply ``--set`` overrides, resolve parameters, compose, validate by the models,
expand the parts, check the mechanism. What could not be read is left out; the rest is checked.
"""

from __future__ import annotations

import json
import numbers
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from operator import getitem
from pathlib import Path
from typing import Any, TypeVar, cast

from pydantic import ValidationError

from sandbox.elements.element import LISTS as MECHANISM_LISTS
from sandbox.errors import Problem, SceneError
from sandbox.scene.check.control import check_units
from sandbox.scene.check.ranges import check_ranges
from sandbox.scene.check.references import check_references
from sandbox.scene.document import Scene
from sandbox.scene.expand import expand
from sandbox.scene.library import find_scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.compose import compose
from sandbox.scene.read.limits import Limits, check_limits, check_size
from sandbox.scene.read.origins import Composed, Origin, relocated
from sandbox.scene.read.overrides import apply_overrides
from sandbox.scene.read.scopes import Parameters, resolve_parameters, resolved_tables
from sandbox.scene.read.source import SceneSource, first_problems, read_source
from sandbox.scene.settings import RETIRED
from sandbox.values.expressions import NamedValues
from sandbox.values.messages import explain, written
from sandbox.values.paths import JsonPath, addresses, parse_path, path_text
from sandbox.values.spec import Spec
from sandbox.wording import kind_of, near, quoted

LISTS = (*MECHANISM_LISTS, "parts")
STAND_INS: dict[str, Any] = {"materials": {}, "tables": {"points": [[0, 1], [1, 1]]}}
"""Replace invalid entries, so that the rest of the scene can be checked."""
Valid = TypeVar("Valid", Scene, Mechanism)


@dataclass(frozen=True)
class Loaded:
    """A scene, its mechanism, and the position of each piece in its file."""

    scene: Scene
    mechanism: Mechanism
    origins: Composed

    @property
    def name(self) -> str:
        """The path of the file in messages; empty without one."""
        return self.origins.source.name

    @property
    def files(self) -> tuple[Path, ...]:
        """All files that the scene includes, directly or not."""
        return self.origins.files

    @property
    def derived(self) -> tuple[str, ...]:
        """The parameters that are expressions of others."""
        written = self.origins.data.get("parameters") or {}
        return tuple(name for name in self.scene.parameters
                     if isinstance(text := written.get(name), str) and text.lstrip()[:1] == "=")

    @property
    def ignored(self) -> list[Problem]:
        """Warnings about settings of older scenes, in the mechanism."""
        return [Problem("unknown-key", f"{quoted(key)} is ignored: the solver no longer has it",
                        f"$.run.{key}", key=True, severity="warning")
                for key in RETIRED if key in self.origins.data.get("run", {})]

    def placed(self, problems: Iterable[Problem]) -> list[Problem]:
        """Problems of the mechanism, each with its path, line and column in the file."""
        return [self.origins.located(each)
                for each in relocated([*problems], self.mechanism, self.scene)]


def load_scene(
    source: str | Path | Mapping[str, Any], *, overrides: Mapping[str, Any] | None = None,
    limits: Limits | None = None,
) -> Scene:
    """Load a scene from a file, or from data as a file would hold it.

    Args:
        source: a path, the name of a shipped scene (``"adaptive_grasp"``), or a mapping, which may
            hold elements of :mod:`sandbox.build`.
        overrides: values that replace those of the scene, by path:
            ``{"run.step": "1 ms", "parts[finger1].lengths[0]": 0.045}``.
        limits: how large a scene may be.

    Raises:
        SceneError: every problem of the scene, each with its place.
    """
    return read_scene(source, overrides=overrides, limits=limits).scene


def read_scene(
    source: str | os.PathLike[str] | Mapping[str, Any], *,
    overrides: Mapping[str, Any] | None = None, limits: Limits | None = None,
) -> Loaded:
    """Load a scene as :func:`load_scene` does, with its mechanism and its places in the file."""
    if limits is not None and not isinstance(limits, Limits):
        raise SceneError([Problem("bad-argument", f"{quoted(limits)} are no limits", "limits",
                                  allowed="sandbox.scene.read.limits.Limits(steps=10_000_000)")])
    limits = limits or Limits()
    if overrides is not None and not isinstance(overrides, Mapping):
        raise SceneError([Problem("bad-argument",
                                  f"{quoted(overrides)} names no values to replace", "overrides",
                                  allowed='values by their paths, such as {"run.step": "1 ms"}')])
    if isinstance(source, Mapping):
        problems: list[Problem] = []
        found = SceneSource(_plain(source, (), limits.nesting, problems), limits=limits)
        if problems:
            raise SceneError(first_problems(problems, limits.problems))
    elif isinstance(text := os.fspath(source) if isinstance(source, os.PathLike) else source, str):
        path = find_scene(text)
        found = read_source(path, limits=limits)
        # a file's name is bytes, which need not be text
        found.data.setdefault("name", os.fsencode(path.stem).decode("utf-8", "replace"))
    else:
        raise SceneError([Problem("bad-argument", f"{quoted(source)} is no scene", "source",
                                  allowed="a path, the name of a shipped scene, or a mapping with "
                                  "the content of a file")])
    return _Loading(found).scene(found.data, overrides or {})


def _plain(value: Any, path: JsonPath, nesting: int, problems: list[Problem]) -> Any:
    """A copy of Python data as a JSON file would give it."""
    if isinstance(value, (Mapping, Spec, list, tuple)) and len(path) >= nesting:
        if not problems:
            problems.append(Problem("limit-exceeded", "nested deeper than the limit 'nesting' of "
                                    f"{nesting}", path_text(path)))
        return None
    if isinstance(value, Spec):
        value = value.model_dump(by_alias=True, exclude_unset=True)
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                problems.append(Problem("wrong-type",
                                        f"a key is text, not {kind_of(key)}", path_text(path)))
        return {key: _plain(entry, (*path, key), nesting, problems)
                for key, entry in value.items() if isinstance(key, str)}
    if isinstance(value, (list, tuple)):
        return [_plain(entry, (*path, i), nesting, problems) for i, entry in enumerate(value)]
    if isinstance(value, numbers.Real) and not isinstance(value, (bool, int, float)):
        return float(value)
    return value


@dataclass
class _Loading:
    """The state of reading one scene: its problems so far, and their positions."""

    source: SceneSource
    problems: dict[Problem, None] = field(default_factory=dict)
    """In the order in which they were found, each once."""
    overridden: set[JsonPath] = field(default_factory=set)
    composed: Composed = field(init=False)
    parameters: Parameters = field(default_factory=Parameters)
    ignored: set[JsonPath] = field(default_factory=set)
    """Entries whose problems have been reported already."""

    def scene(self, data: dict[str, Any], overrides: Mapping[str, Any]) -> Loaded:
        """The scene."""
        limits = self.source.limits
        data, self.overridden, problems = apply_overrides(data, overrides, nesting=limits.nesting)
        self.problems = dict.fromkeys(problems)
        self.composed = Composed(data, Origin(self.source))
        self.stop(check_size(data, limits))
        try:
            json.dumps(data, ensure_ascii=False, default=str).encode()
        except UnicodeEncodeError as error:  # no file can hold it
            before = quoted(error.object[max(error.start - 20, 0):error.start])
            self.stop([Problem("invalid-json", f"half a character (a surrogate) after {before}")])
        if not isinstance(own := data.get("parameters", {}), dict):  # others would follow from it
            self.stop([Problem("wrong-type", f"expected an object {{…}}, got {kind_of(own)}",
                               "$.parameters")])
        self.parameters = resolve_parameters(own, resolved_tables(data.get("tables"), {}, None))
        self.report(self.parameters.problems)
        self.composed = compose(self.source, data, self.parameters)
        self.add(self.composed.problems)
        data = self.composed.data
        self.stop([] if self.composed.failed else check_size(data, limits),
                  always=self.composed.failed)
        self.ignored = set(self.composed.broken)
        values: dict[str, Any] = self.parameters.values
        if own:
            data = {**data, "parameters": dict(values)}
        if tables := resolved_tables(data.get("tables"), values):
            values = NamedValues({**values, **tables})
        scene, readable = self._validated(data, {
            "parameters": values, "folder": self.source.path and self.source.path.parent})
        mechanism = self._checked(scene, readable)
        self.stop(always=bool(self.problems))
        return Loaded(scene, mechanism, self.composed)

    def _validated(self, data: dict[str, Any], context: dict[str, Any]) -> tuple[Scene, _Readable]:
        readable = _Readable(data, self.ignored)
        try:
            scene = Scene.model_validate(data, context=context)
        except ValidationError as error:
            problems = explain(error, data, Scene)
            paths = [parse_path(problem.path) for problem in problems]
            causes = [problem for problem, path in zip(problems, paths, strict=True)
                      if path[:2] not in self.ignored and not self.parameters.reads_failed(
                          reduce(getitem, path, cast(Any, data)))]
            self.report(causes if self.problems else causes or problems)
            readable = _Readable(data, {path[:2] for path in paths} | self.ignored)
            try:
                scene = Scene.model_validate(readable.data, context=context)
            except ValidationError:
                self.stop(always=True)
                raise
        return scene, readable

    def _checked(self, scene: Scene, readable: _Readable) -> Mechanism:
        """The mechanism of a scene, after checks of parts, units, names and sizes."""
        mechanism: Mechanism = scene
        try:
            mechanism = expand(scene)
        except SceneError as error:
            self.report(readable.located(problem) for problem in error.problems
                        if not readable.assumed or problem.code == "duplicate-name")
            readable.assumed |= {part.name for part in scene.parts}
        # of a scene that is too large other checks would take too much time
        too_large = check_limits(mechanism, self.source.limits)
        faults = too_large or [
            *check_references(mechanism, assumed=readable.assumed, faulty=bool(self.problems)),
            *check_ranges(mechanism)]
        self.report(map(readable.located, relocated(faults, mechanism, scene)))
        units = [] if too_large else [*check_units(mechanism)]
        for found in map(readable.located, relocated(units, mechanism, scene)):
            path = written(self.composed.data, parse_path(found.path))  # as far as it is written
            self.report([replace(found, path=path_text(path))])
        return mechanism

    def stop(self, problems: Sequence[Problem] = (), *, always: bool = False) -> None:
        """Report problems that exclude further checks, and raise all so far, if there are any."""
        self.report(problems)
        if problems or always:
            ordered = sorted(self.problems, key=lambda each: (each.file, each.line, each.column))
            raise SceneError(first_problems(ordered, self.source.limits.problems), self.source.name)

    def report(self, problems: Iterable[Problem]) -> None:
        """Add problems of the data with their places in the file; of copies, the first one's."""
        for found in problems:
            place = self.composed.place(parse_path(found.path))
            if self.composed.first(place):
                self.add([place.located(found)])

    def add(self, problems: Iterable[Problem]) -> None:
        """Add problems that have their places; each is reported once."""
        for problem in problems:
            path = parse_path(problem.path) if self.overridden and not problem.file else ()
            if any(path[:n] in self.overridden for n in range(1, len(path) + 1)):
                hint = problem.hint
                if problem.key and not hint:
                    hint = near(str(path[-1]), addresses(self.source.data))
                problem = replace(problem, line=0, column=0, hint=hint,
                                  message=f"{problem.message} (set by an override)")
            self.problems.setdefault(problem)


class _Readable:
    """Scene data without the elements that could not be read."""

    def __init__(self, data: dict[str, Any], broken: set[JsonPath]) -> None:
        self.assumed: set[str] = set()
        """Names of the elements left out; ``*`` for one without a name."""
        self.kept: dict[str, list[int]] = {}  # for each list, the indices of the elements left in
        self.data = dict(data)
        for path in broken:
            if path and (len(path) != 2 or path[0] not in (*LISTS, *STAND_INS)):
                self.data.pop(str(path[0]), None)
                if path[0] in (*LISTS, "materials"):
                    self.assumed.add("*")
        for key in LISTS:
            if isinstance(entries := self.data.get(key), list):
                self.kept[key] = [i for i in range(len(entries)) if (key, i) not in broken]
                self.data[key] = [entries[i] for i in self.kept[key]]
                for i, entry in enumerate(entries):
                    if (key, i) in broken:
                        name = entry.get("name") if isinstance(entry, dict) else None
                        self.assumed.add(name if isinstance(name, str) else "*")
        for key, stand_in in STAND_INS.items():
            if isinstance(entries := self.data.get(key), dict):
                self.data[key] = {name: stand_in if (key, name) in broken else entry
                                  for name, entry in entries.items()}

    def located(self, problem: Problem) -> Problem:
        path = parse_path(problem.path)
        if len(path) > 1 and path[0] in self.kept and isinstance(path[1], int):
            path = (path[0], self.kept[str(path[0])][path[1]], *path[2:])
        return replace(problem, path=path_text(path))


def sound(scene: Scene | Mechanism) -> Mechanism:
    """The mechanism of a scene in Python, if it is valid; its size is not limited.

    Its values are validated again, since ``model_copy`` and ``model_construct`` validate nothing;
    its names, units and ranges are checked as those of a file.
    """
    if not isinstance(scene, Mechanism):
        raise SceneError([Problem(
            "bad-argument", f"{quoted(scene)} is no scene", "scene", allowed="a scene from "
            "sandbox.load_scene, a path, the name of a shipped scene, or a mapping")])
    validated(type(scene), _plain(
        scene.model_dump(by_alias=True, warnings=False), (), sys.maxsize, []))
    return checked(expand(scene) if isinstance(scene, Scene) else scene)


def validated(kind: type[Valid], data: dict[str, Any]) -> Valid:
    """Data as a scene or a mechanism."""
    try:
        return kind.model_validate(data, context={
            "parameters": resolved_tables(data.get("tables"), {})})
    except ValidationError as error:
        raise SceneError(explain(error, data, kind)) from None


def checked(mechanism: Mechanism) -> Mechanism:
    """The mechanism, if its units, names and ranges are right."""
    if problems := [*check_units(mechanism), *check_references(mechanism),
                    *check_ranges(mechanism)]:
        raise SceneError(problems)
    return mechanism
