"""Expansion of a scene to its mechanism: every part as plain elements."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

from sandbox.errors import Problem, SceneError
from sandbox.scene.document import Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.parts.expansion import Known, PartError, expand_parts
from sandbox.wording import quoted

LINE_WIDTH = 100  # of the printed mechanism


def expand(scene: Scene) -> Mechanism:
    """Expand a scene to its mechanism.

    Parts that pull others (trees) are expanded last, otherwise in the order of the scene. The
    scene's own contact rules come after those of its parts and override them. A pull drive that
    names a finger or a tree gets that part's tendon.

    Raises:
        SceneError: a part that names something unknown, or that cannot be built;
            every such problem, with the part's path; or not a scene.
    """
    if not isinstance(scene, Scene):
        raise SceneError([Problem("bad-argument", f"{quoted(scene)} is no scene", "scene",
                                  allowed="a scene from sandbox.load_scene")])
    try:
        elements = expand_parts(scene, Known())
    except PartError as error:
        raise SceneError([replace(each, path=f"${each.path}") for each in error.problems]) from None
    fields = {name: getattr(scene, name) for name in Mechanism.model_fields}
    fields |= elements | {"materials": dict(elements["materials"])}
    return Mechanism.model_construct(set(fields), **fields)


def to_json(mechanism: Mechanism) -> str:
    """The mechanism as a scene without parts; read again it gives an equal mechanism."""
    data = {"format": mechanism.format} | mechanism.model_dump(
        mode="json", by_alias=True, exclude_defaults=True, include=set(Mechanism.model_fields))
    return _printed(data, 0) + "\n"


def _printed(value: Any, depth: int) -> str:
    """JSON with every value on one line that fits there, all else an entry a line."""
    line = json.dumps(value, ensure_ascii=False, allow_nan=False)
    if not value or not isinstance(value, (dict, list)) or (
        depth and len(line) + 2 * depth <= LINE_WIDTH
    ):
        return line
    indent = "  " * (depth + 1)
    if isinstance(value, dict):
        entries = [f"{json.dumps(key)}: {_printed(item, depth + 1)}" for key, item in value.items()]
    else:
        entries = [_printed(item, depth + 1) for item in value]
    left, right = "{}" if isinstance(value, dict) else "[]"
    return f"{left}\n{indent}" + f",\n{indent}".join(entries) + f"\n{'  ' * depth}{right}"
