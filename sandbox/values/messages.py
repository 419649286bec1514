"""Translation of pydantic's validation errors to problems."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import reduce
from operator import getitem
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError
from pydantic_core import ErrorDetails

from sandbox.codes import CODES
from sandbox.errors import Problem
from sandbox.values.paths import JsonPath, holds, path_text
from sandbox.wording import MAX_NAMED, NearMisses, WrongValueError, kind_of, listed, quoted

Model = type[BaseModel]
MAX_EXPLAINED = 5_000  # number of invalid values that are explained
COMPOSING = ("like", "repeat", "include", "parameters")
"""Keys of an entry that composition removes: suggested for similar unknown keys."""
_QUOTED = re.compile(r"'([^']*)'")
OWN = "; for one of your own give its file with --elements"  # added to the types of parts


def explain(error: ValidationError, data: Any, model: Model) -> list[Problem]:
    """The problems of a validation of ``data`` by ``model``, with their paths."""
    near, found = NearMisses(), []
    for each in error.errors(include_url=False)[:MAX_EXPLAINED]:
        minimum, value = each.get("ctx", {}).get("min_length", 0), each["input"]
        if each["type"] == "too_short" and isinstance(value, list) and len(value) >= minimum:
            continue  # a consequence of invalid entries, which have their own messages
        path = locate(data, each["loc"], each["input"], each["type"])
        found.append((each, path, _problem(each, path, model, near)))
    misspelt = {(path[:-1], problem.hint.strip("'")) for _, path, problem in found
                if problem.key and problem.hint}
    return [problem for each, path, problem in found
            if not (each["type"] == "missing" and (path, each["loc"][-1]) in misspelt)]


def _problem(error: ErrorDetails, path: JsonPath, model: Model, near: NearMisses) -> Problem:
    kind, place, on_key = error["type"], path_text(path), error["loc"][-1:] == ("[key]",)
    if kind == "extra_forbidden":
        return _unknown_key(error, path, model, near)
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        return _unknown_type(error, place, model, near)
    context: Mapping[str, Any] = error.get("ctx", {})
    if isinstance(refused := context.get("error"), WrongValueError):
        return Problem.of(refused, place, key=on_key)
    if kind == "literal_error":
        given, choices = error["input"], _QUOTED.findall(str(context["expected"]))
        return Problem("not-allowed", f"{quoted(given)} is not allowed here", place,
                       allowed=listed(choices) if choices else str(context["expected"]),
                       hint=near(given, choices) if isinstance(given, str) else "")
    message = str(refused or error["msg"])
    message = message[:1].lower() + message[1:]
    if kind in _WORDS:
        value, last = error["input"], error["loc"][-1] if error["loc"] else ""
        count = context.get("actual_length")
        message = _WORDS[kind].format(
            **context, given=kind_of(value), quoted=quoted(value),
            count=len(value) if count is None and isinstance(value, list) else count,
            last=f"entry {last} of the list" if isinstance(last, int) else quoted(last))
    code = kind if kind in CODES else _CODES.get(kind, "wrong-type")
    return Problem(code, message, place, allowed=str(context.get("allowed", "")),
                   hint=str(context.get("hint", "")), key=on_key)


def locate(data: Any, loc: tuple[int | str, ...], value: Any, kind: str) -> JsonPath:
    """The path in ``data`` of pydantic's ``loc``.

    A ``loc`` also has members of unions and entries of lists that a model made of a single value.
    A key of the data may have the same name: ``{"to": 3, "over": "1 N", "ramp": 3}``.
    """
    if kind == "missing":
        return written(data, loc[:-1])
    path = written(data, loc)
    if reduce(getitem, path, data) is value:
        return path
    for i, step in enumerate(loc):
        other = written(data, loc[:i] + loc[i + 1:])
        if (isinstance(step, int) or len(other) == len(path)) and \
                reduce(getitem, other, data) is value:
            return other
    return path


def written(data: Any, loc: Iterable[int | str]) -> JsonPath:
    """The path in ``data`` of a path of the models, without steps that the data does not have."""
    path: JsonPath = ()
    tagged = False
    for step in loc:
        tagged = isinstance(data, dict) and data.get("type") == step and not tagged
        if not tagged and holds(data, step):
            path, data = (*path, step), data[step]
    return path


def _unknown_key(error: ErrorDetails, path: JsonPath, model: Model, near: NearMisses) -> Problem:
    key, kind = str(error["loc"][-1]), type_at(model, error["loc"][:-1])
    keys = [field.alias or name for name, field in kind.model_fields.items()] \
        if _is_model(kind) else []
    more = len(keys) - MAX_NAMED
    allowed = ", ".join(keys[:MAX_NAMED]) + (
        f" and {more} more ({fields_page(kind)})" if more > 0 else "")
    words = COMPOSING if len(path) > 1 and isinstance(path[-2], int) else ()
    others = [str(tag) for tag, each in _members(type_at(model, error["loc"][:-2])).items()
              if type_at(each, (key,)) is not None]
    of = f" (a key of {listed(others)})" if others else ""
    return Problem("unknown-key", f"unknown key {quoted(key)}{of}", path_text(path),
                   allowed=allowed, hint=near(key, [*keys, *words]), key=True)


def _unknown_type(error: ErrorDetails, place: str, model: Model, near: NearMisses) -> Problem:
    value = error["input"]
    choices = [str(tag) for tag in _members(type_at(model, error["loc"]))]
    if not isinstance(value, dict):
        return Problem("wrong-type", f"expected an object {{…}}, got {kind_of(value)}", place)
    if (given := value.get("type")) is None:
        return Problem("missing-key", "'type' is missing", place, allowed=listed(choices))
    return Problem("unknown-type", f"unknown type {quoted(given)}", f"{place}.type",
                   allowed=f"{listed(choices)}{OWN if 'assembly' in choices else ''}",
                   hint=near(given, choices) if isinstance(given, str) else "")


_CODES = {
    "missing": "missing-key", "string_pattern_mismatch": "invalid-name",
    "string_too_long": "limit-exceeded", "string_unicode": "invalid-json",
    **dict.fromkeys(("greater_than", "greater_than_equal", "less_than", "less_than_equal"),
                    "out-of-range"),
}
"""Codes of pydantic's own types of errors; all others are of a wrong type."""
_WORDS = {
    "missing": "{last} is missing",
    **dict.fromkeys(("tuple_type", "list_type"), "expected a list […], got {given}"),
    **dict.fromkeys(("model_type", "model_attributes_type", "dict_type"),
                    "expected an object {{…}}, got {given}"),
    "string_type": "expected text, got {given}",
    **dict.fromkeys(("bool_type", "bool_parsing"), "expected true or false, got {given}"),
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float", "int_parsing_size",
                     "finite_number"), "expected a whole number, got {given}"),
    "too_long": "expected at most {max_length} entries, got {count}",
    "too_short": "expected at least {min_length} entries, got {count}",
    "string_too_long": "at most {max_length} characters",
    "string_pattern_mismatch": "{quoted} is not a name: letters, digits and _, parts joined by "
                               "dots, none beginning with a digit",
    "string_unicode": "the text has characters that are not Unicode",
    "greater_than": "must be greater than {gt:g}, got {given}",
    "greater_than_equal": "must be at least {ge:g}, got {given}",
    "less_than": "must be less than {lt:g}, got {given}",
    "less_than_equal": "must be at most {le:g}, got {given}",
}
"""Messages of pydantic's types of errors; the others have their own."""


