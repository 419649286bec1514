"""A section of an object: a fixed circle and a square on a rod that yields (Figure 6)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, WithJsonSchema

from sandbox.elements.joints import Pin, Rod, Rope, Slot
from sandbox.elements.registry import Joint
from sandbox.elements.springs import LinearSpring, RotarySpring
from sandbox.scene.bodies import Body, Box, Circle
from sandbox.scene.geometry import pose_of, to_world
from sandbox.scene.parts.expansion import Elements, Known, PartSpec
from sandbox.scene.settings import Group
from sandbox.values import numbers as of
from sandbox.values.appearance import Planes
from sandbox.values.spec import TYPE
from sandbox.wording import refuse_if

ARM_FRACTION = 0.2  # of the square's mass, for the body that carries the rod's angle
_NUMBER: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string"}]}
RodLengths = Annotated[
    of.Written[tuple[of.Distance, of.Length]],
    BeforeValidator(lambda value: value if isinstance(value, (list, tuple)) else [value, value]),
    WithJsonSchema({"anyOf": [*_NUMBER["anyOf"], {
        "type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2}]}),
]


class Section(PartSpec):
    """A fixed circle; with ``square``, also a square held out from its centre by a rod."""

    type: Literal["section"] = TYPE
    name: of.Name
    """Its name; its bodies are ``<name>.circle`` and ``<name>.square``."""
    at: of.Point = (0.0, 0.0)
    """Centre of the circle in the world [m]."""
    circle: of.Length
    """Radius of the circle [m]."""
    square: of.Length | None = None
    """Side of the square [m]; without it the section is the circle alone."""
    rod: RodLengths | None = None
    """From the circle's centre to the square's [m]: a length, or a telescope's [min, max]."""
    angle: of.Angle = 0.0
    """Direction from the circle's centre to the square at t = 0 [rad]; 0 is along +x."""
    mass: of.Mass = 0.005
    """Mass of the square [kg]."""
    hold: of.Stiffness = 5.0
    """Stiffness of the weak springs that hold the square, along the rod and across it [N/m]."""
    damping: of.Damping = 1.0
    """Damping of the same springs [N s/m]."""
    material: of.Name | None = None
    """Name of both bodies' material, one of the scene's ``materials``."""
    plane: Planes = (0,)
    """Plane of its bodies, as a body's ``plane``."""

    def _verify(self) -> None:
        refuse_if((self.square is None) != (self.rod is None), "'square' and 'rod' belong together")
        refuse_if(self.rod is not None and self.rod[0] > self.rod[1],
                  "'rod' is a length or [shortest, longest]", "wrong-type")

    def expand(self, known: Known) -> Elements:
        """All elements so far, the circle and, if there is one, the square on its rod.

        The circle's frame has x towards the square. ``arm``, a body without shapes pinned to the
        circle, has the rod's angle; the square slides along it without turning on it. A weak spring
        holds the square along the rod, another across it, equally stiff: k_rot = k reach^2.
        """
        name, look = self.name, {"material": self.material, "plane": self.plane}
        circle, arm, square = (f"{name}.{body}" for body in ("circle", "arm", "square"))
        bodies = [Body(name=circle, at=self.at, angle=self.angle, motion="fixed", role="object",
                       shapes=(Circle(radius=self.circle),), **look)]
        if self.square is None or self.rod is None:
            return known.elements + Elements(
                bodies=tuple(bodies),
                groups=(Group(name=name, kind="section", bodies=(circle,)),))
        side, (shortest, reach) = self.square, self.rod
        mass = ARM_FRACTION * self.mass
        bodies += [
            Body(name=arm, at=self.at, angle=self.angle, mass=mass,
                 inertia=mass * reach**2 / 12, centre=(reach / 2, 0.0)),
            Body(name=square, at=to_world(pose_of(bodies[0]), (reach, 0.0)), angle=self.angle,
                 mass=self.mass, role="object", shapes=(Box(size=(side, side)),), **look)]
        ends: dict[str, Any] = {"name": f"{name}.rod", "a": circle, "b": square, "collide": True}
        rod: Joint = Rod(**ends, length=reach) if shortest == reach else \
            Rope(**ends, shortest=shortest, longest=reach)
        return known.elements + Elements(
            bodies=tuple(bodies),
            groups=(Group(name=name, kind="section", bodies=(circle, square)),),
            joints=(Pin(name=f"{name}.pivot", a=circle, b=arm, on_a=(0.0, 0.0), on_b=(0.0, 0.0),
                        damping=self.damping * reach**2),
                    Slot(name=f"{name}.slide", a=arm, b=square, start=(0.0, 0.0), end=(reach, 0.0),
                         turns=False), rod),
            springs=(LinearSpring(name=f"{name}.push", a=circle, b=square, stiffness=self.hold,
                                  damping=self.damping, rest_length=reach),
                     RotarySpring(name=f"{name}.hold", joint=f"{name}.pivot",
                                  stiffness=self.hold * reach**2)))
