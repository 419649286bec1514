"""Joints. Anchors are in the frames of their bodies [m]; one left out follows from the other."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from sandbox.values.numbers import (
    POSITIVE,
    Angle,
    Distance,
    Duration,
    Flag,
    Force,
    Length,
    Name,
    Number,
    Pair,
    Point,
    Ratio,
    RotaryDamping,
    Stiffness,
    Torque,
)
from sandbox.values.spec import TYPE, Spec
from sandbox.wording import WrongValueError

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
    collide: Flag = False
    """Whether the two bodies may touch each other; by default they pass through each other, also
    while the joint is let go."""
    breaks_at: Annotated[Force, POSITIVE] | None = None
    """The size of its ``reaction`` above which it is let go [N], for good unless an event takes it
    up again; by default it never breaks."""
    released: Flag = False
    """Whether it is let go from the start, until an event takes it up."""

    @model_validator(mode="after")
    def _anchored(self) -> Self:
        if self.a == self.b:
            raise WrongValueError("conflicting-keys", "'a' and 'b' must be two bodies")
        if self.on_a is None and self.on_b is None:
            raise WrongValueError("conflicting-keys", "give 'on_a' or 'on_b'")
        return self


class _Closing(_JointSpec):
    takes_up_in: Duration = 0.01
    """How gently a gap closes once the joint is taken up again [s]: over so long most of it goes,
    without a jolt, with a force of some m * gap / takes_up_in^2."""


class _RubbingSpec(_Closing):
    friction_coefficient: Ratio = 0.0
    """Of dry friction that hangs on what the joint carries: it rubs with this times its reaction;
    none by default."""
    static: Ratio = Field(default=1.0, ge=1)
    """How many times as much as it rubs with while it slides it holds with while it does not, 1 or
    more; by default just as much."""

    @property
    def rubs(self) -> bool:
        """Whether it has dry friction."""
        return bool(self.constant_friction or self.friction_coefficient)

    @property
    def constant_friction(self) -> float:
        """Its dry friction that hangs on nothing [N m, N]."""
        return float(getattr(self, "friction", 0.0))

    @model_validator(mode="after")
    def _rubbing(self) -> Self:
        constant = self.constant_friction
        if constant and self.friction_coefficient:
            raise WrongValueError("conflicting-keys", "give 'friction' or 'friction_coefficient', "
                                  "not both")
        if self.static > 1 and not self.rubs:
            raise WrongValueError("conflicting-keys", "'static' needs 'friction' or "
                                  "'friction_coefficient'")
        return self


class Pin(_RubbingSpec):
    """A hinge: two bodies turn about one point.

    Its angle is that of ``b`` against ``a``, in its own sense.
    """

    type: Literal["pin"] = TYPE
    positive: Turn = "counterclockwise"
    """The turn of ``b`` against ``a``, as seen, that counts as positive: of angle, rate, limits,
    springs, torques and motors of this hinge."""
    zero: Angle = 0.0
    """Subtracted from the angle between the two frames [rad] once that is counted in the positive
    sense: where it is clockwise, the hinge's angle is minus the frames' angle, minus ``zero``."""
    limits: Pair[Angle] | None = None
    """Hard stops [lowest, highest] of the hinge's angle [rad]; none by default."""
    damping: RotaryDamping = 0.0
    """Viscous friction of the hinge [N m s/rad]: torque against the rate, per rate."""
    friction: Torque = Field(default=0.0, ge=0)
    """Dry friction of the hinge [N m]: it holds against torques up to this, and slips against this
    one; none by default."""
    pin_radius: Length | None = None
    """Radius at which a pin with a 'friction_coefficient' rubs [m]: its torque is the coefficient
    times this times the reaction."""

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


class Slot(_RubbingSpec):
    """A point of ``b`` slides along a groove of ``a`` that runs from ``start`` to ``end``."""

    type: Literal["slot"] = TYPE
    start: Point
    """One end of the groove, in the frame of ``a`` [m]."""
    end: Point
    """Other end of the groove, in the frame of ``a`` [m]; the point stops hard at either."""
    turns: Flag = True
    """Whether ``b`` may turn on the groove: true leaves its angle free, false keeps the angle that
    the two bodies have to each other at t = 0, as a slider does."""
    on_a: Point | None = None
    """Not used: ``start`` and ``end`` say where the groove is."""
    on_b: Point | None = (0.0, 0.0)
    """The point of ``b`` that stays on the groove, in its frame [m]."""
    friction: Force = Field(default=0.0, ge=0)
    """Dry friction along the groove [N]: it holds against forces up to this, and slides against
    this one; none by default."""


class Weld(_Closing):
    """Two bodies held rigidly together."""

    type: Literal["weld"] = TYPE


class Rod(_Closing):
    """A massless rigid rod between two points."""

    type: Literal["rod"] = TYPE
    length: Length | None = None
    """Distance that the two points keep [m]; by default what it is at t = 0."""
    on_a: Point | None = (0.0, 0.0)
    """One of the points, in the frame of ``a`` [m]."""
    on_b: Point | None = (0.0, 0.0)
    """The other point, in the frame of ``b`` [m]."""


