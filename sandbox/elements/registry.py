"""All kinds of element, by the list of a mechanism that they stand in."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, get_args

from pydantic import Field

from sandbox.elements.controllers.equilibrium import EquilibriumController
from sandbox.elements.controllers.pid import PidController
from sandbox.elements.controllers.relay import RelayController
from sandbox.elements.controllers.simple import (
    FeedbackController,
    ScheduleController,
    SwitchController,
)
from sandbox.elements.controllers.state_feedback import StateFeedbackController
from sandbox.elements.element import Element, tag_of
from sandbox.elements.element_drives import (
    ForceDrive,
    HoldDrive,
    PullDrive,
    RadiusDrive,
    StiffnessDrive,
    SurfaceDrive,
)
from sandbox.elements.fluids import FlowDrive, Line, OpeningDrive, PressureDrive, Valve
from sandbox.elements.joint_drives import (
    BrakeDrive,
    ExtendDrive,
    LengthDrive,
    MotorDrive,
    PushDrive,
    ServoDrive,
    TorqueDrive,
)
from sandbox.elements.loads import Load
from sandbox.elements.points import Actuator, Pin, Rod, Rope, Slot, Weld
from sandbox.elements.springs import Spring
from sandbox.elements.tendons import Tendon
from sandbox.elements.wheels import Gear, Rack, Roll
from sandbox.values.spec import Spec

Joint = Annotated[Pin | Slot | Weld | Rod | Rope | Actuator | Gear | Rack | Roll,
                  Field(discriminator="type")]
Drive = Annotated[
    ForceDrive | TorqueDrive | PullDrive | RadiusDrive | StiffnessDrive | MotorDrive | BrakeDrive
    | ServoDrive | PushDrive | ExtendDrive | LengthDrive | FlowDrive | PressureDrive | OpeningDrive
    | SurfaceDrive | HoldDrive,
    Field(discriminator="type"),
]
Controller = Annotated[
    PidController | ScheduleController | FeedbackController | SwitchController | RelayController
    | StateFeedbackController | EquilibriumController,
    Field(discriminator="type"),
]


def members(union: Any) -> tuple[type[Spec], ...]:
    """The models of a discriminated union such as ``Joint``."""
    return get_args(get_args(union)[0])


_LISTS: Mapping[str, tuple[type[Any], ...]] = {
    "joints": members(Joint), "springs": members(Spring), "tendons": (Tendon,),
    "lines": (Line,), "valves": (Valve,), "loads": members(Load), "drives": members(Drive),
    "controllers": members(Controller)}
KINDS: Mapping[str, Mapping[str, type[Element]]] = {
    name: {tag_of(kind): kind for kind in kinds} for name, kinds in _LISTS.items()}
"""By list, then by ``type``; the ``type`` is empty in lists of one kind."""


def kind_of(name: str, data: Mapping[str, Any]) -> type[Element] | None:
    """The class of an element of a list, for its JSON data; None where it has none."""
    tag = data.get("type", "")
    return KINDS[name].get(tag) if name in KINDS and isinstance(tag, str) else None
