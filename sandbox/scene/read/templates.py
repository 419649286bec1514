"""Templates: ``"like": "digit"`` puts what elements have in common in one place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sandbox.errors import Problem
from sandbox.scene.read.origins import Origin, OriginMap
from sandbox.scene.read.scopes import Scope
from sandbox.wording import NearMisses, kind_of, listed, quoted

MAX_DEPTH = 32
"""Templates that are like one another."""


@dataclass(frozen=True)
class Context:
    """Names, templates and files that apply to a piece of data."""

    scope: Scope
    templates: Any
    home: Origin
    """Of the templates."""
    files: tuple[Path, ...]
    """Files that include one another, down to the file of this piece."""
    inside: tuple[str, ...] = ()
    """Templates that contain this piece."""


class LikeError(Exception):
    """A template that does not exist, is no object, or is like itself; with its place."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.message)
        self.problem = problem


def merge_templates(
    entry: Mapping[str, Any], place: Origin, templates: Any, home: Origin, places: OriginMap,
    near: NearMisses, inside: Sequence[str] = (),
) -> dict[str, Any]:
    """An object with the keys of the templates that it is like.

    Objects are merged key by key; lists and numbers are replaced as a whole. A template may itself
    be like another one.

    Args:
        entry: an object of a scene's file.
        place: where it was written.
        templates: the file's templates.
        home: where these were written.
        places: notes where each key was written.
        near: finds near misses of names.
        inside: templates that contain the entry, from the outermost.

    Raises:
        LikeError: the first name that leads nowhere.
    """
    merged: dict[str, Any] = {}
    for at, layer in reversed(list(_layers(entry, place, templates, home, list(inside), near))):
        _merge(merged, layer, at, places)
    merged.pop("like", None)
    return merged


def _layers(
    layer: Mapping[str, Any], place: Origin, templates: Any, home: Origin, seen: list[str],
    near: NearMisses,
) -> Iterator[tuple[Origin, Mapping[str, Any]]]:
    """An object and the templates under it, with their places."""
    known = templates if isinstance(templates, dict) else {}
    while True:
        yield place, layer
        if "like" not in layer:
            return
        name, at = layer["like"], place.to("like")
        if not isinstance(name, str):
            raise LikeError(at.problem("bad-template",
                                       f"'like' is the name of a template, not {kind_of(name)}"))
        if len(seen) >= MAX_DEPTH:
            raise LikeError(at.problem("circular-definition", "templates are like one another more "
                                       f"than {MAX_DEPTH} deep"))
        if name in seen:
            raise LikeError(at.problem("circular-definition", "templates are like one another: "
                                       f"{' → '.join([*seen, name])}"))
        if name not in known:
            raise LikeError(at.problem(
                "bad-template", f"there is no template {quoted(name)}", hint=near(name, known),
                allowed=listed(known) or "none: the scene has no templates"))
        if not isinstance(known[name], dict):
            raise LikeError(home.to(name).problem("bad-template", f"the template {quoted(name)} is "
                                                  f"{kind_of(known[name])}, not an object {{…}}"))
        seen.append(name)
        place, layer = home.to(name).copied(place), known[name]


def _merge(
    merged: dict[str, Any], layer: Mapping[str, Any], place: Origin, places: OriginMap,
) -> None:
    """Put the keys of an object at a place over those that are there."""
    for key, value in layer.items():
        at, below = places.at(layer, key, place), merged.get(key)
        if isinstance(value, dict) and isinstance(below, dict):
            merged[key] = {}
            _merge(merged[key], below, places.at(merged, key, place), places)
            _merge(merged[key], value, at, places)
        else:
            merged[key] = value
        places.put(merged, key, at)


def inside_template(place: Origin, context: Context) -> Context:
    """The context of an entry that is written inside a template."""
    base = context.home.path
    if place.source is not context.home.source or place.path[:len(base)] != base or \
            len(place.path) <= len(base):
        return context
    name = str(place.path[len(base)])
    if name in context.inside:
        return context
    return replace(context, inside=(*context.inside, name))
