"""Forces of drives; rows of motors, brakes, servos and drives of actuators.

D v is the rate of a hinge or of an actuator's length x; p / h the effort of the drive, within its
bounds. With the target x* of a step, the row of a drive with a stiffness k and a damping c is

    D v + p / (h e) = (k (x* - x) - (c - e) D v_before) / e,   e = c / 2 + h k / 4    (evenly)
    D v + p / (h e) = k (x* - x) / e,                          e = c + h k    (at the step's end)

the second where it is too stiff for the step (:mod:`sandbox.engine.stiffness`). A rigid one has the
rate that leads to its target in the next step, u + (x* - x) / h with u the rate of the target; but
no faster than it can brake, with a the deceleration that its limit leaves:

    |D v - u| <= - a h / 2 + sqrt((a h / 2)^2 + 2 a |x* - x|)

so that it reaches its target without overshoot. If the points of an actuator move across its line,
its length grows by more than D v: rigid drives and those of a speed subtract the difference.
"""

from __future__ import annotations

import math

from sandbox.engine import bounded
from sandbox.engine import memory as at
from sandbox.engine.bonds import holds
from sandbox.engine.coordinates import ahead, ends, vector_ahead
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.plan import add_to
from sandbox.engine.records import PACED, PLACED, SPRUNG
from sandbox.engine.state import DRIVEN
from sandbox.numeric import Array

CAUTION = 0.999  # share of the possible deceleration that a drive uses
MIN_SHARE = 0.01  # the minimum share, under large loads


@entry_point("motors")
def brake_in_time(table: int, h: float, n: int) -> None:
    """Limit the rates of rigid drives to those from which they can brake, and to their maximum."""
    rows, motors = at.rows(table), at.motors(table)
    chosen, m = at.chosen(table), 0
    for k in range(n):
        driven = rows[k]["source"] == DRIVEN and not rows[k]["out"]
        if driven and motors[rows[k]["index"]]["law"] == PLACED:
            chosen[m] = k
            m += 1
    for q in range(m):
        motor = motors[rows[chosen[q]]["index"]]
        inertia = _held(table, h, m, q, False)
        loads = _held(table, h, m, q, True)
        way = 1.0 if motor["short"] > 0.0 else -1.0
        reserve = max(motor["maximum"] - max(way * loads, 0.0), MIN_SHARE * motor["maximum"])
        can = CAUTION * reserve / inertia
        short = abs(motor["short"])
        speed = min(short / h, math.sqrt((can * h / 2) ** 2 + 2 * can * short) - can * h / 2)
        speed = motor["along"] + way * speed
        motor["command"] = min(max(speed, -motor["fastest"]), motor["fastest"])
    for q in range(m):
        row = rows[chosen[q]]
        bias = motors[row["index"]]["bend"] - motors[row["index"]]["command"]
        row["free"] += bias - row["bias"]
        row["bias"] = bias


@kernel
def _held(table: int, h: float, m: int, q: int, loads: bool) -> float:
    """The inertia of the q-th of m chosen rows with the others held, or the load that pushes it."""
    rows, G, A = at.rows(table), at.delassus(table), at.system(table)
    chosen, states = at.chosen(table), at.motors(table)
    for r in range(m):
        row = rows[chosen[r]]
        for c in range(m):
            A[r, c] = G[chosen[r], chosen[c]]
        A[r, r] += bounded.HOLD * row["base"]
        A[r, m] = 1.0 if r == q else 0.0
        if loads:
            A[r, m] = (row["free"] - row["bias"] - states[row["index"]]["seen"]) / h
    bounded.factor_system(A, m, chosen[m:])
    bounded.solve_system(A, m, chosen[m:])
    return float(A[q, m])


