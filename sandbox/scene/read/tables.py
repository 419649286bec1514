"""Named tables before a scene is validated: what numbers are worked out with on the way."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from pydantic import ValidationError

from sandbox.errors import Problem
from sandbox.scene.mechanism import Mechanism
from sandbox.values.expressions import RESERVED, call, parse_expression
from sandbox.values.spec import Spec
from sandbox.values.tables import NamedTable, function_of
from sandbox.wording import WrongValueError

STAND_IN = {"points": [[0, 1], [1, 1]]}
"""For a table that is wrong, so that what else is in the scene can be checked."""


def plain_tables(raw: Any) -> dict[str, Any]:
    """The tables that read no parameters, by their calls: parameters may call these.

    One that is wrong is stood in for by a constant; the models say what is wrong with it.
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