class Rope(_JointSpec):
    """Keeps two points between a least and a largest distance.

    With ``shortest`` 0 it is a slack rope, otherwise a telescopic rod. It does
    not stretch, and its jolt is inelastic: where it becomes taut both ends go
    on at one speed along it, at any step. A tendon is elastic.
    """

    type: Literal["rope"] = TYPE
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
            raise WrongValueError("out-of-range", "'shortest' must not be greater than 'longest'")
        return self


class Actuator(_JointSpec):
    """A cylinder, screw or solenoid between two points, as seen from outside.

    By itself it gives way freely between its ends of stroke. Drives make it work: ``push`` sets its
    force, ``extend`` the speed at which it grows longer, ``length`` its length.
    """

    type: Literal["actuator"] = TYPE
    shortest: Distance = 0.0
    """Distance of the two points with the rod drawn in [m]: a hard stop; none by default."""
    longest: Length | None = None
    """Distance of the two points with the rod out [m]: a hard stop; none by default."""
    on_a: Point | None = (0.0, 0.0)
    """Where the cylinder is held, in the frame of ``a`` [m]."""
    on_b: Point | None = (0.0, 0.0)
    """Where the rod is held, in the frame of ``b`` [m]."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.longest is not None and self.shortest >= self.longest:
            raise WrongValueError("out-of-range", "'shortest' must be less than 'longest'")
        return self


PressureAngle = Annotated[Angle, Field(gt=0, le=math.pi / 4)]


class Gear(_JointSpec):
    """Two gears that mesh, with involute teeth, outside or one inside the other.

    What holds their centres is up to other joints: pins on the ground or on a carrier. Teeth mesh
    as they stand at t = 0. They push along the line of action, which makes the pressure angle with
    the common tangent of the pitch circles; so beside the tangential force there is a radial one,
    which the bearings carry.
    """

    type: Literal["gear"] = TYPE
    radius_a: Length
    """Of the pitch circle of ``a``, whose centre is ``on_a``."""
    radius_b: Length
    """Of the pitch circle of ``b``, whose centre is ``on_b``."""
    inside: Flag = False
    """True: the smaller gear runs inside the larger one, a ring with teeth inside."""
    pressure_angle: PressureAngle = math.radians(20.0)
    """Between the line of action and the common tangent of the pitch circles, up to 45 deg."""
    backlash: Distance = 0.0
    """Play of the teeth along the pitch circles; at t = 0 they stand in its middle."""
    stiffness: Stiffness = Field(default=1e9, gt=0)
    """Of teeth without play, along the line of action [N/m]: by this several planets share a
    load. Of steel teeth about 1.4e10 N/m per metre of their width."""
    on_a: Point = (0.0, 0.0)
    """Centre of the first wheel in the frame of ``a`` [m]."""
    on_b: Point = (0.0, 0.0)
    """Centre of the second wheel in the frame of ``b`` [m]."""

    @model_validator(mode="after")
    def _different(self) -> Self:
        if self.inside and self.radius_a == self.radius_b:
            raise WrongValueError("out-of-range", "the radii of gear and ring must differ")
        return self


class Rack(_JointSpec):
    """A gear ``a`` and a straight rack ``b`` that mesh, as gears do.

    The pitch line has no ends: a rack that is drawn shorter goes on meshing beyond what is drawn.
    """

    type: Literal["rack"] = TYPE
    radius: Length
    """Of the pitch circle of ``a``, whose centre is ``on_a``."""
    along: Pair[Number] = (1.0, 0.0)
    """Direction of the rack's pitch line in the frame of ``b``; its length does not count."""
    pressure_angle: PressureAngle = math.radians(20.0)
    """Between the line of action and the pitch line, up to 45 deg."""
    backlash: Distance = 0.0
    """Play of the teeth along the pitch line; at t = 0 they stand in its middle."""
    stiffness: Stiffness = Field(default=1e9, gt=0)
    """Of teeth without play, along the line of action [N/m]."""
    on_a: Point = (0.0, 0.0)
    """Centre of the gear in the frame of ``a`` [m]."""
    on_b: Point = (0.0, 0.0)
    """A point of the pitch line in the frame of ``b`` [m]."""

    @field_validator("along")
    @classmethod
    def _not_zero(cls, along: tuple[float, float]) -> tuple[float, float]:
        if along == (0.0, 0.0):
            raise WrongValueError("out-of-range", "[0, 0] is no direction")
        return along


class Roll(_JointSpec):
    """Two circles that roll on one another without slip and stay in touch (a Hillberry joint).

    Crossed bands hold such a joint together; here it can be pulled as well as pressed.
    """

    type: Literal["roll"] = TYPE
    radius_a: Length
    """Of the circle of ``a``, whose centre is ``on_a``."""
    radius_b: Length
    """Of the circle of ``b``, whose centre is ``on_b``."""
    inside: Flag = False
    """True: the smaller circle rolls inside the larger one."""
    on_a: Point = (0.0, 0.0)
    """Centre of the first wheel in the frame of ``a`` [m]."""
    on_b: Point = (0.0, 0.0)
    """Centre of the second wheel in the frame of ``b`` [m]."""

    @model_validator(mode="after")
    def _different(self) -> Self:
        if self.inside and self.radius_a == self.radius_b:
            raise WrongValueError("out-of-range", "the radii of both circles must differ")
        return self


Joint = Annotated[Pin | Slot | Weld | Rod | Rope | Actuator | Gear | Rack | Roll,
                  Field(discriminator="type")]
