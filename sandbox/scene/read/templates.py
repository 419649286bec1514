"""Templates: ``"like": "digit"`` puts what elements have in common in one place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from sandbox.errors import Problem
from sandbox.scene.read.origin_map import Layered, Origin
from sandbox.wording import NearMisses, kind_of, listed, quoted

DEEPEST = 32
"""Templates that are like one another."""


class LikeError(Exception):
    """A template that does not exist, is no object, or is like itself; placed."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.message)
        self.problem = problem


def layered(
    entry: Mapping[str, Any], place: Origin, templates: Any, home: Origin, near: NearMisses,
    inside: Sequence[str] = (),
) -> Layered:
    """An object over the templates that it is like, key by key, each with its place.

    Objects are merged under the object's own keys; lists and numbers are replaced as a whole.
    A template may itself be like another one.

    Args:
        entry: an object of a scene's file.
        place: where it stands.
        templates: the file's templates.
        home: where these stand.
        near: tells near misses of names.
        inside: templates whose content the entry is, from the outermost.

    Raises:
        LikeError: what is wrong with the first name that leads nowhere.
    """
    layers = list(_chain(entry, place, templates, home, list(inside), near))
    merged: Layered = {}
    for at, layer in reversed(layers):
        merged = _over(layer, at, merged)
    merged.pop("like", None)
    return merged


def _chain(
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
        if len(seen) >= DEEPEST:
            raise LikeError(at.problem("circular-definition",
                                       f"templates are like one another more than {DEEPEST} deep"))
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


def _over(upper: Mapping[str, Any], place: Origin, lower: Layered) -> Layered:
    result = dict(lower)
    for key, value in upper.items():
        below = result.get(key)
        at = place.to(key)
        if isinstance(value, dict) and below is not None and isinstance(below[0], dict):
            under = below[0] if below[2] else own(below[0], below[1])
            result[key] = (_over(value, at, under), at, True)
        else:
            result[key] = (value, at, False)
    return result


def own(value: Mapping[str, Any], place: Origin) -> Layered:
    """An object of one file as layers have it."""
    return {key: (entry, place.to(key), False) for key, entry in value.items()}


def plain(merged: Layered) -> dict[str, Any]:
    """Layers without their places."""
    return {key: plain(value) if deeper else value for key, (value, _, deeper) in merged.items()}
