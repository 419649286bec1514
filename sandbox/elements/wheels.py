"""Joints of two wheels: gears, racks, and circles that roll on one another."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from sandbox.elements.element import KEPT, Direction, no_mesh
from sandbox.elements.joint import REACTION, JointKind, JointSpec
from sandbox.errors import Problem
from sandbox.values.numbers import Angle, Distance, Flag, Length, Point, Stiffness
from sandbox.values.spec import TYPE
from sandbox.wording import WrongValueError

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft
    from sandbox.scene.mechanism import Mechanism
    from sandbox.scene.parts.placement import Mover

MESH = (*REACTION, "tangential", "radial")
TEETH = "teeth: MuJoCo couples only the joint angles, without forces on the bearings"
PressureAngle = Annotated[Angle, Field(gt=0, le=math.pi / 4), KEPT]


class WheelJoint(JointSpec):
    """A joint of wheels, which mesh as they stand at t = 0."""

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        """Wheels that are released at t = 0 and would have to mesh anew."""
        yield from super().problems(mechanism, path)
        if self.released:
            yield no_mesh(self.name, f"{path}.released")


class CircleJoint(WheelJoint):
    """A joint of two circles."""

    radius_a: Length
    """Radius of the circle of ``a``, of a gear its pitch radius; ``on_a`` is the centre."""
    radius_b: Length
    """Radius of the circle of ``b``, of a gear its pitch radius; ``on_b`` is the centre."""
    inside: Flag = False
    """True: the smaller circle is inside the larger one, as in a ring gear."""
    on_a: Point = (0.0, 0.0)
    """Centre of the first wheel in the frame of ``a`` [m]."""
    on_b: Point = (0.0, 0.0)
    """Centre of the second wheel in the frame of ``b`` [m]."""

    @model_validator(mode="after")
    def _different(self) -> Self:
        if self.inside and self.radius_a == self.radius_b:
            raise WrongValueError("out-of-range", "with 'inside' the two radii must differ")
        return self

    @property
    def radii(self) -> tuple[float, float]:
        """Of the wheels of ``a`` and ``b`` [m]."""
        return self.radius_a, self.radius_b


class ToothedJoint(WheelJoint):
    """A joint of teeth."""

    pressure_angle: PressureAngle = math.radians(20.0)
    """Between the line of action and the tangent of the pitch circles, up to 45 deg."""
    backlash: Distance = 0.0
    """Backlash along the pitch circles or the pitch line; the teeth are centred at t = 0."""
    stiffness: Stiffness = Field(default=1e9, gt=0)
    """Stiffness along the line of action, without backlash [N/m]: planet gears share a load by it.
    Steel teeth have about 1.4e10 N/m per metre of width."""


class Gear(CircleJoint, ToothedJoint):
    """Two gears that mesh, with involute teeth, outside or one inside the other.

    What holds their centres is up to other joints: pins on the ground or on a carrier. Teeth mesh
    as they stand at t = 0. They push along the line of action, which makes the pressure angle with
    the common tangent of the pitch circles; so beside the tangential force there is a radial one,
    which the bearings carry.
    """

    facts = JointKind("gear", MESH, more={"backlash": ("gap",)}, mujoco=TEETH)

    type: Literal["gear"] = TYPE

    def without_pymunk(self, mechanism: Mechanism) -> str:
        """Why pymunk has no counterpart; empty where it has one."""
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
    radius: Length
    """Pitch radius of ``a``, whose centre is ``on_a``."""
    along: Direction = (1.0, 0.0)
    """Direction of the rack's pitch line in the frame of ``b``; any length."""
    on_a: Point = (0.0, 0.0)
    """Centre of the gear in the frame of ``a`` [m]."""
    on_b: Point = (0.0, 0.0)
    """A point of the pitch line in the frame of ``b`` [m]."""

    @property
    def radii(self) -> tuple[float, float]:
        """Of the gear [m]; the rack has none."""
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
        """New values of ``kept`` fields that a placement changes."""
        return {"along": mover.direction(self.b, self.along)}


class Roll(CircleJoint):
    """Two circles that roll on one another without slip and stay in touch (a Hillberry joint).

    Crossed bands hold such a joint together; here it can be pulled as well as pressed.
    """

    PYMUNK = "rolling circles as a joint"
    facts = JointKind("roll", MESH, mujoco="rolling circles as a joint")

    type: Literal["roll"] = TYPE
