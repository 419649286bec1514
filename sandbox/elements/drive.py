"""The base of drives: inputs of the mechanism, as signals over time."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from sandbox.elements.element import Element, Quantity, Reference, live, recorded, references
from sandbox.values.expressions import parse_expression
from sandbox.values.numbers import Name
from sandbox.values.signals import AnySignal, Formula

if TYPE_CHECKING:
    from sandbox.export.document import Draft
    from sandbox.scene.mechanism import Mechanism

Gives = Literal["force", "torque", "push", "tension", "radius", "stiffness", "flow", "pressure",
                "opening", "surface", "hold"]
QUANTITIES: Mapping[str, Quantity] = {
    "value": live("drive_value", "", "current value"),
    "work": recorded("drive_work", "J", "done on the bodies, or on the fluid, since t = 0"),
    "flow": live("drive_flow", "m^3/s", "flow into its line"),
    "torque": live("drive_torque", "N m", "torque on its hinge, in the hinge's positive sense"),
    "force": live("drive_torque", "N", "force on its actuator; positive extends it"),
    "power": Quantity("W", "power on the bodies: torque or force times the rate of its hinge or "
                           "actuator; of a conveyor surface, friction force times its speed"),
}


@dataclass(frozen=True)
class DriveKind:
    """Facts about a kind of drive."""

    target: Reference  # mark of the field that names its target
    # a force on a body, a torque between the two bodies of a hinge, a push between the two points
    # of an actuator, and so on
    gives: Gives
    unit: str  # of its value; empty for that of its spring
    dimension: str
    records: tuple[str, ...] = ("value", "work")
    floor: float = -math.inf  # smaller values count as this
    sole: str = ""  # what only one drive may set of a target; empty where several add up
    limited: bool = False  # whether the solver computes its effort, within a limit
    places: bool = False  # whether its value is a target position
    latched: bool = False  # whether pymunk keeps its value, so that only changes are set
    timely: Literal["pose", "end"] = "pose"  # at which time in a step its value is evaluated
    positive: bool = False  # whether its value must stay greater than 0
    twin: str = ""  # the same drive of an actuator for one of a hinge, and the other way round
    mujoco: str = ""  # why MuJoCo has no counterpart; empty where it has one
    mujoco_varied: str = ""  # why MuJoCo has no counterpart if the value varies


class DriveSpec(Element):
    """The base of all drives."""

    facts: ClassVar[DriveKind]

    type: str
    name: Name
    """Its name; quantities are ``<name>.value`` and so on."""

    if TYPE_CHECKING:
        value: Any

    @property
    def kind(self) -> DriveKind:
        """Facts, which may depend on its fields."""
        return self.facts

    @property
    def target(self) -> tuple[Reference, str]:
        """The element that it acts on: the mark of the field that names it, and the name."""
        return next((reference, name) for _, reference, name in references(self, ""))

    @property
    def owned(self) -> tuple[object, ...]:
        """What no other drive may set."""
        return self.kind.sole, self.target[1]

    def unit(self, mechanism: Mechanism) -> str:
        """The unit of its value."""
        return self.kind.unit

    def dimension(self, mechanism: Mechanism) -> str | None:
        """The dimension of its value; None where no element has the name of its target."""
        return self.kind.dimension

    def signal(self, mechanism: Mechanism) -> AnySignal:
        """Its value over time."""
        found: AnySignal = self.value
        return found

    def quantities(self, mechanism: Mechanism) -> dict[str, str]:
        """The quantities that it records, with their units."""
        own = self.unit(mechanism)
        return {name: QUANTITIES[name].unit or own for name in self.kind.records}

    def without_pymunk(self, mechanism: Mechanism) -> str:
        """Why pymunk has no counterpart; empty where it has one."""
        signal = self.signal(mechanism)
        return super().without_pymunk(mechanism) or (
            "a formula that calls a table" if isinstance(signal, Formula)
            and parse_expression(signal.expression).tables else "")

    def write_mujoco(self, draft: Draft, index: int) -> None:
        """Add the drive to a MuJoCo model."""
        raise NotImplementedError
