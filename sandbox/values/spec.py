"""The base of all that a scene specifies: closed, frozen, SI."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Self, get_args

from pydantic import ConfigDict, Field, ValidationError, model_validator

from sandbox.errors import SceneError
from sandbox.wording import WrongValueError

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
        """Refuse fields that do not fit together, by :func:`refuse_if`."""


def refuse_if(
    fault: object, message: str, code: str = "conflicting-keys", *, allowed: str = "",
) -> None:
    """Raise a WrongValueError where ``fault`` is true."""
    if fault:
        raise WrongValueError(code, message, allowed=allowed)
