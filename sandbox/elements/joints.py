"""Joints of points (pins, slots, welds, rods, ropes, actuators) and of wheels."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field

from sandbox.elements import element as base
from sandbox.elements.element import KEPT, BodyName, Element, Quantity, computed, live
from sandbox.errors import Problem
from sandbox.values import numbers as of
from sandbox.values.spec import TYPE
from sandbox.values.tables import check_distinct
from sandbox.wording import listed, quoted, refuse_if

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft
    from sandbox.scene.mechanism import Mechanism
    from sandbox.scene.parts.placement import Mover

Keeps = Literal["point", "groove", "distance", "range", "gear", "rack", "roll"]


@dataclass(frozen=True)
class JointKind:
    """Facts about a kind of joint."""

    # two coinciding points; a point of b on a line of a; a distance of two points, or a range of
    # it; meshing teeth of two gears, or of a gear and a rack; rolling circles
    keeps: Keeps
    records: tuple[str, ...]  # the quantities that every joint of the kind records
    line: bool = False  # whether it has a length, which drives can push and set
    angle: bool = False  # whether it has an angle, for stops, rotary springs, torques, motors
    friction_unit: str = ""  # unit of its dry friction; empty where it has none
    # additional quantities with limits, backlash, has_friction or a path
    more: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    mujoco: str = ""  # why MuJoCo has no counterpart; empty where it has one
    mujoco_loop: str = ""  # why MuJoCo has no counterpart of such a joint that closes a loop

    @property
    def forces(self) -> int:
        """Number of unknown components of its reaction: 1 if its direction is known, else 2."""
        return 2 if self.keeps in ("point", "roll") else 1

    @property
    def wheels(self) -> bool:
        """Whether its bodies act on each other where two wheels, or a wheel and a rack, meet."""
        return self.teeth or self.keeps == "roll"

    @property
    def teeth(self) -> bool:
        return self.keeps in ("gear", "rack")

    @property
    def along_line(self) -> bool:
        """Whether its force is along the line through its two points."""
        return self.keeps in ("distance", "range")


REACTION = ("reaction", "reaction_x", "reaction_y")
FRICTION = ("friction", "friction_work", "sticks")
QUANTITIES: Mapping[str, Quantity] = {
    "angle": live("joint_angle", "rad", "of `b` against `a`, in the hinge's positive sense"),
    "rate": live("joint_rate", "rad/s", "rate of the angle"),
    "length": live("joint_length", "m", "of an actuator, between its two points"),
    "position": live("joint_length", "m", "of a slot with a path: arc length from the path's first "
                                          "point; it counts on over rounds of a closed path"),
    "speed": live("joint_speed", "m/s", "rate of the length, or of the position on a path"),
    "normal": computed("N", "of a slot with a path: force on `b` across it, positive to its left"),
    "reaction": live("joint_reaction", "N", "magnitude of the reaction force"),
    "reaction_x": live("joint_force", "N", "force on `b` by `a`, in the world", 0),
    "reaction_y": live("joint_force", "N", "the same, upwards", 1),
    "tension": computed("N", "of rods and ropes: reaction, positive in tension", live=True),
    "tangential": computed("N", "of wheels: force on `b` along the pitch circles, positive as `a` "
                                "pushes by turning counter-clockwise"),
    "radial": computed("N", "of wheels: force along the centres, positive if it pushes them apart"),
    "gap": computed("m", "of teeth with backlash: distance to the nearer flank, on pitch circles"),
    "damping": Quantity("joint_damping", "N m", "torque of all its dampers, in the hinge's sense"),
    "damping_work": Quantity("joint_damping_work", "J", "work of all its dampers since t = 0"),
    "stop": Quantity("joint_stop", "N m", "torque of its hard stop, in the hinge's sense"),
    "friction": live("joint_friction", "", "dry friction on `b`: of a pin the torque in its sense; "
                                           "of a slot the force, positive towards its `end`"),
    "friction_work": Quantity("joint_friction_work", "J", "work of dry friction since t = 0"),
    "sticks": live("joint_sticks", "1", "1 while dry friction holds it, else 0", yes_no=True),
}


class JointSpec(Element):
    """The base of all joints."""

    facts: ClassVar[JointKind]
    name: of.Name
    """Its name; quantities are ``<name>.reaction`` and so on."""
    a: BodyName
    """The reference body: a hinge's angle is that of ``b`` against it, a groove moves with it."""
    b: BodyName
    """The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``."""
    on_a: of.Point | None = None
    """Anchor in the frame of ``a`` [m]; by default where ``on_b`` is at t = 0."""
    on_b: of.Point | None = None
    """Anchor in the frame of ``b`` [m]; by default where ``on_a`` is at t = 0."""
    collide: of.Flag = False
    """Whether the two bodies may touch; by default they never do, even if the joint is released."""
    breaks_at: Annotated[of.Force, of.POSITIVE] | None = None
    """Its ``reaction`` above which it breaks [N], until an event engages it; never by default."""
    released: of.Flag = False
    """Whether it starts released, until an event engages it."""

    def _verify(self) -> None:
        refuse_if(self.a == self.b, "'a' and 'b' must be two bodies")
        refuse_if(self.on_a is None and self.on_b is None, "give 'on_a' or 'on_b'")

    def quantities(self, mechanism: Mechanism) -> dict[str, str]:
        kind = self.facts
        names = [*kind.records, *(
            name for field, more in kind.more.items() for name in more
            if getattr(self, field, None))]
        return {name: QUANTITIES[name].unit or kind.friction_unit for name in names}

    def needed(self, quantity: str) -> str:
        field = next((field for field, more in self.facts.more.items() if quantity in more), "")
        return "'friction' or 'friction_coefficient'" if field == "has_friction" else (
            field and f"'{field}'")

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        ends = [next((body for body in mechanism.bodies if body.name == name), None)
                for name in (self.a, self.b)]
        if all(body is not None and body.motion != "dynamic" for body in ends):
            yield Problem("no-effect",
                          f"neither {quoted(self.a)} nor {quoted(self.b)} can move freely",
                          path, allowed="a joint of at least one dynamic body")
        if self.released and self.facts.wheels:
            yield base.no_mesh(self.name, f"{path}.released")


