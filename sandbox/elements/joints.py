"""All joints."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from sandbox.elements.bars import Actuator, Rod, Rope
from sandbox.elements.points import Pin, Slot, Weld
from sandbox.elements.wheels import Gear, Rack, Roll

Joint = Annotated[Pin | Slot | Weld | Rod | Rope | Actuator | Gear | Rack | Roll,
                  Field(discriminator="type")]
