"""A scene that somebody has at hand in Python, held to all that one from a file is held to."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from sandbox.errors import Problem, SceneError
from sandbox.scene.check.ranges import check_ranges
from sandbox.scene.check.references import check_references
from sandbox.scene.check.units import check_units
from sandbox.scene.document import Scene
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.scopes import check_tables
from sandbox.values.messages import explain
from sandbox.wording import quoted

WANTED = ("a scene from sandbox.load_scene, a path, the name of a shipped scene, or a mapping")


def sound(scene: Scene | Mechanism) -> Mechanism:
    """The mechanism of a scene, whoever built it, if all about it is right but its size.

    Its values are validated again, since ``model_copy`` and ``model_construct`` validate nothing;
    its names, units and ranges are those of a scene that was read. How large it is, is its
    author's own affair: :class:`sandbox.scene.read.limits.Limits` are for files.

    Raises:
        SceneError: every problem, by its place in the scene or the mechanism; or no scene at all.
    """
    if not isinstance(scene, Mechanism):
        raise SceneError([Problem("bad-argument", f"{quoted(scene)} is no scene", "scene",
                                  allowed=WANTED)])
    _validate(scene)
    mechanism = expand(scene) if isinstance(scene, Scene) else scene
    if problems := [*check_units(mechanism), *check_references(mechanism),
                    *check_tables(mechanism), *check_ranges(mechanism)]:
        raise SceneError(problems)
    return mechanism


def _validate(scene: Mechanism) -> None:
    """Hold every value to the field that it stands in.

    Raises:
        SceneError: every value that no file could have there.
    """
    kind = type(scene)
    data = _as_read(scene.model_dump(by_alias=True, warnings=False))
    try:
        kind.model_validate(data)
    except ValidationError as error:
        raise SceneError(explain(error, data, kind)) from None


def _as_read(value: Any) -> Any:
    """Data as a file would hold it, with lists in place of tuples."""
    if isinstance(value, dict):
        return {key: _as_read(entry) for key, entry in value.items()}
    return [_as_read(entry) for entry in value] if isinstance(value, (list, tuple)) else value
