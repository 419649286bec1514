"""Poses at which a search for equilibria starts: hinges at given angles, bodies at given places."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sandbox.audit.rest import beyond_joint
from sandbox.equilibria.settle import Settler
from sandbox.errors import Problem, SceneError
from sandbox.model.joints import placed
from sandbox.numeric import Array
from sandbox.wording import listed, near, quoted

Start = Mapping[str, float]
"""``JOINT.angle``, ``BODY.x``, ``BODY.y``, ``BODY.angle`` to values [rad, m]."""
TURN = 0.02
"""Rotation of a hinge in one step [rad]."""
CLOSING = 4
"""Further steps that close a loop."""
PARTS = {"x": 0, "y": 1, "angle": 2}


def place_start(settler: Settler, start: Start) -> Array:
    """The pose of a start, [nb, 3] of the centres of mass; joined bodies move along.

    Raises:
        SceneError: unknown names, with a suggestion.
    """
    model, still = settler.model, settler.still
    known = [*(f"{model.joints.name[j]}.angle" for j in model.joints.pivots.tolist()),
             *(f"{name}.{part}" for name, free in zip(
                 model.bodies.name, model.bodies.free, strict=True) if free for part in PARTS)]
    if wrong := [name for name in start if name not in known]:
        raise SceneError([Problem("name-not-found",
                                  f"{quoted(name)} cannot be given at the start", "from",
                                  allowed=listed(known) or "nothing", hint=near(name, known))
                          for name in wrong])
    still.put(settler.first)
    for name, value in start.items():
        element, _, part = name.rpartition(".")
        joint = model.names.joint.get(element)
        if joint is not None and part == "angle":
            _turn(settler, joint, value)
        else:
            _bring(settler, model.names.body[element], PARTS[part], value)
    return still.pose


def _angle(settler: Settler, joint: int) -> float:
    joints = settler.model.joints
    a, b = settler.still.pose[joints.bodies[joint], 2]
    return float(joints.sense[joint] * (b - a) - joints.zero[joint])


def _turn(settler: Settler, joint: int, value: float) -> None:
    """Turn the bodies beyond a hinge rigidly; in a loop all joints give way."""
    joints, still = settler.model.joints, settler.still
    b = int(joints.bodies[joint, 1])
    beyond = sorted(beyond_joint(settler.model, joint))
    way = value - _angle(settler, joint)
    count = max(1, int(np.ceil(abs(way) / TURN)))
    if not beyond:
        for k in range(count + CLOSING):
            _turn_loop(settler, joint, (value - _angle(settler, joint)) / max(1, count - k))
        return
    part = float(joints.sense[joint]) * (way if b in beyond else -way) / count
    c, s = np.cos(part), np.sin(part)
    for _ in range(count):
        pose = still.pose
        pivot = placed(pose[b], joints.anchor[joint, 1] - settler.model.bodies.centre[b])
        pose[beyond, :2] = pivot + (pose[beyond, :2] - pivot) @ np.array([[c, s], [-s, c]])
        pose[beyond, 2] += part
        still.put(pose)
        still.move(settler.drive)  # tendons update their paths
        still.put(pose)


def _turn_loop(settler: Settler, joint: int, part: float) -> None:
    joints, balance = settler.model.joints, settler.look()
    row = np.zeros(len(balance.mass))
    for body, sign in zip(joints.bodies[joint].tolist(), (-1.0, 1.0), strict=True):
        row[3 * np.flatnonzero(balance.bodies == body) + 2] += sign * float(joints.sense[joint])
    row = balance.free.T @ (row * balance.scale)
    if row @ row > 0:
        settler.still.put(balance.pose_after(
            settler.still.pose, balance.free @ (row * part / (row @ row)) + balance.closing()))


def _bring(settler: Settler, body: int, part: int, value: float) -> None:
    """Move a body's frame; joints that this opens close as the mechanism comes to rest."""
    pose, centre = settler.still.pose, settler.model.bodies.centre[body]
    frame = pose[body].copy()
    frame[:2] = placed(pose[body], -centre)
    frame[part] = value
    pose[body, :2], pose[body, 2] = placed(frame, centre), frame[2]
    settler.still.put(pose)
