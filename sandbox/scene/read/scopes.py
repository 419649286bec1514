"""Names in a piece of a scene: parameters, tables, the index of a ``repeat`` and its copies."""

from __future__ import annotations

import contextlib
import math
import re
from collections import ChainMap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from graphlib import TopologicalSorter
from typing import Annotated, Any

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    ValidationInfo,
)

from sandbox.errors import Problem
from sandbox.scene.bodies import SHAPES
from sandbox.scene.geometry import to_world
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.origins import Origin, RefusedError
from sandbox.values import expressions as ex
from sandbox.values.messages import explain
from sandbox.values.numbers import Coordinate, Pair, number_from, parameters_of
from sandbox.values.paths import parse_path, path_text
from sandbox.values.spec import Spec
from sandbox.values.tables import NamedTable, function_of
from sandbox.wording import WrongValueError, kind_of, listed, quoted, refuse_if

_BRACES = re.compile(r"\{\{|\}\}|\{([^{}]*)\}")
IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
PLACEHOLDER = 1.0
"""Replaces a parameter without a value, so that the rest of the scene can be checked."""


@dataclass(frozen=True)
class Scope:
    """The names that texts of a piece may use."""

    parameters: Mapping[str, float] = field(default_factory=dict)
    """The file's own, SI: they stay in expressions, but can be read here."""
    values: Mapping[str, float | str] = field(default_factory=dict)
    """Numbers replace their names in expressions; words, of a repeat's list, only in braces."""
    tables: Mapping[str, Any] = field(default_factory=dict)  # the file's, by their calls
    renamed: Mapping[str, str] | None = None
    """Of an included file: the names that its tables have in the scene."""
    braces: bool = False  # whether {i} has a meaning, as inside a repeat

    @cached_property
    def numbers(self) -> dict[str, float]:
        """The values that are numbers."""
        return {name: value for name, value in self.values.items() if not isinstance(value, str)}

    @property
    def known(self) -> dict[str, float]:
        """Every number that has a name here."""
        return {**self.parameters, **self.numbers}

    def naming(self, values: Mapping[str, float | str], *, braces: bool) -> Scope:
        """The scope inside, with more names, which hide those of the same name around it."""
        return replace(self, braces=self.braces or braces, values={**self.values, **values})

    def text(self, text: str) -> str:
        """A text with the scope's values in it."""
        if self.braces and ("{" in text or "}" in text):
            text = _BRACES.sub(self._filled, text)
        if not ex.is_expression(text) or not (self.values or self.renamed is not None):
            return text
        try:
            expression = ex.parse_expression(text)
        except WrongValueError:
            return text  # validation reports it
        if self.renamed is not None:
            expression.check_tables(self.tables)
        if not (expression.names & set(self.numbers) or
                (self.renamed is not None and expression.tables)):
            return text
        return f"={expression.bind(self.numbers, self.renamed or {}).text}"

    def _filled(self, match: re.Match[str]) -> str:
        inner = match.group(1)
        if inner is None:
            return match.group()[0]  # two braces are one
        if isinstance(word := self.values.get(inner.strip()), str):
            return word
        known, expression = self.known, ex.parse_expression(inner)
        for name in sorted(expression.names.difference(known)):
            raise ex.unknown_name(name, {**known, **self.values})
        value = float(expression.evaluate({**self.tables, **known}))
        return str(int(value)) if value == int(value) and abs(value) < 1e15 else f"{value:g}"


def check_name(name: Any, what: str, parameters: Mapping[str, float]) -> None:
    """Check a name that expressions are to read."""
    means = "the time" if name == "t" else "a constant, a function or a word of expressions"
    refuse_if(isinstance(name, str) and name in ex.RESERVED, f"{quoted(name)} cannot be the name "
              f"of {what}: it already means {means}", "invalid-name")
    refuse_if(not isinstance(name, str) or not IDENTIFIER.fullmatch(name) or "__" in name
              or len(name) > 100, f"{quoted(name)} is not the name of {what}", "invalid-name",
              allowed="a letter, then letters, digits and single _")
    refuse_if(name in parameters, f"the name {quoted(name)} is that of a parameter already",
              "duplicate-name", allowed='another one for the index: "index": "j"')


