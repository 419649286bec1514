"""Drives: what the world outside does to the mechanism, as a signal over time."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from sandbox.elements.joints import Turn
from sandbox.elements.kinds import DRIVES, ON_TENDON, DriveKind
from sandbox.values.numbers import (
    AngularSpeed,
    Damping,
    FlowResistance,
    Force,
    Name,
    Number,
    Pair,
    Point,
    RotaryDamping,
    RotaryStiffness,
    Speed,
    Stiffness,
    Torque,
)
from sandbox.values.signals import (
    AngleSignal,
    FlowSignal,
    ForceSignal,
    LengthSignal,
    PressureSignal,
    RateSignal,
    ShareSignal,
    SpeedSignal,
    StiffnessSignal,
    TorqueSignal,
)
from sandbox.values.spec import TYPE, Spec
from sandbox.wording import WrongValueError


class ForceDrive(Spec):
    """A force on a point of a body, along a fixed direction."""

    type: Literal["force"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    body: Name
    """Name of the body that is pushed."""
    at: Point = (0.0, 0.0)
    """The point that the force acts on, in the body's frame [m]; it moves with the body."""
    direction: Pair[Number]
    """[x, y] of any length but zero: only its direction counts, and a negative value pushes the
    other way."""
    frame: Literal["world", "body"] = "world"
    """Whether the direction stays as it is in the world, or turns with the body."""
    value: ForceSignal
    """The force over time [N]."""

    @field_validator("direction")
    @classmethod
    def _not_zero(cls, direction: tuple[float, float]) -> tuple[float, float]:
        if direction == (0.0, 0.0):
            raise WrongValueError("out-of-range", "[0, 0] is no direction")
        return direction


