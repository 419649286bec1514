"""Joints with dry friction as flat tables for the compiled step."""

from __future__ import annotations

import numpy as np

from sandbox.engine.joint_state import RUB, RUB_STATE
from sandbox.model.model import Model
from sandbox.numeric import Array, Records


def rub_table(joints: Records, model: Model, first: int) -> tuple[Records, list[tuple[int, int]]]:
    """RUB of all joints that rub and hold a free body; the rows that some of them hang on.

    Args:
        joints: JOINT, with the numbers of their rows.
        model: the mechanism.
        first: the number of the first sum of rows.
    """
    held = [j for j in model.joints.rubbed.tolist() if joints[j]["row"] >= 0]
    table = np.zeros(len(held), RUB)
    sums: list[tuple[int, int]] = []
    for rub, j in zip(table, held, strict=True):
        rub["joint"], rub["sum"] = j, -1
        rub["most"], rub["share"] = model.joints.friction[j], model.joints.rubbing[j]
        rub["static"] = model.joints.static[j]
        if rub["share"] > 0:
            rub["sum"] = first + len(sums)
            one, two = int(joints[j]["row"]), int(joints[j]["row_y"])
            sums.append((one, two if two >= 0 else one))
    return table, sums


def rub_state(rubs: Records, model: Model) -> Records:
    """What they begin with: joints that move at t = 0 slip, those at rest hold."""
    state = np.zeros(len(rubs), RUB_STATE)
    state["ux"] = 1.0
    for own, j in zip(state, rubs["joint"].tolist(), strict=True):
        own["mode"] = -np.sign(rate_at_start(model, j))
    return state


def rate_at_start(model: Model, joint: int) -> float:
    """At which a hinge turns counter-clockwise [rad/s], or a point runs along its groove [m/s]."""
    a, b = model.joints.bodies[joint].tolist()
    one, two = (model.mechanism.bodies[n] for n in (a, b))
    turn = two.angular_velocity - one.angular_velocity
    if model.joints.kind[joint].keeps != "groove":
        return float(turn)
    c, s = np.cos(one.angle), np.sin(one.angle)
    along = np.array([[c, -s], [s, c]]) @ (model.joints.groove[joint, 1]
                                           - model.joints.groove[joint, 0])
    at = _world(model, b, model.joints.anchor[joint, 1])
    speeds = []
    for n, body in ((a, one), (b, two)):
        arm = at - _world(model, n, model.bodies.centre[n])
        speeds.append(np.array(body.velocity)
                      + body.angular_velocity * np.array([-arm[1], arm[0]]))
    return float((speeds[1] - speeds[0]) @ along / np.hypot(*along))


def _world(model: Model, body: int, point: Array) -> Array:
    x, y, angle = model.bodies.pose[body]
    c, s = np.cos(angle), np.sin(angle)
    return np.array([x, y]) + np.array([[c, -s], [s, c]]) @ point
