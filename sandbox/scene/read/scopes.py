"""Names that hold in a piece of a scene: the index of a ``repeat``, parameters of an assembly."""

from __future__ import annotations

import re
from collections import ChainMap
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from pydantic import ValidationError

from sandbox.errors import Problem
from sandbox.scene.mechanism import Mechanism
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
from sandbox.values.spec import Spec
from sandbox.values.tables import NamedTable, function_of
from sandbox.wording import WrongValueError, near, quoted

_BRACES = re.compile(r"\{\{|\}\}|\{([^{}]*)\}")
_NAME = re.compile(r"[A-Za-z]\w*")


@dataclass(frozen=True)
class Scope:
    """What texts of a piece may name."""

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
        for name in sorted(expression.names & set(self.words)):
            raise WrongValueError("bad-expression", f"{quoted(name)} is text; an expression needs "
                                  "numbers", allowed=f"{{{name}}} inside of a name")
        if self.renamed is not None:
            expression.check_tables(self.tables)
        if not (expression.names & set(self.numbers) or
                (self.renamed is not None and expression.tables)):
            return text
        return f"={expression.bind(self.numbers, self.renamed).text}"

    def _filled(self, match: re.Match[str]) -> str:
        inner = match.group(1)
        if inner is None:
            return match.group()[0]  # two braces are one
        if inner.strip() in self.words:
            return self.words[inner.strip()]
        known = self.known
        expression = parse_expression(inner)
        for name in sorted(expression.names):
            if name in self.words:
                raise WrongValueError("bad-expression",
                                      f"{quoted(name)} is text; an expression needs numbers")
            if name not in known:
                raise unknown_name(name, {**known, **self.words})
        value = float(expression.evaluate({**self.tables, **known}))
        return str(int(value)) if value == int(value) and abs(value) < 1e15 else f"{value:g}"


def wrong_index(name: Any, scope: Scope, reserved: frozenset[str]) -> WrongValueError | None:
    """Why a name cannot be that of an index, or None."""
    if not isinstance(name, str) or not _NAME.fullmatch(name) or "__" in name or len(name) > 100:
        return WrongValueError("invalid-name", f"{quoted(name)} is not the name of an index",
                               allowed="a letter, then letters, digits and single _")
    if name in reserved:
        means = "the time" if name == "t" else "a constant, a function or a word of expressions"
        return WrongValueError("invalid-name",
                               f"{quoted(name)} cannot be an index: it already means {means}")
    if name in scope.parameters:
        return WrongValueError("duplicate-name", f"the name {quoted(name)} is that of a parameter "
                               "already", allowed='another one for the index: "index": "j"')
    return None


def unknown_key(key: str, known: tuple[str, ...]) -> WrongValueError:
    """The refusal of a key that is none of those known."""
    return WrongValueError("unknown-key", f"unknown key {quoted(key)}", allowed=", ".join(known),
                           hint=near(key, known))


PLACEHOLDER = 1.0
"""Stands for a parameter without a value, so that what else is in the scene can be checked."""
_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@dataclass
class Parameters:
    """Values (SI) of a scene's parameters; ``failed`` are those that only have a placeholder."""

    values: dict[str, float] = field(default_factory=NamedValues)
    failed: set[str] = field(default_factory=set)
    problems: list[Problem] = field(default_factory=list)
    tables: Mapping[str, Any] = field(default_factory=dict)
    """Those that parameters may call, by their calls."""
    others: Collection[str] = ()
    """Names of those that they may not."""
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


def resolve_parameters(
    raw: Any, tables: Mapping[str, Any] | None = None, others: Collection[str] = (),
) -> Parameters:
    """The values of ``{"pull": "15 N", "each": "=pull / 4"}``; a cycle is named.

    They may call ``tables``; ``others`` are the names of tables that read parameters themselves.

    What is not an object gives nothing: the models refuse it.
    """
    parameters = Parameters(tables=tables or {}, others=others)
    if not isinstance(raw, dict):
        parameters.unreadable = raw is not None
        return parameters
    known = NamedValues({name: raw[name] for name in raw if _named(name, parameters)})
    for name in known:
        _resolve(name, known, parameters, [])
    return parameters


def _named(name: str, parameters: Parameters) -> bool:
    if name in RESERVED:
        means = "the time" if name == "t" else "a constant, a function or a word of expressions"
        parameters.problems.append(Problem("invalid-name", f"{quoted(name)} cannot be a "
                                           f"parameter's name: it already means {means}",
                                           path_text(("parameters", name)), key=True))
    elif not _IDENTIFIER.fullmatch(name) or "__" in name or len(name) > 100:
        parameters.problems.append(Problem(
            "invalid-name",
            f"{quoted(name)} is not a parameter's name", path_text(("parameters", name)),
            allowed="a letter, then letters, digits and single _", key=True))
    else:
        return True
    parameters.failed.add(name)
    return False


