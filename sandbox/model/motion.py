"""What the law of a load reads of its body, and what it makes of that in the world."""

from __future__ import annotations

import numpy as np

from sandbox.model.loads import below
from sandbox.model.model import Model
from sandbox.numeric import Array


def motion_of(
    model: Model, load: int, pose: Array, velocity: Array, acceleration: Array, time: Array,
) -> dict[str, Array]:
    """What the law of a load reads, by name, [n] each.

    Args:
        model: of the mechanism.
        load: its number.
        pose: x, y, angle of the body's centre of mass, [3, n].
        velocity: of that, and turning, [3, n].
        acceleration: the same of these.
        time: [s], [n].
    """
    loads = model.loads
    body = int(loads.body[load])
    (x, y, angle), (u, v, w), (a, b, alpha) = pose, velocity, acceleration
    c, s = np.cos(angle), np.sin(angle)
    px, py = loads.at[load] - model.bodies.centre[body]
    rx, ry = c * px - s * py, s * px + c * py
    vx, vy = u - w * ry, v + w * rx
    ax, ay = a - alpha * ry - w * w * rx, b + alpha * rx - w * w * ry
    if loads.turning[load]:
        vx, vy = c * vx + s * vy, c * vy - s * vx
        ax, ay = c * ax + s * ay, c * ay - s * ax
    one = np.ones_like(x)
    return {"x": x + rx, "y": y + ry, "angle": angle, "vx": vx, "vy": vy, "omega": w,
            "speed": np.hypot(vx, vy), "ax": ax, "ay": ay, "alpha": alpha, "t": time,
            "mass": model.bodies.mass[body] * one, "inertia": model.bodies.inertia[body] * one}


def load_at(
    model: Model, load: int, pose: Array, velocity: Array, acceleration: Array, time: Array,
) -> Array:
    """Force in the world [N] and torque about the centre of mass [N m] of a load, [3, n].

    Arguments as of :func:`motion_of`.
    """
    loads, law = model.loads, model.loads.law[load]
    body = int(loads.body[load])
    c, s = np.cos(pose[2]), np.sin(pose[2])
    if law is None:
        cx, cy = model.bodies.centre[body]
        x = pose[0] - c * cx + s * cy
        area, moment = below(loads.outline(load), x, pose[1] - s * cx - c * cy, pose[2],
                             float(loads.level[load]))
        lift = loads.lift[load]
        return np.stack([np.zeros_like(x), lift * area, lift * (moment - pose[0] * area)])
    fx, fy, torque = law.at(motion_of(model, load, pose, velocity, acceleration, time))
    if loads.per_mass[load]:
        fx, fy = model.bodies.mass[body] * fx, model.bodies.mass[body] * fy
    if loads.turning[load]:
        fx, fy = c * fx - s * fy, s * fx + c * fy
    px, py = loads.at[load] - model.bodies.centre[body]
    rx, ry = c * px - s * py, s * px + c * py
    return np.stack([fx, fy, torque + rx * fy - ry * fx])
