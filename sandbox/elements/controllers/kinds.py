"""All controllers."""

from __future__ import annotations

from typing import Annotated

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

Controller = Annotated[
    PidController | ScheduleController | FeedbackController | SwitchController | RelayController
    | StateFeedbackController | EquilibriumController,
    Field(discriminator="type"),
]