@dataclass
class Parameters:
    """Values (SI) of a scene's parameters; ``failed`` are those that only have a placeholder."""

    values: dict[str, float] = field(default_factory=ex.NamedValues)
    failed: set[str] = field(default_factory=set)
    problems: list[Problem] = field(default_factory=list)

    def reads_failed(self, text: object) -> bool:
        """Whether a text is an expression of a failed parameter, which may be a reserved word."""
        if not isinstance(text, str) or not self.failed:
            return False
        try:
            names = ex.parse_expression(text).names
        except ValueError:  # a parameter named by a keyword of Python makes it invalid
            names = frozenset()
        return not self.failed.isdisjoint(names | (ex.RESERVED & set(IDENTIFIER.findall(text))))


def resolve_parameters(raw: Mapping[str, Any], tables: Mapping[str, Any]) -> Parameters:
    """The values of ``{"pull": "15 N", "each": "=pull / 4"}``; a cycle is named.

    They may call ``tables``; those that are None there read parameters themselves.
    """
    found, known, reads = Parameters(), ex.NamedValues(), dict[str, list[str]]()
    values = ChainMap(found.values, {
        name: each for name, each in tables.items() if each is not None})

    @contextlib.contextmanager
    def refusing(name: str, *, key: bool = False) -> Iterator[None]:
        try:
            yield
        except WrongValueError as error:
            if key or not found.reads_failed(raw[name]):
                found.problems.append(Problem.of(error, path_text(("parameters", name)), key=key))
            found.failed.add(name)

    for name, value in raw.items():
        with refusing(name, key=True):
            check_name(name, "a parameter", {})
            known[name] = value
    for name, value in known.items():
        reads[name] = []
        with refusing(name):
            expression = ex.parse_expression(value) if ex.is_expression(value) else None
            reads[name] = sorted(expression.names) if expression else []
            for table in sorted(expression.tables) if expression else ():
                refuse_if(tables.get(ex.call(table), table) is None, f"the table {quoted(table)} "
                          "reads parameters itself, so no parameter can use it", "invalid-name",
                          allowed="a table of plain numbers")
    for ring in ex.rings({name: [each for each in needed if each in known]
                          for name, needed in reads.items()}):
        start = ring.index(next(name for name in known if name in ring))
        ring = [*ring[start:], *ring[:start], ring[start]]
        with refusing(ring[0]):
            refuse_if(ring, f"parameters that depend on each other: {' → '.join(ring)}",
                      "circular-definition")
        found.failed.update(ring)
    for name in TopologicalSorter({name: () if name in found.failed else needed
                                   for name, needed in reads.items()}).static_order():
        if name not in known or name in found.failed:
            continue
        with refusing(name):
            for needed in reads[name]:
                if needed not in known and needed not in found.failed:
                    raise ex.unknown_name(needed, known, but=name)
            if found.failed.isdisjoint(reads[name]):
                found.values[name] = number_from(known[name], None, values)
            else:
                found.failed.add(name)
    found.values = ex.NamedValues({name: found.values.get(name, PLACEHOLDER) for name in known})
    return found


def resolved_tables(
    raw: Any, parameters: Mapping[str, float], invalid: Any = np.ones_like,
) -> dict[str, Any]:
    """All tables by their calls, ``invalid`` for each that is invalid; validation reports it."""
    found: dict[str, Any] = {}
    for name, entry in raw.items() if isinstance(raw, dict) else ():
        try:
            table = NamedTable.model_validate(entry, context={"parameters": parameters})
            found[ex.call(name)] = function_of(table)
        except ValidationError:
            found[ex.call(name)] = invalid
    return found


WITH_POSITION = ("bodies", "parts", *SHAPES, "guides")
"""Lists whose entries have a position, so that a line or circle can move them."""
Names = dict[str, float | str]


def _index(name: str, info: ValidationInfo) -> str:
    refuse_if(name == info.data.get("index"), f"the name {quoted(name)} is that of the index, "
              "which counts the entries", "duplicate-name",
              allowed='another name, or another "index"')
    check_name(name, "an index", (info.context or {})["own"])
    return name


def _word(value: Any, info: ValidationInfo) -> float | str:
    """A number, or a word for names."""
    if isinstance(value, str) and value.isidentifier():
        return value
    return float(number_from(value, None, parameters_of(info)))


def _count(value: Any, info: ValidationInfo) -> int:
    count, shown, maximum = 0.0, kind_of(value), (info.context or {})["maximum"]
    try:
        count = number_from(value, "ratio", parameters_of(info))
        shown = f"{count:.6g}"
    except WrongValueError:
        if ex.is_expression(value):
            raise
    refuse_if(count != int(count) or count < 1, f"{shown} is not a number of copies", "bad-repeat",
              allowed=f"a whole number from 1 to {maximum}, an expression of parameters that gives "
              "one, or an object with 'count' or 'list'")
    refuse_if(count > maximum, f"{shown} copies are more than a scene may have elements",
              "limit-exceeded",
              allowed=f"at most {maximum} (the limit 'elements', raised by --limit elements=N)")
    return int(count)


