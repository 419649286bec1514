"""Drives: inputs of the mechanism, as signals over time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from sandbox.elements import element as base
from sandbox.elements.element import BodyName, Element, Quantity, computed, live
from sandbox.elements.tendons import RIGID
from sandbox.errors import Problem
from sandbox.values import numbers as of
from sandbox.values import signals
from sandbox.values.expressions import parse_expression
from sandbox.values.spec import TYPE
from sandbox.values.units import si_unit
from sandbox.wording import MAX_NAMED, quoted, refuse_if

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft
    from sandbox.export.mjcf import Draft
    from sandbox.scene.mechanism import Mechanism
    from sandbox.scene.parts.placement import Mover

SMALLEST_RADIUS = 1e-9  # of a circle whose radius a drive sets [m]
Gives = Literal["force", "torque", "push", "tension", "radius", "stiffness", "flow", "pressure",
                "opening", "surface", "hold"]
QUANTITIES: Mapping[str, Quantity] = {
    "value": live("drive_value", "", "current value"),
    "work": Quantity("drive_work", "J", "done on the bodies, or on the fluid, since t = 0"),
    "flow": live("drive_flow", "m^3/s", "flow into its line"),
    "torque": live("drive_torque", "N m", "torque on its hinge, in the hinge's positive sense"),
    "force": live("drive_torque", "N", "force on its actuator; positive extends it"),
    "power": computed("W", "power on the bodies: torque or force times the rate of its hinge or "
                           "actuator; of a conveyor surface, friction force times its speed"),
}


MOVING = ("value", "work", "power")  # quantities that drives record
TURNING, PUSHING = ("value", "work", "torque", "power"), ("value", "work", "force", "power")


@dataclass(frozen=True)
class DriveKind:
    """Facts about a kind of drive."""

    target: base.Reference  # mark of the field that names its target
    # a force on a body, a torque between the two bodies of a hinge, a push between the two points
    # of an actuator, and so on
    gives: Gives
    dimension: str  # of its value; empty for that of its spring
    records: tuple[str, ...] = ("value", "work")
    floor: float = -math.inf  # smaller values count as this
    sole: str = ""  # what only one drive may set of a target; empty where several add up
    limited: bool = False  # whether the solver computes its effort, within a limit
    places: bool = False  # whether its value is a target position
    latched: bool = False  # whether pymunk keeps its value, so that only changes are set
    timely: Literal["pose", "end"] = "pose"  # at which time in a step its value is evaluated
    twin: str = ""  # the same drive of an actuator for one of a hinge, and the other way round
    mujoco: str = ""  # why MuJoCo has no counterpart; empty where it has one
    mujoco_varied: str = ""  # why MuJoCo has no counterpart if the value varies

    @property
    def unit(self) -> str:
        return si_unit(self.dimension)


class DriveSpec(Element):
    """The base of all drives."""

    facts: ClassVar[DriveKind]
    type: str
    name: of.Name
    """Its name; quantities are ``<name>.value`` and so on."""

    if TYPE_CHECKING:
        value: Any

    @property
    def kind(self) -> DriveKind:
        """Facts, which may depend on its fields."""
        return self.facts

    @property
    def target(self) -> tuple[base.Reference, str]:
        """The element that it acts on: the mark of the field that names it, and the name."""
        _, reference, name = next(base.references(self, ""))
        return reference, name

    @property
    def owned(self) -> tuple[object, ...]:
        """What no other drive may set."""
        return self.kind.sole, self.target[1]

    def dimension(self, mechanism: Mechanism) -> str | None:
        """The dimension of its value; None where no element has the name of its target."""
        return self.kind.dimension

    def signal(self, mechanism: Mechanism) -> signals.AnySignal:
        found: signals.AnySignal = self.value
        return found

    def quantities(self, mechanism: Mechanism) -> dict[str, str]:
        own = si_unit(self.dimension(mechanism) or "")
        return {name: QUANTITIES[name].unit or own for name in self.kind.records}

    def without_pymunk(self, mechanism: Mechanism) -> str:
        signal = self.signal(mechanism)
        return super().without_pymunk(mechanism) or (
            "a formula that calls a table" if isinstance(signal, signals.Formula)
            and parse_expression(signal.expression).tables else "")

    def write_mujoco(self, draft: Draft, index: int) -> None:
        raise NotImplementedError


class ForceDrive(DriveSpec):
    """A force on a point of a body, along a fixed direction."""

    facts = DriveKind(base.BODY, "force", "force")
    type: Literal["force"] = TYPE
    body: BodyName
    """Name of the body that is pushed."""
    at: of.Point = (0.0, 0.0)
    """The point that the force acts on, in the body's frame [m]; it moves with the body."""
    direction: base.Direction
    """[x, y] of any length except zero: only its direction counts; a negative value reverses it."""
    frame: Literal["world", "body"] = "world"
    """Whether the direction is fixed in the world or in the body."""
    value: signals.ForceSignal
    """The force over time [N]."""

    @property
    def turning(self) -> bool:
        return self.frame == "body"

    @property
    def along(self) -> base.Vec:
        """Its direction, of length 1."""
        x, y = self.direction / np.hypot(*self.direction)
        return float(x), float(y)

    def placed(self, mover: Mover) -> Mapping[str, Any]:
        return {"direction": mover.vector(self.direction) if self.frame == "world"
                else mover.direction(self.body, self.direction)}

    def write_mujoco(self, draft: Draft, index: int) -> None:
        frame = None if self.turning else draft.world_frame
        site = draft.site(draft.target(index), f"{self.name}.site", self.at)
        draft.motor(index, gear=(*self.along, 0, 0, 0, 0), site=site, refsite=frame)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        turns = {"turns": True} if self.turning else {}
        draft.add("push_point", self.name, draft.value(index), self.body, self.at, self.along,
                  **turns)


