"""A finger: n phalanges, hinges with stops, extensor springs and one tendon.

Frames as in the paper's section 5: phalanx i has its origin at its near hinge C_i, x along the
straight finger, the palm side at -y. Guides V_0 (palm) to V_n (distal) and the springs' points M'
are given in these frames, M'' relative to C_i in the frame of the body before (equations 8, 9, 20
and 21). Positive rotation closes the finger.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal, TypeVar

from pydantic import Field, ValidationInfo, field_validator

from sandbox.elements.element import Turn
from sandbox.elements.joints import Pin
from sandbox.elements.registry import Joint
from sandbox.elements.springs import LinearSpring, Spring
from sandbox.elements.tendons import RIGID, Guide, Tendon
from sandbox.errors import Problem
from sandbox.scene.bodies import Body, Box, Capsule
from sandbox.scene.geometry import Pose, Vec, pose_of, to_world
from sandbox.scene.parts.expansion import Elements, Known, PartError, PartSpec
from sandbox.scene.settings import ContactRule, Group
from sandbox.values import numbers as of
from sandbox.values.appearance import Planes
from sandbox.values.spec import TYPE, ReadMark, Spec
from sandbox.wording import refuse_if

ANCHOR_DISTANCE = 0.015  # from V_0 back to where a finger's tendon ends by default [m]
PALM_MARGIN = 0.003  # of the palm's block around the finger [m]

T = TypeVar("T")


@dataclass(frozen=True)
class OneForAll(ReadMark):
    """Marks a list of which one entry may be given for all; one number is the limit [0, number]."""

    entry: Literal["number", "point", "limit"] = "number"

    def json_schema(self, schema: dict[str, Any]) -> dict[str, Any]:
        """An entry or a list of entries."""
        number: list[dict[str, Any]] = [{"type": "number"}, {"type": "string"}]
        pair = {"type": "array", "items": {"anyOf": number}, "minItems": 2, "maxItems": 2}
        item = pair if self.entry == "point" else {
            "anyOf": [*number, pair] if self.entry == "limit" else number}
        return {"anyOf": [item, {"type": "array", "items": item, "minItems": 1}]}

    def read(self, value: Any, info: ValidationInfo) -> Any:
        """A list of entries."""
        is_list = isinstance(value, (list, tuple))
        if self.entry == "point":
            return value if is_list and value and isinstance(value[0], (list, tuple)) else [value]
        entries = value if is_list else [value]
        if self.entry == "number":
            return entries
        return [limit if isinstance(limit, (list, tuple)) else [0.0, limit] for limit in entries]


def entry(given: Sequence[T], i: int) -> T:
    """The entry of joint ``i``, or the one entry for all."""
    return given[i if len(given) > 1 else 0]


class FingerSprings(Spec):
    """A linear spring over the back of each hinge; one value applies to all hinges."""

    stiffness: Annotated[of.Items[of.Stiffness], OneForAll()]
    """Stiffness of each spring [N/m], 0 or more."""
    on_previous: Annotated[of.Items[of.Point], OneForAll("point"), Field(alias="from")]
    """M'', its attachment on the body before the hinge, relative to the hinge at rotation 0 [m]."""
    on_phalanx: Annotated[of.Items[of.Point], OneForAll("point"), Field(alias="to")]
    """M', its attachment on the phalanx, in the phalanx's frame [m]."""
    damping: Annotated[of.Items[of.Damping], OneForAll()] = (0.0,)
    """Damping of each spring [N s/m]."""
    rest: Annotated[of.Items[of.Coordinate], OneForAll()] | None = None
    """Lengths without force [m]; by default the lengths at rotation 0."""


class FingerTendon(Spec):
    """The finger's tendon."""

    stiffness: of.Stiffness = Field(default=RIGID, gt=0)
    """Tension per stretch [N/m]; the default counts as inextensible."""
    damping: of.Damping = 0.0
    """Tension per rate of stretch [N s/m]."""
    friction: of.Ratio = 0.0
    """Coefficient of friction at the guides V_0 to V_(n-1), as of a [Guide](elements.md#guide);
    guides of ``tendon_to`` have their own."""


