"""Drives of bodies, springs and tendons, and drives that release elements and engage them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from sandbox.elements.drive import DriveKind, DriveSpec
from sandbox.elements.element import (
    BODY,
    HELD,
    OTHER_SIDE,
    RELEASED,
    SPRING,
    TENDON,
    BodyName,
    Direction,
    Turn,
    Vec,
    no_mesh,
)
from sandbox.elements.tendons import RIGID
from sandbox.errors import Problem
from sandbox.values import signals
from sandbox.values.numbers import Name, Point
from sandbox.values.spec import TYPE
from sandbox.wording import MAX_NAMED, WrongValueError, quoted

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft
    from sandbox.export.document import Draft
    from sandbox.scene.mechanism import Mechanism
    from sandbox.scene.parts.placement import Mover

SMALLEST_RADIUS = 1e-9  # of a circle whose radius a drive sets [m]


class ForceDrive(DriveSpec):
    """A force on a point of a body, along a fixed direction."""

    facts = DriveKind(BODY, "force", "N", "force")

    type: Literal["force"] = TYPE
    body: BodyName
    """Name of the body that is pushed."""
    at: Point = (0.0, 0.0)
    """The point that the force acts on, in the body's frame [m]; it moves with the body."""
    direction: Direction
    """[x, y] of any length except zero: only its direction counts; a negative value reverses it."""
    frame: Literal["world", "body"] = "world"
    """Whether the direction is fixed in the world or in the body."""
    value: signals.ForceSignal
    """The force over time [N]."""

    @property
    def turning(self) -> bool:
        """Whether its direction turns with its body."""
        return self.frame == "body"

    @property
    def along(self) -> Vec:
        """Its direction, of length 1."""
        x, y = self.direction / np.hypot(*self.direction)
        return float(x), float(y)

    def placed(self, mover: Mover) -> Mapping[str, Any]:
        """New values of ``kept`` fields that a placement changes."""
        return {"direction": mover.placement.vector(self.direction) if self.frame == "world"
                else mover.direction(self.body, self.direction)}

    def write_mujoco(self, draft: Draft, index: int) -> None:
        frame = None if self.turning else draft.world_frame()
        site = draft.site(draft.target(index), f"{self.name}.site", self.at)
        draft.motor(index, gear=(*self.along, 0, 0, 0, 0), site=site, refsite=frame)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A force before each step."""
        turns = {"turns": True} if self.turning else {}
        draft.add("push_point", self.name, draft.value(index), self.body, self.at, self.along,
                  **turns)


class RadiusDrive(DriveSpec):
    """Sets the radius of a body's circle over time: an object that swells or shrinks."""

    facts = DriveKind(
        BODY, "radius", "m", "length", floor=SMALLEST_RADIUS, sole="radius", latched=True,
        positive=True, mujoco="a changing radius")

    type: Literal["radius"] = TYPE
    body: BodyName
    """Name of the body; mass and inertia stay as they are."""
    shape: int = Field(default=0, ge=0)
    """Which of the body's shapes, counted from 0; it has to be a circle."""
    value: signals.LengthSignal
    """The radius over time [m]."""

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A radius that is set before each step."""
        draft.add("resize", self.name, draft.value(index), self.body,
                  draft.first_solid(self.body, self.shape), floor=SMALLEST_RADIUS)

    @property
    def owned(self) -> tuple[object, ...]:
        """What no other drive may set."""
        return *super().owned, self.shape

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        """A shape that is none, or no circle."""
        body = next((each for each in mechanism.bodies if each.name == self.body), None)
        if body is None:
            return
        kinds = [shape.type for shape in body.shapes]
        if self.shape >= len(kinds):
            what = f"{quoted(self.body)} has no shape {self.shape} (they count from 0)"
        elif kinds[self.shape] != "circle":
            what = (f"shape {self.shape} of {quoted(self.body)} is a {kinds[self.shape]}; only a "
                    "circle has a radius to set")
        else:
            return
        circles = [str(i) for i, kind in enumerate(kinds) if kind == "circle"][:MAX_NAMED]
        yield Problem("not-settable", what, f"{path}.shape", allowed=", ".join(circles)
                      or f"none: {quoted(self.body)} has no circle")


class SurfaceDrive(DriveSpec):
    """Moves the surface of a body along its outline, as on a conveyor; the body does not move.

    Friction carries along the bodies that touch it.
    """

    PYMUNK = "a conveyor surface: its shapes have one surface velocity, not one along an outline"
    facts = DriveKind(
        BODY, "surface", "m/s", "speed", ("value", "work", "power"), sole="surface", timely="end",
        mujoco="a conveyor surface")

    type: Literal["surface"] = TYPE
    body: BodyName
    """Name of the body, all of whose shapes run; its mass and pose are not changed by that."""
    positive: Annotated[Turn, OTHER_SIDE] = "counterclockwise"
    """Positive direction of the speed around the body: with ``clockwise`` its top moves right."""
    value: signals.RateSignal
    """The speed along the surface over time [m/s], seen from the body."""

    @property
    def sense(self) -> float:
        """+1 or -1: the factor from counter-clockwise round its body to the positive way."""
        return 1.0 if self.positive == "counterclockwise" else -1.0


class PullDrive(DriveSpec):
    """Sets the tension of a tendon: an actuator at its last guide. Below 0 counts as 0."""

    facts = DriveKind(TENDON, "tension", "N", "force", floor=0.0, sole="tension")

    type: Literal["pull"] = TYPE
    tendon: Annotated[Name, TENDON]
    """Name of a tendon, or of a finger or tree: then its own tendon is pulled."""
    value: signals.ForceSignal
    """The tension over time [N]; below 0 counts as 0."""

    def write_mujoco(self, draft: Draft, index: int) -> None:
        tendon = draft.model.tendons.name[draft.target(index)]
        draft.sense("actuatorfrc", f"{tendon}.tension", actuator=self.name)
        draft.motor(index, tendon=tendon, gear=-1.0, ctrlrange=(0.0, draft.MAX_FORCE))

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """The tension of its tendon, set before each step."""
        draft.add("set", self.name, draft.value(index), self.tendon, "pulled", floor=0.0)


class StiffnessDrive(DriveSpec):
    """Sets the stiffness of a spring or of a tendon over time. Below 0 counts as 0."""

    facts = DriveKind(
        SPRING, "stiffness", "", "", ("value",), floor=0.0, sole="stiffness",
        mujoco="a stiffness drive")
    on_tendon: ClassVar[DriveKind] = replace(
        facts, target=TENDON, unit="N/m", dimension="stiffness")

    type: Literal["stiffness"] = TYPE
    spring: Annotated[Name | None, SPRING] = None
    """Name of the spring, linear or rotary; its damping stays as it is. This or ``tendon``."""
    tendon: Annotated[Name | None, TENDON] = None
    """In place of ``spring``, the name of a tendon below 100 kN/m without pull drive and guide
    friction, or of a finger or tree for its own tendon. Damping and rest length do not change; a
    ``pretension`` sets the rest length by the tendon's own stiffness."""
    value: signals.StiffnessSignal | None = None
    """Stiffness over time, [N/m] of a linear spring or a tendon, [N m/rad] of a rotary spring; by
    default the element's own, which a controller may change."""

    @model_validator(mode="after")
    def _one_target(self) -> Self:
        if (self.spring is None) == (self.tendon is None):
            raise WrongValueError("conflicting-keys", "a stiffness drive needs either 'spring' or "
                                  "'tendon'")
        return self

    @property
    def kind(self) -> DriveKind:
        """Facts, by its target."""
        return self.facts if self.tendon is None else self.on_tendon

    def _spring(self, mechanism: Mechanism) -> Any:
        """Its spring or tendon; None where no element has the name."""
        return next((each for each in (*mechanism.springs, *mechanism.tendons)
                     if each.name == (self.spring or self.tendon)), None)

    def unit(self, mechanism: Mechanism) -> str:
        """The unit of its value."""
        return self.kind.unit or str(self._spring(mechanism).facts.unit)

    def dimension(self, mechanism: Mechanism) -> str | None:
        """The dimension of its value; None where no element has the name."""
        if self.tendon is not None:
            return self.kind.dimension
        spring = self._spring(mechanism)
        return spring and str(spring.facts.dimension)

    def signal(self, mechanism: Mechanism) -> signals.AnySignal:
        """Its value over time: by default the stiffness of its spring or tendon."""
        return (signals.Constant(constant=self._spring(mechanism).stiffness)
                if self.value is None else self.value)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """The stiffness of its spring or tendon, set before each step."""
        draft.add("set", self.name, draft.value(index), self.spring or self.tendon, "stiffness",
                  floor=0.0)

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        """Springs and tendons that have no stiffness to set, tendons with several tensions."""
        found, name = self._spring(mechanism), quoted(self.spring or self.tendon or "")
        pull = next((each.name for each in mechanism.drives if each.kind.gives == "tension"
                     and each.target[1] == self.tendon), None)
        if pull is not None:
            fault, allowed = (f"{name} has no stiffness to set: {quoted(pull)} pulls it, which "
                              "sets its tension", "a tendon that no drive pulls")
        elif found is None:
            return
        elif found.stiffness is None:
            fault, allowed = (f"{name} follows a law and has no stiffness to set",
                              "a spring with a 'stiffness'")
        elif self.tendon is not None and found.gripping:
            fault, allowed = (f"the stiffness of {name} cannot be set: its guide "
                              f"{found.gripping[0]} has friction, so each span has its own tension",
                              "a tendon whose guides have no 'friction'")
        elif self.tendon is not None and found.stiffness >= RIGID:
            fault, allowed = (f"{name} has no stiffness to set: with {found.stiffness:g} N/m it "
                              "counts as inextensible", f"a tendon with a 'stiffness' below "
                              f"{RIGID:g} N/m, which it has until the drive sets another")
        else:
            return
        yield Problem("not-settable", fault, f"{path}.{'spring' if self.spring else 'tendon'}",
                      allowed=allowed)


class HoldDrive(DriveSpec):
    """Releases and engages a joint, a spring or a tendon, any number of times.

    Models a clutch, a magnet, or a latch that a controller works. A broken element stays broken
    until the value has been 0.5 or less and rises again.
    """

    PYMUNK = RELEASED
    facts = DriveKind(HELD, "hold", "1", "ratio", ("value",), sole="hold", mujoco=RELEASED)

    type: Literal["hold"] = TYPE
    element: Annotated[Name, HELD]
    """Name of the joint, spring or tendon. A joint closes its gap in its ``takes_up_in``."""
    value: signals.ShareSignal
    """Value over time: above 0.5 engages, otherwise releases. An event that releases or engages the
    same element overrides it until the value next crosses 0.5."""

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        """Wheels, which cannot be engaged again."""
        if any(joint.name == self.element and joint.facts.wheels for joint in mechanism.joints):
            yield no_mesh(self.element, f"{path}.element")
