"""Events: what happens once in a run, at a time or when a condition becomes true."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator

from sandbox.elements.controllers.controller import bound
from sandbox.values.numbers import Duration, Frequency, Instant, Items, Name, Quantity
from sandbox.values.spec import Spec
from sandbox.wording import WrongValueError


def _listed(value: object) -> object:
    return [value] if isinstance(value, str) else value


Names = Annotated[Items[Name], BeforeValidator(_listed, json_schema_input_type=(
    Name | tuple[Name, ...]))]
"""One name or several."""


class Event(Spec):
    """Sets drives, switches controllers, releases or engages elements, or stops the run.

    It happens at most once. An event without actions marks an instant in plots and pages. For a
    push, set a force drive of value 0 for a while; to lock and free a joint, set its brake.
    """

    name: Name
    """Its name in the result."""
    at: Instant | None = None
    """When it happens [s]: before the first step whose forces act at or after it."""
    when: str | None = None
    """A condition of quantities, such as ``"=finger.mcp.angle > 0.5"``; instead of ``at``."""
    after: Instant = 0.0
    """Earliest time for ``when`` [s]."""
    rate: Frequency | None = None
    """How often ``when`` is looked at [Hz]; by default 1 kHz as a controller's rate."""
    set: dict[str, Quantity] = Field(default_factory=dict)
    """Drive, ``<controller>.target`` or ``<controller>.active`` (0 or 1) to its new value, in the
    unit of each."""
    release: Names = ()
    """Joints, springs and tendons to release: they carry no load and are not drawn. With a pin its
    stops, damping, springs and drives are released."""
    take_up: Names = ()
    """Joints, springs and tendons to engage again, after they were released or broke."""
    lasts: Duration | None = None
    """Time after which the event is reversed: values, releases and engagements [s]; by default
    never."""
    stop: Literal["pass", "fail"] | None = None
    """Stops the run with this result; by default the run continues."""
    because: str = ""
    """Reason, shown in the result."""

    @field_validator("when")
    @classmethod
    def _bind(cls, text: str | None, info: ValidationInfo) -> str | None:
        return None if text is None else bound(text, info)

    @model_validator(mode="after")
    def _one_cause(self) -> Self:
        if (self.at is None) == (self.when is None):
            raise WrongValueError("conflicting-keys", "give either 'at' or 'when'")
        for key in ("after", "rate"):
            if self.at is not None and getattr(self, key):
                raise WrongValueError("conflicting-keys", f"'{key}' needs 'when', not 'at'")
        if both := sorted(set(self.release) & set(self.take_up)):
            raise WrongValueError("conflicting-keys", "one event cannot release and engage "
                                                      f"'{both[0]}'")
        return self


def first_step(event: Event, step: float) -> int:
    """How many steps of ``step`` [s] are made before an event may happen."""
    if event.at is not None:
        # the forces of step k act at (k - 1/2) h: before the first such step
        return max(0, math.ceil(event.at / step - 0.5 - 1e-9))
    return math.ceil(event.after / step - 1e-9)
