"""``--set path=value``: a scene's data with some of its values replaced."""

from __future__ import annotations

import contextlib
import copy
import json
from collections.abc import Mapping
from typing import Any

from sandbox.errors import Problem
from sandbox.scene.read.compose import Context, merged
from sandbox.scene.read.origins import Composed, Origin, RefusedError
from sandbox.scene.read.scopes import Scope
from sandbox.scene.read.source import SceneSource
from sandbox.values.paths import JsonPath, holds, parse_path
from sandbox.values.units import dimension_of, unit_in, units_of
from sandbox.wording import WrongValueError, kind_of, listed, near, quoted, refuse_if

CLOSED = ("parameters", "templates")
"""Objects whose keys are the author's own, so that a new one is a slip."""


def apply_overrides(
    data: dict[str, Any], overrides: Mapping[str, Any], *, nesting: int = 32
) -> tuple[dict[str, Any], set[JsonPath], list[Problem]]:
    """A copy of ``data`` with the overrides, the paths they set, and their problems."""
    if not overrides:
        return data, set(), []
    result, paths, problems = copy.deepcopy(data), set(), []
    for text, value in overrides.items():
        try:
            refuse_if(not isinstance(text, str), "it is not the text of a path", "bad-override")
            steps = parse_path(text)
            if isinstance(value, str):
                refuse_if(sum(map(value.count, "[{")) > 10 * nesting,
                          "the value has too many brackets", "limit-exceeded")
                with contextlib.suppress(ValueError):
                    value = json.loads(value, parse_constant=str)
            if steps[:1] == ("parameters",) and len(steps) == 2:
                own = result.get("parameters")
                before, after = (unit_in(each) for each in (
                    own.get(steps[1]) if isinstance(own, dict) else None, value))
                if before and after and dimension_of(before) != dimension_of(after):
                    raise WrongValueError(
                        "wrong-unit", f"{quoted(after)} is a unit of {dimension_of(after)}, and "
                        f"{quoted(steps[1])} is in {quoted(before)}",
                        allowed=", ".join(units_of(dimension_of(before))))
            paths.add(_set(result, steps, value))
        except WrongValueError as error:
            problems.append(Problem.of(
                error, "$", message=f"cannot set {quoted(text)}: {error.message}"))
    return result, paths, problems


def _set(data: dict[str, Any], path: JsonPath, value: Any) -> JsonPath:
    """Set one value; the path with names turned into indices."""
    refuse_if(not path, "the whole scene cannot be replaced", "bad-override")
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


def _inherited(data: dict[str, Any], taken: list[str | int]) -> Any:
    """A copy of the list that an element has from its template."""
    value: Any = data
    here = Origin(SceneSource(data))
    for depth, step in enumerate(taken):
        value = value[step] if holds(value, step) else None
        if depth == 1 and isinstance(value, dict):
            with contextlib.suppress(RefusedError):  # reading the scene reports it
                value = merged(value, Context(here, (), Scope()), Composed({}, here))
    refuse_if(not isinstance(value, list), f"there is no list {quoted(taken[-1])} there",
              "bad-override")
    return copy.deepcopy(value)


def _key(holder: Any, step: str | int, taken: list[str | int]) -> str | int:
    """The key or index that ``step`` means in ``holder``."""
    if isinstance(holder, dict):
        key = str(step)
        if len(taken) == 1 and taken[0] in CLOSED and key not in holder:
            what = str(taken[0]).removesuffix("s")
            raise WrongValueError("bad-override", f"the scene has no {what} {quoted(key)}",
                                  allowed=listed(holder) or "none", hint=near(key, holder))
        return key
    if not isinstance(holder, list):
        raise WrongValueError("bad-override", f"{quoted(taken[-1])} is {kind_of(holder)} and has "
                              f"no {quoted(step)} in it")
    if isinstance(step, int):
        refuse_if(step >= len(holder), f"{quoted(taken[-1])} has no entry {step}", "bad-override",
                  allowed=f"0 to {len(holder) - 1}" if holder else "none, the list is empty")
        return step
    names = {entry["name"]: i for i, entry in enumerate(holder)
             if isinstance(entry, dict) and isinstance(entry.get("name"), str)}
    if step in names:
        return names[step]
    raise WrongValueError("bad-override", f"nothing in {quoted(taken[-1])} is named {quoted(step)}",
                          allowed=listed(names) or "an index", hint=near(step, names))