@entry_point("motors")
def motor_row(table: int, h: float, drive: Array, i: int, n: int) -> None:
    """Row ``n``, that of a motor, servo or brake."""
    out = at.rows(table)[n]
    motor, before = at.motors(table)[i], at.before(table)
    value = drive[motor["drive"]]
    brake = motor["maximum"] != motor["maximum"]
    limit = h * min(value if brake else motor["maximum"], bounded.UNBOUNDED)
    bounded.begin_row(out, DRIVEN, i, motor["a"], motor["b"], motor["impulse"], motor["mode"])
    bounded.put_coordinate(out, at.joints(table)[motor["joint"]], 1.0)
    out["low"], out["high"] = -limit, limit
    out["bias"] = 0.0 if brake else -motor["sense"] * value
    if motor["slope"] > 0.0:  # at mid-step, as dampers are
        out["bias"] = (before[motor["b"], 2] - before[motor["a"], 2] - 2.0 * motor["sense"] * value)
        out["soft"] = 2.0 / (h * motor["slope"])
    if motor["law"] == PACED and not motor["line"]:
        return
    place, seen = at.joints(table)[motor["joint"]]["way"], bounded.rate(out, before)
    motor["bend"] = 0.0
    if motor["line"]:
        line, body = at.joints(table)[motor["joint"]], at.body(table)
        _, _, _, ca, sa = ahead(h, body, before, line["a"])
        _, _, _, cb, sb = ahead(h, body, before, line["b"])
        x, y = vector_ahead(line, h, body, before, ca, sa, cb, sb)
        motor["bend"] = (math.hypot(x, y) - place) / h - seen
    if motor["law"] == PACED:
        out["bias"] = motor["bend"] - value
        return
    target = motor["sense"] * (value + motor["zero"])
    if motor["law"] == SPRUNG:
        k, c = motor["k"], motor["c"]
        lead = c + h * k if motor["stiff"] else c / 2 + h * k / 4
        out["soft"] = 1.0 / (h * lead)
        out["bias"] = -k * (target - place) / lead
        if not motor["stiff"]:
            out["bias"] += (c - lead) / lead * seen
        return
    motor["seen"] = motor["along"] = seen
    if motor["target"] == motor["target"]:  # not in the first step, nor in that of its engagement
        motor["along"] = (target - motor["target"]) / h
    motor["aim"] = target  # a step may be solved again: only its report makes it the last one
    motor["short"] = target - place - h * motor["along"]
    out["bias"] = motor["bend"] - motor["along"] - motor["short"] / h


@entry_point("actions")
def drive_forces(table: int, drive: Array) -> None:
    """Apply the forces and torques of drives; their values are ``drive`` [nd]."""
    actions, body, out = at.actions(table), at.body(table), at.force(table)
    for i in range(len(actions)):
        action = actions[i]
        a = action["a"]
        if action["motor"] >= 0 or action["runs"]:
            continue
        if not holds(table, action["bond"]):
            action["torque"] = 0.0
            continue
        value = drive[action["drive"]]
        if action["line"]:
            action["torque"] = value
            joint, b = at.joints(table)[action["joint"]], action["b"]
            ax, ay, bx, by, dx, dy = ends(joint, body, at.turn(table))
            length = math.hypot(dx, dy)
            if length > 0.0:  # else the points of the actuator meet
                fx, fy = value * dx / length, value * dy / length
                add_to(out, a, -fx, -fy, -(ax * fy - ay * fx))
                add_to(out, b, fx, fy, bx * fy - by * fx)
            continue
        if action["b"] >= 0:
            action["torque"] = value
            out[action["b"], 2] += action["sense"] * value
            out[a, 2] -= action["sense"] * value
            continue
        c, s = math.cos(body[a, 2]), math.sin(body[a, 2])
        fx, fy = value * action["dx"], value * action["dy"]
        if action["turning"]:
            fx, fy = c * fx - s * fy, s * fx + c * fy
        rx, ry = c * action["x"] - s * action["y"], s * action["x"] + c * action["y"]
        action["fx"], action["fy"] = fx, fy
        action["torque"] = rx * fy - ry * fx
        add_to(out, a, fx, fy, action["torque"])
