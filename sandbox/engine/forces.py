"""Forces that the pose of a step tells: drives, springs and soft cords; and lengths of all cords.

What also hangs on the velocities at the step's end, or on what other elements carry (joints,
dampers, stiff cords, contacts), is left to :mod:`sandbox.engine.solve`.
"""

from __future__ import annotations

import math

from numba import njit

from sandbox.engine.network import measure
from sandbox.engine.state import PULL, Constants, Result, State
from sandbox.numeric import Array, Integers, Records


@njit(cache=True, error_model="numpy")
def act(actions: Records, results: Records, drive: Array, body: Array, out: Array) -> None:
    """Forces and torques of drives, torques of rotary springs."""
    for i in range(len(actions)):
        action, result = actions[i], results[i]
        a = action["a"]
        if action["motor"] >= 0:
            continue
        value = drive[action["drive"]] if action["drive"] >= 0 else action["k"]
        if action["b"] >= 0:
            result["torque"] = action["sense"] * value
            if action["spring"] >= 0:
                angle = body[action["b"], 2] - body[a, 2]
                result["torque"] = -value * (angle - action["rest"])
            out[action["b"], 2] += result["torque"]
            out[a, 2] -= result["torque"]
            continue
        c, s = math.cos(body[a, 2]), math.sin(body[a, 2])
        fx, fy = value * action["dx"], value * action["dy"]
        if action["turning"]:
            fx, fy = c * fx - s * fy, s * fx + c * fy
        rx, ry = c * action["x"] - s * action["y"], s * action["x"] + c * action["y"]
        result["fx"], result["fy"] = fx, fy
        result["torque"] = rx * fy - ry * fx
        out[a, 0] += fx
        out[a, 1] += fy
        out[a, 2] += result["torque"]


@njit(cache=True, error_model="numpy")
def stretch(
    springs: Records, results: Records, drive: Array, body: Array, turn: Array, out: Array,
) -> None:
    """Where straight springs are, and the forces of those that have no row."""
    for i in range(len(springs)):
        s, result = springs[i], results[i]
        a, b = s["a"], s["b"]
        ca, sa, cb, sb = turn[a, 0], turn[a, 1], turn[b, 0], turn[b, 1]
        ax, ay = ca * s["ax"] - sa * s["ay"], sa * s["ax"] + ca * s["ay"]
        bx, by = cb * s["bx"] - sb * s["by"], sb * s["bx"] + cb * s["by"]
        dx, dy = body[b, 0] + bx - body[a, 0] - ax, body[b, 1] + by - body[a, 1] - ay
        length = math.hypot(dx, dy)
        ux, uy = (dx / length, dy / length) if length > 0.0 else (0.0, 0.0)
        ta, tb = ax * uy - ay * ux, bx * uy - by * ux
        result["length"], result["ux"], result["uy"] = length, ux, uy
        result["ta"], result["tb"] = ta, tb
        if s["row"] >= 0:
            continue
        k = s["k"] if s["drive"] < 0 else drive[s["drive"]]
        force = k * (length - s["rest"])
        result["force"] = force
        out[a, 0] += ux * force
        out[a, 1] += uy * force
        out[a, 2] += ta * force
        out[b, 0] -= ux * force
        out[b, 1] -= uy * force
        out[b, 2] -= tb * force


@njit(cache=True, error_model="numpy")
def pull(
    cords: Records, results: Records, guides: Records, wraps: Records, pulls: Records,
    drive: Array, body: Array, out: Array,
) -> None:
    """Lengths of all cords, and the tensions of those that have no row."""
    for i in range(len(cords)):
        cord, result = cords[i], results[i]
        result["length"] = measure(cord, guides, wraps, pulls, body, False)
        if cord["row"] >= 0:
            continue
        if cord["kind"] == PULL:
            result["tension"] = drive[cord["drive"]]
        else:
            result["tension"] = max(cord["k"] * (result["length"] - cord["rest"]), 0.0)
        for n in range(cord["first"], cord["last"]):
            b = guides[n]["body"]
            out[b, 0] -= pulls[n]["jx"] * result["tension"]
            out[b, 1] -= pulls[n]["jy"] * result["tension"]
            out[b, 2] -= pulls[n]["jt"] * result["tension"]


@njit(cache=True, error_model="numpy")
def ready(
    h: float, gravity: Array, inverse_mass: Array, scheduled: Integers, speeds: Array,
    force: Array, before: Array, free: Array,
) -> None:
    """Velocities after the step if nothing were joined: of scheduled bodies what is given."""
    for i in range(len(free)):
        w, wt = inverse_mass[i, 0], inverse_mass[i, 1]
        if w == 0.0:
            free[i, 0] = free[i, 1] = free[i, 2] = 0.0
            continue
        free[i, 0] = before[i, 0] + h * (gravity[0] + w * force[i, 0])
        free[i, 1] = before[i, 1] + h * (gravity[1] + w * force[i, 1])
        free[i, 2] = before[i, 2] + h * wt * force[i, 2]
    for i in range(len(scheduled)):
        for j in range(3):
            free[scheduled[i], j] = speeds[i, j]


@njit(cache=True, inline="always")
def predict(
    constants: Constants, state: State, result: Result, drive: Array, speeds: Array,
) -> None:
    """All that the poses tell, and the velocities ``result.free`` that this alone leads to.

    Args:
        constants: of the run.
        state: bodies where pymunk has moved them.
        result: filled.
        drive: values of the drives at the step's instant, [nd].
        speeds: velocities of scheduled bodies after the step, [ns, 3].
    """
    body, force = state.body, result.force
    for i in range(len(body)):
        result.turn[i, 0], result.turn[i, 1] = math.cos(body[i, 2]), math.sin(body[i, 2])
        for j in range(3):
            result.before[i, j] = body[i, 3 + j]
            force[i, j] = 0.0
    act(constants.actions, result.actions, drive, body, force)
    stretch(constants.springs, result.springs, drive, body, result.turn, force)
    pull(constants.cords, result.cords, constants.guides, state.guides, result.guides, drive, body,
         force)
    ready(constants.h, constants.gravity, constants.inverse_mass, constants.scheduled, speeds,
          force, result.before, result.free)
