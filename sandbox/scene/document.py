"""The Scene: a mechanism as its author wrote it, with parameters, templates and parts."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from sandbox.scene.mechanism import Mechanism
from sandbox.scene.parts.finger import Finger
from sandbox.scene.parts.section import Section
from sandbox.scene.parts.trees import PulleyTree, RockerTree
from sandbox.scene.values.numbers import Name, Quantity

Part = Annotated[Finger | RockerTree | PulleyTree | Section, Field(discriminator="type")]


class Scene(Mechanism):
    """A mechanism that may also use named parameters, templates and parts.

    A part names its template with ``"like"``; templates are merged into the
    parts, and ``like`` removed, before a scene is validated.
    """

    schema_: str | None = Field(None, alias="$schema")
    """Where an editor finds the JSON Schema of scenes."""
    parameters: dict[Name, Quantity] = Field(default_factory=dict)
    """Named numbers, for expressions such as ``"=pull / 4"``: SI once read, whatever unit they were
    written in."""
    templates: dict[Name, dict[str, Any]] = Field(default_factory=dict)
    """What parts have in common, by name: ``{"digit": {"type": "finger", ...}}``. A part with
    ``"like": "digit"`` takes all keys of that template and puts its own over them, object by
    object; lists are replaced whole. A template may itself be ``like`` another one."""
    parts: tuple[Part, ...] = ()
    """Assemblies of several elements each, such as fingers and trees; ``sandbox expand`` shows what
    they stand for."""