class Finger(PartSpec):
    """A finger of ``n = len(lengths)`` phalanges, from the palm to the tip."""

    type: Literal["finger"] = TYPE
    name: of.Name
    """Its name; its elements are ``<name>.proximal``, ``<name>.mcp``, ``<name>.tendon``."""
    at: of.Point = (0.0, 0.0)
    """The first hinge, in the world or in the frame of ``on`` [m]."""
    angle: of.Angle = 0.0
    """Angle of the straight finger in the world, or in the frame of ``on`` [rad]; 0 is along +x."""
    palm: Literal["below", "above"] = "below"
    """Side to which the finger closes, seen along the straight finger: ``below`` is -y; with
    ``above`` the finger is mirrored."""
    on: of.Name | None = None
    """A body that serves as the palm; by default the finger has its own fixed one."""
    lengths: of.Items[of.Length] = Field(min_length=1, max_length=32)
    """Lengths of the phalanges [m], the proximal one first, the last to the middle of its tip."""
    radii: of.Items[of.Length]
    """Half the thickness of each phalanx [m]."""
    masses: of.Items[of.Mass] | None = None
    """Mass of each phalanx [kg]; either these or ``density``."""
    density: of.Density | None = None
    """Mass per volume of all phalanges [kg/m^3], instead of ``masses``."""
    thickness: of.Length = 0.01
    """Depth across the plane [m], used with ``density`` only."""
    guides: of.Items[of.Point]
    """V_0 in the palm's frame, then V_1 ... V_n, each in its phalanx's frame [m]."""
    springs: FingerSprings | None = None
    """Extensor springs over the backs of the hinges; none by default."""
    damping: Annotated[of.Items[of.RotaryDamping], OneForAll()] = (0.0,)
    """Viscous friction of the hinges [N m s/rad]; one for all or one each."""
    limits: Annotated[of.Items[tuple[of.Angle, of.Angle]], OneForAll("limit")] | None = None
    """Maximum rotation, or [minimum, maximum], of each hinge [rad], positive in closing; one value
    means [0, value]."""
    start: Annotated[of.Items[of.Angle], OneForAll()] = (0.0,)
    """Rotations at t = 0 [rad], positive in closing; one for all or one each."""
    tendon: FingerTendon = FingerTendon()
    """Stiffness and friction of the finger's tendon."""
    tendon_to: of.Items[Guide] = ()
    """Further guides of the tendon after V_0, towards its drive."""
    anchor: of.Point | None = None
    """End of a tendon that no tree pulls, in the palm's frame [m]; by default 15 mm behind V_0."""
    material: of.Name | None = None
    """Name of the phalanges' material, one of the scene's ``materials``."""
    plane: Planes = (0,)
    """Plane of its bodies, as a body's ``plane``: fingers of different planes do not touch."""

    @field_validator("radii", "masses", "guides", "springs", "damping", "limits", "start")
    @classmethod
    def _one_entry_each(cls, given: T, info: ValidationInfo) -> T:
        n = len(info.data.get("lengths", ()))  # 0 for invalid lengths, which are reported already
        exact = {"radii": n, "masses": n, "guides": n + 1}.get(info.field_name or "")
        lists: dict[str, Any] = {f"a finger of {n} phalanges": given}
        if isinstance(given, FingerSprings):
            lists = {f"'{field.alias or name}' over {n} hinges": getattr(given, name)
                     for name, field in FingerSprings.model_fields.items()}
        for what, entries in lists.items():
            counts = (exact,) if exact else tuple(dict.fromkeys((1, n)))
            if n and entries is not None:
                refuse_if(len(entries) not in counts, f"{what}: expected "
                          f"{' or '.join(map(str, counts))} entries, got {len(entries)}",
                          "wrong-type")
        return given

    def _verify(self) -> None:
        refuse_if((self.masses is None) == (self.density is None),
                  "a finger needs either 'masses' or 'density'")

    def expand(self, known: Known) -> Elements:
        """All elements so far, and those of the finger."""
        palm = None
        if self.on is not None and (palm := known.elements.body(self.on)) is None:
            raise PartError([Problem(
                "name-not-found", f"no body before this finger is named {self.on!r}", path=".on",
                hint=known.near(self.on, (body.name for body in known.elements["bodies"])))])
        pulled = not known.pulled.isdisjoint({self.name, f"{self.name}.tendon"})
        return known.elements + _Builder(self, palm).build(pulled=pulled)


