"""Drives: what the world outside does to the mechanism, as a signal over time."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator
from pydantic_core import PydanticCustomError

from sandbox.scene.model import Model
from sandbox.scene.numbers import Name, Number, Point
from sandbox.scene.signals import ForceSignal, LengthSignal, TorqueSignal


class ForceDrive(Model):
    """A force on a point of a body, along a fixed direction."""

    type: Literal["force"]
    name: Name
    body: Name
    at: Point = (0.0, 0.0)
    direction: tuple[Number, Number]
    """Of any length but zero; only its direction counts."""
    frame: Literal["world", "body"] = "world"
    value: ForceSignal
    """[N]"""

    @field_validator("direction")
    @classmethod
    def _not_zero(cls, direction: tuple[float, float]) -> tuple[float, float]:
        if direction == (0.0, 0.0):
            raise PydanticCustomError("direction", "[0, 0] is no direction")
        return direction


class TorqueDrive(Model):
    """A torque between the two bodies of a hinge, positive as the hinge turns."""

    type: Literal["torque"]
    name: Name
    joint: Name
    value: TorqueSignal
    """[N m]"""


class PullDrive(Model):
    """Sets the tension of a tendon: an actuator at its last guide. Below 0 counts as 0."""

    type: Literal["pull"]
    name: Name
    tendon: Name
    """A tendon, or a tree: then its actuator tendon is pulled."""
    value: ForceSignal
    """[N]"""


class RadiusDrive(Model):
    """Sets the radius of a body's circle over time: an object that swells or shrinks."""

    type: Literal["radius"]
    name: Name
    body: Name
    shape: int = Field(0, ge=0)
    """Which of the body's shapes, counted from 0."""
    value: LengthSignal
    """[m]"""


Drive = Annotated[
    ForceDrive | TorqueDrive | PullDrive | RadiusDrive, Field(discriminator="type")
]
