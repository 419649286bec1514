"""Fluid under pressure: lines with their chambers, valves between lines, and their drives."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from sandbox.elements import element as base
from sandbox.elements.drives import DriveKind, DriveSpec
from sandbox.elements.element import BodyName, Element, HingeName, Quantity, live
from sandbox.errors import Problem
from sandbox.values import numbers as of
from sandbox.values.signals import FlowSignal, PressureSignal, ShareSignal
from sandbox.values.spec import TYPE, Spec
from sandbox.values.units import size_fault
from sandbox.wording import quoted, refuse_if

if TYPE_CHECKING:
    from sandbox.scene.mechanism import Mechanism

FLUID = "fluid under pressure in lines"  # why MuJoCo has none of these
OIL = 1.4e9  # modulus of oil with a little air in it [Pa]
LineName = Annotated[of.Name, base.LINE]
LINE_QUANTITIES: Mapping[str, Quantity] = {
    "pressure": live("line_pressure", "Pa", "gauge pressure"),
    "volume": live("line_volume", "m^3", "of its chambers and hoses"),
    "flow": live("line_flow", "m^3/s", "into it, through valves and from drives; of a gas, at "
                                       "ambient pressure"),
    "spilled": Quantity("line_spilled", "m^3", "volume through its relief since t = 0"),
    "work": Quantity("line_work", "J", "done on the bodies since t = 0"),
}
VALVE_QUANTITIES: Mapping[str, Quantity] = {
    "flow": live("valve_flow", "m^3/s", "flow from its `a` to its `b`"),
    "loss": Quantity("valve_loss", "J", "energy lost to throttling since t = 0"),
}


class Cylinder(Spec):
    """A chamber between a point of ``a`` and a point of ``b``: area times distance."""

    type: Literal["cylinder"] = TYPE
    a: BodyName
    """The body that its tube is fixed to."""
    b: BodyName
    """The body that its rod is fixed to."""
    on_a: of.Point = (0.0, 0.0)
    """Point of the tube, in the frame of ``a`` [m]."""
    on_b: of.Point = (0.0, 0.0)
    """Point of the rod, in the frame of ``b`` [m]."""
    area: of.Area
    """Of the piston [m^2]; the force along the line through the points is area times pressure."""
    pulls: of.Flag = False
    """True: the fluid is on the rod side and pulls the points together, as in a muscle."""

    @property
    def gain(self) -> float:
        """Volume per distance of the points [m^2]."""
        return -self.area if self.pulls else self.area


class Vane(Spec):
    """A chamber on a hinge, such as a vane or a bellows: a volume for each angle."""

    type: Literal["vane"] = TYPE
    joint: HingeName
    """Name of the pin that it acts on."""
    displacement: Annotated[of.Displacement, of.NOT_ZERO]
    """Volume per angle, torque per pressure [m^3/rad], in the hinge's sense; may be negative."""

    @property
    def gain(self) -> float:
        """Volume per angle [m^3/rad]."""
        return self.displacement


Chamber = Annotated[Cylinder | Vane, Field(discriminator="type")]


class Line(Element):
    """Chambers and hoses filled with one fluid at one pressure.

    content - volume = volume / modulus * pressure; drives and valves change the content. Every
    chamber pushes with its area times the pressure.
    """

    PYMUNK = FLUID
    RECORDED = LINE_QUANTITIES
    name: of.Name
    """Its name; quantities are ``<name>.pressure``, ``<name>.volume`` and so on."""
    chambers: of.Items[Chamber] = Field(default=(), max_length=64)
    """What the fluid moves; none where the line only stores some, as an accumulator does."""
    volume: of.Volume | None = None
    """Of all fluid at t = 0 [m^3], hoses included; by default that of the cylinders that push."""
    modulus: of.Modulus | None = None
    """Pressure per relative compression, hoses included [Pa]; 1.4 GPa (oil) by default."""
    gas: of.Number | None = Field(default=None, ge=1, le=2)
    """The line contains gas: (pressure + 101325 Pa) * volume^gas is constant without flow. 1 is
    isothermal (slow), 1.4 is adiabatic air (fast). By default the line contains liquid."""
    pressure: of.Pressure = 0.0
    """At t = 0, above the surroundings [Pa]."""
    least: of.Pressure = -base.ATMOSPHERE
    """Minimum pressure [Pa]; below it the line cavitates. By default -101325 Pa, a vacuum."""
    relief: of.Pressure | None = None
    """Maximum pressure [Pa], at which a relief valve opens to the tank; none by default."""

    def _verify(self) -> None:
        relief = math.inf if self.relief is None else self.relief
        refuse_if(not -base.ATMOSPHERE <= self.least <= 0,
                  "the least pressure must be from -101325 Pa, a vacuum, to 0", "out-of-range")
        refuse_if(relief <= 0, "the relief must open at more than 0 Pa", "out-of-range")
        refuse_if(not self.least <= self.pressure <= relief,
                  "the pressure at t = 0 must lie between least and relief", "out-of-range")
        refuse_if(self.gas is not None and self.pressure <= -base.ATMOSPHERE,
                  "a line with gas needs a pressure above a vacuum", "out-of-range")
        refuse_if(self.gas is not None and self.modulus is not None,
                  "'gas' and 'modulus' exclude each other")

    def volume_at(self, world: Callable[[str, base.Vec], base.Vec]) -> float:
        """Volume at t = 0 [m^3]; 0 where neither a field nor the cylinders give it."""
        if self.volume is not None:
            return self.volume
        return math.fsum(
            each.area * math.dist(world(each.a, each.on_a), world(each.b, each.on_b))
            for each in self.chambers if isinstance(each, Cylinder) and not each.pulls)

    def compliance(self, volume: float) -> float:
        """Volume per pressure of its fluid [m^3/Pa], for its volume at t = 0 [m^3]."""
        if self.gas is not None:
            return volume / (self.gas * (self.pressure + base.ATMOSPHERE))
        return volume / (OIL if self.modulus is None else self.modulus)

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        bodies = {body.name for body in mechanism.bodies}
        known = all(chamber.a in bodies and chamber.b in bodies
                    for chamber in self.chambers if isinstance(chamber, Cylinder))
        if known and (fault := size_fault(self.volume_at(mechanism.world), "volume")):
            yield Problem("out-of-range", "its volume at t = 0 follows from the cylinders that "
                          f"push and is {fault}", f"{path}.volume",
                          allowed='the volume of its fluid, such as "0.1 l"')
        for j, chamber in enumerate(self.chambers):
            if isinstance(chamber, Vane) and chamber.joint in mechanism.releasable:
                yield Problem("not-releasable", f"{quoted(chamber.joint)} can be released, but "
                              "this chamber needs it", f"{path}.chambers[{j}].joint",
                              allowed="a hinge that stays")


