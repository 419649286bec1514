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
from sandbox.scene.values.planes import Planes
from sandbox.scene.values.signals import Path


class Circle(Spec):
    """A disc."""

    type: Literal["circle"]
    radius: Length
    """Its radius [m]."""
    at: Point = (0.0, 0.0)
    """Its centre in the body's frame [m]."""


class Box(Spec):
    """A rectangle about ``at``, turned by ``angle`` in the body's frame."""

    type: Literal["box"]
    size: tuple[Length, Length]
    """[width, height] along its own x and y [m]."""
    at: Point = (0.0, 0.0)
    """Its middle in the body's frame [m]."""
    angle: Angle = 0.0
    """Its turn against the body's frame [rad], counter-clockwise."""


class Polygon(Spec):
    """A convex polygon; its corners in either order."""

    type: Literal["polygon"]
    points: tuple[Point, ...] = Field(min_length=3, max_length=64)
    """Its corners in the body's frame [m], one after the other, clockwise or counter-clockwise."""

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
    """Middle of its one round end, in the body's frame [m]."""
    end: Point
    """Middle of its other round end, in the body's frame [m]."""
    radius: Length
    """Half its thickness, and the radius of its ends [m]."""


Shape = Annotated[Circle | Box | Polygon | Capsule, Field(discriminator="type")]
Role = Literal["link", "ground", "palm", "phalanx", "rocker", "pulley", "object"]


class Body(Spec):
    """A rigid body: where it starts, how it moves, what it weighs, what it looks like.

    Mass comes from ``mass``, or from ``density`` times the shapes' area times
    ``thickness``. Centre and inertia follow from the shapes (an even spread of
    the mass over their area) unless given.
    """

    name: Name
    """Its name; quantities are ``<name>.x``, ``<name>.angle`` and so on."""
    at: Point = (0.0, 0.0)
    """Origin of the body's frame in the world at t = 0 [m]."""
    angle: Angle = 0.0
    """Turn of the body's frame against the world at t = 0 [rad], counter-clockwise."""
    motion: Literal["dynamic", "fixed", "scheduled"] = "dynamic"
    """``dynamic`` is moved by forces, ``fixed`` stays where it is, ``scheduled`` follows its
    ``path`` whatever the forces on it."""
    path: Path | None = None
    """Pose over time; for ``"motion": "scheduled"`` only, which needs it."""
    shapes: tuple[Shape, ...] = ()
    """What it consists of, in its frame: its outline for contacts and pictures and, unless given,
    its mass's spread. One without shapes touches nothing."""
    mass: Mass | None = None
    """Of the whole body [kg]; a dynamic body has either this or ``density``."""
    density: Density | None = None
    """Mass per volume [kg/m^3]; with the shapes' areas and ``thickness`` it gives the mass."""
    thickness: Length = 0.01
    """Depth across the plane [m], used with ``density`` only."""
    centre: Point | None = None
    """Centre of mass in the body's frame [m]; by default that of the shapes' area."""
    inertia: Inertia | None = None
    """Moment of inertia about the centre of mass [kg m^2]; by default the mass spread evenly over
    the shapes' area."""
    velocity: tuple[Speed, Speed] = (0.0, 0.0)
    """Velocity [x, y] of the centre of mass at t = 0, in the world [m/s]."""
    angular_velocity: AngularSpeed = 0.0
    """Angular velocity at t = 0 [rad/s], counter-clockwise."""
    material: Name | None = None
    """Name of one of the scene's ``materials``; without one, friction is 0.5 and restitution 0."""
    plane: Planes = (0,)
    """Layer that it lies in, a whole number, higher ones nearer to the eye: bodies of different
    planes pass each other, whatever contact rules say, and are drawn in this order. In a list of
    planes it meets the bodies of each and is drawn in the lowest; ``"all"`` meets everything and is
    drawn behind."""
    role: Role = "link"
    """How it is drawn, and nothing else."""

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
    """Coulomb coefficient, 0 or more, of two surfaces of this material."""
    restitution: Share = 0.0
    """Rebound speed over approach speed of two surfaces of this material: 0 does not bounce, 1
    loses nothing. Of a pair it is the geometric mean of the two."""
