"""The base of joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from sandbox.elements.element import BodyName, Element, Quantity, live, recorded
from sandbox.errors import Problem
from sandbox.values.numbers import POSITIVE, Duration, Flag, Force, Name, Point, Ratio
from sandbox.wording import WrongValueError, quoted

if TYPE_CHECKING:
    from sandbox.scene.mechanism import Mechanism

Keeps = Literal["point", "groove", "distance", "range", "gear", "rack", "roll"]


@dataclass(frozen=True)
class JointKind:
    """Facts about a kind of joint."""

    # two coinciding points; a point of b on a line of a; a distance of two points, or a range of
    # it; meshing teeth of two gears, or of a gear and a rack; rolling circles
    keeps: Keeps
    records: tuple[str, ...]  # the quantities that every joint of the kind records
    line: bool = False  # whether it has a length, which drives can push and set
    angle: bool = False  # whether it has an angle, for stops, rotary springs, torques, motors
    friction_unit: str = ""  # unit of its dry friction; empty where it has none
    # additional quantities with limits, backlash, has_friction or a path
    more: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    mujoco: str = ""  # why MuJoCo has no counterpart; empty where it has one
    mujoco_loop: str = ""  # why MuJoCo has no counterpart of such a joint that closes a loop

    @property
    def forces(self) -> int:
        """Number of unknown components of its reaction: 1 if its direction is known, else 2."""
        return 2 if self.keeps in ("point", "roll") else 1

    @property
    def wheels(self) -> bool:
        """Whether its bodies act on each other where two wheels, or a wheel and a rack, meet."""
        return self.teeth or self.keeps == "roll"

    @property
    def teeth(self) -> bool:
        """Whether it has teeth."""
        return self.keeps in ("gear", "rack")

    @property
    def along_line(self) -> bool:
        """Whether its force is along the line through its two points."""
        return self.keeps in ("distance", "range")


REACTION = ("reaction", "reaction_x", "reaction_y")
FRICTION = ("friction", "friction_work", "sticks")
QUANTITIES: Mapping[str, Quantity] = {
    "angle": live("joint_angle", "rad", "of `b` against `a`, in the hinge's positive sense"),
    "rate": live("joint_rate", "rad/s", "rate of the angle"),
    "length": live("joint_length", "m", "of an actuator, between its two points"),
    "position": live("joint_length", "m", "of a slot with a path: arc length from the path's first "
                                          "point; it counts on over rounds of a closed path"),
    "speed": live("joint_speed", "m/s", "rate of the length of an actuator, or of the position on "
                                        "a path"),
    "normal": Quantity("N", "of a slot with a path: force on `b` across the path, positive to its "
                            "left"),
    "reaction": live("joint_reaction", "N", "magnitude of the reaction force"),
    "reaction_x": live("joint_force", "N", "force on its body `b` by its body `a`, in the world",
                       0),
    "reaction_y": live("joint_force", "N", "the same, upwards", 1),
    "tension": Quantity("N", "of rods and ropes: signed reaction, positive in tension, negative in "
                             "compression", live=True),
    "tangential": Quantity("N", "of wheels: force on `b` along the pitch circles, positive as `a` "
                                "pushes by turning counter-clockwise"),
    "radial": Quantity("N", "of wheels: force along the line of centres, positive if it pushes "
                            "them apart"),
    "gap": Quantity("m", "of teeth with backlash: distance along the pitch circles to the nearer "
                         "flank"),
    "damping": recorded("joint_damping", "N m", "torque of all its dampers, in the hinge's sense"),
    "damping_work": recorded("joint_damping_work", "J", "work of all its dampers since t = 0"),
    "stop": recorded("joint_stop", "N m", "torque of its hard stop, in the hinge's sense"),
    "friction": live("joint_friction", "", "dry friction: of a pin the torque on `b`, in the "
                                           "hinge's sense; of a slot the force on `b`, positive "
                                           "towards the `end` of the groove or path"),
    "friction_work": recorded("joint_friction_work", "J", "work of dry friction since t = 0, at "
                                                          "most 0"),
    "sticks": live("joint_sticks", "1", "1 while dry friction holds it, 0 while it slides",
                   yes_no=True),
}


class JointSpec(Element):
    """The base of all joints."""

    facts: ClassVar[JointKind]

    name: Name
    """Its name; quantities are ``<name>.reaction`` and so on."""
    a: BodyName
    """The reference body: a hinge's angle is that of ``b`` against it, a groove moves with it."""
    b: BodyName
    """The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``."""
    on_a: Point | None = None
    """Anchor in the frame of ``a`` [m]; by default where ``on_b`` is at t = 0."""
    on_b: Point | None = None
    """Anchor in the frame of ``b`` [m]; by default where ``on_a`` is at t = 0."""
    collide: Flag = False
    """Whether the two bodies may touch; by default they never do, even if the joint is released."""
    breaks_at: Annotated[Force, POSITIVE] | None = None
    """Magnitude of its ``reaction`` above which it breaks [N]; it stays released unless an event
    engages it again. By default it never breaks."""
    released: Flag = False
    """Whether it starts released, until an event engages it."""

    @model_validator(mode="after")
    def _anchored(self) -> Self:
        if self.a == self.b:
            raise WrongValueError("conflicting-keys", "'a' and 'b' must be two bodies")
        if self.on_a is None and self.on_b is None:
            raise WrongValueError("conflicting-keys", "give 'on_a' or 'on_b'")
        return self

    def quantities(self, mechanism: Mechanism) -> dict[str, str]:
        """The quantities that it records, with their units."""
        kind = self.facts
        names = [*kind.records, *(
            name for field, more in kind.more.items() for name in more
            if getattr(self, field, None))]
        return {name: QUANTITIES[name].unit or kind.friction_unit for name in names}

    def needed(self, quantity: str) -> str:
        """The field that it needs to record a quantity; empty where no field adds it."""
        field = next((field for field, more in self.facts.more.items() if quantity in more), "")
        return "'friction' or 'friction_coefficient'" if field == "has_friction" else (
            field and f"'{field}'")

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        """A joint between two bodies that cannot move freely."""
        ends = [next((body for body in mechanism.bodies if body.name == name), None)
                for name in (self.a, self.b)]
        if all(body is not None and body.motion != "dynamic" for body in ends):
            yield Problem("no-effect",
                          f"neither {quoted(self.a)} nor {quoted(self.b)} can move freely",
                          path, allowed="a joint of at least one dynamic body")


