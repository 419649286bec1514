"""Named parameters: numbers, quantities, or expressions of each other in any order."""

from __future__ import annotations

import re
from collections import ChainMap
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from sandbox.errors import Problem
from sandbox.values.expressions import (
    RESERVED,
    Expression,
    NamedValues,
    parse_expression,
    unknown_name,
)
from sandbox.values.numbers import number_from
from sandbox.values.paths import path_text
from sandbox.wording import WrongValueError, quoted

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
    """Find one value, after those that it reads; ``chain`` leads from the first one asked for."""
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