IndexName = Annotated[str, AfterValidator(_index)]
Word = Annotated[Any, BeforeValidator(_word, json_schema_input_type=float | str)]
Row = Annotated[
    Annotated[dict[IndexName, Word], Tag("row")] | Annotated[Word, Tag("value")],
    Discriminator(lambda value: "row" if isinstance(value, dict) else "value")]


class Repeat(Spec):
    """Copies of an entry, with names that have a value in each of them."""

    index: IndexName = Field(default="i", validate_default=True)
    """Name of the index; i by default."""
    count: Annotated[int | None, BeforeValidator(
        _count, json_schema_input_type=Annotated[int, Field(ge=1)] | str)] = None
    """Number of copies; the index counts them from 0."""
    entries: Annotated[tuple[Row, ...] | None, Field(alias="list", min_length=1)] = None
    """A value of the index for each copy, or an object of names and values."""
    line: Pair[Coordinate] | None = None
    """From one copy to the next [m]."""
    circle: Pair[Coordinate] | None = None
    """Centre of the circle that the copies go round [m]."""

    def _verify(self) -> None:
        refuse_if(None not in (self.line, self.circle), "'line' and 'circle' exclude each other",
                  "bad-repeat")
        refuse_if((self.count is None) == (self.entries is None),
                  "a repeat needs either 'count' or 'list'", "bad-repeat")

    @property
    def rows(self) -> list[Names]:
        """The names and values of each copy."""
        return [{self.index: float(i), **row} if isinstance(row, dict) else {self.index: row}
                for i, row in enumerate(self.entries or map(float, range(self.count or 0)))]

    def moved(self, entry: dict[str, Any], number: int, among: str, scope: Scope) -> dict[str, Any]:
        """A copy of an entry, moved along the line or round the circle."""
        if self.line is None and self.circle is None:
            return entry
        refuse_if(among not in WITH_POSITION, f"an entry of {quoted(among)} has no position, so it "
                  "cannot have 'line' or 'circle'", "bad-repeat", allowed="entries of "
                  f"{listed(WITH_POSITION)}; others use the index in their names")
        refuse_if("path" in entry, "a body with a path is not moved by a line or circle",
                  "bad-repeat", allowed="the body in an assembly, and that repeated")
        copies = self.count or len(self.entries or ())
        turn = math.tau * number / copies if self.circle is not None else 0.0
        keys: tuple[str, ...] = ("at",)
        if among in SHAPES and ("points" in entry or "end" in entry):
            keys = ("points",) if "points" in entry else ("start", "end")
        known = scope.known
        result = entry | {key: self._point(entry.get(key, [0, 0]), number, turn, known)
                          for key in keys}
        if turn and (among in ("bodies", "parts") or entry.get("type") == "box"):
            with contextlib.suppress(ValueError):  # the models refuse it
                result["angle"] = number_from(entry.get("angle", 0.0), "angle", known) + turn
        return result

    def _point(self, value: Any, number: int, turn: float, known: Mapping[str, float]) -> Any:
        """A point or a list of points; anything else is left for the models to refuse."""
        if not isinstance(value, list) or not value:
            return value
        if isinstance(value[0], list):
            return [self._point(point, number, turn, known) for point in value]
        try:
            x, y = (number_from(each, "length", known) for each in value)
        except ValueError:
            return value
        if self.circle is not None:
            cx, cy = self.circle
            x, y = to_world((cx, cy, turn), (x - cx, y - cy))
        if self.line is not None:
            x, y = x + number * self.line[0], y + number * self.line[1]
        return [x, y]


def read_repeat(value: Any, scope: Scope, limits: Limits, place: Origin) -> Repeat:
    """Read the value of a ``repeat``; a number is that of the copies, counted by ``i``."""
    given = value if isinstance(value, dict) else {"count": value}
    try:
        return Repeat.model_validate(given, context={
            "parameters": scope.known, "own": scope.parameters, "maximum": limits.elements})
    except ValidationError as error:
        raise RefusedError(place, [
            (place.to(*parse_path(problem.path)) if given is value else place).located(problem)
            for problem in explain(error, given, Repeat)]) from None
