"""``like``, ``repeat``, ``include``: a scene's data with what its author left unsaid written out.

It is done before anything is validated. What comes out is plain data as a file could hold it,
and for each piece of it the place where it was written. What it may come to is bounded on the
way: by the limits of elements and nesting, and by that of a file's bytes, which holds for what is
written out, too.
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
from sandbox.scene.read.includes import Library
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.origin_map import Layered, Origin, OriginMap
from sandbox.scene.read.repeat import Copies, RepeatError, read_repeat
from sandbox.scene.read.scopes import (
    Parameters,
    Scope,
    misspelt,
    others_of,
    plain_tables,
    resolve_parameters,
    resolved_tables,
)
from sandbox.scene.read.source import SceneSource
from sandbox.scene.read.templates import LikeError, layered, own, plain
from sandbox.scene.read.writing import CONTAINER, Composed, Context, TooLargeError, Trail, Writer
from sandbox.values.numbers import number_from
from sandbox.values.paths import parse_path
from sandbox.wording import WrongValueError, kind_of, listed, near, quoted

WORDS = ("like", "repeat", "include")
FOLLOWED = ("like", "repeat")
"""Keys that are gone from every entry that is spelled out."""
AWAY = (*FOLLOWED, "include", "parameters")
"""Those that are gone from an assembly."""
def compose(
    source: SceneSource, data: dict[str, Any], parameters: Parameters, limits: Limits,
) -> Composed:
    """Spell out a scene's data, which may differ from its file's by overrides."""
    root = Origin(source)
    places = OriginMap(root)
    if not any(_has_words(data.get(key)) for key in (*LISTS, "parts", "materials")):
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
class _Composer(Writer):
    """Spells out lists, entries and what they include."""

    tables: dict[str, Any] = field(default_factory=dict)
    """The scene's, and those of included files under names of their own."""
    shared: dict[str, str] = field(default_factory=dict)
    """By what an included table is, the name that it has."""

    def scene(self, data: Mapping[str, Any], place: Origin, context: Context) -> dict[str, Any]:
        """All lists of a scene; what is in none of them is left as it is."""
        out = dict(data)
        try:
            for key in (*LISTS, "parts", "materials"):
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
        trail: Trail, *, deeper: bool = False,
    ) -> None:
        """Spell out a value into a container, which may be elsewhere than it was written."""
        self.places.put(container, step, place)
        container[step] = self.value(value, place, context, trail, deeper=deeper)

    def value(
        self, value: Any, place: Origin, context: Context, trail: Trail, *, deeper: bool = False,
    ) -> Any:
        """A value with the scope's names put in; ``deeper`` says that it is layered."""
        self.grow(CONTAINER if isinstance(value, (dict, list)) else 2)
        if len(trail) > self.limits.nesting:
            self.problems.append(place.problem(
                "limit-exceeded", f"spelled out, this is nested deeper than the limit 'nesting' of "
                f"{self.limits.nesting}"))
            raise TooLargeError
        if isinstance(value, str):
            return self.text(value, place, context, trail)
        if isinstance(value, dict):
            if trail[-1] == "materials" and not deeper:
                return self.materials(value, place, context, trail)
            return self.object(value if deeper else own(value, place), context, trail)
        if isinstance(value, list):
            return self.entries(value, place, context, trail)
        return value

    def object(
        self, merged: Layered, context: Context, trail: Trail, away: Collection[str] = (),
    ) -> dict[str, Any]:
        """An object, but for some keys."""
        out: dict[str, Any] = {}
        for key, (value, place, deeper) in merged.items():
            if key in away:
                continue
            self.grow(len(key))
            if context.scope.braces and "{" in key:
                key = str(self.text(key, place, context, trail))
            self.put(out, key, value, place, context, (*trail, key), deeper=deeper)
        return out

    def materials(
        self, value: Mapping[str, Any], place: Origin, context: Context, trail: Trail,
    ) -> dict[str, Any]:
        """Materials by their names, each perhaps like a template."""
        out: dict[str, Any] = {}
        for name, entry in value.items():
            at, below = place.to(name), (*trail, name)
            if isinstance(entry, dict) and "like" in entry:
                try:
                    merged = layered(entry, at, context.templates, context.home, self.near,
                                     context.inside)
                except LikeError as error:
                    self.problems.append(error.problem)
                    self.broken.add(below)
                    out[name] = {}
                    continue
                self.put(out, name, merged, at, context, below, deeper=True)
            else:
                self.put(out, name, entry, at, context, below)
        return out

    def entries(
        self, items: list[Any], place: Origin, context: Context, trail: Trail,
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
            inner = _within(here, context)
            known, grows = len(self.problems), any(word in item for word in WORDS)
            try:
                if grows:
                    self.count(here)
                merged = (layered(item, here, inner.templates, inner.home, self.near, inner.inside)
                          if "like" in item else own(item, here))
                self.copies(out, merged, here, inner, trail)
            except LikeError as error:
                self.problems.append(error.problem)
                self.leave_out(out, item, here, trail)
            except TooLargeError:
                if grows and len(self.problems) == known:
                    self.too_large(here)
                raise
        return out

    def copies(
        self, out: list[Any], merged: Layered, here: Origin, context: Context, trail: Trail,
    ) -> None:
        """Append all that an entry stands for."""
        if "repeat" not in merged:
            self.append(out, self.entry(merged, here, context, (*trail, len(out))), here)
            return
        value, place, deeper = merged["repeat"]
        try:
            repeat = read_repeat(plain(value) if deeper else value, context.scope, self.limits)
        except RepeatError as error:
            self.tell(place.to(*error.path), error.error, key=error.key)
            self.leave_out(out, plain(merged), here, trail)
            return
        among = next((str(step) for step in reversed(trail) if isinstance(step, str)), "")
        self.few_enough(len(out) + len(repeat.rows), among, place)
        known = len(self.problems)
        for number, names in enumerate(repeat.rows):
            self.count(place)
            label = repeat.label(number)
            at = replace(here, copy=f"{here.copy}, {label}" if here.copy else label)
            scope = context.scope.naming(names, braces=True)
            inner = replace(context, scope=scope)
            entry = self.entry(_copied(merged, at.copy), at, inner, (*trail, len(out)))
            try:
                moved = self.moved(entry, replace(repeat, scope=scope), number, among)
            except WrongValueError as error:
                self.tell(place, error)
            if len(self.problems) > known:  # the other copies would have the same
                self.leave_out(out, {}, here, trail)
                return
            self.append(out, moved, at)

    def moved(self, entry: Any, repeat: Copies, number: int, among: str) -> Any:
        """The entry where it belongs; its values stay where they were written."""
        if not isinstance(entry, dict):
            return entry
        moved = repeat.moved(entry, number, among)
        for key in moved if moved is not entry else ():
            if (id(entry), key) in self.places.moved:
                self.places.put(moved, key, self.places.moved[id(entry), key])
        return moved

    def entry(self, merged: Layered, here: Origin, context: Context, trail: Trail) -> Any:
        """One copy of an entry."""
        if "each" in merged and "repeat" in merged:
            return self.value(merged["each"][0], merged["each"][1], context, trail,
                              deeper=merged["each"][2])
        part = len(trail) > 1 and trail[-2] == "parts"
        if part and "include" in merged:
            return self.included(merged, here, context, trail)
        if part and "parameters" in merged and merged.get("type", ("",))[0] == "assembly":
            given = self.parameters(merged, context, {})
            if given is None:
                self.broken.add(trail)
                return {"name": merged["name"][0]} if "name" in merged else {}
            scope = context.scope.naming(given, braces=False)
            return self.object(merged, replace(context, scope=scope), trail, AWAY)
        return self.object(merged, context, trail, FOLLOWED)

    def parameters(
        self, merged: Layered, context: Context, defaults: Mapping[str, Any], tables: Any = None,
    ) -> dict[str, float] | None:
        """Values of the parameters of an assembly, over those of the scene that it includes.

        ``tables`` are that scene's, as they are written.

        None if they cannot be told; why is among the problems.
        """
        if "parameters" not in merged:
            given: Layered = {}
        else:
            value, place, deeper = merged["parameters"]
            if not isinstance(value, dict):
                self.problems.append(place.problem(
                    "wrong-type", f"expected an object {{…}}, got {kind_of(value)}"))
                return None
            given = value if deeper else own(value, place)
        known = context.scope.known
        values: dict[str, Any] = {} if "include" in merged else dict(known)
        told = len(self.problems)
        if "include" in merged:
            for name in [name for name in given if name not in defaults]:
                self.problems.append(given[name][1].problem(
                    "name-not-found", f"the included scene has no parameter {quoted(name)}",
                    key=True, allowed=listed(defaults) or "none", hint=near(name, defaults)))
            given = {name: entry for name, entry in given.items() if name in defaults}
        for name, (value, place, _) in given.items():
            values[name] = (self.parameter(name, value, place, context, given)
                            if isinstance(value, str) else value)
        plain = plain_tables(tables) if "include" in merged else context.scope.tables
        resolved = resolve_parameters({**defaults, **values}, plain, others_of(tables, plain))
        for problem in resolved.problems:
            name = str(parse_path(problem.path)[1])
            if name in given:
                self.problems.append(given[name][1].located(problem))
        if len(self.problems) > told:
            return None
        return {name: float(value) for name, value in resolved.values.items()
                if name in defaults or name in given}

    def parameter(
        self, name: str, text: str, place: Origin, context: Context, given: Layered,
    ) -> Any:
        """A parameter's text, worked out at once where it reads what holds outside."""
        outside = {k: v for k, v in context.scope.known.items() if k == name or k not in given}
        scope = replace(context.scope, numbers={
            k: v for k, v in context.scope.numbers.items() if k in outside})
        filled = self.text(text, place, replace(context, scope=scope))
        try:
            return float(number_from(filled, None, {**outside, **context.scope.tables}))
        except ValueError:
            return filled  # of parameters beside it, or wrong

    def included(
        self, merged: Layered, here: Origin, context: Context, trail: Trail,
    ) -> dict[str, Any]:
        """An assembly of what a file holds, under the entry's own keys."""
        value, place, _ = merged["include"]
        name = merged["name"][0] if "name" in merged else None
        known = len(self.problems)
        out: dict[str, Any] = {"type": "assembly"}
        self.places.put(out, "type", here)
        try:
            if "type" in merged and merged["type"][0] != "assembly":
                raise WrongValueError("bad-include", "only an assembly includes a scene",
                                      allowed='"type": "assembly", or no type')
            value = self.text(value, place, context) if isinstance(value, str) else value
            path = self.library.find(value)
            if path in context.files:
                raise WrongValueError("bad-include", "a scene that includes itself has no end: "
                                      + " → ".join(each.name for each in (*context.files, path)))
            source = self.library.open(path, _shown(self.library.main, path))
            self.content(out, source, path, merged, here, context, trail)
        except WrongValueError as error:
            self.tell(place, error)
        except SceneError as error:
            note = _note(place)
            self.problems.extend(replace(each, message=f"{each.message} ({note})")
                                 for each in error.problems)
        if len(self.problems) > known:
            self.broken.add(trail)
            return {"name": name} if name is not None else {}
        mine = self.object(merged, context, trail, (*AWAY, "type"))
        for key, entry in mine.items():
            self.places.put(out, key, merged[key][1] if key in merged else here)
            out[key] = entry
        return out

    def with_tables(
        self, scope: Scope, tables: Any, root: Origin, merged: Layered, context: Context,
    ) -> Scope:
        """The scope of a file with its tables, which are put among the scene's.

        Equal ones of several copies are one.
        """
        if tables is None:
            return scope
        if not isinstance(tables, dict):
            self.problems.append(root.to("tables").problem(
                "wrong-type", f"expected an object {{…}}, got {kind_of(tables)}"))
            return scope
        renamed: dict[str, str] = {}
        for name, entry in tables.items():
            place = root.to("tables", name)
            inner = replace(context, scope=scope)
            value = self.value(entry, place, inner, ("tables", name))
            key = f"{root.source.name} {name} {json.dumps(value)}"
            if key not in self.shared:
                new = first = f"{_prefix(merged)}_{name}"[:90]
                while new in self.tables:
                    new = f"{first}_{len(self.tables)}"
                self.shared[key] = new
                self.places.put(self.tables, new, place)
                self.tables[new] = value
            renamed[name] = self.shared[key]
        return replace(scope, renamed=renamed)

    def content(
        self, out: dict[str, Any], source: SceneSource, path: Path, merged: Layered, here: Origin,
        context: Context, trail: Trail,
    ) -> None:
        """Spell out what an assembly has of a file."""
        root = Origin(source, included=_note(merged["include"][1]), copy=here.copy)
        data = source.data
        for key in data:
            if key not in KEYS:
                self.tell(root.to(key), misspelt(key, KEYS), key=True)
        defaults = data.get("parameters", {})
        if not isinstance(defaults, dict):
            self.problems.append(root.to("parameters").problem(
                "wrong-type", f"expected an object {{…}}, got {kind_of(defaults)}"))
            return
        plain = plain_tables(data.get("tables"))
        own_values = resolve_parameters(defaults, plain, others_of(data.get("tables"), plain))
        self.problems.extend(root.to(*parse_path(each.path)).located(each)
                             for each in own_values.problems)
        told = len(self.problems)
        given = self.parameters(merged, context, defaults, data.get("tables"))
        if given is None or own_values.problems or len(self.problems) > told:
            return
        scope = self.with_tables(
            Scope(tables=resolved_tables(data.get("tables"), given), renamed={}).naming(
                given, braces=False), data.get("tables"), root, merged, context)
        inner = Context(scope, data.get("templates"),
                         root.to("templates"), (*context.files, path))
        for key in ASSEMBLED:
            if key in data and key not in merged:
                self.put(out, key, data[key], root.to(key), inner, (*trail, key))


def _prefix(merged: Layered) -> str:
    """What the names of the tables begin with that an assembly has of its file."""
    name = merged["name"][0] if "name" in merged else None
    words = re.findall("[A-Za-z0-9]+", name)[:8] if isinstance(name, str) else []
    return "_".join(["included", *words] if not words or words[0][0].isdigit() else words)[:40]


def _within(place: Origin, context: Context) -> Context:
    """The context of what stands in a template, if that is where it stands."""
    base = context.home.path
    if place.source is not context.home.source or place.path[:len(base)] != base or \
            len(place.path) <= len(base):
        return context
    name = str(place.path[len(base)])
    if name in context.inside:
        return context
    return replace(context, inside=(*context.inside, name))


def _copied(merged: Layered, copy: str) -> Layered:
    """The same layers, as those of a copy."""
    return {key: (_copied(value, copy) if deeper else value, replace(place, copy=copy), deeper)
            for key, (value, place, deeper) in merged.items()}


def _shown(main: SceneSource, path: Path) -> str:
    """What messages call an included file: as its scene is called."""
    return str(Path(main.name).parent / path.name) if main.name else path.name


def _note(place: Origin) -> str:
    line, column = place.source.where(place.path)
    return f"included by {place.source.name}:{line}:{column}"