class ClosingJoint(JointSpec):
    """A joint that closes its gap when it is engaged again."""

    takes_up_in: of.Duration = 0.01
    """Time in which its gap closes when it is engaged again [s]; force m * gap / takes_up_in^2."""


class FrictionJoint(ClosingJoint):
    """A joint that may have dry friction."""

    LACKS: ClassVar[Mapping[str, str]] = {
        "friction_coefficient": "joint friction that depends on the reaction",
        "static": "static friction above that of sliding"}

    if TYPE_CHECKING:
        friction: float

    friction_coefficient: of.Ratio = 0.0
    """Coefficient of dry friction: friction is this times the reaction; none by default."""
    static: of.Ratio = Field(default=1.0, ge=1)
    """Ratio of static to sliding friction, 1 or more; 1 by default."""

    @property
    def has_friction(self) -> bool:
        return bool(self.friction or self.friction_coefficient)

    def _verify(self) -> None:
        super()._verify()
        refuse_if(self.friction and self.friction_coefficient,
                  "give 'friction' or 'friction_coefficient', not both")
        refuse_if(self.static > 1 and not self.has_friction,
                  "'static' needs 'friction' or 'friction_coefficient'")


class Pin(FrictionJoint):
    """A hinge: two bodies turn about one point.

    Its angle is that of ``b`` against ``a``, in its own sense.
    """

    facts = JointKind(
        "point", ("angle", "rate", *REACTION, "damping", "damping_work"), angle=True,
        friction_unit="N m", more={"limits": ("stop",), "has_friction": FRICTION})
    type: Literal["pin"] = TYPE
    positive: Annotated[base.Turn, base.OTHER_SIDE] = "counterclockwise"
    """Positive sense of rotation of ``b`` against ``a``, for all quantities of this hinge."""
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

    def _verify(self) -> None:
        super()._verify()
        refuse_if(self.limits is not None and self.limits[0] >= self.limits[1],
                  "limits are [lowest, highest]", "out-of-range")
        refuse_if(self.friction_coefficient and self.pin_radius is None,
                  "the 'friction_coefficient' of a pin needs a 'pin_radius'")
        refuse_if(self.pin_radius is not None and not self.friction_coefficient,
                  "'pin_radius' needs a 'friction_coefficient'")

    @property
    def sense(self) -> float:
        """+1 or -1: the factor from a counter-clockwise turn to the positive one."""
        return 1.0 if self.positive == "counterclockwise" else -1.0

    @property
    def coefficient(self) -> float:
        """Friction torque per reaction [m]."""
        return self.friction_coefficient * (self.pin_radius or 0.0)

    def placed(self, mover: Mover) -> Mapping[str, Any]:
        """Keep the angle at t = 0, sense (b - a) - zero, of a hinge between inside and outside."""
        inner = [name in mover.own for name in (self.a, self.b)]
        if all(inner) or not any(inner):
            return {}
        body = mover.outer_body(self.a if inner[1] else self.b, "")
        s, turn = mover.sign, mover.angle
        moved = s * self.sense * (turn - body.angle) + self.sense * body.angle
        return {"zero": self.zero + (moved if inner[1] else -moved)}

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
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
    """In place of ``start`` and ``end``: points of a curved groove in the frame of ``a`` [m], a
    quintic spline through them in this order; its ends are hard stops."""
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

    def _verify(self) -> None:
        super()._verify()
        missing = [name for name in ("start", "end") if getattr(self, name) is None]
        if self.path is None:
            are = "are" if len(missing) > 1 else "is"
            refuse_if(missing, f"{listed(missing)} {are} missing", "missing-key",
                      allowed="'start' and 'end', or a 'path'")
            refuse_if(self.closed, "'closed' belongs to a 'path'")
        else:
            refuse_if(len(missing) < 2, "give 'start' and 'end', or a 'path'")
            check_distinct(self.path, closed=self.closed)

    @property
    def groove(self) -> tuple[Any, Any] | None:
        return None if self.path else (self.start, self.end)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        draft.joint(index, "GrooveJoint", self.start, self.end, draft.anchors(index)[1])
        if not self.turns:
            draft.hold_angle(index)


