"""Names that hold in a piece of a scene: parameters, tables, the index of a ``repeat``."""

from __future__ import annotations

import re
from collections import ChainMap
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from pydantic import ValidationError

from sandbox.errors import Problem
from sandbox.values.expressions import (
    RESERVED,
    Expression,
    NamedValues,
    call,
    parse_expression,
    unknown_name,
)
from sandbox.values.numbers import number_from
from sandbox.values.paths import path_text
from sandbox.values.tables import NamedTable, function_of
from sandbox.wording import WrongValueError, near, quoted

_BRACES = re.compile(r"\{\{|\}\}|\{([^{}]*)\}")
_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
MOST_DEEP = 100
"""Parameters that depend on one another."""
PLACEHOLDER = 1.0
"""Stands for a parameter without a value, so that what else is in the scene can be checked."""
STAND_IN = {"points": [[0, 1], [1, 1]]}
"""For a table that is wrong, so that what else is in the scene can be checked."""


@dataclass(frozen=True)
class Scope:
    """The names that texts of a piece may use."""

    parameters: Mapping[str, float] = field(default_factory=dict)
    """The file's own, SI: they stay in expressions, but can be read here."""
    numbers: Mapping[str, float] = field(default_factory=dict)
    """Put in expressions for their names."""
    words: Mapping[str, str] = field(default_factory=dict)
    """Entries of a repeat's list that are no numbers; for braces only."""
    tables: Mapping[str, Any] = field(default_factory=dict)
    """The file's, by their calls."""
    renamed: Mapping[str, str] | None = None
    """Of a file that is included: from its tables' names to those that they have in the scene."""
    braces: bool = False
    """Whether ``{i}`` means something: inside a ``repeat`` it does."""

    @property
    def known(self) -> dict[str, float]:
        """Every number that has a name here."""
        return {**self.parameters, **self.numbers}

    def naming(self, values: Mapping[str, float | str], *, braces: bool) -> Scope:
        """The scope inside, with more names, before those of the same name around it."""
        words = {name: value for name, value in values.items() if isinstance(value, str)}
        numbers = {name: value for name, value in values.items() if not isinstance(value, str)}
        return replace(
            self, braces=self.braces or braces,
            words={**{k: v for k, v in self.words.items() if k not in numbers}, **words},
            numbers={**{k: v for k, v in self.numbers.items() if k not in words}, **numbers})

    def text(self, text: str) -> str:
        """A text with the scope's values in it.

        Raises:
            WrongValueError: braces that hold no known name.
        """
        if self.braces and ("{" in text or "}" in text):
            text = _BRACES.sub(self._filled, text)
        if not text.lstrip().startswith("=") or not (
                self.numbers or self.words or self.renamed is not None):
            return text
        try:
            expression = parse_expression(text)
        except WrongValueError:
            return text  # validation reports it
        self._check_numbers(expression)
        if self.renamed is not None:
            expression.check_tables(self.tables)
        if not (expression.names & set(self.numbers) or
                (self.renamed is not None and expression.tables)):
            return text
        return f"={expression.bind(self.numbers, self.renamed).text}"

    def _check_numbers(self, expression: Expression) -> None:
        for name in sorted(expression.names & set(self.words)):
            raise WrongValueError("bad-expression", f"{quoted(name)} is text; an expression needs "
                                  "numbers", allowed=f"{{{name}}} inside of a name")

    def _filled(self, match: re.Match[str]) -> str:
        inner = match.group(1)
        if inner is None:
            return match.group()[0]  # two braces are one
        if inner.strip() in self.words:
            return self.words[inner.strip()]
        known, expression = self.known, parse_expression(inner)
        self._check_numbers(expression)
        for name in sorted(expression.names.difference(known)):
            raise unknown_name(name, {**known, **self.words})
        value = float(expression.evaluate({**self.tables, **known}))
        return str(int(value)) if value == int(value) and abs(value) < 1e15 else f"{value:g}"


def check_name(name: Any, what: str, parameters: Mapping[str, float]) -> None:
    """Check a name that expressions are to read.

    Raises:
        WrongValueError: it is no name, or has another meaning already.
    """
    if isinstance(name, str) and name in RESERVED:
        means = "the time" if name == "t" else "a constant, a function or a word of expressions"
        raise WrongValueError("invalid-name", f"{quoted(name)} cannot be the name of {what}: it "
                              f"already means {means}")
    if not isinstance(name, str) or not _IDENTIFIER.fullmatch(name) or "__" in name or (
            len(name) > 100):
        raise WrongValueError("invalid-name", f"{quoted(name)} is not the name of {what}",
                              allowed="a letter, then letters, digits and single _")
    if name in parameters:
        raise WrongValueError("duplicate-name", f"the name {quoted(name)} is that of a parameter "
                              "already", allowed='another one for the index: "index": "j"')


