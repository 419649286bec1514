"""Joints. Anchors are in the frames of their bodies [m]; one left out follows from the other."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from sandbox.scene.elements.spec import Spec
from sandbox.scene.values.numbers import Angle, Distance, Length, Name, Point, RotaryDamping

Turn = Literal["counterclockwise", "clockwise"]


class _JointSpec(Spec):
    name: Name
    a: Name
    b: Name
    on_a: Point | None = None
    """Anchor in the frame of ``a``; by default where ``on_b`` is at t = 0."""
    on_b: Point | None = None
    """Anchor in the frame of ``b``; by default where ``on_a`` is at t = 0."""
    collide: bool = False
    """Whether the two bodies may touch each other."""

    @model_validator(mode="after")
    def _anchored(self) -> Self:
        if self.a == self.b:
            raise PydanticCustomError("joint", "'a' and 'b' must be two bodies")
        if self.on_a is None and self.on_b is None:
            raise PydanticCustomError("joint", "give 'on_a' or 'on_b'")
        return self


class Pin(_JointSpec):
    """A hinge (PivotJoint). Its angle is that of ``b`` against ``a``, in its own sense."""

    type: Literal["pin"]
    positive: Turn = "counterclockwise"
    """The turn of ``b`` against ``a`` that counts as positive."""
    zero: Angle = 0.0
    """Subtracted from the angle between the two frames once that is counted in the positive
    sense: where it is clockwise, the hinge's angle is minus the frames' angle, minus ``zero``."""
    limits: tuple[Angle, Angle] | None = None
    """Hard stops [lowest, highest]."""
    damping: RotaryDamping = 0.0
    """Viscous friction of the hinge [N m s/rad]."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.limits is not None and self.limits[0] >= self.limits[1]:
            raise PydanticCustomError("limits", "limits are [lowest, highest]")
        return self


class Slot(_JointSpec):
    """A point of ``b`` on a groove of ``a`` that runs from ``start`` to ``end`` (GrooveJoint)."""

    type: Literal["slot"]
    start: Point
    end: Point
    turns: bool = True
    """False keeps the angle between the two bodies: a slider."""
    on_b: Point | None = (0.0, 0.0)


class Weld(_JointSpec):
    """Two bodies held together (PivotJoint and GearJoint)."""

    type: Literal["weld"]


class Rod(_JointSpec):
    """A massless rigid rod between two points (PinJoint)."""

    type: Literal["rod"]
    length: Length | None = None
    """By default the distance at t = 0."""

    on_a: Point | None = (0.0, 0.0)
    on_b: Point | None = (0.0, 0.0)


class Rope(_JointSpec):
    """Keeps two points between a least and a largest distance (SlideJoint).

    With ``shortest`` 0 it is a slack rope, otherwise a telescopic rod. It does
    not stretch, and its jerk is inelastic: where it becomes taut both ends go
    on at one speed along it, at any step. A tendon is elastic.
    """

    type: Literal["rope"]
    longest: Length
    shortest: Distance = 0.0
    on_a: Point | None = (0.0, 0.0)
    on_b: Point | None = (0.0, 0.0)

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.shortest > self.longest:
            raise PydanticCustomError("limits", "'shortest' is larger than 'longest'")
        return self


Joint = Annotated[Pin | Slot | Weld | Rod | Rope, Field(discriminator="type")]
