"""Templates: ``"like": "digit"`` puts what parts have in common in one place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from sandbox.errors import Problem
from sandbox.scene.read.paths import JsonPath, path_text
from sandbox.wording import NearMisses, kind_of, listed, quoted

DEEPEST = 32
"""Templates that are like one another."""


@dataclass
class Merged:
    """A scene's data with its templates merged in.

    ``layers`` has for each part the objects it was merged from, its own first,
    each with its path; ``broken`` the parts whose template does not exist.
    """

    data: dict[str, Any]
    problems: list[Problem] = field(default_factory=list)
    layers: dict[int, list[tuple[JsonPath, dict[str, Any]]]] = field(default_factory=dict)
    broken: set[int] = field(default_factory=set)
    near: NearMisses = field(default_factory=NearMisses)

    def origin(self, path: JsonPath) -> JsonPath:
        """Where the value at a path of the merged data was written."""
        if len(path) < 3 or path[0] != "parts" or not isinstance(path[1], int):
            return path
        deepest: tuple[int, JsonPath] = (0, path)
        for base, layer in self.layers.get(path[1], ()):
            depth = _depth(layer, path[2:])
            if depth > deepest[0]:
                deepest = depth, (*base, *path[2:])
        return deepest[1]


def _depth(value: Any, path: JsonPath) -> int:
    """How many steps of ``path`` exist in ``value``."""
    for depth, step in enumerate(path):
        if not holds(value, step):
            return depth
        value = value[step]
    return len(path)


def holds(value: Any, step: str | int) -> bool:
    """Whether a key or an index leads on from a value."""
    if isinstance(value, list):
        return isinstance(step, int) and 0 <= step < len(value)
    return isinstance(value, dict) and step in value


def merge_templates(data: dict[str, Any]) -> Merged:
    """Merge each part's template under the part's own keys, object by object.

    Lists and numbers are replaced as a whole. A template may itself be like
    another one. Whatever is not an object is left for the models to refuse.
    """
    merged = Merged(data)
    parts, templates = data.get("parts"), data.get("templates", {})
    if not isinstance(parts, list) or not isinstance(templates, dict):
        return merged
    spelled_out = []
    for i, part in enumerate(parts):
        if isinstance(part, dict) and "like" in part:
            merged.layers[i] = list(_layers(("parts", i), part, templates, merged, i))
            part = {}
            for _, layer in reversed(merged.layers[i]):
                part = _over(layer, part)
            part.pop("like", None)
        spelled_out.append(part)
    merged.data = {**data, "parts": spelled_out}
    return merged


def _layers(
    path: JsonPath, layer: dict[str, Any], templates: dict[str, Any], merged: Merged, index: int
) -> Iterator[tuple[JsonPath, dict[str, Any]]]:
    """A part and the chain of templates under it; what is wrong goes into ``merged``."""
    seen: dict[str, None] = {}
    while True:
        yield path, layer
        if "like" not in layer:
            return
        name, at = layer["like"], path_text((*path, "like"))
        wrong = None
        if not isinstance(name, str):
            wrong = Problem(f"'like' is the name of a template, not {kind_of(name)}", at)
        elif len(seen) == DEEPEST:
            wrong = Problem(f"templates are like one another more than {DEEPEST} deep", at)
        elif name in seen:
            wrong = Problem(f"templates are like one another: {' → '.join([*seen, name])}", at)
        elif name not in templates:
            wrong = Problem(f"there is no template {quoted(name)}", at,
                            allowed=listed(templates) or "none: the scene has no templates",
                            hint=merged.near(name, templates))
        elif not isinstance(templates[name], dict):
            wrong = Problem(f"the template {quoted(name)} is {kind_of(templates[name])}, "
                            "not an object {…}", path_text(("templates", name)))
        if wrong:
            merged.problems.append(wrong)
            merged.broken.add(index)
            return
        seen[name] = None
        path, layer = ("templates", name), templates[name]


def _over(upper: dict[str, Any], lower: dict[str, Any]) -> dict[str, Any]:
    result = dict(lower)
    for key, value in upper.items():
        below = result.get(key)
        both = isinstance(value, dict) and isinstance(below, dict)
        result[key] = _over(value, below) if both and isinstance(below, dict) else value
    return result
