"""Springs with dampers: linear between two points, rotary about a hinge."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field, ValidationInfo, field_validator

from sandbox.elements.element import KEPT, BodyName, Element, HingeName, Quantity, live
from sandbox.values import numbers as of
from sandbox.values.spec import TYPE
from sandbox.wording import refuse_if

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft

TakenUp = Literal["natural", "as_is"]
LACKS_LAW = "a spring with a law, or one that acts on one side only"  # in pymunk
QUANTITIES: Mapping[str, Quantity] = {
    "length": live("spring_length", "m", "between its two points"),
    "force": live("spring_force", "N", "positive in tension; damper included"),
    "angle": live("spring_length", "rad", "of its hinge, in the hinge's positive sense"),
    "torque": Quantity("spring_force", "N m", "positive against a positive angle; damper included"),
    "work": Quantity("spring_work", "J", "done on the bodies since t = 0"),
}


@dataclass(frozen=True)
class SpringKind:
    """How springs of a kind act."""

    dimension: str  # of its stiffness
    records: tuple[str, ...]
    straight: bool  # between two points; otherwise about a hinge


class SpringSpec(Element):
    """The base of all springs."""

    RECORDED = QUANTITIES
    facts: ClassVar[SpringKind]
    OWN: ClassVar[tuple[str, ...]]

    @property
    def law(self) -> str | None:
        text: str | None = getattr(self, self.LOCAL[0])
        return text

    def _verify(self) -> None:
        refuse_if((getattr(self, "stiffness", None) is None) == (self.law is None),
                  f"give either 'stiffness' or '{self.LOCAL[0]}'")


def _read_law(cls: type[SpringSpec], text: str | None, info: ValidationInfo) -> str | None:
    return None if text is None else of.law_of(text, cls.OWN, "spring", info)


class LinearSpring(SpringSpec):
    """A straight spring and damper from a point of ``a`` to a point of ``b``; pulls and pushes."""

    facts = SpringKind("stiffness", ("length", "force", "work"), straight=True)
    LACKS = dict.fromkeys(("force", "only"), LACKS_LAW)
    LOCAL = ("force",)
    OWN = ("stretch", "rate")
    type: Literal["linear"] = TYPE
    name: of.Name
    """Its name; quantities are ``<name>.force`` and so on."""
    a: BodyName
    """The body at its one end."""
    b: BodyName
    """The body at its other end."""
    on_a: of.Point = (0.0, 0.0)
    """Attachment, in the frame of ``a`` [m]."""
    on_b: of.Point = (0.0, 0.0)
    """Attachment, in the frame of ``b`` [m]."""
    stiffness: of.Stiffness | None = None
    """Force per change of length [N/m], 0 or more; positive in tension."""
    force: str | None = None
    """In place of ``stiffness``, the force [N] as an expression of its ``stretch`` [m], length
    minus rest length, and of the ``rate`` of the stretch [m/s]: ``"=1e3 * stretch + 4e6 * stretch
    ** 3"``, ``"=bumper(stretch)"``. Positive in tension."""
    only: Literal["pull", "push"] | None = None
    """One-sided: ``pull`` acts above the rest length only (bungee cord), ``push`` below it only."""
    damping: of.Damping = 0.0
    """Force per rate of length [N s/m], against it; of a one-sided spring only while it acts."""
    rest_length: of.Distance | None = None
    """Length without force [m], where ``stretch`` is 0; by default the length at t = 0."""
    breaks_at: Annotated[of.Force, of.POSITIVE] | None = None
    """Force above which it breaks [N], until an event engages it again; never by default."""
    released: of.Flag = False
    """Whether it starts released, until an event engages it."""
    taken_up: TakenUp = "natural"
    """Rest length once it is engaged again: ``natural``, as before, or ``as_is``, without force."""

    _law = field_validator("force")(_read_law)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        draft.add("constraint", self.name, "DampedSpring", self.a, self.b, self.on_a, self.on_b,
                  draft.model.springs.rest[index], self.stiffness, self.damping)


class RotarySpring(SpringSpec):
    """A torsion spring and damper on a hinge, in the hinge's positive sense."""

    facts = SpringKind("rotary stiffness", ("angle", "torque", "work"), straight=False)
    LACKS = dict.fromkeys(("torque", "only"), LACKS_LAW)
    LOCAL = ("torque",)
    OWN = ("twist", "rate")
    type: Literal["rotary"] = TYPE
    name: of.Name
    """Its name; quantities are ``<name>.torque`` and so on."""
    joint: HingeName
    """Name of the pin that it acts on; the spring has this hinge's angle and positive sense."""
    stiffness: of.RotaryStiffness | None = None
    """Torque per angle [N m/rad], 0 or more, towards ``rest_angle``."""
    torque: str | None = None
    """In place of ``stiffness``, the torque [N m] as an expression of its ``twist`` [rad], the
    hinge's angle minus ``rest_angle``, and of its ``rate`` [rad/s]: ``"=0.2 * twist ** 3"``,
    ``"=pad(twist)"``. Positive reduces a positive twist."""
    only: Literal["above", "below"] | None = None
    """One-sided: it acts only ``above`` or only ``below`` its rest angle, and only towards it."""
    damping: of.RotaryDamping = 0.0
    """Torque per rate [N m s/rad], against it; of a one-sided spring only while it acts."""
    rest_angle: Annotated[of.Angle, KEPT] = 0.0
    """Hinge angle without torque [rad], in the hinge's sense; 0 by default."""
    breaks_at: Annotated[of.Torque, of.POSITIVE] | None = None
    """Torque above which it breaks [N m], without damping; never by default."""
    released: of.Flag = False
    """Whether it starts released, until an event engages it. Its damping is never released."""

    _law = field_validator("torque")(_read_law)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """A DampedRotarySpring, whose angle is that of ``a`` against ``b``, and a damper."""
        joint = int(draft.model.springs.joint[index])
        spec, joints = draft.mechanism.joints[joint], draft.model.joints
        draft.add("constraint", self.name, "DampedRotarySpring", spec.a, spec.b,
                  -joints.sense[joint] * (self.rest_angle + joints.zero[joint]),
                  self.stiffness, 0.0)
        if self.damping:
            draft.add("damper", f"{self.name}.work", spec.a, spec.b, self.damping)


Spring = Annotated[LinearSpring | RotarySpring, Field(discriminator="type")]
