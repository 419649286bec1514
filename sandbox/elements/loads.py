"""Loads: forces on bodies by a law of their own motion; drag, buoyancy, fields."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema

from sandbox.elements.element import KEPT, NAMED, Element, Quantity, live
from sandbox.errors import Problem
from sandbox.values import numbers as of
from sandbox.values.spec import TYPE
from sandbox.wording import quoted, refuse_if

if TYPE_CHECKING:
    from sandbox.scene.bodies import Body
    from sandbox.scene.mechanism import Mechanism

# names in the law of a load, in the order in which programs number them
MOTION = ("x", "y", "angle", "vx", "vy", "omega", "speed", "ax", "ay", "alpha", "t", "mass",
          "inertia")
MAX_PATTERNS = 100


def _law(dimension: str) -> Any:
    """Reads an expression of a body's motion, or a number of a dimension."""
    def read(value: Any, info: ValidationInfo) -> str:
        if isinstance(value, str) and value.lstrip().startswith("="):
            return of.law_of(value, MOTION, "body", info)
        return f"={of.number_from(value, dimension, of.parameters_of(info))!r}"

    return BeforeValidator(read)


_SCHEMA = WithJsonSchema({
    "anyOf": [{"type": "number"}, {"type": "string"}],
    "description": 'A number, a string with a unit, or an expression of the body\'s motion such as '
                   '"=-2 * vx".'})
ForceLaw = Annotated[of.Written[str], _law("force"), _SCHEMA]
TorqueLaw = Annotated[of.Written[str], _law("torque"), _SCHEMA]
AccelerationLaw = Annotated[of.Written[str], _law("acceleration"), _SCHEMA]
_PATTERN = {"type": "string", "minLength": 1, "maxLength": 100}
Patterns = Annotated[
    of.Items[Annotated[str, Field(min_length=1, max_length=100)]],
    Field(min_length=1, max_length=MAX_PATTERNS),
    BeforeValidator(lambda value: (value,) if isinstance(value, str) else value),
    WithJsonSchema({"anyOf": [_PATTERN, {"type": "array", "items": _PATTERN, "minItems": 1,
                                         "maxItems": MAX_PATTERNS}]})]
QUANTITIES: Mapping[str, Quantity] = {
    "fx": live("load_force", "N", "force on the body, in the world", 0),
    "fy": live("load_force", "N", "the same, upwards", 1),
    "torque": live("load_torque", "N m", "about the body's centre of mass"),
    "work": Quantity("load_work", "J", "done on the body since t = 0"),
}


class LoadSpec(Element):
    """The base of all loads."""

    RECORDED = QUANTITIES
    PYMUNK = "a load by a law of a body's own motion"
    type: str
    name: of.Name
    """Its name; quantities are ``<name>.<body>.fx`` and so on."""
    bodies: Patterns = ("*",)
    """Bodies that it acts on: a name, a pattern such as ``"ball*"``, or a list of them. By default
    every body that moves freely; fixed and scheduled bodies are skipped."""

    def borne(self, bodies: Sequence[Body]) -> list[int]:
        """Numbers of the bodies that it acts on, of those that move freely."""
        fits = [re.compile(fnmatch.translate(pattern)).match for pattern in self.bodies]
        return [i for i, body in enumerate(bodies) if body.motion == "dynamic"
                and any(fit(body.name) for fit in fits)]

    def laws(self) -> tuple[str | None, str | None, str | None] | None:
        """The two components of the force and the torque, as expressions; None without a law."""
        return None

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        names = {each.name for kind in NAMED for each in getattr(mechanism, kind)}
        for body in self.borne(mechanism.bodies):
            other = mechanism.bodies[body].name
            if (both := f"{self.name}.{other}") in names:
                yield Problem("duplicate-name",
                              f"{quoted(both)} is the name of another element, and here it "
                              f"would mean this load on {quoted(other)}",
                              f"{path}.name", allowed="another name")


