"""How a body of the tree moves against its parent: slides and hinges, in the scene's own counts.

A joint's coordinate is the number that a recording shows: a pin's angle in its
positive sense minus its zero, a slot's way from the groove's start, a free
body's x, y (of its centre of mass) and angle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from sandbox.export.tree import Link, Tree, groove, meeting_points, travel
from sandbox.scene.elements.bodies import Body
from sandbox.scene.elements.joints import Pin, Slot
from sandbox.scene.geometry import (
    Vec,
    joint_angle_sign,
    mass_properties,
    pose_of,
    to_body,
    to_world,
)

Vec3 = tuple[float, float, float]


@dataclass(frozen=True)
class Freedom:
    """One coordinate of a body; points and axes are in the body's own frame.

    ``start`` and ``rate`` are its value and speed at t = 0, ``limits`` its
    hard stops, ``pin`` the hinge that it is, if it is one. A ``made`` name is
    not that of an element of the scene.
    """

    name: str
    kind: Literal["hinge", "slide"]
    axis: Vec3
    at: Vec = (0.0, 0.0)
    start: float = 0.0
    rate: float = 0.0
    limits: tuple[float, float] | None = None
    pin: Pin | None = None
    made: bool = False


def freedoms(link: Link, bodies: dict[str, Body]) -> list[Freedom]:
    """The coordinates of a body, in the order in which they act; none if it is held."""
    body, joint = link.body, link.joint
    if body.motion != "dynamic":
        return []
    if joint is None:
        return _free(body)
    a, b = bodies[joint.a], bodies[joint.b]
    if isinstance(joint, Pin):
        return [_hinge(joint, a, b, turned=link.turned)]
    if isinstance(joint, Slot):
        return _slide(joint, a, b, turned=link.turned)
    return []


def _free(body: Body) -> list[Freedom]:
    centre = mass_properties(body).centre
    x, y = to_world(pose_of(body), centre)
    c, s = math.cos(body.angle), math.sin(body.angle)
    return [
        Freedom(f"{body.name}.x", "slide", (c, -s, 0.0), start=x, rate=body.velocity[0],
                made=True),
        Freedom(f"{body.name}.y", "slide", (s, c, 0.0), start=y, rate=body.velocity[1],
                made=True),
        Freedom(f"{body.name}.angle", "hinge", (0.0, 0.0, 1.0), at=centre,
                start=body.angle, rate=body.angular_velocity, made=True),
    ]


def _hinge(pin: Pin, a: Body, b: Body, *, turned: bool) -> Freedom:
    sign = joint_angle_sign(pin)
    points = meeting_points(pin, a, b)
    return Freedom(
        pin.name, "hinge", (0.0, 0.0, -sign if turned else sign),
        at=points[0] if turned else points[1],
        start=sign * (b.angle - a.angle) - pin.zero, rate=sign * (_spin(b) - _spin(a)),
        limits=pin.limits, pin=pin)


def _slide(slot: Slot, a: Body, b: Body, *, turned: bool) -> list[Freedom]:
    along, length = groove(slot)
    points = meeting_points(slot, a, b)
    turn = Freedom(
        f"{slot.name}.turn", "hinge", (0.0, 0.0, -1.0 if turned else 1.0),
        at=points[0] if turned else points[1], start=b.angle - a.angle, rate=_spin(b) - _spin(a),
        made=True)
    ahead = along if turned else to_body((0.0, 0.0, b.angle - a.angle), along)
    side = -1.0 if turned else 1.0
    world = to_world((0.0, 0.0, a.angle), along)
    point = to_world(pose_of(b), points[1])
    va, vb = _velocity(a, point), _velocity(b, point)
    way = Freedom(
        slot.name, "slide", (side * ahead[0], side * ahead[1], 0.0),
        start=travel(slot, a, b), limits=(0.0, length),
        rate=(vb[0] - va[0]) * world[0] + (vb[1] - va[1]) * world[1])
    if not slot.turns:
        return [way]
    return [turn, way] if turned else [way, turn]


def _spin(body: Body) -> float:
    return body.angular_velocity if body.motion == "dynamic" else 0.0


def _velocity(body: Body, point: Vec) -> Vec:
    """Of a body's point at ``point`` of the world, at t = 0 [m/s]."""
    if body.motion != "dynamic":
        return 0.0, 0.0
    x, y = to_world(pose_of(body), mass_properties(body).centre)
    spin = body.angular_velocity
    return body.velocity[0] - spin * (point[1] - y), body.velocity[1] + spin * (point[0] - x)


@dataclass(frozen=True)
class Turn:
    """The angle of a pin that closes a loop, as a sum over hinges of the tree.

    ``angle = offset + sum(share * coordinate)`` [rad].
    """

    shares: tuple[tuple[str, float], ...]
    offset: float


def turn_of(
    pin: Pin, tree: Tree, bodies: Mapping[str, Body], moves: Mapping[str, Sequence[Freedom]],
) -> Turn:
    """How the angle of a pin follows from the hinges that carry its two bodies.

    ``moves`` gives the coordinates of every body.
    """
    sign = joint_angle_sign(pin)
    shares: dict[str, float] = {}
    start: dict[str, float] = {}
    for name, side in ((pin.b, sign), (pin.a, -sign)):
        for link in tree.line(name):
            for freedom in moves[link.body.name]:
                if freedom.kind == "hinge":
                    start[freedom.name] = freedom.start
                    shares[freedom.name] = shares.get(freedom.name, 0.0) + side * freedom.axis[2]
    shares = {name: share for name, share in shares.items() if share}
    offset = sign * (bodies[pin.b].angle - bodies[pin.a].angle) - pin.zero
    offset -= sum(share * start[name] for name, share in shares.items())
    return Turn(tuple(shares.items()), offset)
