"""Marks of the types of fields, as in ``Annotated[float, Dimension("length")]``."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, TypeVar

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

Mark = TypeVar("Mark")


def mark_of(metadata: Iterable[Any], kind: type[Mark]) -> Mark | None:
    """The mark of a kind among the annotations of a field's type."""
    return next((each for each in metadata if isinstance(each, kind)), None)


class ReadMark:
    """The base of marks of a type that read a written value before pydantic does."""

    def read(self, value: Any, info: ValidationInfo) -> Any:
        """The value for pydantic."""
        raise NotImplementedError

    def json_schema(self, schema: dict[str, Any]) -> dict[str, Any]:
        """The JSON Schema of written values, from that of the values for pydantic."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler,
    ) -> CoreSchema:
        return core_schema.with_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler,
    ) -> dict[str, Any]:
        return self.json_schema(handler(schema))


@dataclass(frozen=True)
class TextFor(ReadMark):
    """Marks a model for which a text may be given: the value of one of its fields."""

    field: str

    def read(self, value: Any, info: ValidationInfo) -> Any:
        """An object in place of a text."""
        return {self.field: value} if isinstance(value, str) else value

    def json_schema(self, schema: dict[str, Any]) -> dict[str, Any]:
        """A text or an object."""
        return {"anyOf": [{"type": "string"}, schema]}
