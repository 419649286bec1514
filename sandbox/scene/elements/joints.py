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
    """Its name; quantities are ``<name>.reaction`` and so on."""
    a: Name
    """The body that is counted from: a hinge's angle is that of ``b`` against it, a slot's groove
    moves with it."""
    b: Name
    """The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``."""
    on_a: Point | None = None
    """Anchor in the frame of ``a`` [m]; by default where ``on_b`` is at t = 0."""
    on_b: Point | None = None
    """Anchor in the frame of ``b`` [m]; by default where ``on_a`` is at t = 0."""
    collide: bool = False
    """Whether the two bodies may touch each other; by default they pass through each other."""

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
    """The turn of ``b`` against ``a``, as seen, that counts as positive: of angle, rate, limits,
    springs, torques and motors of this hinge."""
    zero: Angle = 0.0
    """Subtracted from the angle between the two frames [rad] once that is counted in the positive
    sense: where it is clockwise, the hinge's angle is minus the frames' angle, minus ``zero``."""
    limits: tuple[Angle, Angle] | None = None
    """Hard stops [lowest, highest] of the hinge's angle [rad]; none by default."""
    damping: RotaryDamping = 0.0
    """Viscous friction of the hinge [N m s/rad]: torque against the rate, per rate."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.limits is not None and self.limits[0] >= self.limits[1]:
            raise PydanticCustomError("limits", "limits are [lowest, highest]")
        return self


class Slot(_JointSpec):
    """A point of ``b`` on a groove of ``a`` that runs from ``start`` to ``end`` (GrooveJoint)."""

    type: Literal["slot"]
    start: Point
    """One end of the groove, in the frame of ``a`` [m]."""
    end: Point
    """Other end of the groove, in the frame of ``a`` [m]; the point stops hard at either."""
    turns: bool = True
    """Whether ``b`` may turn on the groove: true leaves its angle free, false keeps the angle that
    the two bodies have to each other at t = 0, as a slider does."""
    on_a: Point | None = None
    """Not used: ``start`` and ``end`` say where the groove is."""
    on_b: Point | None = (0.0, 0.0)
    """The point of ``b`` that stays on the groove, in its frame [m]."""


class Weld(_JointSpec):
    """Two bodies held together (PivotJoint and GearJoint)."""

    type: Literal["weld"]


class Rod(_JointSpec):
    """A massless rigid rod between two points (PinJoint)."""

    type: Literal["rod"]
    length: Length | None = None
    """Distance that the two points keep [m]; by default what it is at t = 0."""
    on_a: Point | None = (0.0, 0.0)
    """One of the points, in the frame of ``a`` [m]."""
    on_b: Point | None = (0.0, 0.0)
    """The other point, in the frame of ``b`` [m]."""


class Rope(_JointSpec):
    """Keeps two points between a least and a largest distance (SlideJoint).

    With ``shortest`` 0 it is a slack rope, otherwise a telescopic rod. It does
    not stretch, and its jerk is inelastic: where it becomes taut both ends go
    on at one speed along it, at any step. A tendon is elastic.
    """

    type: Literal["rope"]
    longest: Length
    """Largest distance of the two points [m]."""
    shortest: Distance = 0.0
    """Least distance of the two points [m]; 0 leaves them free to come together."""
    on_a: Point | None = (0.0, 0.0)
    """One of the points, in the frame of ``a`` [m]."""
    on_b: Point | None = (0.0, 0.0)
    """The other point, in the frame of ``b`` [m]."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.shortest > self.longest:
            raise PydanticCustomError("limits", "'shortest' is larger than 'longest'")
        return self


Joint = Annotated[Pin | Slot | Weld | Rod | Rope, Field(discriminator="type")]
