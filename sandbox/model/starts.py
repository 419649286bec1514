"""How fast bodies and joints move at t = 0, by what the scene says of its bodies."""

from __future__ import annotations

import math

from sandbox.model.joints import place_in_slot
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.scene.geometry import Vec, pose_of, to_world


def spin(model: Model, body: int) -> float:
    """Of a body, counter-clockwise [rad/s]; 0 of what does not move freely."""
    return model.mechanism.bodies[body].angular_velocity if model.bodies.free[body] else 0.0


def velocity_at(model: Model, body: int, place: Vec) -> Vec:
    """Of a body's point that is at a ``place`` of the world [m/s]."""
    if not model.bodies.free[body]:
        return 0.0, 0.0
    (x, y), (vx, vy) = _world(model, body, model.bodies.centre[body]), (
        model.mechanism.bodies[body].velocity)
    w = spin(model, body)
    return vx - w * (place[1] - y), vy + w * (place[0] - x)


def turning(model: Model, joint: int) -> float:
    """At which ``b`` of a joint turns against ``a``, counter-clockwise [rad/s]."""
    a, b = model.joints.bodies[joint].tolist()
    return spin(model, b) - spin(model, a)


def sliding(model: Model, joint: int) -> float:
    """At which the point of a slot runs along it [m/s]; 0 where that has no length."""
    a, b = model.joints.bodies[joint].tolist()
    there, place = place_in_slot(model, joint, model.bodies.pose), _world(
        model, b, model.joints.anchor[joint, 1])
    (ax, ay), (bx, by) = velocity_at(model, a, place), velocity_at(model, b, place)
    return float((bx - ax) * there.x + (by - ay) * there.y)


def lengthening(model: Model, joint: int) -> float:
    """At which the two points of a joint go apart [m/s]; 0 where they are one."""
    ends = model.joints.bodies[joint].tolist()
    one, two = (_world(model, body, point)
                for body, point in zip(ends, model.joints.anchor[joint], strict=True))
    return _along(one, two, *(velocity_at(model, body, place)
                              for body, place in zip(ends, (one, two), strict=True)))


def _along(start: Vec, end: Vec, of_a: Vec, of_b: Vec) -> float:
    """Of the second of two velocities against the first, along the way from start to end."""
    x, y = end[0] - start[0], end[1] - start[1]
    length = math.hypot(x, y)
    return ((of_b[0] - of_a[0]) * x + (of_b[1] - of_a[1]) * y) / length if length > 0 else 0.0


def _world(model: Model, body: int, point: Array) -> Vec:
    return to_world(pose_of(model.mechanism.bodies[body]), (float(point[0]), float(point[1])))
