"""A finger: n phalanges, hinges with stops, extensor springs and one tendon.

Frames as in the paper's section 5: phalanx i has its origin at its near hinge
C_i, x along the straight finger, the palm side at -y. Guides V_0 (palm) to
V_n (distal) and the springs' points M' are given in these frames, M'' relative
to C_i in the frame of the body before (equations 8, 9, 20 and 21). Positive
rotation closes the finger.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self, TypeVar

from pydantic import Field, ValidationInfo, field_validator, model_validator

from sandbox.elements.element import Turn
from sandbox.elements.points import Pin
from sandbox.elements.registry import Joint
from sandbox.elements.springs import LinearSpring, Spring
from sandbox.elements.tendons import RIGID, Guide, Tendon
from sandbox.errors import Problem
from sandbox.scene.bodies import Body, Box, Capsule
from sandbox.scene.geometry import Pose, Vec, pose_of, to_world
from sandbox.scene.parts.expansion import (
    Angles,
    Coordinates,
    Dampings,
    Elements,
    Known,
    Limits,
    PartError,
    PartSpec,
    Points,
    RotaryDampings,
    Stiffnesses,
    each,
)
from sandbox.scene.settings import ContactRule, Group
from sandbox.values.appearance import Planes
from sandbox.values.numbers import (
    Angle,
    Damping,
    Density,
    Items,
    Length,
    Mass,
    Name,
    Point,
    Ratio,
    Stiffness,
)
from sandbox.values.spec import TYPE, Spec
from sandbox.wording import WrongValueError

ANCHOR_DISTANCE = 0.015  # from V_0 back to where a finger's tendon ends by default [m]
PALM_MARGIN = 0.003  # of the palm's block around the finger [m]

Entries = TypeVar("Entries", bound=Sequence[object] | None)


class FingerSprings(Spec):
    """A linear spring over the back of each hinge; one value applies to all hinges."""

    stiffness: Stiffnesses
    """Stiffness of each spring [N/m], 0 or more."""
    on_previous: Annotated[Points, Field(alias="from")]
    """M'', its attachment on the body before the hinge, relative to the hinge at rotation 0 [m]."""
    on_phalanx: Annotated[Points, Field(alias="to")]
    """M', its attachment on the phalanx, in the phalanx's frame [m]."""
    damping: Dampings = (0.0,)
    """Damping of each spring [N s/m]."""
    rest: Coordinates | None = None
    """Lengths without force [m]; by default the lengths at rotation 0."""


class FingerTendon(Spec):
    """The finger's tendon."""

    stiffness: Stiffness = Field(default=RIGID, gt=0)
    """Tension per stretch [N/m]; the default counts as inextensible."""
    damping: Damping = 0.0
    """Tension per rate of stretch [N s/m]."""
    friction: Ratio = 0.0
    """Coefficient of friction between the tendon and the guides V_0 to V_(n-1), as that of a
    [Guide](elements.md#guide): each reduces the tension. The tendon is tied at V_n; further guides,
    ``tendon_to``, have their own friction. None by default."""


