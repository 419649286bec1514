"""How a body of the tree moves against its parent: slides and hinges, in the scene's own counts.

A joint's coordinate is the number that a recording shows: a pin's angle in its
positive sense minus its zero, a slot's displacement from the groove's start, a
free body's x, y (of its centre of mass) and angle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from sandbox.export.tree import Link, Tree, anchors, displacement, groove, meeting_points, pose, vec
from sandbox.model.model import NONE, Model
from sandbox.model.starts import sliding, turning
from sandbox.scene.geometry import Vec, to_body, to_world

Vec3 = tuple[float, float, float]


@dataclass(frozen=True)
class Freedom:
    """One coordinate of a body; points and axes are in the body's own frame."""

    name: str
    kind: Literal["hinge", "slide"]
    axis: Vec3
    at: Vec = (0.0, 0.0)
    """Where its axis is [m]."""
    start: float = 0.0
    """Its value at t = 0 [rad or m]."""
    rate: float = 0.0
    """Its speed at t = 0 [rad/s or m/s]."""
    limits: tuple[float, float] | None = None
    """Its hard stops [rad or m]."""
    joint: int = NONE
    """The number of the hinge that it is, if it is one."""
    loss: float = 0.0
    """Of a slide: dry friction [N]."""
    made: bool = False
    """Whether its name is not that of an element of the scene."""


def freedoms(model: Model, link: Link) -> list[Freedom]:
    """The coordinates of a body, in the order in which they act; none unless it moves freely."""
    if not model.bodies.free[link.body]:
        return []
    if link.joint == NONE:
        return _free(model, link.body)
    return CARRIERS[model.mechanism.joints[link.joint].type](model, link)


def _free(model: Model, body: int) -> list[Freedom]:
    name, spec = model.bodies.name[body], model.mechanism.bodies[body]
    place, centre = pose(model, body), vec(model.bodies.centre[body])
    x, y = to_world(place, centre)
    c, s = math.cos(place[2]), math.sin(place[2])
    return [
        Freedom(f"{name}.x", "slide", (c, -s, 0.0), start=x, rate=spec.velocity[0], made=True),
        Freedom(f"{name}.y", "slide", (s, c, 0.0), start=y, rate=spec.velocity[1], made=True),
        Freedom(f"{name}.angle", "hinge", (0.0, 0.0, 1.0), at=centre, start=place[2],
                rate=spec.angular_velocity, made=True),
    ]


def _hinge(model: Model, link: Link) -> list[Freedom]:
    joints, joint = model.joints, link.joint
    sense = float(joints.sense[joint])
    on_a, on_b = anchors(model, joint)
    return [Freedom(
        joints.name[joint], "hinge", (0.0, 0.0, -sense if link.backwards else sense),
        at=on_a if link.backwards else on_b, start=float(joints.start[joint]),
        rate=sense * turning(model, joint), limits=stops(model, joint), joint=joint)]


def stops(model: Model, joint: int) -> tuple[float, float] | None:
    """Lowest and highest angle of a hinge [rad], if it has stops."""
    return vec(model.joints.stops[joint]) if joint in model.joints.stopped else None


def _slide(model: Model, link: Link) -> list[Freedom]:
    joint, backwards = link.joint, link.backwards
    name = model.joints.name[joint]
    a, b = model.joints.bodies[joint].tolist()
    at_a, at_b = pose(model, a), pose(model, b)
    along, length = groove(model, joint)
    points = meeting_points(model, joint)
    hinge = Freedom(
        f"{name}.turn", "hinge", (0.0, 0.0, -1.0 if backwards else 1.0),
        at=points[0] if backwards else points[1], start=at_b[2] - at_a[2],
        rate=turning(model, joint), made=True)
    ahead = along if backwards else to_body((0.0, 0.0, at_b[2] - at_a[2]), along)
    side = -1.0 if backwards else 1.0
    slide = Freedom(
        name, "slide", (side * ahead[0], side * ahead[1], 0.0),
        start=displacement(model, joint), limits=(0.0, length),
        loss=float(model.joints.friction[joint]), rate=sliding(model, joint))
    if not model.joints.turns[joint]:
        return [slide]
    return [hinge, slide] if backwards else [slide, hinge]


def _none(model: Model, link: Link) -> list[Freedom]:
    return []


CARRIERS: Mapping[str, Callable[[Model, Link], list[Freedom]]] = {
    "pin": _hinge, "slot": _slide, "weld": _none}
"""By kind of joint: the coordinates of a body that such a joint carries."""


@dataclass(frozen=True)
class AngleSum:
    """The angle of a pin that closes a loop, as a sum over hinges of the tree.

    ``angle = offset + sum(factor * coordinate)`` [rad].
    """

    factors: tuple[tuple[str, float], ...]
    """Names of coordinates, each with +1, -1 or another whole number."""
    offset: float


def angle_sum(
    model: Model, joint: int, tree: Tree, moves: Mapping[int, Sequence[Freedom]],
) -> AngleSum:
    """How the angle of a pin follows from the hinges that carry its two bodies.

    ``moves`` gives the coordinates of every body.
    """
    sense = float(model.joints.sense[joint])
    a, b = model.joints.bodies[joint].tolist()
    factors: dict[str, float] = {}
    start: dict[str, float] = {}
    for body, side in ((b, sense), (a, -sense)):
        for link in tree.line(body):
            for freedom in moves[link.body]:
                if freedom.kind == "hinge":
                    start[freedom.name] = freedom.start
                    factors[freedom.name] = factors.get(freedom.name, 0.0) + side * freedom.axis[2]
    factors = {name: factor for name, factor in factors.items() if factor}
    offset = float(model.joints.start[joint])
    offset -= sum(factor * start[name] for name, factor in factors.items())
    return AngleSum(tuple(factors.items()), offset)
