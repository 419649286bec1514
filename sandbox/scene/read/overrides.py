"""``--set path=value``: a scene's data with some of its values replaced."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Mapping
from typing import Any

from sandbox.errors import Problem
from sandbox.scene.read.compose import Context, merged
from sandbox.scene.read.origins import Composed, Origin, RefusedError
from sandbox.scene.read.positions import half_character
from sandbox.scene.read.scopes import Scope
from sandbox.scene.read.source import SceneSource
from sandbox.values.paths import JsonPath, holds, parse_path
from sandbox.values.units import dimension_of, unit_in, units_of
from sandbox.wording import NearMisses, WrongValueError, kind_of, listed, near, quoted

CLOSED = ("parameters", "templates")
"""Objects whose keys are the author's own, so that a new one can only be a slip."""
_NOWHERE = Origin(SceneSource({}))


def apply_overrides(
    data: dict[str, Any], overrides: Mapping[str, Any], *, nesting: int = 32
) -> tuple[dict[str, Any], set[JsonPath], list[Problem]]:
    """A copy of ``data`` with the overrides, the paths they set, and their problems.

    A list's item is chosen by its index or its name: ``bodies[disc].mass``. A
    value given as text is JSON if it parses, else the text itself.
    """
    if not overrides:
        return data, set(), []
    result, paths, problems = _copy(data), set(), []
    for text, value in overrides.items():
        try:
            if not isinstance(text, str):
                raise WrongValueError("bad-override", "it is not the text of a path")
            steps, new = parse_path(text), _value(value, nesting)
            if steps[:1] == ("parameters",):
                _same_dimension(result, steps, new)
            written = json.dumps([*steps, new], default=str, skipkeys=True, ensure_ascii=False)
            if half := half_character(written):
                raise WrongValueError("invalid-json", half)
            paths.add(_set(result, steps, new))
        except WrongValueError as wrong:
            problems.append(Problem(wrong.code, f"cannot set {quoted(text)}: {wrong.message}",
                                    allowed=wrong.allowed, hint=wrong.hint))
    return result, paths, problems


def _copy(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copy(entry) for key, entry in value.items()}
    return [_copy(entry) for entry in value] if isinstance(value, list) else value


def _value(value: Any, nesting: int) -> Any:
    if not isinstance(value, str):
        return value
    if sum(map(value.count, "[{")) > 10 * nesting:
        raise WrongValueError("limit-exceeded", "the value has too many brackets")
    try:
        return json.loads(value, parse_constant=lambda constant: constant)
    except ValueError:
        return value


def _set(data: dict[str, Any], path: JsonPath, value: Any) -> JsonPath:
    """Set one value; the path with names turned into indices."""
    if not path:
        raise WrongValueError("bad-override", "the whole scene cannot be replaced")
    holder: Any = data
    taken: list[str | int] = []
    for step, following in zip(path, (*path[1:], None), strict=True):
        step = _key(holder, step, taken)
        taken.append(step)
        if following is None:
            holder[step] = value
            break
        if isinstance(holder, dict) and step not in holder:
            holder[step] = _inherited(data, taken) if isinstance(following, int) else {}
        holder = holder[step]
    return tuple(taken)


def _same_dimension(data: dict[str, Any], path: JsonPath, value: Any) -> None:
    """Check that a parameter has the dimension that it has in the scene's file.

    Raises:
        WrongValueError: both have units, of different dimensions.
    """
    own = data.get("parameters")
    before, after = (unit_in(each) for each in (
        own.get(path[1]) if isinstance(own, dict) and len(path) == 2 else None, value))
    if before and after and dimension_of(before) != dimension_of(after):
        raise WrongValueError("wrong-unit", f"{quoted(after)} is a unit of {dimension_of(after)}, "
                              f"and {quoted(path[1])} is in {quoted(before)}",
                              allowed=", ".join(units_of(dimension_of(before))))


def _inherited(data: dict[str, Any], taken: list[str | int]) -> Any:
    """A copy of the list that an element has from its template.

    Raises:
        WrongValueError: there is no such list.
    """
    value: Any = data
    for depth, step in enumerate(taken):
        value = value[step] if holds(value, step) else None
        if depth == 1 and isinstance(value, dict):
            context = Context(Scope(), data.get("templates"), _NOWHERE)
            with contextlib.suppress(RefusedError):  # reading the scene reports it
                value = merged(value, _NOWHERE, context, Composed({}, _NOWHERE), NearMisses())
    if not isinstance(value, list):
        raise WrongValueError("bad-override", f"there is no list {quoted(taken[-1])} there")
    return _copy(value)


def _key(holder: Any, step: str | int, taken: list[str | int]) -> str | int:
    """The key or index that ``step`` means in ``holder``."""
    if isinstance(holder, dict):
        return _key_of_object(holder, str(step), taken)
    if not isinstance(holder, list):
        raise WrongValueError("bad-override", f"{quoted(taken[-1])} is {kind_of(holder)} and has "
                              f"no {quoted(step)} in it")
    if isinstance(step, int):
        if step < len(holder):
            return step
        raise WrongValueError(
            "bad-override", f"{quoted(taken[-1])} has no entry {step}",
            allowed=f"0 to {len(holder) - 1}" if holder else "none, the list is empty")
    names = {entry["name"]: i for i, entry in enumerate(holder)
             if isinstance(entry, dict) and isinstance(entry.get("name"), str)}
    if step in names:
        return names[step]
    raise WrongValueError("bad-override", f"nothing in {quoted(taken[-1])} is named {quoted(step)}",
                          allowed=listed(names) or "an index", hint=near(step, names))


def _key_of_object(holder: dict[str, Any], key: str, taken: list[str | int]) -> str:
    if len(taken) == 1 and taken[0] in CLOSED and key not in holder:
        what = str(taken[0]).removesuffix("s")
        raise WrongValueError("bad-override", f"the scene has no {what} {quoted(key)}",
                              allowed=listed(holder) or "none", hint=near(key, holder))
    return key
