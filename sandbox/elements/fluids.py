"""Fluid under pressure: lines with their chambers, and valves between lines.

A line is to pressure and volume what a tendon is to tension and length: one pressure in all of
its chambers, which grow as the fluid pushes.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from sandbox.elements.kinds import ATMOSPHERE
from sandbox.values.numbers import (
    Area,
    Density,
    Displacement,
    Flag,
    FlowResistance,
    Items,
    Modulus,
    Name,
    Number,
    Point,
    Pressure,
    Volume,
)
from sandbox.values.spec import TYPE, Spec
from sandbox.wording import WrongValueError


class Cylinder(Spec):
    """A chamber between a point of ``a`` and a point of ``b``: area times distance."""

    type: Literal["cylinder"] = TYPE
    a: Name
    """The body that its tube is tied to."""
    b: Name
    """The body that its rod is tied to."""
    on_a: Point = (0.0, 0.0)
    """Where it is tied, in the frame of ``a`` [m]."""
    on_b: Point = (0.0, 0.0)
    """Where it is tied, in the frame of ``b`` [m]."""
    area: Area
    """Of the piston that the fluid presses [m^2]; the force along the line through the two points
    is this times the pressure."""
    pulls: Flag = False
    """Whether the fluid is on the rod's side: its volume then grows as the points come nearer, and
    pressure pulls them together, as in an artificial muscle."""


class Vane(Spec):
    """A chamber on a hinge, such as a vane or a bellows: a volume for each angle."""

    type: Literal["vane"] = TYPE
    joint: Name
    """Name of the pin that it turns."""
    displacement: Displacement
    """Volume per angle of the hinge, in its own sense [m^3/rad]; the torque is this times the
    pressure, and against that sense where it is negative."""

    @model_validator(mode="after")
    def _something(self) -> Self:
        if abs(self.displacement) < 1e-24:
            raise WrongValueError("out-of-range", "must not be 0: give a volume per angle such as "
                                  "2 ml/rad; a negative one reverses the direction")
        return self


Chamber = Annotated[Cylinder | Vane, Field(discriminator="type")]


class Line(Spec):
    """Chambers and hoses that are filled with one fluid under one pressure.

    content - volume = volume / modulus * pressure; what is in it changes by what drives and valves
    let in and out. Every chamber pushes with its area times the pressure.
    """

    name: Name
    """Its name; quantities are ``<name>.pressure``, ``<name>.volume`` and so on."""
    chambers: Items[Chamber] = Field(default=(), max_length=64)
    """What the fluid moves; none where the line only stores some, as an accumulator does."""
    volume: Volume | None = None
    """Of all the fluid at t = 0, in chambers and hoses [m^3]; by default that of its cylinders that
    push, area times distance."""
    modulus: Modulus | None = None
    """Pressure per share by which the fluid is pressed together, walls of hoses included [Pa]; by
    default 1.4 GPa, that of oil. Not of a gas."""
    gas: Number | None = Field(default=None, ge=1, le=2)
    """The line is filled with gas: (pressure + 101325 Pa) * volume^gas stays the same while nothing
    comes in, with 1 where it is slow and stays as warm as its surroundings, 1.4 where air has no
    time for that. By default it is a liquid."""
    pressure: Pressure = 0.0
    """At t = 0, above the surroundings [Pa]."""
    least: Pressure = -ATMOSPHERE
    """The least pressure [Pa]: where it would be less the line is no longer full, with a void, as
    a cord hangs slack. By default -101325 Pa, a vacuum."""
    relief: Pressure | None = None
    """The most pressure [Pa]: where it would be more fluid is let out into the tank. By default
    there is no such valve."""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        most = self.least if self.relief is None else self.relief
        if self.least > 0 or self.least < -ATMOSPHERE:
            raise WrongValueError("out-of-range", "the least pressure must be from -101325 Pa, a "
                                  "vacuum, to 0")
        if self.relief is not None and most <= 0:
            raise WrongValueError("out-of-range", "the relief must open at more than 0 Pa")
        if self.pressure < self.least or (self.relief is not None and self.pressure > most):
            raise WrongValueError("out-of-range", "the pressure at t = 0 must lie between least "
                                  "and relief")
        if self.gas is not None and self.modulus is not None:
            raise WrongValueError("conflicting-keys", "'gas' and 'modulus' exclude each other")
        if self.gas is not None and self.pressure <= -ATMOSPHERE:
            raise WrongValueError("out-of-range", "a line with gas needs a pressure above a vacuum")
        return self


class Valve(Spec):
    """Lets fluid from one line into another, or out of and into the tank.

    p_a - p_b = resistance * Q + density / 2 * (Q / (discharge * area))^2, of Q / opening where a
    drive has it partly open.
    """

    name: Name
    """Its name; quantities are ``<name>.flow`` and ``<name>.loss``."""
    a: Name | None = None
    """The line at its one end; left out it is the tank, whose pressure is 0."""
    b: Name | None = None
    """The line at its other end; left out it is the tank."""
    resistance: FlowResistance = 0.0
    """Pressure per flow of a long narrow passage [Pa s/m^3]."""
    area: Area | None = None
    """Of the opening of an orifice [m^2]; by default it is no orifice."""
    discharge: Annotated[Number, Field(gt=0.01, le=1)] = 0.61
    """How much of the orifice's area the jet takes."""
    density: Density = 870.0
    """Of the fluid, which counts in an orifice [kg/m^3]; by default that of oil."""
    one_way: Flag = False
    """A check valve: it lets fluid from ``a`` to ``b`` and not back."""

    @model_validator(mode="after")
    def _between(self) -> Self:
        if self.a == self.b:
            raise WrongValueError("conflicting-keys", "a valve needs a line: give 'a', 'b' or both")
        if self.resistance < 1e-12 and self.area is None:
            raise WrongValueError("conflicting-keys", "a valve needs 'area', or a 'resistance' "
                                  "greater than 0")
        return self
