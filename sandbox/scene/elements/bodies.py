"""Bodies and their shapes. A body's points are in its own frame [m]."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from sandbox.scene.elements.spec import Spec
from sandbox.scene.values.numbers import (
    Angle,
    AngularSpeed,
    Density,
    Inertia,
    Length,
    Mass,
    Name,
    Point,
    Ratio,
    Share,
    Speed,
)
from sandbox.scene.values.signals import Path


class Circle(Spec):
    """A disc."""

    type: Literal["circle"]
    radius: Length
    at: Point = (0.0, 0.0)
    """Centre in the body's frame."""


class Box(Spec):
    """A rectangle about ``at``, turned by ``angle`` in the body's frame."""

    type: Literal["box"]
    size: tuple[Length, Length]
    at: Point = (0.0, 0.0)
    angle: Angle = 0.0


class Polygon(Spec):
    """A convex polygon; its corners in either order."""

    type: Literal["polygon"]
    points: tuple[Point, ...] = Field(min_length=3, max_length=64)

    @model_validator(mode="after")
    def _convex(self) -> Self:
        p = self.points
        bends = [
            (p[i - 1][0] - p[i - 2][0]) * (p[i][1] - p[i - 1][1])
            - (p[i - 1][1] - p[i - 2][1]) * (p[i][0] - p[i - 1][0])
            for i in range(len(p))
        ]
        if not (all(bend > 0 for bend in bends) or all(bend < 0 for bend in bends)):
            raise PydanticCustomError("polygon", "the corners must form a convex polygon")
        return self


class Capsule(Spec):
    """A segment from ``start`` to ``end`` with a radius: a phalanx."""

    type: Literal["capsule"]
    start: Point = (0.0, 0.0)
    end: Point
    radius: Length


Shape = Annotated[Circle | Box | Polygon | Capsule, Field(discriminator="type")]
Role = Literal["link", "ground", "palm", "phalanx", "rocker", "pulley", "object"]


class Body(Spec):
    """A rigid body: where it starts, how it moves, what it weighs, what it looks like.

    Mass comes from ``mass``, or from ``density`` times the shapes' area times
    ``thickness``. Centre and inertia follow from the shapes (an even spread of
    the mass over their area) unless given.
    """

    name: Name
    at: Point = (0.0, 0.0)
    """Origin of the body's frame in the world at t = 0."""
    angle: Angle = 0.0
    motion: Literal["dynamic", "fixed", "scheduled"] = "dynamic"
    path: Path | None = None
    """Pose over time; for ``"motion": "scheduled"`` only."""
    shapes: tuple[Shape, ...] = ()
    mass: Mass | None = None
    density: Density | None = None
    thickness: Length = 0.01
    """Depth across the plane [m], used with ``density`` only."""
    centre: Point | None = None
    """Centre of mass in the body's frame."""
    inertia: Inertia | None = None
    """About the centre of mass [kg m^2]."""
    velocity: tuple[Speed, Speed] = (0.0, 0.0)
    """Of the centre of mass at t = 0 [m/s]."""
    angular_velocity: AngularSpeed = 0.0
    """At t = 0 [rad/s], counter-clockwise."""
    material: Name | None = None
    role: Role = "link"
    """How it is drawn."""

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.motion == "scheduled") != (self.path is not None):
            raise PydanticCustomError(
                "path", "'path' and \"motion\": \"scheduled\" belong together")
        if self.motion == "dynamic":
            if (self.mass is None) == (self.density is None):
                raise PydanticCustomError("mass", "a dynamic body has either 'mass' or 'density'")
            if not self.shapes and (self.inertia is None or self.mass is None):
                raise PydanticCustomError(
                    "mass", "a dynamic body without shapes needs 'mass' and 'inertia'")
        return self


class Material(Spec):
    """A contact surface. The friction of a pair is the geometric mean of the two."""

    friction: Ratio = 0.5
    restitution: Share = 0.0