def _callable(expression: Expression, parameters: Parameters) -> Mapping[str, Any]:
    """What an expression of a parameter may read: the values so far, tables if it calls one."""
    if not expression.tables:
        return parameters.values
    for name in sorted(expression.tables.intersection(parameters.others)):
        raise WrongValueError("invalid-name", f"the table {quoted(name)} reads parameters itself, "
                              "so no parameter can use it", allowed="a table of plain numbers")
    return ChainMap(parameters.values, dict(parameters.tables))


def _resolve(
    name: str, raw: Mapping[str, Any], parameters: Parameters, chain: list[str]
) -> None:
    """Find one value, after those that it reads; ``chain`` leads from the first one to it."""
    if name in parameters.values:
        return
    value, failed = raw[name], True
    known: Mapping[str, Any] = parameters.values
    try:
        if name in chain:
            cycle = " → ".join([*chain[chain.index(name):], name])
            raise WrongValueError("circular-definition",
                                  f"parameters that depend on each other: {cycle}")
        if len(chain) > 100:
            raise WrongValueError("circular-definition",
                                  "parameters depend on each other more than 100 deep")
        if isinstance(value, str) and value.lstrip().startswith("="):
            expression = parse_expression(value)
            known = _callable(expression, parameters)
            for needed in sorted(expression.names):
                if needed in raw:
                    _resolve(needed, raw, parameters, [*chain, name])
                elif needed not in parameters.failed:
                    raise unknown_name(needed, raw, but=name)
        if name in parameters.values:
            return  # it was part of a cycle, reported where the cycle closed
        number = number_from(value, None, known)
        failed = parameters.reads_failed(value)
    except WrongValueError as error:
        number = PLACEHOLDER
        if not parameters.reads_failed(value):
            parameters.problems.append(Problem.of(error, path_text(("parameters", name))))
    parameters.values[name] = number
    if failed:
        parameters.failed.add(name)


STAND_IN = {"points": [[0, 1], [1, 1]]}
"""For a table that is wrong, so that what else is in the scene can be checked."""


def plain_tables(raw: Any) -> dict[str, Any]:
    """The tables that read no parameters, by their calls: parameters may call these.

    A wrong table is replaced by a constant; validation reports it.
    """
    return {call(name): _function(entry, {}) for name, entry in _entries(raw)
            if not _reads(entry)}


def can_name(name: str) -> bool:
    """Whether a table may have a name."""
    return re.fullmatch("[A-Za-z][A-Za-z0-9_]{,99}", name) is not None and (
        name not in RESERVED and "__" not in name)


def others_of(raw: Any, plain: Mapping[str, Any]) -> list[str]:
    """Names of the tables that are not among the plain ones."""
    return [name for name, _ in _entries(raw) if call(name) not in plain]


def resolved_tables(raw: Any, parameters: Mapping[str, float]) -> dict[str, Any]:
    """All tables by their calls, a constant for each that is wrong."""
    return {call(name): _function(entry, parameters) for name, entry in _entries(raw)}


def check_tables(mechanism: Mechanism) -> list[Problem]:
    """Expressions that call what is no table, of a mechanism that was not read from a file."""
    return [problem for kind in type(mechanism).model_fields
            for problem in _called(getattr(mechanism, kind), mechanism.functions, f"$.{kind}")]


def _entries(raw: Any) -> list[tuple[str, Any]]:
    return list(raw.items()) if isinstance(raw, dict) else []


def _reads(value: Any) -> bool:
    if isinstance(value, dict):
        return any(map(_reads, value.values()))
    if isinstance(value, list):
        return any(map(_reads, value))
    return isinstance(value, str) and value.lstrip().startswith("=")


def _function(entry: Any, parameters: Mapping[str, float]) -> Any:
    try:
        return function_of(NamedTable.model_validate(entry, context={"parameters": parameters}))
    except ValidationError:
        return np.ones_like


def _called(value: Any, known: Mapping[str, Any], path: str) -> list[Problem]:
    if isinstance(value, str):
        if not value.startswith("=") or "(" not in value:
            return []
        try:
            parse_expression(value).check_tables(known)
        except WrongValueError as error:
            return [Problem.of(error, path)]
        return []
    if isinstance(value, Spec):
        return [problem for name in type(value).model_fields
                for problem in _called(getattr(value, name), known, f"{path}.{name}")]
    if isinstance(value, tuple) and not (value and isinstance(value[0], float)):
        return [problem for i, entry in enumerate(value)
                for problem in _called(entry, known, f"{path}[{i}]")]
    return []