ELEMENTS, PARTS = "docs/elements.md", "docs/parts.md"  # have the fields of all elements and parts


def fields_page(model: Model) -> str:
    """The section of the docs that has a model's fields, as ``docs/parts.md#leaf``."""
    room, name = model.__module__, model.__name__
    if not room.startswith("sandbox."):
        return "docs/howto/own_joint.md"
    if room.startswith("sandbox.sweeps."):
        return "docs/searches.md#a-search-as-a-file" if "Search" in name else \
            "docs/sweeps.md#a-study-as-a-file"
    part = ".parts." in room or name == "Assembly"
    return f"{PARTS if part else ELEMENTS}#{name.lower()}"


def fields_at(model: Model, data: Any, path: JsonPath) -> str:
    """The section with the fields of the data at a path; empty for a missing or unknown type."""
    found, here = "", type_at(model, ())
    for depth, step in enumerate((*path, "")):
        if isinstance(data, dict) and isinstance(data.get("type"), str) and not _is_model(here):
            here = type_at(here, (data["type"],))
        if _is_model(here) or (depth == 1 and here is not None):  # a list of the scene has none
            found = fields_page(here) if _is_model(here) else ""
        if not holds(data, step):
            break
        here, data = type_at(here, (step,)), data[step]
    return found


def _is_model(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def type_at(kind: Any, loc: tuple[int | str, ...]) -> Any:
    """The model, or union of models, at a pydantic location; None if there is none."""
    while get_origin(kind) is Annotated:
        kind = get_args(kind)[0]
    origin, arguments = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        arguments = tuple(member for member in arguments if member is not NoneType)
        if len(arguments) == 1:
            return type_at(arguments[0], loc)
    if not loc or kind is None:
        return kind
    inner: Any = None
    if origin in (Union, UnionType):
        inner = _members(kind).get(loc[0])
    elif _is_model(kind):
        inner = next((field.annotation for name, field in kind.model_fields.items()
                      if loc[0] in (name, field.alias)), None)
    elif origin in (tuple, list, dict) and arguments:
        inner = arguments[1 if origin is dict else 0]
    return type_at(inner, loc[1:])


def _members(union: Any) -> dict[int | str, Any]:
    """The members of a union by their tags: its own, or the values of their ``type``."""
    found: dict[int | str, Any] = {}
    for member in get_args(union):
        model = type_at(member, ())
        tags = [mark.tag for mark in get_args(member) if isinstance(mark, Tag)]
        if _is_model(model) and "type" in model.model_fields:
            tags += get_args(model.model_fields["type"].annotation)
        found |= dict.fromkeys(tags, model)
    return found
