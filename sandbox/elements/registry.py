"""All kinds of element, by the list of a mechanism that they stand in."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, get_args

from pydantic import Field

from sandbox.elements import drives, fluids, joints, motors
from sandbox.elements.controllers import controller, equilibrium, pid, state_feedback
from sandbox.elements.element import Element, tag_of
from sandbox.elements.loads import Load
from sandbox.elements.springs import Spring
from sandbox.elements.tendons import Tendon
from sandbox.values.spec import Spec

Joint = Annotated[
    joints.Pin | joints.Slot | joints.Weld | joints.Rod | joints.Rope | joints.Actuator
    | joints.Gear | joints.Rack | joints.Roll,
    Field(discriminator="type"),
]
Drive = Annotated[
    drives.ForceDrive | motors.TorqueDrive | drives.PullDrive | drives.RadiusDrive
    | drives.StiffnessDrive | motors.MotorDrive | motors.BrakeDrive | motors.ServoDrive
    | motors.PushDrive | motors.ExtendDrive | motors.LengthDrive | fluids.FlowDrive
    | fluids.PressureDrive | fluids.OpeningDrive | drives.SurfaceDrive | drives.HoldDrive,
    Field(discriminator="type"),
]
Controller = Annotated[
    pid.PidController | controller.ScheduleController | controller.FeedbackController
    | controller.SwitchController | pid.RelayController | state_feedback.StateFeedbackController
    | equilibrium.EquilibriumController,
    Field(discriminator="type"),
]


def members(union: Any) -> tuple[type[Spec], ...]:
    """The models of a discriminated union such as ``Joint``."""
    return get_args(get_args(union)[0])


_LISTS: Mapping[str, tuple[type[Any], ...]] = {
    "joints": members(Joint), "springs": members(Spring), "tendons": (Tendon,),
    "lines": (fluids.Line,), "valves": (fluids.Valve,), "loads": members(Load),
    "drives": members(Drive), "controllers": members(Controller)}
# by list, then by ``type``, which is empty in lists of one kind
KINDS: Mapping[str, Mapping[str, type[Element]]] = {
    name: {tag_of(kind): kind for kind in kinds} for name, kinds in _LISTS.items()}
