"""Springs with dampers: linear between two points, rotary about a hinge."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, ValidationInfo, field_validator, model_validator

from sandbox.elements.element import KEPT, BodyName, Element, HingeName, Quantity, recorded
from sandbox.values.numbers import (
    POSITIVE,
    Angle,
    Damping,
    Distance,
    Flag,
    Force,
    Name,
    Point,
    RotaryDamping,
    RotaryStiffness,
    Stiffness,
    Torque,
    law_of,
)
from sandbox.values.spec import TYPE
from sandbox.wording import WrongValueError

if TYPE_CHECKING:
    from sandbox.model.compile import Scope
    from sandbox.scene.mechanism import Mechanism

TakenUp = Literal["natural", "as_is"]
QUANTITIES: Mapping[str, Quantity] = {
    "length": recorded("spring_length", "m", "between its two points", live=True),
    "force": recorded("spring_force", "N", "positive in tension; damper included", live=True),
    "angle": recorded("spring_length", "rad", "of its hinge, in the hinge's positive sense",
                      live=True),
    "torque": recorded("spring_force", "N m",
                       "positive against a positive angle; damper included"),
    "work": recorded("spring_work", "J", "done on the bodies since t = 0"),
}


@dataclass(frozen=True)
class SpringKind:
    """How springs of a kind act."""

    unit: str
    """Of its stiffness."""
    dimension: str
    records: tuple[str, ...]
    straight: bool
    """From point to point; otherwise about a hinge."""


class SpringSpec(Element):
    """The base of all springs."""

    facts: ClassVar[SpringKind]
    OWN: ClassVar[tuple[str, ...]]

    @property
    def law(self) -> str | None:
        """Its law, an expression; None with a stiffness."""
        raise NotImplementedError

    def quantities(self, mechanism: Mechanism) -> dict[str, str]:
        """The quantities that it records, with their units."""
        return {name: QUANTITIES[name].unit for name in self.facts.records}

    @model_validator(mode="after")
    def _one_law(self) -> Self:
        if (getattr(self, "stiffness", None) is None) == (self.law is None):
            said = "not both" if self.law is not None else "one of them"
            raise WrongValueError("conflicting-keys",
                                  f"give 'stiffness' or '{self.LOCAL[0]}', {said}")
        return self


def _read_law(cls: type[SpringSpec], text: str | None, info: ValidationInfo) -> str | None:
    return None if text is None else law_of(text, cls.OWN, "spring", info)


class LinearSpring(SpringSpec):
    """A straight spring and damper from a point of ``a`` to a point of ``b``; pulls and pushes."""

    facts: ClassVar[SpringKind] = SpringKind(
        "N/m", "stiffness", ("length", "force", "work"), straight=True)

    LOCAL = ("force",)
    OWN = ("stretch", "rate")

    type: Literal["linear"] = TYPE
    name: Name
    """Its name; quantities are ``<name>.force`` and so on."""
    a: BodyName
    """The body at its one end."""
    b: BodyName
    """The body at its other end."""
    on_a: Point = (0.0, 0.0)
    """Where it is tied, in the frame of ``a`` [m]."""
    on_b: Point = (0.0, 0.0)
    """Where it is tied, in the frame of ``b`` [m]."""
    stiffness: Stiffness | None = None
    """Force per change of length [N/m], 0 or more; the force is positive where it pulls."""
    force: str | None = None
    """In place of ``stiffness`` the force [N] as an expression of its ``stretch`` [m], its length
    less that at rest, and of its ``rate`` [m/s], by which that grows: ``"=1e3 * stretch +
    4e6 * stretch ** 3"``, ``"=bumper(stretch)"``. Positive pulls."""
    only: Literal["pull", "push"] | None = None
    """One-sided: ``pull`` for what only pulls, and is slack below its length at rest, as a bungee
    cord; ``push`` for what only pushes, and stands apart above it, as a bump stop."""
    damping: Damping = 0.0
    """Force per rate of length [N s/m], against it; of a one-sided spring only while it acts."""
    rest_length: Distance | None = None
    """Length at which it neither pulls nor pushes [m]; by default the length at t = 0. The
    ``stretch`` of its ``force`` counts from it."""
    breaks_at: Annotated[Force, POSITIVE] | None = None
    """The size of its force, either way, above which it is let go [N], for good unless an event
    takes it up again; by default it never breaks."""
    released: Flag = False
    """Whether it is let go from the start, until an event takes it up."""
    taken_up: TakenUp = "natural"
    """With which length at rest an event takes it up again: ``natural`` is the one that it has had,
    so that it may pull at once; ``as_is`` the distance of its points then, so that it begins
    without force."""

    _law = field_validator("force")(_read_law)

    @property
    def law(self) -> str | None:
        """Its law, an expression; None with a stiffness."""
        return self.force

    def columns(self, scope: Scope) -> dict[str, Any]:
        """Its columns of :class:`sandbox.model.model.Springs`, besides those of all."""
        p, q = scope.world(self.a, self.on_a), scope.world(self.b, self.on_b)
        start = float(np.hypot(q[0] - p[0], q[1] - p[1]))
        return {"bodies": (scope.number("bodies", self.a), scope.number("bodies", self.b)),
                "anchor": (self.on_a, self.on_b), "start": start,
                "rest": start if self.rest_length is None else self.rest_length}