class Weld(ClosingJoint):
    """Two bodies held rigidly together."""

    facts = JointKind("point", REACTION)
    turns: ClassVar[bool] = False
    type: Literal["weld"] = TYPE

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        draft.joint(index, "PivotJoint", *draft.anchors(index))
        draft.hold_angle(index)


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
        length = self.length
        if length is None:
            on_a, on_b = mechanism.anchors(self)
            length = math.dist(mechanism.world(self.a, on_a), mechanism.world(self.b, on_b))
        return {"reach": (length, length)}

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        draft.joint(index, "PinJoint", *draft.anchors(index),
                    distance=draft.model.joints.reach[index, 0])


class RangeJoint(BarJoint):
    """A joint between a minimum and a maximum distance."""

    shortest: of.Distance = 0.0
    """Minimum distance of the two points [m], a hard stop; none by default."""
    longest: of.Length | None = None
    """Maximum distance of the two points [m], a hard stop; none by default."""

    def _verify(self) -> None:
        super()._verify()
        refuse_if(self.longest is not None and self.shortest > self.longest,
                  "'shortest' must not be greater than 'longest'", "out-of-range")

    @property
    def reach(self) -> tuple[float, float]:
        return self.shortest, self.longest or math.inf

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        draft.joint(index, "SlideJoint", *draft.anchors(index), *draft.model.joints.reach[index])


class Rope(RangeJoint):
    """Keeps the distance of two points between a minimum and a maximum.

    With ``shortest`` 0 it is a slack rope, otherwise a telescopic rod. It does not stretch, and it
    becomes taut without rebound. A tendon is elastic.
    """

    facts = JointKind("range", (*REACTION, "tension"))
    type: Literal["rope"] = TYPE
    longest: of.Length
    """Maximum distance of the two points [m]."""


class Actuator(RangeJoint):
    """A cylinder, screw or solenoid between two points.

    Without a drive it moves freely between its ends of stroke. The drive ``push`` sets its force,
    ``extend`` its speed of extension, ``length`` its length.
    """

    facts = JointKind("range", ("length", "speed", *REACTION), line=True)
    type: Literal["actuator"] = TYPE


MESH = (*REACTION, "tangential", "radial")
TEETH = "teeth: MuJoCo couples only the joint angles, without forces on the bearings"


class CircleJoint(JointSpec):
    """A joint of two circles."""

    radius_a: of.Length
    """Radius of the circle of ``a``, of a gear its pitch radius; ``on_a`` is the centre."""
    radius_b: of.Length
    """Radius of the circle of ``b``, of a gear its pitch radius; ``on_b`` is the centre."""
    inside: of.Flag = False
    """True: the smaller circle is inside the larger one, as in a ring gear."""
    on_a: of.Point = (0.0, 0.0)
    """Centre of the first wheel in the frame of ``a`` [m]."""
    on_b: of.Point = (0.0, 0.0)
    """Centre of the second wheel in the frame of ``b`` [m]."""

    def _verify(self) -> None:
        super()._verify()
        refuse_if(self.inside and self.radius_a == self.radius_b,
                  "with 'inside' the two radii must differ", "out-of-range")

    @property
    def radii(self) -> tuple[float, float]:
        return self.radius_a, self.radius_b


