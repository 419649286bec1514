"""Joints of a distance: rods, ropes and actuators."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from pydantic import model_validator

from sandbox.elements.joint import REACTION, Anchors, ClosingJoint, JointKind, JointSpec
from sandbox.values.numbers import Distance, Length, Point
from sandbox.values.spec import TYPE
from sandbox.wording import WrongValueError

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft


class Rod(ClosingJoint):
    """A massless rigid rod between two points."""

    facts: ClassVar[JointKind] = JointKind("distance", (*REACTION, "tension"))

    type: Literal["rod"] = TYPE
    length: Length | None = None
    """Distance between the two points [m]; by default that at t = 0."""
    on_a: Point | None = (0.0, 0.0)
    """One of the points, in the frame of ``a`` [m]."""
    on_b: Point | None = (0.0, 0.0)
    """The other point, in the frame of ``b`` [m]."""

    def columns(self, at: Anchors) -> dict[str, Any]:
        """Its columns of :class:`sandbox.model.model.Joints`, besides those of every joint."""
        length = at.distance if self.length is None else self.length
        return {"reach": (length, length)}

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A PinJoint."""
        draft.joint(index, "PinJoint", *draft.anchors(index),
                    distance=draft.model.joints.reach[index, 0])


class Rope(JointSpec):
    """Keeps the distance of two points between a minimum and a maximum.

    With ``shortest`` 0 it is a slack rope, otherwise a telescopic rod. It does not stretch, and it
    becomes taut without rebound: both ends then have the same speed along it, at any step. A tendon
    is elastic.
    """

    facts: ClassVar[JointKind] = JointKind("range", (*REACTION, "tension"))

    type: Literal["rope"] = TYPE
    longest: Length
    """Largest distance of the two points [m]."""
    shortest: Distance = 0.0
    """Minimum distance between the two points [m]; 0 sets no minimum."""
    on_a: Point | None = (0.0, 0.0)
    """One of the points, in the frame of ``a`` [m]."""
    on_b: Point | None = (0.0, 0.0)
    """The other point, in the frame of ``b`` [m]."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.shortest > self.longest:
            raise WrongValueError("out-of-range", "'shortest' must not be greater than 'longest'")
        return self

    def columns(self, at: Anchors) -> dict[str, Any]:
        """Its columns of :class:`sandbox.model.model.Joints`, besides those of every joint."""
        return {"reach": (self.shortest, self.longest)}

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A SlideJoint."""
        draft.joint(index, "SlideJoint", *draft.anchors(index), *draft.model.joints.reach[index])


class Actuator(JointSpec):
    """A cylinder, screw or solenoid between two points.

    Without a drive it moves freely between its ends of stroke. The drive ``push`` sets its force,
    ``extend`` its speed of extension, ``length`` its length.
    """

    facts: ClassVar[JointKind] = JointKind("range", ("length", "speed", *REACTION), line=True)

    type: Literal["actuator"] = TYPE
    shortest: Distance = 0.0
    """Distance of the two points with the rod drawn in [m]: a hard stop; none by default."""
    longest: Length | None = None
    """Distance of the two points with the rod out [m]: a hard stop; none by default."""
    on_a: Point | None = (0.0, 0.0)
    """Attachment of the cylinder, in the frame of ``a`` [m]."""
    on_b: Point | None = (0.0, 0.0)
    """Attachment of the rod, in the frame of ``b`` [m]."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.longest is not None and self.shortest >= self.longest:
            raise WrongValueError("out-of-range", "'shortest' must be less than 'longest'")
        return self

    def columns(self, at: Anchors) -> dict[str, Any]:
        """Its columns of :class:`sandbox.model.model.Joints`, besides those of every joint."""
        return {"reach": (self.shortest, self.longest or math.inf)}

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A SlideJoint."""
        draft.joint(index, "SlideJoint", *draft.anchors(index), *draft.model.joints.reach[index])