class _Builder:
    """Expands a finger; its elements share the palm's frame and the names."""

    def __init__(self, finger: Finger, palm: Body | None) -> None:
        self.finger, self.given_palm = finger, palm
        n = len(finger.lengths)
        few = {1: ("proximal",), 2: ("proximal", "distal"), 3: ("proximal", "middle", "distal")}
        phalanges = few.get(n) or [f"phalanx{i + 1}" for i in range(n)]
        hinges = ("mcp", "pip", "dip")[:n] if n <= 3 else [f"hinge{i + 1}" for i in range(n)]
        self.names = tuple(f"{finger.name}.{name}" for name in phalanges)
        self.hinges = tuple(f"{finger.name}.{name}" for name in hinges)
        self.palm = palm.name if palm is not None else f"{finger.name}.palm"
        # the palm's frame: origin at the first hinge, x along the straight finger
        frame = (*finger.at, finger.angle)
        self.on_body: Pose = (0.0, 0.0, 0.0) if palm is None else frame
        self.world: Pose = frame if palm is None else (
            *to_world(pose_of(palm), finger.at), palm.angle + finger.angle)
        self.side = 1.0 if finger.palm == "below" else -1.0
        """-1 mirrors the finger, so that it closes the other way."""

    def build(self, *, pulled: bool) -> Elements:
        """All elements; ``pulled`` by a tree, which continues the tendon behind V_0, or not."""
        everything = f"{self.finger.name}.*"
        free = (everything, *([] if self.given_palm is None else [self.palm]))
        joints, springs = self._joints()
        return Elements(
            bodies=tuple(self._bodies()),
            joints=joints, springs=springs, tendons=(self._tendon(pulled),),
            contacts=tuple(ContactRule(between=(everything, other), collide=False)
                           for other in free),
            groups=(Group(name=self.finger.name, kind="finger", bodies=self.names),))

    def _mirrored(self, point: Vec) -> Vec:
        return point[0], self.side * point[1]

    def _on_palm(self, point: Vec) -> Vec:
        return to_world(self.on_body, self._mirrored(point))

    def _bodies(self) -> Iterator[Body]:
        """The palm, a fixed block with V_0 and M'', if none is given, and the phalanges."""
        finger, (x, y, angle) = self.finger, self.world
        points = [finger.guides[0], (0.0, finger.radii[0]), (0.0, -finger.radii[0])]
        if finger.springs is not None:
            points.append(finger.springs.on_previous[0])
        left = min(x for x, _ in points) - PALM_MARGIN
        low = min(y for _, y in points) - PALM_MARGIN
        high = max(y for _, y in points) + PALM_MARGIN
        if self.given_palm is None:
            yield Body(
                name=self.palm, at=finger.at, angle=finger.angle, motion="fixed", role="palm",
                material=finger.material, plane=finger.plane, shapes=(Box(
                    size=(-left, high - low), at=(left / 2, self.side * (low + high) / 2)),))
        for i, (name, length, radius) in enumerate(zip(
                self.names, finger.lengths, finger.radii, strict=True)):
            angle -= self.side * entry(finger.start, i)
            weight: dict[str, Any] = {"density": finger.density, "thickness": finger.thickness}
            if finger.masses is not None:
                mass = finger.masses[i]
                weight = {"mass": mass, "inertia": mass * (length**2 / 12 + radius**2 / 4)}
            yield Body(
                name=name, at=(x, y), angle=angle, role="phalanx",
                shapes=(Capsule(end=(length, 0.0), radius=radius),),
                centre=(length / 2, 0.0), material=finger.material, plane=finger.plane, **weight)
            x, y = to_world((x, y, angle), (length, 0.0))

    def _joints(self) -> tuple[tuple[Joint, ...], tuple[Spring, ...]]:
        """Hinges and the springs over them, from M'' to M' by equations (20) and (21)."""
        finger, given = self.finger, self.finger.springs
        joints, springs = list[Joint](), list[Spring]()
        positive: Turn = "clockwise" if self.side > 0 else "counterclockwise"
        for i, (hinge, (a, b)) in enumerate(zip(
                self.hinges, pairwise((self.palm, *self.names)), strict=True)):
            length = finger.lengths[i - 1]
            joints.append(Pin(
                name=hinge, positive=positive, a=a, b=b, on_b=(0.0, 0.0),
                zero=0.0 if i else -self.side * self.on_body[2],
                on_a=(length, 0.0) if i else self._on_palm((0.0, 0.0)),
                limits=entry(finger.limits, i) if finger.limits else None,
                damping=entry(finger.damping, i)))
            if given is None:
                continue
            before, after = entry(given.on_previous, i), entry(given.on_phalanx, i)
            x, y = self._mirrored(before)
            springs.append(LinearSpring(
                name=f"{hinge}_spring", a=a, b=b,
                on_a=(length + x, y) if i else self._on_palm(before), on_b=self._mirrored(after),
                stiffness=entry(given.stiffness, i), damping=entry(given.damping, i),
                rest_length=entry(given.rest, i) if given.rest else math.dist(before, after)))
        return tuple(joints), tuple(springs)

    def _tendon(self, pulled: bool) -> Tendon:
        """From V_n, where it is attached, by V_1 and V_0 to its drive."""
        finger, friction = self.finger, self.finger.tendon.friction
        guides = [Guide(body=self.names[-1], at=self._mirrored(finger.guides[-1]))]
        guides += [Guide(body=name, at=self._mirrored(point), friction=friction)
                   for name, point in zip(self.names[-2::-1], finger.guides[-2:0:-1], strict=True)]
        guides.append(Guide(body=self.palm, at=self._on_palm(finger.guides[0]), friction=friction))
        guides.extend(finger.tendon_to)
        if not pulled and not finger.tendon_to:
            x, y = finger.guides[0]
            anchor = finger.anchor or (x - ANCHOR_DISTANCE, y)
            guides.append(Guide(body=self.palm, at=self._on_palm(anchor)))
        return Tendon(name=f"{finger.name}.tendon", guides=tuple(guides),
                      stiffness=finger.tendon.stiffness, damping=finger.tendon.damping)