def unknown_key(key: str, known: tuple[str, ...]) -> WrongValueError:
    """The refusal of a key that is none of those known."""
    return WrongValueError("unknown-key", f"unknown key {quoted(key)}", allowed=", ".join(known),
                           hint=near(key, known))


@dataclass
class Parameters:
    """Values (SI) of a scene's parameters; ``failed`` are those that only have a placeholder."""

    values: dict[str, float] = field(default_factory=NamedValues)
    failed: set[str] = field(default_factory=set)
    problems: list[Problem] = field(default_factory=list)
    unreadable: bool = False
    """Whether the scene's ``parameters`` are not even an object."""

    def reads_failed(self, text: object) -> bool:
        """Whether a text is an expression of a parameter that failed.

        One that is called as a constant or a function is none of the names that it reads.
        """
        if not isinstance(text, str) or not (self.failed or self.unreadable):
            return False
        try:
            names = parse_expression(text).names
        except ValueError:  # a word of Python that was to be a parameter makes it none
            names = frozenset()
        words = names | (RESERVED & set(_IDENTIFIER.findall(text)))
        return bool(names if self.unreadable else words & self.failed)


def resolve_parameters(raw: Any, tables: Mapping[str, Any]) -> Parameters:
    """The values of ``{"pull": "15 N", "each": "=pull / 4"}``; a cycle is named.

    They may call ``tables``, except those that read parameters themselves, which are None there.
    What is not an object gives nothing: the models refuse it.
    """
    found = Parameters(unreadable=raw is not None and not isinstance(raw, dict))
    known = NamedValues()
    for name, value in raw.items() if isinstance(raw, dict) else ():
        try:
            check_name(name, "a parameter", {})
            known[name] = value
        except WrongValueError as error:
            found.problems.append(Problem.of(error, path_text(("parameters", name)), key=True))
            found.failed.add(name)
    for name in known:
        _resolve(name, known, found, [], tables)
    return found


def _resolve(
    name: str, raw: Mapping[str, Any], found: Parameters, chain: list[str],
    tables: Mapping[str, Any],
) -> None:
    """Find one value, after those that it reads; ``chain`` leads from the first one to it."""
    if name in found.values:
        return
    value, failed = raw[name], True
    known: Mapping[str, Any] = found.values
    try:
        if name in chain:
            cycle = " → ".join([*chain[chain.index(name):], name])
            raise WrongValueError("circular-definition",
                                  f"parameters that depend on each other: {cycle}")
        if len(chain) > MOST_DEEP:
            raise WrongValueError("circular-definition", "parameters depend on each other more "
                                  f"than {MOST_DEEP} deep")
        if isinstance(value, str) and value.lstrip().startswith("="):
            expression = parse_expression(value)
            for table in sorted(expression.tables):
                known = ChainMap(found.values, dict(tables))
                if tables.get(call(table), table) is None:
                    raise WrongValueError(
                        "invalid-name", f"the table {quoted(table)} reads parameters itself, so "
                        "no parameter can use it", allowed="a table of plain numbers")
            for needed in sorted(expression.names):
                if needed in raw:
                    _resolve(needed, raw, found, [*chain, name], tables)
                elif needed not in found.failed:
                    raise unknown_name(needed, raw, but=name)
        if name in found.values:
            return  # it was part of a cycle, reported where the cycle closed
        number = number_from(value, None, known)
        failed = found.reads_failed(value)
    except WrongValueError as error:
        number = PLACEHOLDER
        if not found.reads_failed(value):
            found.problems.append(Problem.of(error, path_text(("parameters", name))))
    found.values[name] = number
    if failed:
        found.failed.add(name)


def can_name(name: str) -> bool:
    """Whether a table may have a name."""
    try:
        check_name(name, "a table", {})
    except WrongValueError:
        return False
    return True


def plain_tables(raw: Any) -> dict[str, Any]:
    """The tables by their calls that parameters may call; None for those that read parameters."""
    return {call(name): None if _reads(entry) else _function(entry, {})
            for name, entry in _entries(raw)}


def resolved_tables(raw: Any, parameters: Mapping[str, float]) -> dict[str, Any]:
    """All tables by their calls, a constant for each that is wrong; validation reports it."""
    return {call(name): _function(entry, parameters) for name, entry in _entries(raw)}


def _entries(raw: Any) -> list[tuple[str, Any]]:
    return list(raw.items()) if isinstance(raw, dict) else []


def _reads(value: Any) -> bool:
    if isinstance(value, (dict, list)):
        return any(map(_reads, value.values() if isinstance(value, dict) else value))
    return isinstance(value, str) and value.lstrip().startswith("=")


def _function(entry: Any, parameters: Mapping[str, float]) -> Any:
    try:
        return function_of(NamedTable.model_validate(entry, context={"parameters": parameters}))
    except ValidationError:
        return np.ones_like