class ToothedJoint(JointSpec):
    """A joint of teeth."""

    pressure_angle: Annotated[of.Angle, Field(gt=0, le=math.pi / 4), KEPT] = math.radians(20.0)
    """Between the line of action and the tangent of the pitch circles, up to 45 deg."""
    backlash: of.Distance = 0.0
    """Backlash along the pitch circles or the pitch line; the teeth are centred at t = 0."""
    stiffness: of.Stiffness = Field(default=1e9, gt=0)
    """Stiffness along the line of action, without backlash [N/m]: planet gears share a load by it.
    Steel teeth have about 1.4e10 N/m per metre of width."""


class Gear(CircleJoint, ToothedJoint):
    """Two gears that mesh, with involute teeth, outside or one inside the other.

    Other joints hold their centres: pins on the ground or on a carrier. Teeth mesh as they stand at
    t = 0. They push along the line of action, at the pressure angle to the common tangent of the
    pitch circles, so the bearings carry a radial force too.
    """

    facts = JointKind("gear", MESH, more={"backlash": ("gap",)}, mujoco=TEETH)
    type: Literal["gear"] = TYPE

    def without_pymunk(self, mechanism: Mechanism) -> str:
        fixed = {body.name for body in mechanism.bodies if body.motion == "fixed"}
        held = {body for joint in mechanism.joints if joint.facts.angle
                for body, other in ((joint.a, joint.b), (joint.b, joint.a)) if other in fixed}
        if {self.a, self.b} - held - fixed:
            return "gears whose centres move: a GearJoint counts angles against the world"
        return "teeth with backlash" if self.backlash else ""

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A GearJoint, which has no forces on the bearings."""
        ratio = (1 if self.inside else -1) * self.radius_b / self.radius_a
        a, b = (draft.model.bodies.pose[body, 2] for body in draft.model.joints.bodies[index])
        draft.joint(index, "GearJoint", b * ratio - a, ratio)


class Rack(ToothedJoint):
    """A gear ``a`` and a straight rack ``b`` that mesh, as gears do.

    The pitch line has no ends: a rack that is drawn shorter goes on meshing beyond what is drawn.
    """

    PYMUNK = "a rack: its joints couple no rotation with a displacement"
    facts = JointKind("rack", MESH, more={"backlash": ("gap",)}, mujoco=TEETH)
    type: Literal["rack"] = TYPE
    radius: of.Length
    """Pitch radius of ``a``, whose centre is ``on_a``."""
    along: base.Direction = (1.0, 0.0)
    """Direction of the rack's pitch line in the frame of ``b``; any length."""
    on_a: of.Point = (0.0, 0.0)
    """Centre of the gear in the frame of ``a`` [m]."""
    on_b: of.Point = (0.0, 0.0)
    """A point of the pitch line in the frame of ``b`` [m]."""

    @property
    def radii(self) -> tuple[float, float]:
        return self.radius, math.nan

    def columns(self, mechanism: Mechanism) -> dict[str, Any]:
        """The rack's direction in its frame, of length 1, with the gear to its left."""
        x, y = self.along
        size = math.hypot(x, y)
        px, py = mechanism.world(self.b, self.on_b)
        qx, qy = mechanism.world(self.b, (self.on_b[0] + x / size, self.on_b[1] + y / size))
        gx, gy = mechanism.world(self.a, self.on_a)
        length = math.copysign(size, (qx - px) * (gy - py) - (qy - py) * (gx - px))
        return {"along": (x / length, y / length)}

    def placed(self, mover: Mover) -> Mapping[str, Any]:
        return {"along": mover.direction(self.b, self.along)}


class Roll(CircleJoint):
    """Two circles that roll on one another without slip and stay in touch (a Hillberry joint).

    Crossed bands hold such a joint together; here it can be pulled as well as pressed.
    """

    PYMUNK = "rolling circles as a joint"
    facts = JointKind("roll", MESH, mujoco="rolling circles as a joint")
    type: Literal["roll"] = TYPE
