"""The base of all that a scene specifies: closed, frozen, SI; marks of the types of fields."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar, get_args

from pydantic import BeforeValidator, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import CoreSchema, core_schema

from sandbox.errors import SceneError

TYPE: Any = Field()  # the default of a field type: a file must have it, the constructor fills it in

if TYPE_CHECKING:
    from pydantic import BaseModel as Model
else:
    from pydantic import BaseModel

    class _Constructor(type(BaseModel)):
        def __call__(cls, /, **fields: Any) -> Any:
            """Build an element in Python.

            Raises:
                SceneError: every value that is missing, unknown or invalid.
            """
            if "type" in cls.model_fields:
                tag, = get_args(cls.model_fields["type"].annotation)
                fields = {"type": tag} | fields
            fields = {name: value.tolist() if hasattr(value, "tolist") else value
                      for name, value in fields.items()}  # arrays
            try:
                return super().__call__(**fields)
            except ValidationError as error:
                from sandbox.values.messages import explain

                raise SceneError(explain(error, fields, cls), cls.__name__) from None

    class Model(BaseModel, metaclass=_Constructor):
        """The base of schema models."""


class Spec(Model):
    """Immutable data; an unknown key is an error, NaN and infinity are refused."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, populate_by_name=True,
        serialize_by_alias=True, validate_default=False,
    )
    # fields that hold expressions of names of their own: no element is meant by them
    LOCAL: ClassVar[tuple[str, ...]] = ()

    @model_validator(mode="after")
    def _verified(self) -> Self:
        self._verify()
        return self

    def _verify(self) -> None:
        """Refuse fields that do not fit together, by :func:`sandbox.wording.refuse_if`."""


Mark = TypeVar("Mark")


def mark_of(metadata: Iterable[Any], kind: type[Mark]) -> Mark | None:
    """The mark of a kind among the annotations of a field's type."""
    return next((each for each in metadata if isinstance(each, kind)), None)


class ReadMark:
    """The base of marks of a type that read a written value before pydantic does."""

    def read(self, value: Any, info: Any) -> Any:
        """The value for pydantic; ``info`` is of the validation."""
        raise NotImplementedError

    def json_schema(self, schema: dict[str, Any]) -> dict[str, Any]:
        """The JSON Schema of written values, from that of the values for pydantic."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return core_schema.with_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: Any) -> dict[str, Any]:
        return self.json_schema(handler(schema))


def text_for(model: Any, field: str) -> BeforeValidator:
    """For a model a text may be given: the value of one of its fields."""
    return BeforeValidator(lambda value: {field: value} if isinstance(value, str) else value,
                           json_schema_input_type=str | model)
