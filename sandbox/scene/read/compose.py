"""Composition of a scene, before validation: ``like``, ``repeat`` and ``include`` are expanded.

The result is plain data, of limited nesting and size, with the place of each piece.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from sandbox.elements.element import LISTS
from sandbox.errors import SceneError
from sandbox.scene.document import ASSEMBLED, KEYS
from sandbox.scene.read import scopes
from sandbox.scene.read.limits import Limits, over
from sandbox.scene.read.origins import Composed, Origin, RefusedError
from sandbox.scene.read.scopes import Scope, resolved_tables
from sandbox.scene.read.source import Library, SceneSource
from sandbox.values.numbers import number_from
from sandbox.values.paths import JsonPath, parse_path
from sandbox.wording import WrongValueError, kind_of, listed, near, quoted, refuse_if

WORDS = ("like", "repeat", "include")
ENTRY_WORDS = ("like", "repeat")  # keys that no composed entry has
ASSEMBLY_WORDS = (*WORDS, "parameters")  # keys that no composed assembly has
COMPOSED_LISTS = (*LISTS, "parts", "materials")
CONTAINER_SIZE = 40  # characters that an object or a list counts for in the size of the result
DEEPEST_LIKE = 32  # maximum length of a chain of templates that are like one another


class TooLargeError(Exception):
    """The result exceeds a limit: its problem, or nothing for its size."""


@dataclass(frozen=True)
class Context:
    """A piece of data: its place, its path in the result, and the names that apply to it."""

    place: Origin
    trail: JsonPath
    scope: Scope
    files: tuple[Path, ...] = ()  # files that include one another, down to the file of this piece

    def to(self, step: str | int, place: Origin) -> Context:
        """The context of a child at a place."""
        return replace(self, place=place, trail=(*self.trail, step))


def compose(source: SceneSource, data: dict[str, Any], parameters: scopes.Parameters) -> Composed:
    """Compose a scene's data, which may differ from its file's by overrides."""
    root = Origin(replace(source, data=data))
    made = Composed(data, root)
    if any(_has_words(data.get(key)) for key in COMPOSED_LISTS):
        tables = data.get("tables")
        scope = Scope(parameters.values, tables=resolved_tables(tables, parameters.values))
        home = (source.path.resolve(),) if source.path is not None else ()
        composer = _Composer(made, Library(source), source.limits, root,
                             dict(tables) if isinstance(tables, dict) else {})
        composer.scene(data, Context(root, (), scope, home))
        made.files = tuple(composer.library.read)
    return made


def _has_words(value: Any) -> bool:
    if isinstance(value, dict):
        return any(word in value for word in WORDS) or (
            value.get("type") == "assembly" and "parameters" in value) or any(
                map(_has_words, value.values()))
    return isinstance(value, list) and any(map(_has_words, value))


def merged(entry: Any, at: Context, places: Composed, inside: tuple[str, ...] = ()) -> Any:
    """An entry with the keys of the templates that it is like.

    Objects are merged key by key; lists and numbers are replaced as a whole. A template may itself
    be like another one: ``inside`` are those so far. ``places`` notes where each key was written.
    """
    if not isinstance(entry, dict) or "like" not in entry:
        return entry
    known, name = at.place.source.data.get("templates"), entry["like"]
    known = known if isinstance(known, dict) else {}
    with at.place.to("like").refusing():
        refuse_if(not isinstance(name, str), "'like' is the name of a template, not "
                  f"{kind_of(name)}", "bad-template")
        if name in inside or len(inside) >= DEEPEST_LIKE:
            raise WrongValueError("circular-definition", "templates are like one another: "
                                  f"{' → '.join([*inside, name])}")
        if name not in known:
            raise WrongValueError(
                "bad-template", f"there is no template {quoted(name)}",
                allowed=listed(known) or "none: the scene has no templates",
                hint=places.near(name, known))
    home = replace(at.place, path=("templates", name))
    with home.refusing():
        refuse_if(not isinstance(known[name], dict), f"the template {quoted(name)} is "
                  f"{kind_of(known[name])}, not an object {{…}}", "bad-template")
    below = merged(known[name], replace(at, place=home), places, (*inside, name))
    return _over(entry, at.place, below, home, places)


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
    """Composes lists and their entries."""

    made: Composed
    library: Library
    limits: Limits
    top: Origin  # the entry of the scene's own lists that is composed
    tables: dict[str, Any]  # tables of the scene, and of included files under names of their own
    shared: dict[str, str] = field(default_factory=dict)
    """Names of included tables by their content."""
    size: int = 0  # characters of the result, approximately

    def scene(self, data: Mapping[str, Any], at: Context) -> None:
        """All lists of a scene; other keys are left as they are."""
        out = self.made.data = dict(data)
        try:
            for key in COMPOSED_LISTS:
                if isinstance(data.get(key), (list, dict)):
                    self.put(out, data[key], at.to(key, at.place.to(key)))
        except TooLargeError as error:
            self.made.failed = True
            self.made.problems += error.args or [self.top.problem(
                "limit-exceeded", "spelled out, the scene is larger than the limit 'file_bytes' "
                f"of {self.limits.file_bytes} bytes",
                allowed="a larger one when the limit is raised")]
        if self.shared:
            self.made.put(out, "tables", at.place.to("tables"))
            out["tables"] = self.tables

    def put(self, container: Any, value: Any, at: Context) -> None:
        self.made.put(container, at.trail[-1], at.place)
        container[at.trail[-1]] = self.value(value, at)

    def value(self, value: Any, at: Context) -> Any:
        """A value with the scope's names replaced."""
        holds = isinstance(value, (dict, list))
        self.size += len(value) if isinstance(value, str) else CONTAINER_SIZE if holds else 2
        if self.size > self.limits.file_bytes:
            raise TooLargeError
        if len(at.trail) > self.limits.nesting:
            raise TooLargeError(at.place.problem(
                "limit-exceeded", f"spelled out, this is nested deeper than the limit 'nesting' of "
                f"{self.limits.nesting}"))
        if isinstance(value, str):
            with at.place.refusing():
                return at.scope.text(value)
        if isinstance(value, dict):
            return self.object({}, value, at)
        return self.entries(value, at) if holds else value

    def object(
        self, out: dict[str, Any], value: Mapping[str, Any], at: Context,
        left_out: Collection[str] = (),
    ) -> dict[str, Any]:
        """Compose an object, without some keys, into another one; its materials like templates."""
        for key, entry in value.items():
            if key in left_out:
                continue
            self.size += len(key)
            inner = at.to(key, self.made.at(value, key, at.place))
            try:
                if at.scope.braces and "{" in key:
                    with inner.place.refusing(key=True):
                        inner = at.to(at.scope.text(key), inner.place)
                if at.trail[-1] == "materials":
                    entry = merged(entry, inner, self.made)
                self.put(out, entry, inner)
            except RefusedError as error:
                self.refuse(error, inner.trail)
                out[str(inner.trail[-1])] = {}
        return out

    def entries(self, items: list[Any], at: Context) -> list[Any]:
        """A list with each of its entries merged, repeated and included."""
        out: list[Any] = []
        for number, item in enumerate(items):
            here = at.to(len(out), at.place.to(number))
            if len(at.trail) == 1:
                self.top = here.place
            try:
                if isinstance(item, dict):
                    self.copies(out, merged(item, here, self.made), here)
                else:
                    self.append(out, self.value(item, here), here.place)
            except RefusedError as error:
                self.refuse(error, (*at.trail, len(out)))
                name = item.get("name") if isinstance(item, dict) and "repeat" not in item else None
                named = isinstance(name, str) and "{" not in name
                self.append(out, {"name": name} if named else {}, here.place)
        return out

    def copies(self, out: list[Any], item: dict[str, Any], at: Context) -> None:
        if "repeat" not in item:
            self.append(out, self.entry(item, at), at.place)
            return
        place = self.made.at(item, "repeat", at.place)
        repeat = scopes.read_repeat(item["repeat"], at.scope, self.limits, place)
        among = next((str(step) for step in reversed(at.trail) if isinstance(step, str)), "")
        limit = "bodies" if among in ("bodies", "parts") else "elements"
        for problem in over(self.limits, limit, len(out) + len(repeat.rows), "$",
                            f"with these copies there are {{count}} {among or 'entries'}"):
            raise TooLargeError(place.located(problem))
        known = len(self.made.problems)
        for number, names in enumerate(repeat.rows):
            name, value = next(iter(names.items()))
            label = f"{name} = {value if isinstance(value, str) else format(value, 'g')}"
            scope = at.scope.naming(names, braces=True)
            here = replace(
                at, trail=(*at.trail[:-1], len(out)), scope=scope, place=replace(
                    at.place, copy=f"{at.place.copy}, {label}" if at.place.copy else label))
            entry = self.entry(item, here)
            if len(self.made.problems) > known:  # the other copies would have the same
                raise RefusedError(at.place, [])
            if isinstance(entry, dict):
                with place.refusing():
                    moved = repeat.moved(entry, number, among, scope)
                self.made.moved[id(moved)] = moved, self.made.of(entry)
                entry = moved
            self.append(out, entry, here.place)

    def entry(self, item: dict[str, Any], at: Context) -> Any:
        if "each" in item and "repeat" in item:
            return self.value(item["each"], replace(at, place=self.made.at(item, "each", at.place)))
        if at.trail[-2:-1] == ("parts",):
            if "include" in item:
                return self.object(self.included(item, at), item, at, (*ASSEMBLY_WORDS, "type"))
            if "parameters" in item and item.get("type") == "assembly":
                scope = at.scope.naming(self.parameters(item, at), braces=False)
                return self.object({}, item, replace(at, scope=scope), ASSEMBLY_WORDS)
        return self.object({}, item, at, ENTRY_WORDS)

    def append(self, out: list[Any], value: Any, place: Origin) -> None:
        """Append an entry to a list whose indices may differ from those of the text."""
        self.made.put(out, len(out), place)
        out.append(value)

    def refuse(self, error: RefusedError, trail: JsonPath) -> None:
        """Report an entry that cannot be composed, once for all its copies."""
        self.made.broken.add(trail[:2])
        if self.made.first(error.place):
            self.made.problems += error.problems

    def parameters(
        self, item: dict[str, Any], at: Context, file: Origin | None = None,
    ) -> dict[str, float]:
        """Values of an assembly's parameters, which replace those of the file that it includes."""
        given, place = item.get("parameters", {}), self.made.at(item, "parameters", at.place)
        _check_object(given, place)
        data = file.source.data if file else {}
        defaults: Mapping[str, Any] = data.get("parameters", {})
        around, tables = ({}, resolved_tables(data.get("tables"), {}, None)) if file else (
            at.scope.known, at.scope.tables)
        places = {name: self.made.at(given, name, place) for name in given}
        problems = [places[name].problem(
            "name-not-found", f"the included scene has no parameter {quoted(name)}", key=True,
            allowed=listed(defaults) or "none", hint=near(name, defaults))
            for name in given if file and name not in defaults]
        given = {name: value for name, value in given.items() if not file or name in defaults}
        values = {name: self.parameter(name, value, at.scope, places[name], given)
                  if isinstance(value, str) else value for name, value in given.items()}
        resolved = scopes.resolve_parameters({**defaults, **around, **values}, tables)
        for problem in resolved.problems:
            path = parse_path(problem.path)
            if file is not None or path[1] in given:
                problems.append(places.get(
                    str(path[1]), (file or at.place).to(*path)).located(problem))
        if problems:
            raise RefusedError(place, problems)
        return {name: float(value) for name, value in resolved.values.items()
                if name in defaults or name in given}

    def parameter(
        self, name: str, text: str, scope: Scope, place: Origin, given: Mapping[str, Any],
    ) -> Any:
        """The number of a parameter's text if names around the assembly suffice; else the text."""
        outside = {k: v for k, v in scope.known.items() if k == name or k not in given}
        values = {k: v for k, v in scope.values.items() if k in outside or isinstance(v, str)}
        with place.refusing():
            filled = replace(scope, values=values).text(text)
        try:
            return float(number_from(filled, None, {**outside, **scope.tables}))
        except ValueError:
            return filled  # reads other parameters of the assembly, or is invalid

    def included(self, item: dict[str, Any], at: Context) -> dict[str, Any]:
        place, name = self.made.at(item, "include", at.place), item["include"]
        with place.refusing():
            refuse_if(item.get("type", "assembly") != "assembly", "only an assembly includes a "
                      "scene", "bad-include", allowed='"type": "assembly", or no type')
            path = self.library.find(at.scope.text(name) if isinstance(name, str) else name)
            refuse_if(path in at.files, "a scene that includes itself has no end: "
                      + " → ".join(each.name for each in (*at.files, path)), "bad-include")
            try:
                source = self.library.open(path)
            except SceneError as error:
                raise RefusedError(place, [
                    replace(each, message=f"{each.message} ({place.including})")
                    for each in error.problems]) from None
        root, data = Origin(source, included=place.including, copy=at.place.copy), source.data
        for key in (key for key in data if key not in KEYS):
            self.refuse(RefusedError(root.to(key), [root.to(key).problem(
                "unknown-key", f"unknown key {quoted(key)}", key=True, allowed=", ".join(KEYS),
                hint=near(key, KEYS))]), at.trail)
        tables = data.get("tables")
        _check_object(data.get("parameters", {}), root.to("parameters"))
        given = self.parameters(item, at, root)
        scope = Scope(tables=resolved_tables(tables, given), renamed={}).naming(given, braces=False)
        inner = Context(root, at.trail, scope, (*at.files, path))
        if tables is not None:
            _check_object(tables, root.to("tables"))
            inner = replace(inner, scope=replace(scope, renamed=self.renamed(
                tables, str(item.get("name", "")), inner)))
        out: dict[str, Any] = {"type": "assembly"}
        self.made.put(out, "type", at.place)
        for key in ASSEMBLED:
            if key in data and key not in item:
                self.put(out, data[key], inner.to(key, root.to(key)))
        return out

    def renamed(self, tables: Mapping[str, Any], assembly: str, at: Context) -> dict[str, str]:
        """Add the tables of a file to the scene's, equal ones once; their new names."""
        words = re.findall("[A-Za-z0-9]+", assembly)[:8]
        prefix = "_".join(words if words and not words[0][0].isdigit() else ["included", *words])
        found: dict[str, str] = {}
        known = len(self.made.problems)
        for table, entry in tables.items():
            place = at.place.to("tables", table)
            value = self.value(entry, at.to("tables", place).to(table, place))
            if len(self.made.problems) > known:
                raise RefusedError(place, [])
            key = f"{place.source.name} {table} {json.dumps(value)}"
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
        refuse_if(not isinstance(value, dict), f"expected an object {{…}}, got {kind_of(value)}",
                  "wrong-type")