class TorqueDrive(Spec):
    """A torque between the two bodies of a hinge, positive as the hinge turns."""

    type: Literal["torque"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    joint: Name
    """Name of the pin that it acts on."""
    value: TorqueSignal
    """The torque over time [N m], in the hinge's sense: on its body ``b``, and the opposite on
    ``a``."""


class PullDrive(Spec):
    """Sets the tension of a tendon: an actuator at its last guide. Below 0 counts as 0."""

    type: Literal["pull"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    tendon: Name
    """Name of a tendon, or of a finger or tree: then its own tendon is pulled."""
    value: ForceSignal
    """The tension over time [N]; below 0 counts as 0."""


class RadiusDrive(Spec):
    """Sets the radius of a body's circle over time: an object that swells or shrinks."""

    type: Literal["radius"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    body: Name
    """Name of the body; mass and inertia stay as they are."""
    shape: int = Field(default=0, ge=0)
    """Which of the body's shapes, counted from 0; it has to be a circle."""
    value: LengthSignal
    """The radius over time [m]."""


class StiffnessDrive(Spec):
    """Sets the stiffness of a spring or of a tendon over time. Below 0 counts as 0."""

    type: Literal["stiffness"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    spring: Name | None = None
    """Name of the spring, linear or rotary; its damping stays as it is. This or ``tendon``."""
    tendon: Name | None = None
    """In place of ``spring`` the name of a tendon of less than 100 kN/m that no drive pulls and no
    guide holds by friction, or of a finger or tree: then its own tendon. Its damping and its length
    at rest stay as they are; this is also the length that a ``pretension`` gives it by the
    tendon's own stiffness."""
    value: StiffnessSignal | None = None
    """The stiffness over time, [N/m] of a linear spring or a tendon, [N m/rad] of a rotary spring;
    by default what it has itself, which a controller may then change."""

    @model_validator(mode="after")
    def _one_target(self) -> Self:
        if (self.spring is None) == (self.tendon is None):
            raise WrongValueError("conflicting-keys", "a stiffness drive needs either 'spring' or "
                                  "'tendon'")
        return self


class MotorDrive(Spec):
    """Turns a hinge: at a set speed with no more than a given torque, or along a line.

    With ``stall`` and ``no_load`` its torque is on a line that falls with the speed w of the hinge,
    T = stall (u - w) / no_load, u the ``value``: it drives while w is between 0 and u, brakes and
    gives power back where w is beyond u, and brakes with more than ``stall`` where it is turned
    against u; where u is below 0, all of it the other way round.
    """

    type: Literal["motor"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, what it gives as ``<name>.torque``."""
    joint: Name
    """Name of the pin that it acts on."""
    value: SpeedSignal | None = None
    """The speed of ``b`` against ``a`` over time [rad/s], in the hinge's own sense. Of a motor with
    a line it is that at which it gives no torque, by default ``no_load``: half of it is half the
    voltage, minus it the full voltage backwards."""
    torque: Torque | None = Field(default=None, gt=0)
    """The most that it can give, either way [N m]; may be left out of a motor with a line, which
    then gives whatever the line says."""
    stall: Torque | None = Field(default=None, gt=0)
    """Of a motor with a line: its torque at rest [N m], while ``value`` is ``no_load``."""
    no_load: AngularSpeed | None = Field(default=None, gt=0)
    """Of a motor with a line: the speed at which its torque is 0 [rad/s], while ``value`` is this,
    as it is by default."""

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if (self.stall is None) != (self.no_load is None):
            lacks = "stall" if self.stall is None else "no_load"
            raise WrongValueError("missing-key", f"'{lacks}' is missing: 'stall' (torque at rest) "
                                  "and 'no_load' (speed without load) belong together")
        if self.stall is None:
            for field, what in (("value", "the speed that it is to keep"),
                                ("torque", "the most that it can give")):
                if getattr(self, field) is None:
                    raise WrongValueError("missing-key", f"a motor needs '{field}', {what}; or a "
                                          "line, 'stall' and 'no_load'")
        return self


class BrakeDrive(Spec):
    """Holds a hinge with at most a given torque and slips above it: a lock, a brake.

    Friction that a hinge always has is its own ``friction``.
    """

    type: Literal["brake"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, what it holds with as
    ``<name>.torque``."""
    joint: Name
    """Name of the pin that it holds."""
    value: TorqueSignal
    """The torque up to which it holds over time [N m]; 0 lets go, below 0 counts as 0."""


class _PlaceDrive(Spec):
    """Brings something to a place: as a spring would, or as hard as a limit allows."""

    @model_validator(mode="after")
    def _one_law(self) -> Self:
        stiffness, damping, speed = (getattr(self, name) for name in (
            "stiffness", "damping", "speed"))
        if stiffness is None and damping:
            raise WrongValueError("conflicting-keys", "'damping' needs 'stiffness'")
        if stiffness is not None and speed is not None:
            raise WrongValueError("conflicting-keys", "'speed' and 'stiffness' exclude each other; "
                                  "use 'damping'")
        return self


class ServoDrive(_PlaceDrive):
    """Brings a hinge to an angle and holds it there, with no more than a given torque.

    With ``stiffness`` it is a controller with a spring's law: torque = stiffness (value - angle) -
    damping rate, up to ``torque``. Loads then move it away from its target, as they do a real one
    without an integrator. Without ``stiffness`` it is rigid: it goes to its target with ``torque``,
    brakes in time so as not to overshoot, and holds it exactly as long as ``torque`` suffices.
    """

    type: Literal["servo"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, what it gives as ``<name>.torque``."""
    joint: Name
    """Name of the pin that it acts on."""
    value: AngleSignal
    """The angle to go to over time [rad], as the hinge counts it: in its own sense, from its
    ``zero``."""
    torque: Torque = Field(gt=0)
    """The most that it can give, either way [N m]."""
    stiffness: RotaryStiffness | None = Field(default=None, gt=0)
    """Torque for each radian that is missing [N m/rad]; without, the default, it is rigid."""
    damping: RotaryDamping = 0.0
    """With ``stiffness``: torque against the hinge's rate, per rate [N m s/rad]."""
    speed: AngularSpeed | None = Field(default=None, gt=0)
    """Of a rigid one the most that it turns at [rad/s]; no limit by default."""


class PushDrive(Spec):
    """A force between the two points of an actuator, along the line through them."""

    type: Literal["push"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    joint: Name
    """Name of the actuator that it acts on."""
    value: ForceSignal
    """The force over time [N]; positive pushes the points apart, negative pulls them together."""


class ExtendDrive(Spec):
    """Lengthens an actuator at a set speed, with no more than a given force."""

    type: Literal["extend"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, what it gives as ``<name>.force``."""
    joint: Name
    """Name of the actuator that it acts on."""
    value: RateSignal
    """The speed over time [m/s]; positive makes the actuator longer."""
    force: Force = Field(gt=0)
    """The most that it can give, either way [N]."""


class LengthDrive(_PlaceDrive):
    """Brings an actuator to a length and holds it there, with no more than a given force.

    With ``stiffness`` its force = stiffness (value - length) - damping speed, up to ``force``.
    Without, it is rigid: it goes to its target with ``force``, brakes in time so as not to
    overshoot, and holds it exactly as long as ``force`` suffices.
    """

    type: Literal["length"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, what it gives as ``<name>.force``."""
    joint: Name
    """Name of the actuator that it acts on."""
    value: LengthSignal
    """The distance of the actuator's two points to go to over time [m]."""
    force: Force = Field(gt=0)
    """The most that it can give, either way [N]."""
    stiffness: Stiffness | None = Field(default=None, gt=0)
    """Force for each metre that is missing [N/m]; without, the default, it is rigid."""
    damping: Damping = 0.0
    """With ``stiffness``: force against the actuator's speed, per speed [N s/m]."""
    speed: Speed | None = Field(default=None, gt=0)
    """Of a rigid one the fastest that its length changes [m/s]; no limit by default."""


class FlowDrive(Spec):
    """Pumps fluid into a line, however high the pressure: the line's ``relief`` bounds it."""

    type: Literal["flow"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, the work on the fluid as
    ``<name>.work``."""
    line: Name
    """Name of the line that it feeds."""
    value: FlowSignal
    """The flow over time [m^3/s], of a gas as it would be at the pressure of the surroundings;
    below 0 it is sucked out."""


class PressureDrive(Spec):
    """A source of pressure that a line is fed from, and that takes fluid back."""

    type: Literal["pressure"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, what it gives as ``<name>.flow``."""
    line: Name
    """Name of the line that it feeds."""
    value: PressureSignal
    """The pressure over time [Pa], above the surroundings; the line's ``least`` and ``relief``
    bound what it comes to there."""
    resistance: FlowResistance = 0.0
    """Pressure that is lost per flow between the source and the line [Pa s/m^3]; with 0, the
    default, the line has the pressure of the source."""


class OpeningDrive(Spec):
    """Opens and shuts a valve."""

    type: Literal["opening"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    valve: Name
    """Name of the valve; one that no drive opens is fully open."""
    value: ShareSignal
    """How far it is open over time: 0 is shut, 1 fully open. Below 0 counts as 0."""


class SurfaceDrive(Spec):
    """Lets the surface of a body run along its outline, as that of a conveyor; the body stays.

    What touches it is carried along by friction.
    """

    type: Literal["surface"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, friction times speed as
    ``<name>.power``."""
    body: Name
    """Name of the body, all of whose shapes run; its mass and pose are not changed by that."""
    positive: Turn = "counterclockwise"
    """Which way round the body, as seen, a positive speed runs: with ``clockwise`` its top runs to
    the right."""
    value: RateSignal
    """The speed along the surface over time [m/s], seen from the body."""


class HoldDrive(Spec):
    """Lets go of a joint, a spring or a tendon and takes it up again, as often as its value says.

    A clutch, a magnet, a latch that a controller works. What breaks stays broken until the value
    has been 0.5 or less and rises again.
    """

    type: Literal["hold"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, and whether the element holds as
    ``<element>.held``."""
    element: Name
    """Name of the joint, spring or tendon. A joint closes its gap in its ``takes_up_in``."""
    value: ShareSignal
    """Over time: above 0.5 it is held, else let go. An event that lets go of the same element or
    takes it up counts until this value crosses 0.5 the next time."""


Drive = Annotated[
    ForceDrive | TorqueDrive | PullDrive | RadiusDrive | StiffnessDrive | MotorDrive | BrakeDrive
    | ServoDrive | PushDrive | ExtendDrive | LengthDrive | FlowDrive | PressureDrive | OpeningDrive
    | SurfaceDrive | HoldDrive,
    Field(discriminator="type"),
]


def kind_of(drive: Drive) -> DriveKind:
    """What a drive sets and how that is felt, by its type and by what it names."""
    if isinstance(drive, StiffnessDrive) and drive.tendon is not None:
        return ON_TENDON[drive.type]
    return DRIVES[drive.type]
