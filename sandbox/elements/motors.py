"""Drives of hinges and actuators: torques, motors, brakes, servos, pushes and lengths."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field

from sandbox.elements import element as base
from sandbox.elements.drives import MOVING, PUSHING, TURNING, DriveKind, DriveSpec
from sandbox.elements.element import HingeName
from sandbox.values import numbers as of
from sandbox.values import signals
from sandbox.values.spec import TYPE
from sandbox.wording import refuse_if

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft
    from sandbox.export.mjcf import Draft
    from sandbox.scene.mechanism import Mechanism


class HingeDrive(DriveSpec):
    """A drive of a hinge."""

    joint: HingeName
    """Name of the pin that it acts on."""


class ActuatorDrive(DriveSpec):
    """A drive of an actuator."""

    joint: Annotated[of.Name, base.ACTUATOR]
    """Name of the actuator that it acts on."""


class TorqueDrive(HingeDrive):
    """A torque between the two bodies of a hinge, positive as the hinge turns."""

    facts = DriveKind(base.HINGE, "torque", "torque", MOVING, twin="push")
    type: Literal["torque"] = TYPE
    value: signals.TorqueSignal
    """Torque on body ``b`` over time [N m], in the hinge's sense; the opposite acts on ``a``."""

    def write_mujoco(self, draft: Draft, index: int) -> None:
        draft.motor(index, **draft.drive_hinge(index))

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        _, joint = draft.target(index)
        draft.add("twist", self.name, draft.value(index), joint.a, joint.b, joint.sense)


class MotorDrive(HingeDrive):
    """Drives a hinge at a set speed with a maximum torque, or along a torque-speed line.

    With ``stall`` and ``no_load`` its torque at the hinge speed w is T = stall (u - w) / no_load, u
    the ``value``. It drives while w is between 0 and u, and brakes outside: with more than
    ``stall`` if w is opposed to u.
    """

    facts = DriveKind(base.HINGE, "torque", "angular speed", TURNING, sole="motor", limited=True,
                      timely="end", twin="extend",
                      mujoco="a motor with a set speed or a torque-speed line")
    type: Literal["motor"] = TYPE
    value: Annotated[signals.SpeedSignal | None, base.KEPT] = None
    """Speed of ``b`` against ``a`` over time [rad/s], in the hinge's positive sense; with a line
    the speed without torque, in proportion to the voltage, by default ``no_load``."""
    torque: of.Torque | None = Field(default=None, gt=0)
    """Maximum torque in both directions [N m]; optional for a motor with a line."""
    stall: of.Torque | None = Field(default=None, gt=0)
    """Of a motor with a line: its torque at rest [N m], while ``value`` is ``no_load``."""
    no_load: of.AngularSpeed | None = Field(default=None, gt=0)
    """Of a motor with a line: the speed without torque [rad/s], while ``value`` is its default."""

    def _verify(self) -> None:
        missing = "stall" if self.stall is None else "no_load"
        refuse_if((self.stall is None) != (self.no_load is None), f"'{missing}' is missing: "
                  "'stall' (torque at rest) and 'no_load' (speed without load) belong together",
                  "missing-key")
        for field, what in ("value", "the speed that it is to keep"), ("torque", "its maximum"):
            refuse_if(self.stall is None and getattr(self, field) is None, f"a motor needs "
                      f"'{field}', {what}; or a line, 'stall' and 'no_load'", "missing-key")

    @property
    def slope(self) -> float | None:
        """With a line: torque per missing speed [N m s/rad]."""
        return None if self.stall is None or self.no_load is None else self.stall / self.no_load

    def signal(self, mechanism: Mechanism) -> signals.AnySignal:
        return signals.Constant(constant=self.no_load) if self.value is None else self.value

    def without_pymunk(self, mechanism: Mechanism) -> str:
        return "a motor with a torque-speed line and a largest torque" \
            if self.stall and self.torque else super().without_pymunk(mechanism)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        _, joint = draft.target(index)
        if self.slope is not None:
            draft.add("damper", f"{self.name}.torque", joint.a, joint.b, self.slope)
            draft.add("twist", self.name, draft.value(index), joint.a, joint.b,
                      self.slope * joint.sense)
            return
        draft.add("constraint", self.name, "SimpleMotor", joint.a, joint.b, 0.0,
                  max_force=self.torque)
        draft.add("set", self.name, draft.value(index), self.name, "rate", -joint.sense, later=0.5)


class BrakeDrive(HingeDrive):
    """Holds a hinge up to a maximum torque and slips above it: a lock, a brake.

    Permanent friction of a hinge is its own ``friction``.
    """

    facts = DriveKind(base.HINGE, "torque", "torque", TURNING, floor=0.0, sole="brake",
                      limited=True, mujoco_varied="a changing brake")
    type: Literal["brake"] = TYPE
    value: signals.TorqueSignal
    """Maximum torque over time [N m]; 0 and less release the hinge."""

    def write_mujoco(self, draft: Draft, index: int) -> None:
        draft.brakes[draft.target(index)] = draft.final_value(index)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        _, joint = draft.target(index)
        draft.add("constraint", self.name, "SimpleMotor", joint.a, joint.b, 0.0)
        draft.add("set", self.name, draft.value(index), self.name, "max_force", floor=0.0)


