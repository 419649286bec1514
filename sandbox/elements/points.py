"""Joints of points: pins, slots and welds; rods, ropes and actuators."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from sandbox.elements.element import KEPT, OTHER_SIDE, Turn
from sandbox.elements.joint import (
    FRICTION,
    REACTION,
    ClosingJoint,
    FrictionJoint,
    JointKind,
    JointSpec,
)
from sandbox.values import numbers as of
from sandbox.values.spec import TYPE
from sandbox.values.tables import check_distinct
from sandbox.wording import WrongValueError, listed

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft
    from sandbox.scene.mechanism import Mechanism
    from sandbox.scene.parts.placement import Mover


class Pin(FrictionJoint):
    """A hinge: two bodies turn about one point.

    Its angle is that of ``b`` against ``a``, in its own sense.
    """

    facts = JointKind(
        "point", ("angle", "rate", *REACTION, "damping", "damping_work"), angle=True,
        friction_unit="N m", more={"limits": ("stop",), "has_friction": FRICTION})

    type: Literal["pin"] = TYPE
    positive: Annotated[Turn, OTHER_SIDE] = "counterclockwise"
    """Sense of rotation of ``b`` against ``a`` that counts as positive: for angle, rate, limits,
    springs, torques and motors of this hinge."""
    zero: Annotated[of.Angle, KEPT] = 0.0
    """Subtracted from the angle between the frames, in the positive sense [rad]."""
    limits: Annotated[of.Pair[of.Angle] | None, KEPT] = None
    """Hard stops [lowest, highest] of the hinge's angle [rad]; none by default."""
    damping: of.RotaryDamping = 0.0
    """Viscous friction of the hinge [N m s/rad]: torque against the rate, per rate."""
    friction: of.Torque = Field(default=0.0, ge=0)
    """Dry friction of the hinge [N m]: torque up to which it holds, and at which it slips."""
    pin_radius: of.Length | None = None
    """With a 'friction_coefficient' [m]: friction torque = coefficient * radius * reaction."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.limits is not None and self.limits[0] >= self.limits[1]:
            raise WrongValueError("out-of-range", "limits are [lowest, highest]")
        if self.friction_coefficient and self.pin_radius is None:
            raise WrongValueError("conflicting-keys", "the 'friction_coefficient' of a pin needs a "
                                  "'pin_radius'")
        if self.pin_radius is not None and not self.friction_coefficient:
            raise WrongValueError("conflicting-keys", "'pin_radius' needs a 'friction_coefficient'")
        return self

    @property
    def sense(self) -> float:
        """+1 or -1: the factor from a counter-clockwise turn to the positive one."""
        return 1.0 if self.positive == "counterclockwise" else -1.0

    @property
    def coefficient(self) -> float:
        """Friction torque per reaction [m]."""
        return self.friction_coefficient * (self.pin_radius or 0.0)

    def placed(self, mover: Mover) -> Mapping[str, Any]:
        """Keep the angle at t = 0 of a hinge between an assembly and the scene around it.

        From sense (b - a) - zero, with s a + g for the angle of a body of the assembly and
        s sense for the sense.
        """
        inner = [name in mover.own for name in (self.a, self.b)]
        if all(inner) or not any(inner):
            return {}
        body = mover.outer_body(self.a if inner[1] else self.b, "")
        s, turn = mover.placement.sign, mover.placement.angle
        moved = s * self.sense * (turn - body.angle) + self.sense * body.angle
        return {"zero": self.zero + (moved if inner[1] else -moved)}

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A PivotJoint; a RotaryLimitJoint as stops, SimpleMotors as damper and as friction."""
        draft.joint(index, "PivotJoint", *draft.anchors(index))
        if self.limits:
            stops = sorted(self.sense * (limit + self.zero) for limit in self.limits)
            draft.add("constraint", f"{self.name}.stop", "RotaryLimitJoint", self.a, self.b, *stops)
        if self.damping:
            draft.add("damper", f"{self.name}.damping", self.a, self.b, self.damping)
        if self.friction:
            draft.add("constraint", f"{self.name}.friction", "SimpleMotor", self.a, self.b, 0.0,
                      max_force=self.friction)


