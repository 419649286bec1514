"""The models behind a place of a scene or a study, and the page that has their fields."""

from __future__ import annotations

from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, Tag

from sandbox.values.paths import JsonPath, holds

ELEMENTS, PARTS = "docs/elements.md", "docs/parts.md"
"""Pages with the fields of all elements and parts."""
STUDIES = "docs/sweeps.md#a-study-as-a-file"
SEARCHES = "docs/searches.md#a-search-as-a-file"


def fields_page(model: type[BaseModel]) -> str:
    """The section of the docs that has a model's fields, as ``docs/parts.md#leaf``."""
    room, name = model.__module__, model.__name__
    if room.startswith("sandbox.sweeps."):
        return SEARCHES if "Search" in name else STUDIES
    part = ".parts." in room or name == "Assembly"
    return f"{PARTS if part else ELEMENTS}#{name.lower()}"


def fields_at(model: type[BaseModel], data: Any, path: JsonPath) -> str:
    """The section with the fields of what stands at a path of data, or of what it is part of.

    Empty in a list of the data for what is of no model: its ``type`` is missing, or unknown.
    """
    found, loc = "", tuple[str | int, ...]()
    for step in (*path, ""):
        here = type_at(model, loc)
        kind = data.get("type") if isinstance(data, dict) else None
        if isinstance(kind, str) and not _is_model(here):
            loc = (*loc, kind)
            here = type_at(model, loc)
        if _is_model(here):
            found = fields_page(here)
        elif len(loc) == 1 and here is not None:  # a list of the scene
            found = ""
        if not holds(data, step):
            break
        loc, data = (*loc, step), data[step]
    return found


def _is_model(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def type_at(kind: Any, loc: tuple[int | str, ...]) -> Any:
    """The model, or union of models, at a pydantic location; None if there is none."""
    kind = bare(kind)[0]
    origin, arguments = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        arguments = tuple(member for member in arguments if member is not NoneType)
        if len(arguments) == 1:
            return type_at(arguments[0], loc)
        chosen = [member for member in arguments if loc and _tagged(member, loc[0])]
        return type_at(chosen[0], loc[1:]) if chosen else None if loc else kind
    if not loc:
        return kind
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        for name, field in kind.model_fields.items():
            if loc[0] in (name, field.alias):
                return type_at(field.annotation, loc[1:])
    if origin in (tuple, list, dict) and arguments:
        return type_at(arguments[1 if origin is dict else 0], loc[1:])
    return None


def bare(kind: Any) -> tuple[Any, list[str]]:
    """A type without its annotations, and the union tags among them."""
    tags: list[str] = []
    while get_origin(kind) is Annotated:
        kind, *extras = get_args(kind)
        tags += [extra.tag for extra in extras if isinstance(extra, Tag)]
    return kind, tags


def _tagged(member: Any, tag: int | str) -> bool:
    member, tags = bare(member)
    if tag in tags:
        return True
    if not (isinstance(member, type) and issubclass(member, BaseModel)):
        return False
    field = member.model_fields.get("type")
    return (field is not None and get_origin(field.annotation) is Literal
            and tag in get_args(field.annotation))
