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
    a: Name
    b: Name
    on_a: Point = (0.0, 0.0)
    on_b: Point = (0.0, 0.0)
    stiffness: Stiffness
    damping: Damping = 0.0
    rest_length: Distance | None = None
    """By default the length at t = 0."""


class RotarySpring(Spec):
    """A torsion spring and damper on a hinge, in the hinge's own sense of turning."""

    type: Literal["rotary"]
    name: Name
    joint: Name
    """The pin it acts on."""
    stiffness: RotaryStiffness
    damping: RotaryDamping = 0.0
    rest_angle: Angle = 0.0


Spring = Annotated[LinearSpring | RotarySpring, Field(discriminator="type")]