class RotarySpring(SpringSpec):
    """A torsion spring and damper on a hinge, in the hinge's own sense of turning."""

    facts: ClassVar[SpringKind] = SpringKind(
        "N m/rad", "rotary stiffness", ("angle", "torque", "work"), straight=False)

    LOCAL = ("torque",)
    OWN = ("twist", "rate")

    type: Literal["rotary"] = TYPE
    name: Name
    """Its name; quantities are ``<name>.torque`` and so on."""
    joint: HingeName
    """Name of the pin that it acts on; its angle is this hinge's, in the hinge's sense."""
    stiffness: RotaryStiffness | None = None
    """Torque per angle [N m/rad], 0 or more, towards ``rest_angle``."""
    torque: str | None = None
    """In place of ``stiffness`` the torque [N m] as an expression of its ``twist`` [rad], the
    hinge's angle less ``rest_angle``, and of its ``rate`` [rad/s]: ``"=0.2 * twist ** 3"``,
    ``"=pad(twist)"``. Positive turns a positive twist back."""
    only: Literal["above", "below"] | None = None
    """One-sided: it acts only where the hinge's angle is ``above`` the one at rest, or only where
    it is ``below``, and only towards it."""
    damping: RotaryDamping = 0.0
    """Torque per rate [N m s/rad], against it; of a one-sided spring only while it acts."""
    rest_angle: Annotated[Angle, KEPT] = 0.0
    """The hinge's angle at which it gives no torque [rad], in the hinge's sense; 0 by default,
    wherever the hinge starts."""
    breaks_at: Annotated[Torque, POSITIVE] | None = None
    """The size of its torque, either way and without its damping, above which it is let go [N m],
    for good unless an event takes it up again; by default it never breaks."""
    released: Flag = False
    """Whether it is let go from the start, until an event takes it up. Its damping is part of the
    hinge's, and stays as long as that."""

    _law = field_validator("torque")(_read_law)

    @property
    def law(self) -> str | None:
        """Its law, an expression; None with a stiffness."""
        return self.torque

    def columns(self, scope: Scope) -> dict[str, Any]:
        """Its columns of :class:`sandbox.model.model.Springs`, besides those of all."""
        joint = scope.number("joints", self.joint)
        return {"bodies": scope.joints.bodies[joint], "start": float(scope.joints.start[joint]),
                "rest": self.rest_angle, "joint": joint}


Spring = Annotated[LinearSpring | RotarySpring, Field(discriminator="type")]
