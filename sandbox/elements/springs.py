"""Springs with dampers: linear between two points, rotary about a hinge."""

from __future__ import annotations

from typing import Annotated, Literal, TypeVar

from pydantic import Field, ValidationInfo, field_validator, model_validator

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
from sandbox.values.spec import TYPE, Spec
from sandbox.wording import WrongValueError

TakenUp = Literal["natural", "as_is"]
AnySpring = TypeVar("AnySpring", "LinearSpring", "RotarySpring")


OWN: dict[str, tuple[str, ...]] = {"force": ("stretch", "rate"), "torque": ("twist", "rate")}
"""What the law of a spring may read, by its field."""


def _force_law(text: str | None, info: ValidationInfo) -> str | None:
    return None if text is None else law_of(text, OWN["force"], "spring", info)


def _torque_law(text: str | None, info: ValidationInfo) -> str | None:
    return None if text is None else law_of(text, OWN["torque"], "spring", info)


def _one_law(spring: AnySpring) -> AnySpring:
    """Either a stiffness or a law, not both and not neither."""
    field = "force" if isinstance(spring, LinearSpring) else "torque"
    law = getattr(spring, field)
    if (spring.stiffness is None) == (law is None):
        said = "not both" if law is not None else "one of them"
        raise WrongValueError("conflicting-keys", f"give 'stiffness' or '{field}', {said}")
    return spring


class LinearSpring(Spec):
    """A straight spring and damper from a point of ``a`` to a point of ``b``; pulls and pushes."""

    LOCAL = ("force",)

    type: Literal["linear"] = TYPE
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

    _law = field_validator("force")(_force_law)
    _one = model_validator(mode="after")(_one_law)


class RotarySpring(Spec):
    """A torsion spring and damper on a hinge, in the hinge's own sense of turning."""

    LOCAL = ("torque",)

    type: Literal["rotary"] = TYPE
    name: Name
    """Its name; quantities are ``<name>.torque`` and so on."""
    joint: Name
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
    rest_angle: Angle = 0.0
    """The hinge's angle at which it gives no torque [rad], in the hinge's sense; 0 by default,
    wherever the hinge starts."""
    breaks_at: Annotated[Torque, POSITIVE] | None = None
    """The size of its torque, either way and without its damping, above which it is let go [N m],
    for good unless an event takes it up again; by default it never breaks."""
    released: Flag = False
    """Whether it is let go from the start, until an event takes it up. Its damping is part of the
    hinge's, and stays as long as that."""

    _law = field_validator("torque")(_torque_law)
    _one = model_validator(mode="after")(_one_law)


Spring = Annotated[LinearSpring | RotarySpring, Field(discriminator="type")]