class Slot(FrictionJoint):
    """A point of ``b`` slides along a groove of ``a``, straight or along a smooth path."""

    facts = JointKind(
        "groove", REACTION, friction_unit="N",
        more={"has_friction": FRICTION, "path": ("position", "speed", "normal")},
        mujoco_loop="a groove that closes a loop")
    LACKS: ClassVar[Mapping[str, str]] = {
        "path": "a groove along a path", "friction": "friction in a groove", **FrictionJoint.LACKS}

    type: Literal["slot"] = TYPE
    start: of.Point | None = None
    """One end of a straight groove, in the frame of ``a`` [m]."""
    end: of.Point | None = None
    """Other end of the groove, in the frame of ``a`` [m]; both ends are hard stops."""
    path: Annotated[of.Items[of.Point], Field(min_length=3, max_length=1000)] | None = None
    """In place of ``start`` and ``end``: points of a curved groove in the frame of ``a`` [m].

    The groove is the smooth curve through them in this order, a quintic spline; its ends are hard
    stops."""
    closed: of.Flag = False
    """Whether the path continues from its last point to the first; then it has no ends."""
    turns: of.Flag = True
    """Whether ``b`` may rotate on the groove; false keeps its angle to ``a``, as in a slider."""
    on_a: of.Point | None = None
    """Not used: ``start`` and ``end``, or ``path``, define the groove."""
    on_b: of.Point | None = (0.0, 0.0)
    """The point of ``b`` that stays on the groove, in its frame [m]."""
    friction: of.Force = Field(default=0.0, ge=0)
    """Dry friction along the groove [N]: force up to which it holds, and at which it slides."""

    @model_validator(mode="after")
    def _along(self) -> Self:
        missing = [name for name in ("start", "end") if getattr(self, name) is None]
        if self.path is None:
            if missing:
                raise WrongValueError("missing-key", f"{listed(missing)} "
                                      f"{'are' if len(missing) > 1 else 'is'} missing",
                                      allowed="'start' and 'end', or a 'path'")
            if self.closed:
                raise WrongValueError("conflicting-keys", "'closed' belongs to a 'path'")
            return self
        if len(missing) < 2:
            raise WrongValueError("conflicting-keys", "give 'start' and 'end', or a 'path'")
        check_distinct(self.path, closed=self.closed)
        return self

    def columns(self, mechanism: Mechanism) -> dict[str, Any]:
        """Its numbers in columns of the model that are no attributes of it."""
        return {"coefficient": self.friction_coefficient,
                "groove": None if self.path else (self.start, self.end)}

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A GrooveJoint; a GearJoint keeps the angle."""
        draft.joint(index, "GrooveJoint", self.start, self.end, draft.anchors(index)[1])
        if not self.turns:
            draft.add("constraint", f"{self.name}.angle", "GearJoint", self.a, self.b,
                      draft.turn(index), 1.0)


class Weld(ClosingJoint):
    """Two bodies held rigidly together."""

    facts = JointKind("point", REACTION)

    turns: ClassVar[bool] = False

    type: Literal["weld"] = TYPE

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A PivotJoint; a GearJoint keeps the angle."""
        draft.joint(index, "PivotJoint", *draft.anchors(index))
        draft.add("constraint", f"{self.name}.angle", "GearJoint", self.a, self.b,
                  draft.turn(index), 1.0)


class BarJoint(JointSpec):
    """A joint of the distance of two points."""

    on_a: of.Point | None = (0.0, 0.0)
    """Attachment, in the frame of ``a`` [m]."""
    on_b: of.Point | None = (0.0, 0.0)
    """Attachment, in the frame of ``b`` [m]."""


class Rod(BarJoint, ClosingJoint):
    """A massless rigid rod between two points."""

    facts = JointKind("distance", (*REACTION, "tension"))

    type: Literal["rod"] = TYPE
    length: of.Length | None = None
    """Distance between the two points [m]; by default that at t = 0."""

    def columns(self, mechanism: Mechanism) -> dict[str, Any]:
        """Its numbers in columns of the model that are no attributes of it."""
        length = self.length
        if length is None:
            on_a, on_b = mechanism.anchors(self)
            length = math.dist(mechanism.world(self.a, on_a), mechanism.world(self.b, on_b))
        return {"reach": (length, length)}

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A PinJoint."""
        draft.joint(index, "PinJoint", *draft.anchors(index),
                    distance=draft.model.joints.reach[index, 0])


class RangeJoint(BarJoint):
    """A joint between a minimum and a maximum distance."""

    if TYPE_CHECKING:
        shortest: float
        longest: float | None

    def columns(self, mechanism: Mechanism) -> dict[str, Any]:
        """Its numbers in columns of the model that are no attributes of it."""
        return {"reach": (self.shortest, self.longest or math.inf)}

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A SlideJoint."""
        draft.joint(index, "SlideJoint", *draft.anchors(index), *draft.model.joints.reach[index])


class Rope(RangeJoint):
    """Keeps the distance of two points between a minimum and a maximum.

    With ``shortest`` 0 it is a slack rope, otherwise a telescopic rod. It does not stretch, and it
    becomes taut without rebound: both ends then have the same speed along it, at any step. A tendon
    is elastic.
    """

    facts = JointKind("range", (*REACTION, "tension"))

    type: Literal["rope"] = TYPE
    longest: of.Length
    """Largest distance of the two points [m]."""
    shortest: of.Distance = 0.0
    """Minimum distance between the two points [m]; 0 sets no minimum."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.shortest > self.longest:
            raise WrongValueError("out-of-range", "'shortest' must not be greater than 'longest'")
        return self


class Actuator(RangeJoint):
    """A cylinder, screw or solenoid between two points.

    Without a drive it moves freely between its ends of stroke. The drive ``push`` sets its force,
    ``extend`` its speed of extension, ``length`` its length.
    """

    facts = JointKind("range", ("length", "speed", *REACTION), line=True)

    type: Literal["actuator"] = TYPE
    shortest: of.Distance = 0.0
    """Distance of the two points with the rod drawn in [m]: a hard stop; none by default."""
    longest: of.Length | None = None
    """Distance of the two points with the rod out [m]: a hard stop; none by default."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.longest is not None and self.shortest >= self.longest:
            raise WrongValueError("out-of-range", "'shortest' must be less than 'longest'")
        return self