class PlaceDrive(DriveSpec):
    """Moves something to a position: as a spring, or rigidly within a limit."""

    LACKS: ClassVar[Mapping[str, str]] = {
        "stiffness": "a spring towards a position with a largest force"}

    if TYPE_CHECKING:
        stiffness: float | None
        damping: float
        speed: float | None

    def _verify(self) -> None:
        refuse_if(self.stiffness is None and self.damping, "'damping' needs 'stiffness'")
        refuse_if(self.stiffness is not None and self.speed is not None,
                  "'speed' and 'stiffness' exclude each other; use 'damping'")

    def write_spring(self, draft: Draft, index: int, where: str, offset: float) -> None:
        """Add an actuator of force k (value - q) - c q'; MuJoCo's q is less by ``offset``."""
        k, c, effort = float(self.stiffness or 0.0), float(self.damping), self.facts.records[2]
        most = float(getattr(self, effort))
        draft.motor(index, "general", effort, gainprm=k, biastype="affine",
                    biasprm=(-k * offset, -k, -c), forcerange=(-most, most),
                    **{where: draft.model.joints.name[draft.target(index)]})


class ServoDrive(HingeDrive, PlaceDrive):
    """Moves a hinge to an angle and holds it there with a maximum torque.

    With ``stiffness`` it acts as a spring: torque = stiffness (value - angle) - damping rate, up to
    ``torque``. Loads then move it away from its target, as in a real servo without an integrator.
    Without ``stiffness`` it is rigid: it moves to its target with ``torque``, brakes in time to
    avoid overshoot, and holds it exactly as long as ``torque`` suffices.
    """

    facts = DriveKind(base.HINGE, "torque", "angle", TURNING, sole="motor", limited=True,
                      places=True, twin="length")
    type: Literal["servo"] = TYPE
    value: signals.AngleSignal
    """Target angle over time [rad], in the hinge's sense from its ``zero``."""
    torque: of.Torque = Field(gt=0)
    """Maximum torque in both directions [N m]."""
    stiffness: of.RotaryStiffness | None = Field(default=None, gt=0)
    """Torque for each radian that is missing [N m/rad]; without, the default, it is rigid."""
    damping: of.RotaryDamping = 0.0
    """With ``stiffness``: torque against the hinge's rate, per rate [N m s/rad]."""
    speed: of.AngularSpeed | None = Field(default=None, gt=0)
    """Maximum speed of a rigid servo [rad/s]; no limit by default."""

    def write_mujoco(self, draft: Draft, index: int) -> None:
        where, = draft.drive_hinge(index)
        self.write_spring(draft, index, where,
                          draft.angle_sum(draft.target(index))[1] if where == "tendon" else 0.0)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A SimpleMotor whose rate leads to the angle in some 10 steps."""
        _, joint = draft.target(index)
        draft.add("constraint", self.name, "SimpleMotor", joint.a, joint.b, 0.0,
                  max_force=self.torque)
        draft.add("servo", self.name, draft.value(index), self.name, joint.sense, joint.zero,
                  self.speed or math.inf)


class PushDrive(ActuatorDrive):
    """A force between the two points of an actuator, along the line through them."""

    facts = DriveKind(base.ACTUATOR, "push", "force", MOVING, twin="torque")
    type: Literal["push"] = TYPE
    value: signals.ForceSignal
    """The force over time [N]; positive pushes the points apart, negative pulls them together."""

    def write_mujoco(self, draft: Draft, index: int) -> None:
        draft.motor(index, tendon=draft.model.joints.name[draft.target(index)])

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        number, joint = draft.target(index)
        on_a, on_b = draft.anchors(number)
        draft.add("push_apart", self.name, draft.value(index), joint.a, on_a, joint.b, on_b)


class ExtendDrive(ActuatorDrive):
    """Extends an actuator at a set speed with a maximum force."""

    facts = DriveKind(base.ACTUATOR, "push", "speed", PUSHING, sole="length", limited=True,
                      timely="end", twin="motor", mujoco="an actuator with a set speed")
    type: Literal["extend"] = TYPE
    value: signals.RateSignal
    """The speed over time [m/s]; positive makes the actuator longer."""
    force: of.Force = Field(gt=0)
    """Maximum force in both directions [N]."""

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        number, joint = draft.target(index)
        draft.add("constraint", self.name, "PinJoint", joint.a, joint.b, *draft.anchors(number),
                  error_bias=0.0, max_force=self.force)
        draft.add("extend", self.name, draft.value(index), self.name, later=0.5)


class LengthDrive(ActuatorDrive, PlaceDrive):
    """Moves an actuator to a length and holds it there with a maximum force.

    With ``stiffness`` its force = stiffness (value - length) - damping speed, up to ``force``.
    Without, it is rigid: it moves to its target with ``force``, brakes in time to avoid overshoot,
    and holds it exactly as long as ``force`` suffices.
    """

    facts = DriveKind(base.ACTUATOR, "push", "length", PUSHING, sole="length", limited=True,
                      places=True, twin="servo")
    type: Literal["length"] = TYPE
    value: signals.LengthSignal
    """The distance of the actuator's two points to go to over time [m]."""
    force: of.Force = Field(gt=0)
    """Maximum force in both directions [N]."""
    stiffness: of.Stiffness | None = Field(default=None, gt=0)
    """Force for each metre that is missing [N/m]; without, the default, it is rigid."""
    damping: of.Damping = 0.0
    """With ``stiffness``: force against the actuator's speed, per speed [N s/m]."""
    speed: of.Speed | None = Field(default=None, gt=0)
    """Of a rigid one the fastest that its length changes [m/s]; no limit by default."""

    def write_mujoco(self, draft: Draft, index: int) -> None:
        self.write_spring(draft, index, "tendon", 0.0)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        number, joint = draft.target(index)
        speed = {} if self.speed is None else {"max_bias": self.speed}
        draft.add("constraint", self.name, "PinJoint", joint.a, joint.b, *draft.anchors(number),
                  max_force=self.force, **speed)
        draft.add("set", self.name, draft.value(index), self.name, "distance")
