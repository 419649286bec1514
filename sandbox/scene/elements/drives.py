"""Drives: what the world outside does to the mechanism, as a signal over time."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator
from pydantic_core import PydanticCustomError

from sandbox.scene.elements.spec import Spec
from sandbox.scene.values.numbers import Name, Number, Point, Torque
from sandbox.scene.values.signals import (
    ForceSignal,
    LengthSignal,
    SpeedSignal,
    StiffnessSignal,
    TorqueSignal,
)


class ForceDrive(Spec):
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


class TorqueDrive(Spec):
    """A torque between the two bodies of a hinge, positive as the hinge turns."""

    type: Literal["torque"]
    name: Name
    joint: Name
    value: TorqueSignal
    """[N m]"""


class PullDrive(Spec):
    """Sets the tension of a tendon: an actuator at its last guide. Below 0 counts as 0."""

    type: Literal["pull"]
    name: Name
    tendon: Name
    """A tendon, or a tree: then its actuator tendon is pulled."""
    value: ForceSignal
    """[N]"""


class RadiusDrive(Spec):
    """Sets the radius of a body's circle over time: an object that swells or shrinks."""

    type: Literal["radius"]
    name: Name
    body: Name
    shape: int = Field(0, ge=0)
    """Which of the body's shapes, counted from 0."""
    value: LengthSignal
    """[m]"""


class StiffnessDrive(Spec):
    """Sets the stiffness of a spring over time. Below 0 counts as 0."""

    type: Literal["stiffness"]
    name: Name
    spring: Name
    value: StiffnessSignal | None = None
    """[N/m] of a linear spring, [N m/rad] of a rotary one; by default what the spring has."""


class MotorDrive(Spec):
    """Turns a hinge at a set speed, with no more than a given torque."""

    type: Literal["motor"]
    name: Name
    joint: Name
    value: SpeedSignal
    """[rad/s], in the hinge's own sense."""
    torque: Torque = Field(gt=0)
    """The most it can give [N m]."""


class BrakeDrive(Spec):
    """Holds a hinge with at most a given torque and slips above it: a lock, or dry friction."""

    type: Literal["brake"]
    name: Name
    joint: Name
    value: TorqueSignal
    """The torque up to which it holds [N m]; 0 lets go, below 0 counts as 0."""


Drive = Annotated[
    ForceDrive | TorqueDrive | PullDrive | RadiusDrive | StiffnessDrive | MotorDrive | BrakeDrive,
    Field(discriminator="type"),
]
