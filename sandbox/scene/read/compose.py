"""Composition of a scene: ``like``, ``repeat`` and ``include`` are expanded.

Composition comes before validation. Its result is plain data as a file could hold it, with the
place where each piece was written. Nesting and size of the result are limited on the way.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from sandbox.elements.element import LISTS
from sandbox.errors import Problem, SceneError
from sandbox.scene.document import ASSEMBLED, KEYS
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.origins import Composed, Origin, RefusedError
from sandbox.scene.read.scopes import (
    Copies,
    Parameters,
    Scope,
    plain_tables,
    read_repeat,
    resolve_parameters,
    resolved_tables,
    unknown_key,
)
from sandbox.scene.read.source import Library, SceneSource
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
MOST_LIKE = 32
"""Templates that are like one another."""


class TooLargeError(Exception):
    """The result exceeds a limit: its problem, or None for its size."""

    def __init__(self, problem: Problem | None = None) -> None:
        super().__init__()
        self.problem = problem


@dataclass(frozen=True)
class Context:
    """Names, templates and files that apply to a piece of data."""

    scope: Scope
    templates: Any
    home: Origin
    """Of the templates."""
    files: tuple[Path, ...] = ()
    """Files that include one another, down to the file of this piece."""
    inside: tuple[str, ...] = ()
    """Templates that contain this piece."""

    def at(self, place: Origin) -> Context:
        """The context of an entry, which may be written inside a template."""
        base = self.home.path
        within = place.source is self.home.source and place.path[:len(base)] == base
        name = str(place.path[len(base)]) if within and len(place.path) > len(base) else ""
        return replace(self, inside=(*self.inside, name)) if name and name not in self.inside \
            else self


def compose(
    source: SceneSource, data: dict[str, Any], parameters: Parameters, limits: Limits,
) -> Composed:
    """Compose a scene's data, which may differ from its file's by overrides."""
    root = Origin(source)
    made = Composed(data, root)
    if any(_has_words(data.get(key)) for key in COMPOSED_LISTS):
        tables = data.get("tables")
        scope = Scope(parameters.values, tables=resolved_tables(tables, parameters.values))
        home = (source.path.resolve(),) if source.path is not None else ()
        composer = _Composer(made, Library(source, limits), limits, root,
                             dict(tables) if isinstance(tables, dict) else {})
        composer.scene(data, Context(scope, data.get("templates"), root.to("templates"), home))
        made.files = tuple(composer.library.read)
    return made


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


def merged(
    entry: Any, place: Origin, context: Context, places: Composed, near: NearMisses,
) -> Any:
    """An entry with the keys of the templates that it is like.

    Objects are merged key by key; lists and numbers are replaced as a whole. A template may itself
    be like another one. ``places`` notes where each key was written.

    Raises:
        RefusedError: the first name that leads nowhere.
    """
    if not isinstance(entry, dict) or "like" not in entry:
        return entry
    known = context.templates if isinstance(context.templates, dict) else {}
    name, inside = entry["like"], context.inside
    with place.to("like").refusing():
        if not isinstance(name, str):
            raise WrongValueError("bad-template",
                                  f"'like' is the name of a template, not {kind_of(name)}")
        if name in inside:
            raise WrongValueError("circular-definition", "templates are like one another: "
                                  f"{' → '.join([*inside, name])}")
        if len(inside) >= MOST_LIKE:
            raise WrongValueError("circular-definition", "templates are like one another more than "
                                  f"{MOST_LIKE} deep")
        if name not in known:
            raise WrongValueError(
                "bad-template", f"there is no template {quoted(name)}", hint=near(name, known),
                allowed=listed(known) or "none: the scene has no templates")
    home = context.home.to(name).copied(place)
    with home.refusing():
        if not isinstance(known[name], dict):
            raise WrongValueError("bad-template", f"the template {quoted(name)} is "
                                  f"{kind_of(known[name])}, not an object {{…}}")
    below = merged(known[name], home, replace(context, inside=(*inside, name)), places, near)
    return _over(entry, place, below, home, places)


def _over(
    above: Mapping[str, Any], place: Origin, below: Mapping[str, Any], home: Origin,
    places: Composed,
) -> dict[str, Any]:
    """The keys of an object over those of another one, each with its place."""
    made: dict[str, Any] = {}
    for key in {**below, **above}:
        here, there = places.at(above, key, place), places.at(below, key, home)
        if key == "like":
            continue
        if key not in above:
            made[key], here = below[key], there
        elif isinstance(above[key], dict) and isinstance(below.get(key), dict):
            made[key] = _over(above[key], here, below[key], there, places)
        else:
            made[key] = above[key]
        places.put(made, key, here)
    return made


@dataclass
class _Composer:
    """Composes lists and their entries. ``trail`` is the path of a value in the result."""

    made: Composed
    library: Library
    limits: Limits
    top: Origin
    """The entry of the scene's own lists that is composed."""
    tables: dict[str, Any]
    """Tables of the scene, and of included files under names of their own."""
    shared: dict[str, str] = field(default_factory=dict)
    """Names of included tables by their content."""
    near: NearMisses = field(default_factory=NearMisses)
    size: int = 0
    """Characters of the result, approximately."""

    # -- values -----------------------------------------------------------------------

    def scene(self, data: Mapping[str, Any], context: Context) -> None:
        """All lists of a scene; other keys are left as they are."""
        root = out = self.made.data = dict(data)
        try:
            for key in COMPOSED_LISTS:
                if isinstance(data.get(key), (list, dict)):
                    self.put(out, key, data[key], self.made.root.to(key), context, (key,))
        except TooLargeError as error:
            self.made.failed = True
            self.made.problems.append(error.problem or self.top.problem(
                "limit-exceeded", "spelled out, the scene is larger than the limit 'file_bytes' "
                f"of {self.limits.file_bytes} bytes",
                allowed="a larger one when the limit is raised"))
        if self.shared:
            self.made.put(root, "tables", self.made.root.to("tables"))
            root["tables"] = self.tables

    def put(
        self, container: Any, step: str | int, value: Any, place: Origin, context: Context,
        trail: JsonPath,
    ) -> None:
        """Compose a value into a container."""
        self.made.put(container, step, place)
        container[step] = self.value(value, place, context, trail)

    def value(self, value: Any, place: Origin, context: Context, trail: JsonPath) -> Any:
        """A value with the scope's names replaced."""
        holds = isinstance(value, (dict, list))
        self.size += len(value) if isinstance(value, str) else CONTAINER_SIZE if holds else 2
        if self.size > self.limits.file_bytes:
            raise TooLargeError
        if len(trail) > self.limits.nesting:
            raise TooLargeError(place.problem(
                "limit-exceeded", f"spelled out, this is nested deeper than the limit 'nesting' of "
                f"{self.limits.nesting}"))
        if isinstance(value, str):
            return self.text(value, place, context)
        if isinstance(value, dict):
            return self.object({}, value, place, context, trail)
        return self.entries(value, place, context, trail) if holds else value

    def text(self, text: str, place: Origin, context: Context, *, key: bool = False) -> str:
        """A text with the scope's names replaced."""
        with place.refusing(key=key):
            return context.scope.text(text)

    def object(
        self, out: dict[str, Any], value: Mapping[str, Any], place: Origin, context: Context,
        trail: JsonPath, left_out: Collection[str] = (),
    ) -> dict[str, Any]:
        """Compose an object, without some keys, into another one; its materials like templates."""
        materials = trail[-1] == "materials"
        for key, entry in value.items():
            if key in left_out:
                continue
            self.size += len(key)
            at, name = self.made.at(value, key, place), key
            try:
                if context.scope.braces and "{" in key:
                    name = self.text(key, at, context, key=True)
                if materials:
                    entry = merged(entry, at, context, self.made, self.near)
                self.put(out, name, entry, at, context, (*trail, name))
            except RefusedError as error:
                self.refuse(error, (*trail, name))
                out[name] = {}
        return out

    # -- entries of lists -------------------------------------------------------------

    def entries(
        self, items: list[Any], place: Origin, context: Context, trail: JsonPath,
    ) -> list[Any]:
        """A list with each of its entries merged, repeated and included."""
        out: list[Any] = []
        for number, item in enumerate(items):
            here = place.to(number)
            if len(trail) == 1:
                self.top = here
            try:
                if isinstance(item, dict):
                    inner = context.at(here)
                    entry = merged(item, here, inner, self.made, self.near)
                    self.copies(out, entry, here, inner, trail)
                else:
                    if len(out) != number:
                        self.made.put(out, len(out), here)
                    out.append(self.value(item, here, context, (*trail, len(out))))
            except RefusedError as error:
                self.refuse(error, (*trail, len(out)))
                self.append(out, _stand_in(item), here)
        return out

    def copies(
        self, out: list[Any], item: dict[str, Any], here: Origin, context: Context,
        trail: JsonPath,
    ) -> None:
        """Append all copies of an entry."""
        if "repeat" not in item:
            self.append(out, self.entry(item, here, context, (*trail, len(out))), here)
            return
        place = self.made.at(item, "repeat", here)
        repeat = read_repeat(item["repeat"], context.scope, self.limits, place)
        among = next((str(step) for step in reversed(trail) if isinstance(step, str)), "")
        self.check_length(len(out) + len(repeat.rows), among, place)
        known = len(self.made.problems)
        for number, names in enumerate(repeat.rows):
            label = repeat.label(number)
            at = replace(here, copy=f"{here.copy}, {label}" if here.copy else label)
            scope = context.scope.naming(names, braces=True)
            entry = self.entry(item, at, replace(context, scope=scope), (*trail, len(out)))
            if len(self.made.problems) > known:  # the other copies would have the same
                raise RefusedError(here, [])
            with place.refusing():
                moved = self.moved(entry, replace(repeat, scope=scope), number, among)
            self.append(out, moved, at)

    def moved(self, entry: Any, repeat: Copies, number: int, among: str) -> Any:
        """A copy at its own position; the places of its values stay."""
        if not isinstance(entry, dict):
            return entry
        moved = repeat.moved(entry, number, among)
        self.made.copy(entry, moved)
        return moved

    def entry(self, item: dict[str, Any], here: Origin, context: Context, trail: JsonPath) -> Any:
        """One copy of an entry."""
        if "each" in item and "repeat" in item:
            return self.value(item["each"], self.made.at(item, "each", here), context, trail)
        part = trail[-2:-1] == ("parts",)
        if part and "include" in item:
            out = self.included(item, here, context, trail)
            return self.object(out, item, here, context, trail, (*ASSEMBLY_WORDS, "type"))
        if part and "parameters" in item and item.get("type") == "assembly":
            given = self.parameters(item, here, context)
            scope = context.scope.naming(given, braces=False)
            return self.object({}, item, here, replace(context, scope=scope), trail, ASSEMBLY_WORDS)
        return self.object({}, item, here, context, trail, ENTRY_WORDS)

    def append(self, out: list[Any], value: Any, place: Origin) -> None:
        """Append an entry to a list whose indices may differ from those of the text."""
        self.made.put(out, len(out), place)
        out.append(value)

    def check_length(self, count: int, among: str, place: Origin) -> None:
        """Check the length of a list of copies."""
        limit = "bodies" if among in ("bodies", "parts") else "elements"
        if count > (most := getattr(self.limits, limit)):
            raise TooLargeError(place.problem(
                "limit-exceeded", f"with these copies there are {count} {among or 'entries'}",
                allowed=f"at most {most} (the limit '{limit}', raised by --limit {limit}=N)"))

    def refuse(self, error: RefusedError, trail: JsonPath) -> None:
        """Report an entry that cannot be composed, once for all its copies."""
        self.made.broken.add(trail[:2])
        if self.made.first(error.place):
            self.made.problems += error.problems

    # -- assemblies -------------------------------------------------------------------

    def parameters(
        self, item: dict[str, Any], here: Origin, context: Context,
        included: tuple[Origin, Mapping[str, Any], Any] | None = None,
    ) -> dict[str, float]:
        """Values of an assembly's parameters, which replace those of the scene that it includes.

        ``included`` are the place of that scene, its own parameters, and its tables.
        """
        given, at = item.get("parameters", {}), self.made.at(item, "parameters", here)
        _check_object(given, at)
        root, defaults, tables = included or (here, {}, None)
        known = {} if included else context.scope.known
        place = {name: self.made.at(given, name, at) for name in given}
        wrong = [place[name].problem(
            "name-not-found", f"the included scene has no parameter {quoted(name)}", key=True,
            allowed=listed(defaults) or "none", hint=near(name, defaults))
            for name in given if included and name not in defaults]
        given = {name: value for name, value in given.items()
                 if not included or name in defaults}
        values = {name: self.parameter(name, value, place[name], context, given)
                  if isinstance(value, str) else value for name, value in given.items()}
        resolved = resolve_parameters(
            {**defaults, **known, **values},
            plain_tables(tables) if included else context.scope.tables)
        for problem in resolved.problems:
            path = parse_path(problem.path)
            if included or path[1] in given:
                wrong.append(place.get(str(path[1]), root.to(*path)).located(problem))
        if wrong:
            raise RefusedError(at, wrong)
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
        """An assembly with the content of a file."""
        place, name = self.made.at(item, "include", here), item["include"]
        with place.refusing():
            if item.get("type", "assembly") != "assembly":
                raise WrongValueError("bad-include", "only an assembly includes a scene",
                                      allowed='"type": "assembly", or no type')
            path = self.library.find(
                self.text(name, place, context) if isinstance(name, str) else name)
            if path in context.files:
                raise WrongValueError("bad-include", "a scene that includes itself has no end: "
                                      + " → ".join(each.name for each in (*context.files, path)))
            try:
                source = self.library.open(path)
            except SceneError as error:
                raise RefusedError(place, [
                    replace(each, message=f"{each.message} ({place.including})")
                    for each in error.problems]) from None
        root, data = Origin(source, included=place.including, copy=here.copy), source.data
        for key in data:
            if key not in KEYS:
                at = root.to(key)
                problem = Problem.of(unknown_key(key, KEYS), "$", key=True)
                self.refuse(RefusedError(at, [at.located(problem)]), trail)
        tables, defaults = data.get("tables"), data.get("parameters", {})
        _check_object(defaults, root.to("parameters"))
        given = self.parameters(item, here, context, (root, defaults, tables))
        scope = Scope(tables=resolved_tables(tables, given), renamed={}).naming(given, braces=False)
        if tables is not None:
            _check_object(tables, root.to("tables"))
            scope = replace(scope, renamed=self.renamed(
                tables, root, str(item.get("name", "")), replace(context, scope=scope), trail))
        inner = Context(scope, data.get("templates"), root.to("templates"), (*context.files, path))
        out: dict[str, Any] = {"type": "assembly"}
        self.made.put(out, "type", here)
        for key in ASSEMBLED:
            if key in data and key not in item:
                self.put(out, key, data[key], root.to(key), inner, (*trail, key))
        return out

    def renamed(
        self, tables: Mapping[str, Any], root: Origin, assembly: str, context: Context,
        trail: JsonPath,
    ) -> dict[str, str]:
        """Add the tables of a file to the scene's; their new names by their own.

        Equal tables of several copies become one.
        """
        words = re.findall("[A-Za-z0-9]+", assembly)[:8]
        prefix = "_".join(words if words and not words[0][0].isdigit() else ["included", *words])
        found: dict[str, str] = {}
        known = len(self.made.problems)
        for table, entry in tables.items():
            place = root.to("tables", table)
            value = self.value(entry, place, context, (*trail, "tables", table))
            if len(self.made.problems) > known:
                raise RefusedError(place, [])
            key = f"{root.source.name} {table} {json.dumps(value)}"
            if key not in self.shared:
                new = first = f"{prefix[:40]}_{table}"[:90]
                while new in self.tables:
                    new = f"{first}_{len(self.tables)}"
                self.shared[key] = new
                self.made.put(self.tables, new, place)
                self.tables[new] = value
            found[table] = self.shared[key]
        return found


def _check_object(value: Any, place: Origin) -> None:
    with place.refusing():
        if not isinstance(value, dict):
            raise WrongValueError("wrong-type", f"expected an object {{…}}, got {kind_of(value)}")


def _stand_in(item: Any) -> dict[str, Any]:
    """An entry in place of one that cannot be composed: its name if it is plain, else nothing."""
    name = item.get("name") if isinstance(item, dict) and "repeat" not in item else None
    return {"name": name} if isinstance(name, str) and "{" not in name else {}
