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
    """Named numbers for expressions, SI once read."""
    templates: dict[Name, dict[str, Any]] = Field(default_factory=dict)
    """What parts have in common: ``{"digit": {"type": "finger", ...}}``."""
    parts: tuple[Part, ...] = ()
    """Assemblies, spelled out by :func:`sandbox.scene.expand.expand`."""