class Finger(PartSpec):
    """A finger of ``n = len(lengths)`` phalanges, from the palm to the tip."""

    type: Literal["finger"] = TYPE
    name: Name
    """Its name, with which those of its elements begin: ``<name>.proximal``, ``<name>.mcp``,
    ``<name>.tendon``."""
    at: Point = (0.0, 0.0)
    """The first hinge, in the world or in the frame of ``on`` [m]."""
    angle: Angle = 0.0
    """Turn of the straight finger against the world, or against ``on`` [rad], counter-clockwise; 0
    points along +x."""
    palm: Literal["below", "above"] = "below"
    """Side to which the finger closes, seen along the straight finger: with ``below`` its palm side
    is -y, with ``above`` the whole finger is mirrored."""
    on: Name | None = None
    """A body that serves as the palm; by default the finger has its own fixed one."""
    lengths: Items[Length] = Field(min_length=1, max_length=32)
    """Lengths of the phalanges [m], the proximal one first; the last reaches to the middle of the
    round tip."""
    radii: Items[Length]
    """Half the thickness of each phalanx [m]."""
    masses: Items[Mass] | None = None
    """Mass of each phalanx [kg]; either these or ``density``."""
    density: Density | None = None
    """Mass per volume of all phalanges [kg/m^3], instead of ``masses``."""
    thickness: Length = 0.01
    """Depth across the plane [m], used with ``density`` only."""
    guides: Items[Point]
    """V_0 in the palm's frame, then V_1 ... V_n, each in its phalanx's frame [m]."""
    springs: FingerSprings | None = None
    """Extensor springs over the backs of the hinges; none by default."""
    damping: RotaryDampings = (0.0,)
    """Viscous friction of the hinges [N m s/rad]; one for all or one each."""
    limits: Limits | None = None
    """Maximum rotation, or [minimum, maximum], of each hinge [rad], positive in closing; one value
    means [0, value]. None by default."""
    start: Angles = (0.0,)
    """Rotations at t = 0 [rad], closing counted positive; one for all or one each."""
    tendon: FingerTendon = FingerTendon()
    """Stiffness and friction of the finger's tendon."""
    tendon_to: Items[Guide] = ()
    """Further guides of the tendon after V_0, towards its drive."""
    anchor: Point | None = None
    """Where the tendon ends when nothing else pulls it, in the palm's frame [m]; by default 15 mm
    behind V_0."""
    material: Name | None = None
    """Name of the phalanges' material, one of the scene's ``materials``."""
    plane: Planes = (0,)
    """Layer in which its bodies lie, as a body's ``plane``: fingers of different planes pass each
    other."""

    @field_validator("radii", "masses", "guides", "damping", "limits", "start")
    @classmethod
    def _one_entry_each(cls, given: Entries, info: ValidationInfo) -> Entries:
        n = len(info.data.get("lengths", ()))
        if given is None or not n:  # without lengths there is one complaint already
            return given
        exact = {"radii": n, "masses": n, "guides": n + 1}.get(info.field_name or "")
        _check_count(given, (exact,) if exact else (1, n), f"a finger of {n} phalanges")
        return given

    @field_validator("springs")
    @classmethod
    def _one_spring_each(
        cls, springs: FingerSprings | None, info: ValidationInfo
    ) -> FingerSprings | None:
        n = len(info.data.get("lengths", ()))
        if springs is not None and n:
            for name, field in FingerSprings.model_fields.items():
                if (given := getattr(springs, name)) is not None:
                    _check_count(given, (1, n), f"'{field.alias or name}' over {n} hinges")
        return springs

    @model_validator(mode="after")
    def _weighed(self) -> Self:
        if (self.masses is None) == (self.density is None):
            raise WrongValueError("conflicting-keys", "a finger needs either 'masses' or 'density'")
        return self

    @property
    def body_count(self) -> int:
        """Number of phalanges."""
        return len(self.lengths)

    @property
    def tendon_names(self) -> dict[str, str]:
        """Its tendon."""
        return {self.name: f"{self.name}.tendon"}

    def expand(self, known: Known) -> Elements:
        """All elements so far, and those of the finger."""
        palm = None
        if self.on is not None and (palm := known.elements.body(self.on)) is None:
            raise PartError([Problem(
                "name-not-found", f"no body before this finger is named {self.on!r}", path=".on",
                hint=known.near(self.on, (body.name for body in known.elements.bodies)))])
        pulled = not known.pulled.isdisjoint({self.name, known.tendon_of[self.name]})
        return known.elements + expand_finger(self, palm=palm, pulled=pulled)


def _check_count(given: Sequence[object], counts: tuple[int, ...], what: str) -> None:
    if len(given) not in counts:
        wanted = " or ".join(str(count) for count in dict.fromkeys(counts))
        raise WrongValueError("wrong-type", f"{what}: expected {wanted} entries, got {len(given)}")