class LawLoad(LoadSpec):
    """A force or a torque on bodies, by an expression of each body's own motion.

    An expression may read ``x``, ``y``, ``vx``, ``vy``, ``speed``, ``ax``, ``ay`` of the point
    ``at``, ``angle``, ``omega``, ``alpha``, ``mass``, ``inertia``, ``t``, parameters and tables.
    """

    LOCAL = ("force", "acceleration", "torque")
    type: Literal["law"] = TYPE
    force: of.Pair[ForceLaw] | None = None
    """The force [x, y] at the point ``at`` [N]: ``["=-0.2 * vx", "=-0.2 * vy"]``."""
    acceleration: of.Pair[AccelerationLaw] | None = None
    """In place of ``force``, force [x, y] per mass [m/s^2]: ``[0, "-1.62 m/s^2"]``."""
    torque: TorqueLaw | None = None
    """An additional torque on the body [N m], positive counter-clockwise: ``"=-0.01 * omega"``."""
    at: of.Point | None = None
    """Point that the force acts on, in each body's frame [m]; by default its centre of mass."""
    frame: Literal["world", "body"] = "world"
    """Axes of the two components: of the world, or of the body. ``vx``, ``vy``, ``ax``, ``ay`` are
    along the same axes; ``x``, ``y`` and ``angle`` are in the world."""

    def _verify(self) -> None:
        refuse_if(self.force is not None and self.acceleration is not None,
                  "give 'force' or 'acceleration', the force per mass, not both")
        refuse_if(self.force is None and self.acceleration is None and self.torque is None,
                  "give a 'force', an 'acceleration' or a 'torque'")

    def laws(self) -> tuple[str | None, str | None, str | None]:
        return *(self.force or self.acceleration or (None, None)), self.torque

    def columns(self, mechanism: Mechanism) -> dict[str, Any]:
        return {"at": self.at, "turning": self.frame == "body",
                "per_mass": self.acceleration is not None}


class DragLoad(LoadSpec):
    """Drag of a medium on bodies, at their centres of mass.

    F = -(linear + density / 2 * coefficient * area * |v|) v, v relative to the medium.
    """

    type: Literal["drag"] = TYPE
    linear: of.Damping = 0.0
    """Force per speed [N s/m], for slow motion in a viscous medium."""
    area: of.Area | None = None
    """Frontal area of the body, across the motion [m^2]; by default there is no quadratic drag."""
    coefficient: of.Ratio = 1.0
    """The drag coefficient of that area: 0.47 of a ball, 1.1 of a disc across the flow."""
    density: of.Density = 1.2
    """Of the medium [kg/m^3]; by default that of air."""
    turning: of.RotaryDamping = 0.0
    """Torque per angular speed [N m s/rad], against it."""
    flow: Annotated[of.Pair[of.Speed], KEPT] = (0.0, 0.0)
    """The velocity [x, y] of the medium in the world, such as wind [m/s]; none by default."""

    def _verify(self) -> None:
        refuse_if(self.area is None and not self.linear and not self.turning,
                  "give 'linear', 'area' or 'turning'")

    def laws(self) -> tuple[str | None, str | None, str | None]:
        u, v = (f"(v{axis} - {float(speed)!r})" if speed else f"v{axis}"
                for axis, speed in zip("xy", self.flow, strict=True))
        square = 0.5 * self.density * self.coefficient * (self.area or 0.0)
        size = repr(float(self.linear))
        if square:
            size = f"({size} + {square!r} * hypot({u}, {v}))"
        return f"=-{size} * {u}", f"=-{size} * {v}", f"=-{float(self.turning)!r} * omega"


class BuoyancyLoad(LoadSpec):
    """Buoyancy of bodies, as far as their shapes, or what they ``displace``, are below a level.

    F = density * thickness * (area below the level) * g, upwards, at the centroid of that area,
    with the ``thickness`` of the body and the scene's gravity, which has to point downwards. It is
    exact; shapes that overlap count twice, as in a body's mass. Only a ``drag`` takes energy.
    """

    type: Literal["buoyancy"] = TYPE
    level: Annotated[of.Coordinate, KEPT] = 0.0
    """Height of the surface: its ``y`` in the world [m]."""
    density: of.Density = 1000.0
    """Of the liquid [kg/m^3]; by default that of water."""

    def columns(self, mechanism: Mechanism) -> dict[str, Any]:
        return {"level": self.level, "weight": -self.density * mechanism.gravity[1]}

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        yield from super().problems(mechanism, path)
        x, y = mechanism.gravity
        if x or y >= 0:
            yield Problem("bad-fluid", "a liquid lifts against gravity, which has to point "
                          f"downwards here, and it is [{x:g}, {y:g}]", path,
                          allowed='a scene with "gravity": [0, -9.81]')


Load = Annotated[LawLoad | DragLoad | BuoyancyLoad, Field(discriminator="type")]
