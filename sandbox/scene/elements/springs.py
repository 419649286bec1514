"""Springs with dampers: linear between two points, rotary about a hinge."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from sandbox.scene.elements.spec import Spec
from sandbox.scene.values.numbers import (
    Angle,
    Damping,
    Distance,
    Name,
    Point,
    RotaryDamping,
    RotaryStiffness,
    Stiffness,
)


class LinearSpring(Spec):
    """A straight spring and damper from a point of ``a`` to a point of ``b``; pulls and pushes."""

    type: Literal["linear"]
    name: Name
    """Its name; quantities are ``<name>.force`` and so on."""
    a: Name
    """The body at its one end."""
    b: Name
    """The body at its other end."""
    on_a: Point = (0.0, 0.0)
    """Where it is tied, in the frame of ``a`` [m]."""
    on_b: Point = (0.0, 0.0)
    """Where it is tied, in the frame of ``b`` [m]."""
    stiffness: Stiffness
    """Force per change of length [N/m], 0 or more; the force is positive where it pulls."""
    damping: Damping = 0.0
    """Force per rate of length [N s/m], against it."""
    rest_length: Distance | None = None
    """Length at which it neither pulls nor pushes [m]; by default the length at t = 0."""


class RotarySpring(Spec):
    """A torsion spring and damper on a hinge, in the hinge's own sense of turning."""

    type: Literal["rotary"]
    name: Name
    """Its name; quantities are ``<name>.torque`` and so on."""
    joint: Name
    """Name of the pin that it acts on; its angle is this hinge's, in the hinge's sense."""
    stiffness: RotaryStiffness
    """Torque per angle [N m/rad], 0 or more, towards ``rest_angle``."""
    damping: RotaryDamping = 0.0
    """Torque per rate [N m s/rad], against it."""
    rest_angle: Angle = 0.0
    """The hinge's angle at which it gives no torque [rad], in the hinge's sense; 0 by default,
    wherever the hinge starts."""


Spring = Annotated[LinearSpring | RotarySpring, Field(discriminator="type")]