@dataclass(frozen=True)
class _Frame:
    """The palm as the finger sees it: origin at the first hinge, x along the straight finger."""

    body: str
    on_body: Pose
    """Of this frame in the frame of the palm's body."""
    world: Pose
    side: float
    """-1 mirrors the finger, so that it closes the other way."""

    def mirrored(self, point: Vec) -> Vec:
        return point[0], self.side * point[1]

    def on_palm(self, point: Vec) -> Vec:
        """A point of the palm, given as the author gives it, in its body's frame."""
        return to_world(self.on_body, self.mirrored(point))


def phalanx_names(count: int) -> tuple[str, ...]:
    """``proximal``, ``middle``, ``distal`` for up to three, else ``phalanx1``, ..."""
    known = {1: ("proximal",), 2: ("proximal", "distal"), 3: ("proximal", "middle", "distal")}
    return known.get(count) or tuple(f"phalanx{i + 1}" for i in range(count))


def hinge_names(count: int) -> tuple[str, ...]:
    """``mcp``, ``pip``, ``dip`` for up to three, else ``hinge1``, ..."""
    known = ("mcp", "pip", "dip")
    return known[:count] if count <= 3 else tuple(f"hinge{i + 1}" for i in range(count))


def expand_finger(finger: Finger, *, palm: Body | None = None, pulled: bool = False) -> Elements:
    """The finger's bodies, hinges, springs, tendon, contact rules and group.

    ``palm`` is the body that ``finger.on`` names; ``pulled`` means that a tree
    takes over the tendon behind V_0, so that no anchor is needed.
    """
    frame = _frame(finger, palm)
    own_palm = () if palm is not None else (_palm(finger),)
    phalanges = _phalanges(finger, frame)
    names = tuple(body.name for body in phalanges)
    everything = f"{finger.name}.*"
    contacts = [ContactRule(between=(everything, everything), collide=False)]
    if palm is not None:
        contacts.append(ContactRule(between=(everything, palm.name), collide=False))
    return Elements(
        bodies=own_palm + phalanges,
        joints=_hinges(finger, frame, names),
        springs=_springs(finger, frame, names),
        tendons=(_tendon(finger, frame, names, pulled=pulled),),
        contacts=tuple(contacts),
        groups=(Group(name=finger.name, kind="finger", bodies=names),),
    )


def _frame(finger: Finger, palm: Body | None) -> _Frame:
    side = 1.0 if finger.palm == "below" else -1.0
    given = (*finger.at, finger.angle)
    if palm is None:
        return _Frame(f"{finger.name}.palm", (0.0, 0.0, 0.0), given, side)
    return _Frame(palm.name, given, (*to_world(pose_of(palm), finger.at),
                                     palm.angle + finger.angle), side)


def _anchor(finger: Finger) -> Vec:
    if finger.anchor is not None:
        return finger.anchor
    x, y = finger.guides[0]
    return x - ANCHOR_DISTANCE, y


def _palm(finger: Finger) -> Body:
    """A fixed block behind the first hinge that carries V_0 and M''."""
    points = [finger.guides[0], (0.0, finger.radii[0]), (0.0, -finger.radii[0])]
    if finger.springs is not None:
        points.append(finger.springs.on_previous[0])
    left = min(x for x, _ in points) - PALM_MARGIN
    low = min(y for _, y in points) - PALM_MARGIN
    high = max(y for _, y in points) + PALM_MARGIN
    side = 1.0 if finger.palm == "below" else -1.0
    return Body(
        name=f"{finger.name}.palm", at=finger.at, angle=finger.angle, motion="fixed", role="palm",
        material=finger.material, plane=finger.plane,
        shapes=(Box(type="box", size=(-left, high - low), at=(left / 2, side * (low + high) / 2)),),
    )


