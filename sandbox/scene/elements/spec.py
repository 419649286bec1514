"""The base of all that a scene specifies: closed, frozen, SI."""

from __future__ import annotations

from typing import ClassVar

from pydantic import BaseModel, ConfigDict


class Spec(BaseModel):
    """Immutable data; an unknown key is an error, NaN and infinity are refused."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, populate_by_name=True,
        serialize_by_alias=True, validate_default=False,
    )
    # fields that hold expressions of names of their own: no element is meant by them
    LOCAL: ClassVar[tuple[str, ...]] = ()
