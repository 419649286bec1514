"""Poses to begin at: hinges at given angles, bodies at given places."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from sandbox.audit.rest import beyond_joint
from sandbox.equilibria.search import Search
from sandbox.errors import Problem, SceneError
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.wording import listed, near, quoted

Start = Mapping[str, float]
"""``JOINT.angle``, ``BODY.x``, ``BODY.y``, ``BODY.angle`` to values [rad, m]."""
TURN = 0.02
"""A ring is turned by so much at once [rad]."""
PARTS = {"x": 0, "y": 1, "angle": 2}


def startable(model: Model) -> list[str]:
    """The names that a start may give values."""
    return [*(f"{model.joints.name[j]}.angle" for j in model.joints.pivots.tolist()),
            *(f"{name}.{part}" for name, free in zip(
                model.bodies.name, model.bodies.free, strict=True) if free for part in PARTS)]


def placed(search: Search, start: Start) -> Array:
    """The pose of a start, [nb, 3] of the centres of mass; what is joined moves along.

    Raises:
        SceneError: names that nothing has, with a near miss.
    """
    model, known = search.model, startable(search.model)
    if wrong := [name for name in start if name not in known]:
        raise SceneError([Problem("name-not-found",
                                  f"{quoted(name)} can't be given at the start", "from",
                                  allowed=listed(known) or "nothing", hint=near(name, known))
                          for name in wrong])
    search.still.put(search.first)
    for name, value in start.items():
        element, _, part = name.rpartition(".")
        joint = model.names.joint.get(element)
        if joint is not None and part == "angle":
            _turn(search, joint, value)
        else:
            _bring(search, model.names.body[element], PARTS[part], value)
    return search.still.pose


def _angle(search: Search, joint: int) -> float:
    joints = search.model.joints
    a, b = search.still.pose[joints.bodies[joint], 2]
    return float(joints.sense[joint] * (b - a) - joints.zero[joint])


def _turn(search: Search, joint: int, value: float) -> None:
    """Turn what hangs on a hinge rigidly; a ring gives way in all its joints."""
    joints, still = search.model.joints, search.still
    beyond = sorted(beyond_joint(search.model, joint))
    way = float(joints.sense[joint]) * (value - _angle(search, joint))
    if not beyond:
        _turn_ring(search, joint, value)
        return
    if int(joints.bodies[joint, 1]) not in beyond:
        way = -way
    for part in _parts(way):
        pose = still.pose
        pivot = _point(search, int(joints.bodies[joint, 1]), joints.anchor[joint, 1])
        c, s = np.cos(part), np.sin(part)
        arm = pose[beyond, :2] - pivot
        pose[beyond, :2] = pivot + arm @ np.array([[c, s], [-s, c]])
        pose[beyond, 2] += part
        still.put(pose)
        still.move(search.drive)  # cords learn where they run
        still.put(pose)


def _turn_ring(search: Search, joint: int, value: float) -> None:
    still, joints = search.still, search.model.joints
    a, b = joints.bodies[joint].tolist()
    steps = list(_parts(value - _angle(search, joint)))
    for k in range(len(steps) + 4):  # the last ones close what is open
        left = value - _angle(search, joint)
        balance = search.look()
        row = np.zeros(len(balance.mass))
        for body, sign in ((a, -1.0), (b, 1.0)):
            at = np.flatnonzero(balance.bodies == body)
            row[3 * at + 2] += sign * float(joints.sense[joint])
        row = balance.free.T @ (row * balance.scale)
        if not row @ row > 0:
            return
        part = left / max(1, len(steps) - k)
        still.put(balance.moved(balance.free @ (row * part / (row @ row)) + balance.closing()))


def _parts(way: float) -> Iterator[float]:
    count = max(1, int(np.ceil(abs(way) / TURN)))
    for _ in range(count):
        yield way / count


def _point(search: Search, body: int, local: Array) -> Array:
    x, y, angle = search.still.pose[body]
    c, s = np.cos(angle), np.sin(angle)
    arm = local - search.model.bodies.centre[body]
    return np.array([x + c * arm[0] - s * arm[1], y + s * arm[0] + c * arm[1]])


def _bring(search: Search, body: int, part: int, value: float) -> None:
    """Put a body's frame where it is to be; joints that this opens close as it relaxes."""
    pose = search.still.pose
    x, y, angle = pose[body]
    cx, cy = search.model.bodies.centre[body]
    c, s = np.cos(angle), np.sin(angle)
    frame = np.array([x - (c * cx - s * cy), y - (s * cx + c * cy), angle])
    frame[part] = value
    c, s = np.cos(frame[2]), np.sin(frame[2])
    pose[body] = frame + np.array([c * cx - s * cy, s * cx + c * cy, 0.0])
    search.still.put(pose)