class Valve(Element):
    """Lets fluid from one line into another, or out of and into the tank.

    p_a - p_b = resistance * Q + density / 2 * (Q / (discharge * area))^2; partly open Q / opening.
    """

    PYMUNK = FLUID
    RECORDED = VALVE_QUANTITIES
    name: of.Name
    """Its name; quantities are ``<name>.flow`` and ``<name>.loss``."""
    a: Annotated[of.Name | None, base.LINE] = None
    """The line at its one end; left out it is the tank, whose pressure is 0."""
    b: Annotated[of.Name | None, base.LINE] = None
    """The line at its other end; left out it is the tank."""
    resistance: of.FlowResistance = 0.0
    """Pressure per flow of a long narrow passage [Pa s/m^3]."""
    area: of.Area | None = None
    """Of the opening of an orifice [m^2]; by default it is no orifice."""
    discharge: Annotated[of.Number, Field(gt=0.01, le=1)] = 0.61
    """How much of the orifice's area the jet takes."""
    density: of.Density = 870.0
    """Of the fluid, which counts in an orifice [kg/m^3]; by default that of oil."""
    one_way: of.Flag = False
    """A check valve: it lets fluid from ``a`` to ``b`` and not back."""

    def _verify(self) -> None:
        refuse_if(self.a == self.b, "a valve needs a line: give 'a', 'b' or both")
        refuse_if(self.resistance < 1e-12 and self.area is None,
                  "a valve needs 'area', or a 'resistance' greater than 0")

    @property
    def orifice(self) -> float:
        """Pressure per square of the flow [Pa s^2/m^6]."""
        if self.area is None:
            return 0.0
        return self.density / 2 / (self.discharge * self.area) ** 2


class FlowDrive(DriveSpec):
    """Pumps fluid into a line, however high the pressure: the line's ``relief`` bounds it."""

    PYMUNK = FLUID
    facts = DriveKind(base.LINE, "flow", "flow", ("value", "work", "flow"), mujoco=FLUID)
    type: Literal["flow"] = TYPE
    line: LineName
    """Name of the line that it feeds."""
    value: FlowSignal
    """The flow over time [m^3/s], of a gas at ambient pressure; below 0 out of the line."""


class PressureDrive(DriveSpec):
    """A pressure source that feeds a line and takes fluid back."""

    PYMUNK = FLUID
    facts = DriveKind(base.LINE, "pressure", "pressure", ("value", "work", "flow"), sole="pressure",
                      mujoco=FLUID)
    type: Literal["pressure"] = TYPE
    line: LineName
    """Name of the line that it feeds."""
    value: PressureSignal
    """Gauge pressure over time [Pa], limited by the line's ``least`` and ``relief``."""
    resistance: of.FlowResistance = 0.0
    """Pressure loss per flow between the source and the line [Pa s/m^3]; none by default."""


class OpeningDrive(DriveSpec):
    """Opens and shuts a valve."""

    PYMUNK = FLUID
    facts = DriveKind(base.VALVE, "opening", "ratio", ("value",), floor=0.0, sole="opening",
                      mujoco=FLUID)
    type: Literal["opening"] = TYPE
    valve: Annotated[of.Name, base.VALVE]
    """Name of the valve; one that no drive opens is fully open."""
    value: ShareSignal
    """How far it is open over time: 0 is shut, 1 fully open. Below 0 counts as 0."""
