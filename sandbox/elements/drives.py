"""All drives."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from sandbox.elements.body_drives import ForceDrive, RadiusDrive, SurfaceDrive
from sandbox.elements.element_drives import HoldDrive, PullDrive, StiffnessDrive
from sandbox.elements.fluids import FlowDrive, OpeningDrive, PressureDrive
from sandbox.elements.joint_drives import (
    BrakeDrive,
    ExtendDrive,
    LengthDrive,
    MotorDrive,
    PushDrive,
    ServoDrive,
    TorqueDrive,
)

Drive = Annotated[
    ForceDrive | TorqueDrive | PullDrive | RadiusDrive | StiffnessDrive | MotorDrive | BrakeDrive
    | ServoDrive | PushDrive | ExtendDrive | LengthDrive | FlowDrive | PressureDrive | OpeningDrive
    | SurfaceDrive | HoldDrive,
    Field(discriminator="type"),
]
