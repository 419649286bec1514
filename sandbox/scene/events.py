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
    """Sets drives, switches controllers, lets go or takes up, or stops the run; at most once.

    One that does nothing of the kind marks an instant: it is noted, and marked in plots and pages.
    A push is a force drive of value 0 that an event sets for a while; a joint
    is locked and freed by setting its brake.
    """

    name: Name
    """Its name, by which the verdict tells when it happened."""
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
    """Joints, springs and tendons that it lets go: they carry nothing any more and are not drawn.
    With a pin go its stops and damping and what acts on it."""
    take_up: Names = ()
    """Joints, springs and tendons that it takes up again, after they were let go or broke."""
    lasts: Duration | None = None
    """Time after which what was set is as before, what was let go is taken up, and what was taken
    up let go [s]; by default for good."""
    stop: Literal["pass", "fail"] | None = None
    """Ends the run with this verdict; by default the run goes on."""
    because: str = ""
    """Why it is there; stands in the verdict."""

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
            raise WrongValueError("conflicting-keys", "one event cannot release and take up "
                                  f"'{both[0]}'")
        return self


def first_step(event: Event, step: float) -> int:
    """How many steps of ``step`` [s] are made before an event may happen."""
    if event.at is not None:
        # the forces of step k act at (k - 1/2) h: before the first such step
        return max(0, math.ceil(event.at / step - 0.5 - 1e-9))
    return math.ceil(event.after / step - 1e-9)
