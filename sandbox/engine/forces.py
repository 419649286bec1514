"""Forces that the pose of a step tells: drives, springs and soft cords; and lengths of all cords.

What also hangs on the velocities at the step's end, or on what other elements carry (joints,
dampers, stiff cords, contacts), is left to :mod:`sandbox.engine.solve`.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.coordinates import ends
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.network import measure, wound_up
from sandbox.engine.records import GRIPPED, PULL
from sandbox.engine.ties import holds
from sandbox.numeric import Array


@entry_point("actions")
def act(table: int, drive: Array) -> None:
    """Forces and torques of drives [nd]."""
    actions, results = at.actions(table), at.action_results(table)
    body, out = at.body(table), at.force(table)
    for i in range(len(actions)):
        action, result = actions[i], results[i]
        a = action["a"]
        if action["motor"] >= 0 or action["runs"]:
            continue
        if not holds(table, action["tie"]):
            result["torque"] = 0.0
            continue
        value = drive[action["drive"]]
        if action["line"] >= 0:
            result["torque"] = value
            _push(table, action, value)
            continue
        if action["b"] >= 0:
            result["torque"] = action["sense"] * value
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


@kernel
def _push(table: int, action: Any, force: float) -> None:
    """The force of a drive between the two points of an actuator; none where they meet."""
    out, joint, a, b = at.force(table), at.joints(table)[action["line"]], action["a"], action["b"]
    ax, ay, bx, by, dx, dy = ends(joint, at.body(table), at.turn(table))
    length = math.hypot(dx, dy)
    if length > 0.0:
        fx, fy = force * dx / length, force * dy / length
        out[a, 0] -= fx
        out[a, 1] -= fy
        out[a, 2] -= ax * fy - ay * fx
        out[b, 0] += fx
        out[b, 1] += fy
        out[b, 2] += bx * fy - by * fx


@entry_point("cords")
def pull(table: int, drive: Array) -> None:
    """Lengths of all cords, and the tensions of those that have no row."""
    cords, results, body = at.cords(table), at.cord_results(table), at.body(table)
    states = at.cord_states(table)
    guides, wraps, pulls = at.guides(table), at.guide_states(table), at.guide_results(table)
    out = at.force(table)
    for i in range(len(cords)):
        cord, result = cords[i], results[i]
        if cord["stiffener"] >= 0:
            states[i]["k"] = drive[cord["stiffener"]]
        result["length"] = measure(cord, guides, wraps, pulls, body, False)
        if cord["whole"] >= 0:
            result["wound"] = wound_up(cord, guides, wraps)
            states[i]["inside"] = max(cord["least"], states[i]["rest"] - result["wound"])
        if cord["row"] >= 0 or cord["kind"] == GRIPPED:
            continue
        if not holds(table, cord["tie"]):
            result["tension"] = 0.0
        elif cord["kind"] == PULL:
            result["tension"] = drive[cord["drive"]]
        else:
            result["tension"] = max(states[i]["k"] * (result["length"] - states[i]["rest"]), 0.0)
        for n in range(cord["first"], cord["last"]):
            b = guides[n]["body"]
            out[b, 0] -= pulls[n]["jx"] * result["tension"]
            out[b, 1] -= pulls[n]["jy"] * result["tension"]
            out[b, 2] -= pulls[n]["jt"] * result["tension"]


@kernel
def begin(table: int) -> None:
    """Note how the bodies stand and move where pymunk has moved them."""
    body, before, turn, force, kick, shift = (
        at.body(table), at.before(table), at.turn(table), at.force(table), at.kick(table),
        at.shift(table))
    at.made(table)[0] += 1
    for i in range(len(body)):
        turn[i, 0], turn[i, 1] = math.cos(body[i, 2]), math.sin(body[i, 2])
        for j in range(3):
            before[i, j] = body[i, 3 + j]
            force[i, j] = kick[i, j] = shift[i, j] = 0.0


@kernel
def let_go(table: int, h: float, speeds: Array) -> None:
    """Velocities after the step if nothing were joined.

    Those of scheduled bodies are given: ``speeds`` [ns, 3].
    """
    before, free, force = at.before(table), at.free(table), at.force(table)
    inverse_mass, gravity = at.inverse_mass(table), at.gravity(table)
    for i in range(len(free)):
        w, wt = inverse_mass[i, 0], inverse_mass[i, 1]
        if w == 0.0:
            free[i, 0] = free[i, 1] = free[i, 2] = 0.0
            continue
        free[i, 0] = before[i, 0] + h * (gravity[0] + w * force[i, 0])
        free[i, 1] = before[i, 1] + h * (gravity[1] + w * force[i, 1])
        free[i, 2] = before[i, 2] + h * wt * force[i, 2]
    scheduled = at.scheduled(table)
    for i in range(len(scheduled)):
        for j in range(3):
            free[scheduled[i], j] = speeds[i, j]
