"""Layers of the picture, as a scene asks for them."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from sandbox.kinds.layers import FORMS, LAYERS, WHOLE, asked
from sandbox.scene.values.numbers import Written
from sandbox.wording import WrongValueError, kind_of

WORDS = "list of layers, or object of layer: true, false or bodies"
_PATTERNS: dict[str, Any] = {"type": "array", "items": {"type": "string"}}
SCHEMA = WithJsonSchema({"anyOf": [
    {"type": "array", "items": {"enum": [
        *LAYERS, WHOLE, *(f"-{name}" for name in (*LAYERS, WHOLE))]}},
    {"type": "object", "additionalProperties": False, "properties": {
        name: {"anyOf": [{"type": "boolean"}, {"type": "string"}, _PATTERNS]}
        for name in (*LAYERS, WHOLE)}},
]})


def _read(value: Any) -> dict[str, tuple[str, ...]]:
    if isinstance(value, str):
        raise WrongValueError("not-allowed", f"{kind_of(value)} names no layers", allowed=FORMS)
    return asked(value)


ShownLayers = Annotated[Written[dict[str, tuple[str, ...]]], BeforeValidator(_read), SCHEMA]
"""Of each layer that is named the patterns of bodies that it is shown of; none hides it."""