class ClosingJoint(JointSpec):
    """A joint that closes its gap when it is engaged again."""

    takes_up_in: Duration = 0.01
    """Time in which most of the gap closes once the joint is engaged again [s], smoothly, with a
    force of about m * gap / takes_up_in^2."""


class FrictionJoint(ClosingJoint):
    """A joint that may have dry friction."""

    LACKS: ClassVar[Mapping[str, str]] = {
        "friction_coefficient": "joint friction that depends on the reaction",
        "static": "static friction above that of sliding"}

    if TYPE_CHECKING:
        friction: float

    friction_coefficient: Ratio = 0.0
    """Coefficient of dry friction: friction is this times the reaction; none by default."""
    static: Ratio = Field(default=1.0, ge=1)
    """Ratio of static to sliding friction, 1 or more; 1 by default."""

    @property
    def has_friction(self) -> bool:
        """Whether it has dry friction."""
        return bool(self.friction or self.friction_coefficient)

    @model_validator(mode="after")
    def _check_friction(self) -> Self:
        if self.friction and self.friction_coefficient:
            raise WrongValueError("conflicting-keys", "give 'friction' or 'friction_coefficient', "
                                  "not both")
        if self.static > 1 and not self.has_friction:
            raise WrongValueError("conflicting-keys", "'static' needs 'friction' or "
                                  "'friction_coefficient'")
        return self
