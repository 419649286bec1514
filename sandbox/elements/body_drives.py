"""Drives of bodies: forces, radii of circles, surfaces that run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import islice
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from sandbox.elements.drive import DriveKind, DriveSpec
from sandbox.elements.element import BODY, OTHER_SIDE, BodyName, Direction, Turn, direction_problems
from sandbox.errors import Problem
from sandbox.values.numbers import Name, Point
from sandbox.values.signals import ForceSignal, LengthSignal, RateSignal
from sandbox.values.spec import TYPE
from sandbox.wording import MOST_NAMED, quoted

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft
    from sandbox.export.document import Draft
    from sandbox.scene.mechanism import Mechanism
    from sandbox.scene.parts.placement import Mover

SMALLEST_RADIUS = 1e-9
"""Of a circle that a drive makes smaller [m]."""


class ForceDrive(DriveSpec):
    """A force on a point of a body, along a fixed direction."""

    facts: ClassVar[DriveKind] = DriveKind(
        BODY, "force", "N", "force")

    type: Literal["force"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    body: BodyName
    """Name of the body that is pushed."""
    at: Point = (0.0, 0.0)
    """The point that the force acts on, in the body's frame [m]; it moves with the body."""
    direction: Direction
    """[x, y] of any length except zero: only its direction counts; a negative value reverses it."""
    frame: Literal["world", "body"] = "world"
    """Whether the direction is fixed in the world or in the body."""
    value: ForceSignal
    """The force over time [N]."""

    def columns(self) -> dict[str, Any]:
        """Its columns of :class:`sandbox.model.model.Drives`, besides those of all."""
        size = np.hypot(*self.direction)
        return {"at": self.at, "turning": self.frame == "body", "direction": (
            float(self.direction[0] / size), float(self.direction[1] / size))}

    def range_problems(self, path: str) -> Iterator[Problem]:
        """A direction without a length that can be computed with."""
        return direction_problems(self.direction, f"{path}.direction")

    def placed(self, mover: Mover) -> Mapping[str, Any]:
        """Fields that are ``kept`` and that a placement changes all the same, with new values."""
        return {"direction": mover.placement.vector(self.direction) if self.frame == "world"
                else mover.direction(self.body, self.direction)}

    def write_mujoco(self, draft: Draft, index: int) -> None:
        """Add the drive to a MuJoCo model."""
        columns = self.columns()
        frame = None if columns["turning"] else draft.world_frame()
        site = draft.site(draft.target(index), f"{self.name}.site", self.at)
        draft.motor(index, gear=(*columns["direction"], 0, 0, 0, 0), site=site, refsite=frame)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A force before each step."""
        turns = {"turns": True} if self.frame == "body" else {}
        draft.add("push_point", self.name, draft.value(index), self.body, self.at,
                  self.columns()["direction"], **turns)


class RadiusDrive(DriveSpec):
    """Sets the radius of a body's circle over time: an object that swells or shrinks."""

    facts: ClassVar[DriveKind] = DriveKind(
        BODY, "radius", "m", "length", floor=SMALLEST_RADIUS, sole="radius", latched=True,
        mujoco="a changing radius")

    type: Literal["radius"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    body: BodyName
    """Name of the body; mass and inertia stay as they are."""
    shape: int = Field(default=0, ge=0)
    """Which of the body's shapes, counted from 0; it has to be a circle."""
    value: LengthSignal
    """The radius over time [m]."""

    def columns(self) -> dict[str, Any]:
        """Its columns of :class:`sandbox.model.model.Drives`, besides those of all."""
        return {"shape": self.shape}

    @property
    def positive_value(self) -> bool:
        """Whether its value must stay greater than 0."""
        return True

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
        if self.shape < len(kinds) and kinds[self.shape] == "circle":
            return
        circles = (str(i) for i, kind in enumerate(kinds) if kind == "circle")
        allowed = ", ".join(islice(circles, MOST_NAMED)) \
            or f"none: {quoted(self.body)} has no circle"
        what = (f"{quoted(self.body)} has no shape {self.shape} (they count from 0)"
                if self.shape >= len(kinds) else
                f"shape {self.shape} of {quoted(self.body)} is a {kinds[self.shape]}; only a "
                "circle has a radius to set")
        yield Problem("not-settable", what, f"{path}.shape", allowed=allowed)


class SurfaceDrive(DriveSpec):
    """Moves the surface of a body along its outline, as on a conveyor; the body does not move.

    Friction carries along the bodies that touch it.
    """

    PYMUNK = "a conveyor surface: its shapes have one surface velocity, not one along an outline"
    facts: ClassVar[DriveKind] = DriveKind(
        BODY, "surface", "m/s", "speed", ("value", "work", "power"), sole="surface", timely="end",
        mujoco="a conveyor surface")

    type: Literal["surface"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, friction times speed as
    ``<name>.power``."""
    body: BodyName
    """Name of the body, all of whose shapes run; its mass and pose are not changed by that."""
    positive: Annotated[Turn, OTHER_SIDE] = "counterclockwise"
    """Positive direction of the speed around the body: with ``clockwise`` its top moves right."""
    value: RateSignal
    """The speed along the surface over time [m/s], seen from the body."""

    def columns(self) -> dict[str, Any]:
        """Its columns of :class:`sandbox.model.model.Drives`, besides those of all."""
        return {"sense": 1.0 if self.positive == "counterclockwise" else -1.0}
