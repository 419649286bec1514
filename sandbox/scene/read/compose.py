"""Composition of a scene: ``like``, ``repeat`` and ``include`` are expanded.

Composition comes before validation. Its result is plain data as a file could hold it, with the
place where each piece was written. Limits of elements, nesting and a file's size apply on the way.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NoReturn

from sandbox.elements.element import LISTS
from sandbox.errors import Problem, SceneError
from sandbox.scene.document import ASSEMBLED, KEYS
from sandbox.scene.read.includes import Library
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.origins import Composed, Origin, OriginMap
from sandbox.scene.read.repeat import Copies, RepeatError, read_repeat
from sandbox.scene.read.scopes import (
    Parameters,
    Scope,
    others_of,
    plain_tables,
    resolve_parameters,
    resolved_tables,
    unknown_key,
)
from sandbox.scene.read.source import SceneSource
from sandbox.scene.read.templates import Context, LikeError, inside_template, merge_templates
from sandbox.values.numbers import number_from
from sandbox.values.paths import JsonPath, parse_path
from sandbox.wording import NearMisses, WrongValueError, kind_of, listed, near, quoted

WORDS = ("like", "repeat", "include")
ENTRY_WORDS = ("like", "repeat")
"""Keys that no composed entry has."""
ASSEMBLY_WORDS = (*ENTRY_WORDS, "include", "parameters")
"""Keys that no composed assembly has."""
COMPOSED_LISTS = (*LISTS, "parts", "materials")
CONTAINER_SIZE = 40
"""Characters that an object or a list counts for in the size of the result."""


class TooLargeError(Exception):
    """The result exceeds a limit; the reason is among the problems."""


def compose(
    source: SceneSource, data: dict[str, Any], parameters: Parameters, limits: Limits,
) -> Composed:
    """Compose a scene's data, which may differ from its file's by overrides."""
    root = Origin(source)
    places = OriginMap(root)
    if not any(_has_words(data.get(key)) for key in COMPOSED_LISTS):
        return Composed(data, places)
    composer = _Composer(Library(source, limits), limits, places)
    home = (source.path.resolve(),) if source.path is not None else ()
    tables = data.get("tables")
    scope = Scope(parameters.values, tables=resolved_tables(tables, parameters.values))
    composer.tables = dict(tables) if isinstance(tables, dict) else {}
    context = Context(scope, data.get("templates"), root.to("templates"), home)
    out = composer.scene(data, root, context)
    return Composed(out, places, composer.problems, composer.broken, composer.failed,
                    tuple(composer.library.read))


def _has_words(value: Any) -> bool:
    waiting = [value]
    while waiting:
        each = waiting.pop()
        if isinstance(each, dict):
            if any(word in each for word in WORDS) or (
                    each.get("type") == "assembly" and "parameters" in each):
                return True
            waiting.extend(each.values())
        elif isinstance(each, list):
            waiting.extend(entry for entry in each if isinstance(entry, (dict, list)))
    return False


@dataclass
class _Composer:
    """Composes lists and their entries. ``trail`` is the path of a value in the result."""

    library: Library
    limits: Limits
    places: OriginMap
    problems: list[Problem] = field(default_factory=list)
    broken: set[JsonPath] = field(default_factory=set)
    failed: bool = False
    near: NearMisses = field(default_factory=NearMisses)
    size: int = 0
    """Characters of the result, approximately."""
    copies_made: int = 0
    """Entries that repeat, like and include have led to."""
    tables: dict[str, Any] = field(default_factory=dict)
    """Tables of the scene, and of included files under names of their own."""
    shared: dict[str, str] = field(default_factory=dict)
    """Names of included tables by their content."""

    # -- values -----------------------------------------------------------------------

    def scene(self, data: Mapping[str, Any], place: Origin, context: Context) -> dict[str, Any]:
        """All lists of a scene; other keys are left as they are."""
        out = dict(data)
        try:
            for key in COMPOSED_LISTS:
                if isinstance(data.get(key), (list, dict)):
                    self.put(out, key, data[key], place.to(key), context, (key,))
        except TooLargeError:
            self.failed = True
            if not self.problems:
                self.too_large(place)
        if self.shared:
            self.places.put(out, "tables", place.to("tables"))
            out["tables"] = self.tables
        return out

    def put(
        self, container: Any, step: str | int, value: Any, place: Origin, context: Context,
        trail: JsonPath,
    ) -> None:
        """Compose a value into a container."""
        self.places.put(container, step, place)
        container[step] = self.value(value, place, context, trail)

    def value(self, value: Any, place: Origin, context: Context, trail: JsonPath) -> Any:
        """A value with the scope's names replaced."""
        self.grow(CONTAINER_SIZE if isinstance(value, (dict, list)) else 2)
        if len(trail) > self.limits.nesting:
            self.problems.append(place.problem(
                "limit-exceeded", f"spelled out, this is nested deeper than the limit 'nesting' of "
                f"{self.limits.nesting}"))
            raise TooLargeError
        if isinstance(value, str):
            return self.text(value, place, context, trail)
        if isinstance(value, dict):
            make = self.materials if trail[-1] == "materials" else self.object
            return make(value, place, context, trail)
        if isinstance(value, list):
            return self.entries(value, place, context, trail)
        return value

    def text(
        self, text: str, place: Origin, context: Context, trail: JsonPath = (),
    ) -> str | None:
        """A text with the scope's names replaced; None, and a broken entry, if that fails."""
        self.grow(len(text))
        try:
            return context.scope.text(text)
        except WrongValueError as error:
            self.report(place, error)
            if trail:
                self.broken.add(trail[:2])
            return None

    def object(
        self, value: Mapping[str, Any], place: Origin, context: Context, trail: JsonPath,
        left_out: Collection[str] = (),
    ) -> dict[str, Any]:
        """An object without some keys."""
        out: dict[str, Any] = {}
        for key, entry in value.items():
            if key in left_out:
                continue
            self.grow(len(key))
            at, name = self.places.at(value, key, place), key
            if context.scope.braces and "{" in key:
                name = str(self.text(key, at, context, trail))
            self.put(out, name, entry, at, context, (*trail, name))
        return out

    def materials(
        self, value: Mapping[str, Any], place: Origin, context: Context, trail: JsonPath,
    ) -> dict[str, Any]:
        """Materials by their names, each perhaps like a template."""
        out: dict[str, Any] = {}
        for name, entry in value.items():
            at, below = self.places.at(value, name, place), (*trail, name)
            try:
                merged = self.merged(entry, at, context)
            except LikeError as error:
                self.problems.append(error.problem)
                self.broken.add(below)
                out[name] = {}
                continue
            self.put(out, name, merged, at, context, below)
        return out

    def merged(self, entry: Any, place: Origin, context: Context) -> Any:
        """An entry with the keys of the templates that it is like."""
        if not isinstance(entry, dict) or "like" not in entry:
            return entry
        return merge_templates(entry, place, context.templates, context.home, self.places,
                               self.near, context.inside)

    # -- entries of lists -------------------------------------------------------------

    def entries(
        self, items: list[Any], place: Origin, context: Context, trail: JsonPath,
    ) -> list[Any]:
        """A list with each of its entries merged, repeated and included."""
        out: list[Any] = []
        for number, item in enumerate(items):
            here = place.to(number)
            if not isinstance(item, dict):
                if len(out) != number:
                    self.places.put(out, len(out), here)
                out.append(self.value(item, here, context, (*trail, len(out))))
                continue
            inner = inside_template(here, context)
            known, grows = len(self.problems), any(word in item for word in WORDS)
            try:
                if grows:
                    self.count(here)
                self.copies(out, self.merged(item, here, inner), here, inner, trail)
            except LikeError as error:
                self.problems.append(error.problem)
                self.leave_out(out, item, here, trail)
            except TooLargeError:
                if grows and len(self.problems) == known:
                    self.too_large(here)
                raise
        return out

    def copies(
        self, out: list[Any], item: dict[str, Any], here: Origin, context: Context,
        trail: JsonPath,
    ) -> None:
        """Append all copies of an entry."""
        if "repeat" not in item:
            self.append(out, self.entry(item, here, context, (*trail, len(out))), here)
            return
        place = self.places.at(item, "repeat", here)
        try:
            repeat = read_repeat(item["repeat"], context.scope, self.limits)
        except RepeatError as error:
            self.report(place.to(*error.path), error.error, key=error.key)
            self.leave_out(out, item, here, trail)
            return
        among = next((str(step) for step in reversed(trail) if isinstance(step, str)), "")
        self.check_length(len(out) + len(repeat.rows), among, place)
        known = len(self.problems)
        for number, names in enumerate(repeat.rows):
            self.count(place)
            label = repeat.label(number)
            at = replace(here, copy=f"{here.copy}, {label}" if here.copy else label)
            scope = context.scope.naming(names, braces=True)
            entry = self.entry(item, at, replace(context, scope=scope), (*trail, len(out)))
            try:
                moved = self.moved(entry, replace(repeat, scope=scope), number, among)
            except WrongValueError as error:
                self.report(place, error)
            if len(self.problems) > known:  # the other copies would have the same
                self.leave_out(out, {}, here, trail)
                return
            self.append(out, moved, at)

    def moved(self, entry: Any, repeat: Copies, number: int, among: str) -> Any:
        """A copy at its own position; the places of its values stay."""
        if not isinstance(entry, dict):
            return entry
        moved = repeat.moved(entry, number, among)
        self.places.copy(entry, moved)
        return moved

    def entry(self, item: dict[str, Any], here: Origin, context: Context, trail: JsonPath) -> Any:
        """One copy of an entry."""
        if "each" in item and "repeat" in item:
            return self.value(item["each"], self.places.at(item, "each", here), context, trail)
        part = len(trail) > 1 and trail[-2] == "parts"
        if part and "include" in item:
            return self.included(item, here, context, trail)
        if part and "parameters" in item and item.get("type") == "assembly":
            given = self.parameters(item, here, context, {})
            if given is None:
                self.broken.add(trail)
                return {"name": item["name"]} if "name" in item else {}
            scope = context.scope.naming(given, braces=False)
            return self.object(item, here, replace(context, scope=scope), trail, ASSEMBLY_WORDS)
        return self.object(item, here, context, trail, ENTRY_WORDS)

    # -- assemblies -------------------------------------------------------------------

    def parameters(
        self, item: dict[str, Any], here: Origin, context: Context, defaults: Mapping[str, Any],
        tables: Any = None,
    ) -> dict[str, float] | None:
        """Values of an assembly's parameters, which replace those of the scene that it includes.

        Args:
            item: the assembly.
            here: where it was written.
            context: around it.
            defaults: parameters of the included scene.
            tables: of the included scene, as they are written.

        Returns:
            None if there is a problem.
        """
        given, at = item.get("parameters", {}), self.places.at(item, "parameters", here)
        if not isinstance(given, dict):
            self.problems.append(at.problem(
                "wrong-type", f"expected an object {{…}}, got {kind_of(given)}"))
            return None
        place = {name: self.places.at(given, name, at) for name in given}
        includes, before = "include" in item, len(self.problems)
        values: dict[str, Any] = {} if includes else dict(context.scope.known)
        if includes:
            for name in [name for name in given if name not in defaults]:
                self.problems.append(place[name].problem(
                    "name-not-found", f"the included scene has no parameter {quoted(name)}",
                    key=True, allowed=listed(defaults) or "none", hint=near(name, defaults)))
            given = {name: value for name, value in given.items() if name in defaults}
        for name, value in given.items():
            values[name] = (self.parameter(name, value, place[name], context, given)
                            if isinstance(value, str) else value)
        plain = plain_tables(tables) if includes else context.scope.tables
        resolved = resolve_parameters({**defaults, **values}, plain, others_of(tables, plain))
        for problem in resolved.problems:
            name = str(parse_path(problem.path)[1])
            if name in given:
                self.problems.append(place[name].located(problem))
        if len(self.problems) > before:
            return None
        return {name: float(value) for name, value in resolved.values.items()
                if name in defaults or name in given}

    def parameter(
        self, name: str, text: str, place: Origin, context: Context, given: Mapping[str, Any],
    ) -> Any:
        """The number of a parameter's text if names around the assembly suffice; else the text."""
        outside = {k: v for k, v in context.scope.known.items() if k == name or k not in given}
        scope = replace(context.scope, numbers={
            k: v for k, v in context.scope.numbers.items() if k in outside})
        filled = self.text(text, place, replace(context, scope=scope))
        try:
            return float(number_from(filled, None, {**outside, **context.scope.tables}))
        except ValueError:
            return filled  # of parameters beside it, or wrong

    def included(
        self, item: dict[str, Any], here: Origin, context: Context, trail: JsonPath,
    ) -> dict[str, Any]:
        """An assembly with the content of a file, under the entry's own keys."""
        place, known = self.places.at(item, "include", here), len(self.problems)
        out: dict[str, Any] = {"type": "assembly"}
        self.places.put(out, "type", here)
        try:
            if item.get("type", "assembly") != "assembly":
                raise WrongValueError("bad-include", "only an assembly includes a scene",
                                      allowed='"type": "assembly", or no type')
            name = item["include"]
            path = self.library.find(
                self.text(name, place, context) if isinstance(name, str) else name)
            if path in context.files:
                raise WrongValueError("bad-include", "a scene that includes itself has no end: "
                                      + " → ".join(each.name for each in (*context.files, path)))
            main = self.library.main
            source = self.library.open(
                path, str(Path(main.name).parent / path.name) if main.name else path.name)
            root = Origin(source, included=place.including, copy=here.copy)
            self.content(out, root, path, item, here, context, trail)
        except WrongValueError as error:
            self.report(place, error)
        except SceneError as error:
            note = place.including
            self.problems.extend(replace(each, message=f"{each.message} ({note})")
                                 for each in error.problems)
        if len(self.problems) > known:
            self.broken.add(trail)
            return {"name": item["name"]} if item.get("name") is not None else {}
        mine = self.object(item, here, context, trail, (*ASSEMBLY_WORDS, "type"))
        for key, entry in mine.items():
            self.places.put(out, key, self.places.moved[id(mine), key])
            out[key] = entry
        return out

    def content(
        self, out: dict[str, Any], root: Origin, path: Path, item: dict[str, Any], here: Origin,
        context: Context, trail: JsonPath,
    ) -> None:
        """Compose what an assembly has of a file."""
        data = root.source.data
        for key in data:
            if key not in KEYS:
                self.report(root.to(key), unknown_key(key, KEYS), key=True)
        defaults = data.get("parameters", {})
        if not isinstance(defaults, dict):
            self.problems.append(root.to("parameters").problem(
                "wrong-type", f"expected an object {{…}}, got {kind_of(defaults)}"))
            return
        tables = data.get("tables")
        plain = plain_tables(tables)
        own = resolve_parameters(defaults, plain, others_of(tables, plain))
        self.problems.extend(root.to(*parse_path(each.path)).located(each)
                             for each in own.problems)
        before = len(self.problems)
        given = self.parameters(item, here, context, defaults, tables)
        if given is None or own.problems or len(self.problems) > before:
            return
        scope = Scope(tables=resolved_tables(tables, given), renamed={}).naming(
            given, braces=False)
        scope = self.with_tables(scope, tables, root, item.get("name"), context)
        inner = Context(scope, data.get("templates"), root.to("templates"), (*context.files, path))
        for key in ASSEMBLED:
            if key in data and key not in item:
                self.put(out, key, data[key], root.to(key), inner, (*trail, key))

    def with_tables(
        self, scope: Scope, tables: Any, root: Origin, name: Any, context: Context,
    ) -> Scope:
        """The scope of a file with its tables, which are added to the scene's under new names.

        Equal tables of several copies become one.
        """
        if tables is None:
            return scope
        if not isinstance(tables, dict):
            self.problems.append(root.to("tables").problem(
                "wrong-type", f"expected an object {{…}}, got {kind_of(tables)}"))
            return scope
        words = re.findall("[A-Za-z0-9]+", name)[:8] if isinstance(name, str) else []
        prefix = "_".join(words if words and not words[0][0].isdigit() else ["included", *words])
        renamed: dict[str, str] = {}
        for table, entry in tables.items():
            place = root.to("tables", table)
            value = self.value(entry, place, replace(context, scope=scope), ("tables", table))
            key = f"{root.source.name} {table} {json.dumps(value)}"
            if key not in self.shared:
                new = first = f"{prefix[:40]}_{table}"[:90]
                while new in self.tables:
                    new = f"{first}_{len(self.tables)}"
                self.shared[key] = new
                self.places.put(self.tables, new, place)
                self.tables[new] = value
            renamed[table] = self.shared[key]
        return replace(scope, renamed=renamed)

    # -- size and problems ------------------------------------------------------------

    def grow(self, characters: int) -> None:
        """Count characters for the limit of a file's bytes."""
        self.size += characters
        if self.size > self.limits.file_bytes:
            raise TooLargeError

    def check_length(self, count: int, among: str, place: Origin) -> None:
        """Check the length of a list before its copies are made."""
        limit = "bodies" if among in ("bodies", "parts") else "elements"
        if count > getattr(self.limits, limit):
            self.exceed(place, f"with these copies there are {count} {among or 'entries'}", limit)

    def exceed(self, place: Origin, message: str, limit: str) -> NoReturn:
        """Report that the number of elements exceeds a limit, and end the composition."""
        most = getattr(self.limits, limit)
        self.problems.append(place.problem("limit-exceeded", message, allowed=(
            f"at most {most} (the limit '{limit}', raised by --limit {limit}=N)")))
        raise TooLargeError

    def too_large(self, place: Origin) -> None:
        """Report that the result, from a place on, is larger than a file may be."""
        self.problems.append(place.problem(
            "limit-exceeded", "spelled out, the scene is larger than the limit 'file_bytes' of "
            f"{self.limits.file_bytes} bytes", allowed="a larger one when the limit is raised"))

    def count(self, place: Origin) -> None:
        """Count one more entry that a repeat or a template has led to."""
        self.copies_made += 1
        if self.copies_made > self.limits.elements:
            self.exceed(place, f"repeats and templates make more than {self.limits.elements} "
                        "copies here", "elements")

    def report(self, place: Origin, error: WrongValueError, *, key: bool = False) -> None:
        """Add a problem at a place, once for all copies of it."""
        if self.places.first(place):
            self.problems.append(place.located(Problem.of(error, "$", key=key)))

    def append(self, out: list[Any], value: Any, place: Origin) -> None:
        """Append an entry to a list whose indices may differ from those of the text."""
        self.places.put(out, len(out), place)
        out.append(value)

    def leave_out(
        self, out: list[Any], item: Mapping[str, Any], place: Origin, trail: JsonPath,
    ) -> None:
        """Append an entry in place of one that cannot be composed."""
        self.broken.add((*trail, len(out)))
        name = item.get("name")
        plainly = isinstance(name, str) and "{" not in name and "repeat" not in item
        self.append(out, {"name": name} if plainly else {}, place)