class RadiusDrive(DriveSpec):
    """Sets the radius of a body's circle over time: an object that swells or shrinks."""

    facts = DriveKind(base.BODY, "radius", "length", floor=SMALLEST_RADIUS, sole="radius",
                      latched=True, mujoco="a changing radius")
    type: Literal["radius"] = TYPE
    body: BodyName
    """Name of the body; mass and inertia stay as they are."""
    shape: int = Field(default=0, ge=0)
    """Which of the body's shapes, counted from 0; it has to be a circle."""
    value: signals.LengthSignal
    """The radius over time [m]."""

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        draft.add("resize", self.name, draft.value(index), self.body,
                  draft.first_solid(self.body, self.shape), floor=SMALLEST_RADIUS)

    @property
    def owned(self) -> tuple[object, ...]:
        return *super().owned, self.shape

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        body = next((each for each in mechanism.bodies if each.name == self.body), None)
        if body is None:
            return
        circles = [i for i, shape in enumerate(body.shapes) if shape.type == "circle"]
        if self.shape not in circles:
            yield Problem("not-settable", f"shape {self.shape} of {quoted(self.body)} (they count "
                          "from 0) is no circle, which has a radius to set", f"{path}.shape",
                          allowed=", ".join(map(str, circles[:MAX_NAMED]))
                          or f"none: {quoted(self.body)} has no circle")


class SurfaceDrive(DriveSpec):
    """Moves the surface of a body along its outline, as on a conveyor; the body does not move.

    Friction carries along the bodies that touch it.
    """

    PYMUNK = "a conveyor surface: its shapes have one surface velocity, not one along an outline"
    facts = DriveKind(base.BODY, "surface", "speed", MOVING, sole="surface", timely="end",
                      mujoco="a conveyor surface")
    type: Literal["surface"] = TYPE
    body: BodyName
    """Name of the body, all of whose shapes run; its mass and pose are not changed by that."""
    positive: Annotated[base.Turn, base.OTHER_SIDE] = "counterclockwise"
    """Positive direction of the speed around the body: with ``clockwise`` its top moves right."""
    value: signals.RateSignal
    """The speed along the surface over time [m/s], seen from the body."""

    @property
    def sense(self) -> float:
        """+1 or -1: the factor from counter-clockwise round its body to the positive way."""
        return 1.0 if self.positive == "counterclockwise" else -1.0


class PullDrive(DriveSpec):
    """Sets the tension of a tendon: an actuator at its last guide. Below 0 counts as 0."""

    facts = DriveKind(base.TENDON, "tension", "force", floor=0.0, sole="tension")
    type: Literal["pull"] = TYPE
    tendon: Annotated[of.Name, base.TENDON]
    """Name of a tendon, or of a finger or tree: then its own tendon is pulled."""
    value: signals.ForceSignal
    """The tension over time [N]; below 0 counts as 0."""

    def write_mujoco(self, draft: Draft, index: int) -> None:
        tendon = draft.model.tendons.name[draft.target(index)]
        draft.sense("actuatorfrc", f"{tendon}.tension", actuator=self.name)
        draft.motor(index, tendon=tendon, gear=-1.0, ctrlrange=(0.0, draft.MAX_FORCE))

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        draft.add("set", self.name, draft.value(index), self.tendon, "pulled", floor=0.0)