def _phalanges(finger: Finger, frame: _Frame) -> tuple[Body, ...]:
    x, y, angle = frame.world
    n = len(finger.lengths)
    bodies = []
    for i, (name, start) in enumerate(
        zip(phalanx_names(n), each(finger.start, n), strict=True)
    ):
        length, radius = finger.lengths[i], finger.radii[i]
        angle -= frame.side * start
        weight: dict[str, Any] = {"density": finger.density, "thickness": finger.thickness}
        if finger.masses is not None:
            mass = finger.masses[i]
            weight = {"mass": mass, "inertia": mass * (length**2 / 12 + radius**2 / 4)}
        bodies.append(Body(
            name=f"{finger.name}.{name}", at=(x, y), angle=angle, role="phalanx",
            shapes=(Capsule(type="capsule", end=(length, 0.0), radius=radius),),
            centre=(length / 2, 0.0), material=finger.material, plane=finger.plane, **weight,
        ))
        x, y = to_world((x, y, angle), (length, 0.0))
    return tuple(bodies)


def _hinges(finger: Finger, frame: _Frame, names: tuple[str, ...]) -> tuple[Joint, ...]:
    n = len(names)
    damping = each(finger.damping, n)
    limits = each(finger.limits, n) if finger.limits is not None else (None,) * n
    positive: Turn = "clockwise" if frame.side > 0 else "counterclockwise"
    zero = -frame.side * frame.on_body[2]
    return tuple(
        Pin(
            type="pin", name=f"{finger.name}.{hinge}", positive=positive,
            a=names[i - 1] if i else frame.body, b=names[i], zero=0.0 if i else zero,
            on_a=(finger.lengths[i - 1], 0.0) if i else frame.on_palm((0.0, 0.0)),
            on_b=(0.0, 0.0), limits=limits[i], damping=damping[i],
        )
        for i, hinge in enumerate(hinge_names(n))
    )


def _springs(finger: Finger, frame: _Frame, names: tuple[str, ...]) -> tuple[Spring, ...]:
    """Over each hinge, from M'' to M'; equations (20) and (21) place the two ends."""
    given, n = finger.springs, len(names)
    if given is None:
        return ()
    before, after = each(given.on_previous, n), each(given.on_phalanx, n)
    stiffness, damping = each(given.stiffness, n), each(given.damping, n)
    rest = each(given.rest, n) if given.rest is not None else tuple(
        math.dist(p, q) for p, q in zip(before, after, strict=True))
    springs: list[Spring] = []
    for i, hinge in enumerate(hinge_names(n)):
        if i:
            x, y = frame.mirrored(before[i])
            on_a = (finger.lengths[i - 1] + x, y)
        else:
            on_a = frame.on_palm(before[0])
        springs.append(LinearSpring(
            type="linear", name=f"{finger.name}.{hinge}_spring",
            a=names[i - 1] if i else frame.body, b=names[i],
            on_a=on_a, on_b=frame.mirrored(after[i]),
            stiffness=stiffness[i], damping=damping[i], rest_length=rest[i],
        ))
    return tuple(springs)


def _tendon(finger: Finger, frame: _Frame, names: tuple[str, ...], *, pulled: bool) -> Tendon:
    """From V_n, where it is tied, by V_1 and V_0 to whatever pulls it."""
    friction = finger.tendon.friction
    guides = [
        Guide(body=name, at=frame.mirrored(point), friction=friction)
        for name, point in zip(names[:-1], finger.guides[1:-1], strict=True)
    ][::-1]
    guides.insert(0, Guide(body=names[-1], at=frame.mirrored(finger.guides[-1])))
    guides.append(Guide(body=frame.body, at=frame.on_palm(finger.guides[0]), friction=friction))
    guides.extend(finger.tendon_to)
    if not pulled and not finger.tendon_to:
        guides.append(Guide(body=frame.body, at=frame.on_palm(_anchor(finger))))
    return Tendon(
        name=f"{finger.name}.tendon", guides=tuple(guides),
        stiffness=finger.tendon.stiffness, damping=finger.tendon.damping,
    )