class StiffnessDrive(DriveSpec):
    """Sets the stiffness of a spring or of a tendon over time. Below 0 counts as 0."""

    facts = DriveKind(base.SPRING, "stiffness", "", ("value",), floor=0.0, sole="stiffness",
                      mujoco="a stiffness drive")
    on_tendon: ClassVar[DriveKind] = replace(facts, target=base.TENDON, dimension="stiffness")
    type: Literal["stiffness"] = TYPE
    spring: Annotated[of.Name | None, base.SPRING] = None
    """Name of the spring, linear or rotary; its damping stays as it is. This or ``tendon``."""
    tendon: Annotated[of.Name | None, base.TENDON] = None
    """In place of ``spring``, the name of a tendon below 100 kN/m without pull drive and guide
    friction, or of a finger or tree for its own tendon. Damping and rest length do not change; a
    ``pretension`` sets the rest length by the tendon's own stiffness."""
    value: signals.Signal | None = None
    """Stiffness over time [N/m, of a rotary spring N m/rad]; by default the element's own."""

    def _verify(self) -> None:
        refuse_if((self.spring is None) == (self.tendon is None),
                  "a stiffness drive needs either 'spring' or 'tendon'")

    @property
    def kind(self) -> DriveKind:
        return self.facts if self.tendon is None else self.on_tendon

    def _spring(self, mechanism: Mechanism) -> Any:
        """Its spring or tendon; None where no element has the name."""
        return next((each for each in (*mechanism.springs, *mechanism.tendons)
                     if each.name == (self.spring or self.tendon)), None)

    def dimension(self, mechanism: Mechanism) -> str | None:
        if self.tendon is not None:
            return self.kind.dimension
        spring = self._spring(mechanism)
        return spring and str(spring.facts.dimension)

    def signal(self, mechanism: Mechanism) -> signals.AnySignal:
        return (signals.Constant(constant=self._spring(mechanism).stiffness)
                if self.value is None else self.value)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        draft.add("set", self.name, draft.value(index), self.spring or self.tendon, "stiffness",
                  floor=0.0)

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        found, why = self._spring(mechanism), ""
        pull = next((each.name for each in mechanism.drives if each.kind.gives == "tension"
                     and each.target[1] == self.tendon), None)
        if pull is not None:
            why = f"{quoted(pull)} pulls it, which sets its tension"
        elif found is not None and found.stiffness is None:
            why = "it follows a law"
        elif found is not None and self.tendon is not None and found.gripping:
            why = f"its guide {found.gripping[0]} has friction, so each span has its own tension"
        elif found is not None and self.tendon is not None and found.stiffness >= RIGID:
            why = f"with {found.stiffness:g} N/m it counts as inextensible"
        if why:
            allowed = "a spring with a 'stiffness'" if self.spring else (
                f"a tendon below {RIGID:g} N/m without pull drive and guide friction")
            yield Problem("not-settable", f"{quoted(self.spring or self.tendon or '')} has no "
                          f"stiffness to set: {why}",
                          f"{path}.{'spring' if self.spring else 'tendon'}", allowed=allowed)


class HoldDrive(DriveSpec):
    """Releases and engages a joint, a spring or a tendon, any number of times.

    Models a clutch, a magnet, or a latch that a controller works. A broken element stays broken
    until the value has been 0.5 or less and rises again.
    """

    PYMUNK = base.RELEASED
    facts = DriveKind(base.HELD, "hold", "ratio", ("value",), sole="hold", mujoco=base.RELEASED)
    type: Literal["hold"] = TYPE
    element: Annotated[of.Name, base.HELD]
    """Name of the joint, spring or tendon. A joint closes its gap in its ``takes_up_in``."""
    value: signals.ShareSignal
    """Value over time: above 0.5 engages, otherwise releases. An event that releases or engages the
    same element overrides it until the value next crosses 0.5."""

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        if any(joint.name == self.element and joint.facts.wheels for joint in mechanism.joints):
            yield base.no_mesh(self.element, f"{path}.element")
