"""Which bounded rows a step has: contacts, limits, motors; those that carry and those in danger.

A motion that reaches a limit at the instant t of a step is stopped in two steps: the first one
leads to the limit, the second one leaves no speed. Their mean instant is t, so positions are right
to second order. But an acceleration a > 0 away from the limit acts from t on. A third step, which
begins at rest and gives a, adds the speed gained since then.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import bounded
from sandbox.engine import memory as at
from sandbox.engine.bonds import holds, joint_holds
from sandbox.engine.coordinates import flank
from sandbox.engine.entry_points import entry_point
from sandbox.engine.joint_friction import friction_rows
from sandbox.engine.kernel import kernel
from sandbox.engine.motors import motor_row
from sandbox.engine.records import FLANK, STOP
from sandbox.engine.rows import beyond
from sandbox.engine.state import HOLDS, LIMITED, NORMAL, SLIDES, STILL, TANGENT
from sandbox.engine.tendons import slip_rows
from sandbox.numeric import Array, Records

RETURN, RETURN_TURNING = 0.1, 1.0
"""The fastest that an overlap is undone [m/s], an overrun stop [rad/s]: nothing is thrown."""


@kernel
def closing_rate(h: float, gap: float, fastest: float) -> float:
    """What a row adds to its rate for its gap: all of it may go in this step, an overlap too."""
    return max(beyond(gap) / h, -fastest)


@kernel
def normal_row(h: float, touches: Records, i: int, out: Any) -> None:
    """The normal row of contact ``i``, a TOUCH, into a BOUND."""
    t = touches[i]
    nx, ny = t["nx"], t["ny"]
    bounded.begin_row(out, NORMAL, i, t["a"], t["b"], t["normal"], 0)
    out["gentle"], out["high"] = 1, bounded.UNBOUNDED
    out["ax"], out["ay"], out["bx"], out["by"] = -nx, -ny, nx, ny
    out["at"], out["bt"] = t["ay"] * nx - t["ax"] * ny, t["bx"] * ny - t["by"] * nx
    instant = t["instant"] if t["bounce"] > 0.0 else 0.0
    out["bias"] = (closing_rate(h, t["gap"] + t["gap_shift"], RETURN)
                   + (0.5 * h - instant) * t["acceleration"])
    if t["soft"] > 0.0:
        out["bias"], out["soft"], out["gentle"] = t["bias"], t["soft"], 0


@kernel
def tangent_row(h: float, body: Array, touches: Records, i: int, normal: int, out: Any) -> None:
    """The tangential row of contact ``i``.

    Its arms turn on with their bodies, by half a step up to the instant of the velocities: the
    point of a corner that sticks then stays where it is, to second order. Static friction is for
    what stuck in the last step, or is new and at rest.
    """
    t = touches[i]
    x, y = -t["ny"], t["nx"]
    wa, wb = body[t["a"], 5], body[t["b"], 5]
    arm_a, arm_b = t["ax"] * x + t["ay"] * y, t["bx"] * x + t["by"] * y
    bounded.begin_row(out, TANGENT, i, t["a"], t["b"], t["tangent"], t["mode"])
    out["normal"], out["friction"], out["hold"] = normal, t["friction"], bounded.HOLD_TANGENT
    out["ax"], out["ay"], out["bx"], out["by"] = -x, -y, x, y
    out["at"], out["bt"] = t["ay"] * x - t["ax"] * y, t["bx"] * y - t["by"] * x
    out["bias"] = 0.5 * h * (wa * wa * arm_a - wb * wb * arm_b) + t["belt"]
    out["bias"], out["soft"] = out["bias"] + t["bias_along"], t["soft_along"]
    out["static"], out["phase"], out["slip"] = t["static"], SLIDES, t["mode"]
    a, b, carried = t["a"], t["b"], t["normal"] > 0.0
    sliding = (x * (body[b, 3] - body[a, 3]) + y * (body[b, 4] - body[a, 4])
               + out["at"] * wa + out["bt"] * wb + t["belt"])
    if t["static"] > 1.0 and t["mode"] == 0 and (carried or abs(sliding) < STILL):
        out["phase"], out["friction"] = HOLDS, t["static"] * t["friction"]
        out["reserve"] = out["friction"] * t["normal"] if carried else math.nan
        out["p_static"] = t["tangent"]


@kernel
def piled(table: int, joint: int) -> bool:
    """Whether a joint's limits, motors and friction are solved with the contacts of a pile."""
    loose, bodies, one = at.loose(table), at.pile_bodies(table), at.joints(table)[joint]
    i = max(loose[one["a"]], loose[one["b"]])
    return bool(i >= 0 and bodies[i]["piled"])


@kernel
def limit_row(table: int, h: float, i: int, out: Any) -> None:
    """The row of limit ``i``, a LIMIT, into a BOUND."""
    limit = at.limits(table)[i]
    joint, side = at.joints(table)[limit["joint"]], limit["side"]
    bounded.begin_row(out, LIMITED, i, joint["a"], joint["b"], limit["impulse"], 0)
    out["gentle"], out["high"] = 1, bounded.UNBOUNDED
    if limit["what"] == FLANK:
        gap, ux, uy, on_a, on_b = flank(joint, side, 0.0, at.body(table), at.before(table))
        out["ax"], out["ay"], out["at"] = -ux, -uy, on_a
        out["bx"], out["by"], out["bt"] = ux, uy, on_b
        out["bias"] = closing_rate(h, gap - limit["bound"], RETURN)
        return
    bounded.put_coordinate(out, joint, side)
    out["bias"] = _gap_rate(h, limit, joint)


@kernel
def _gap_rate(h: float, limit: Any, joint: Any) -> float:
    """What the row of a limit that is no flank adds to its rate."""
    fastest = RETURN_TURNING if limit["what"] == STOP else RETURN
    return closing_rate(h, limit["side"] * (joint["way"] - limit["bound"]), fastest)


@kernel
def _kept(h: float, limit: Any, joint: Any, v: Array, slack: float) -> bool:
    """Whether velocities ``v`` keep a limit: by the sums of its row, which is not made."""
    if limit["what"] == FLANK:
        return False
    a, b, side = joint["a"], joint["b"], limit["side"]
    dx, dy = side * joint["dx"], side * joint["dy"]
    speed = (-dx * v[a, 0] - dy * v[a, 1] + side * joint["ta"] * v[a, 2]
             + dx * v[b, 0] + dy * v[b, 1] + side * joint["tb"] * v[b, 2])
    return bool(speed + _gap_rate(h, limit, joint) >= -slack)


@entry_point()
def kept_rows(table: int, h: float, drive: Array) -> int:
    """Begin with the motors and with what carried something in the last step; how many rows."""
    rows, touches, limits = at.rows(table), at.touches(table), at.limits(table)
    n = 0
    motors = at.motors(table)
    for i in range(len(motors)):
        if holds(table, motors[i]["bond"]) and not piled(table, motors[i]["joint"]):
            motor_row(table, h, drive, i, n)
            n += 1
    for i in range(len(at.dry_friction(table))):
        joint = at.dry_friction(table)[i]["joint"]
        if joint_holds(table, joint) and not piled(table, joint):
            n = friction_rows(table, h, i, n)
    for i in range(len(at.slips(table))):
        n = slip_rows(table, h, i, n)
    for i in range(len(limits)):
        joint = limits[i]["joint"]
        if limits[i]["impulse"] > 0.0 and joint_holds(table, joint) and not piled(table, joint):
            limit_row(table, h, i, rows[n])
            n += 1
    for i in range(at.touching(table)[0]):
        if touches[i]["listed"] == 1:
            n = _with_touch(h, at.body(table), touches, rows, i, n)
    for k in range(n):
        if rows[k]["a"] < len(at.before(table)):
            own = bounded.rate(rows[k], at.before(table))
            if rows[k]["source"] == TANGENT:
                own += touches[rows[k]["index"]]["belt"]
            rows[k]["last"] *= 1.0 - bounded.FADE * min(1.0, abs(own) / bounded.MOVING)
    return n


@kernel
def _with_touch(h: float, body: Array, touches: Records, rows: Records, i: int, n: int) -> int:
    normal_row(h, touches, i, rows[n])
    touches[i]["listed"] = 1
    if touches[i]["friction"] > 0.0:
        tangent_row(h, body, touches, i, n, rows[n + 1])
        return n + 2
    return n + 1


@entry_point()
def broken_rows(table: int, h: float, n: int, slack: float) -> int:
    """Add the limits and contacts that the velocities break; how many rows there are then."""
    rows, touches, velocity, first = at.rows(table), at.touches(table), at.velocity(table), n
    limits, joints = at.limits(table), at.joints(table)
    for i in range(len(limits)):
        j = limits[i]["joint"]
        if _kept(h, limits[i], joints[j], velocity, slack) or (
                not joint_holds(table, j) or piled(table, j)):
            continue
        limit_row(table, h, i, rows[n])
        new = bounded.rate(rows[n], velocity) + rows[n]["bias"] < -slack
        for k in range(first):
            new &= rows[k]["source"] != LIMITED or rows[k]["index"] != i
        if new:
            n += 1
    for i in range(at.touching(table)[0]):
        if not touches[i]["listed"]:
            normal_row(h, touches, i, rows[n])
            if bounded.rate(rows[n], velocity) + rows[n]["bias"] < -slack:
                n = _with_touch(h, at.body(table), touches, rows, i, n)
    return n


@kernel
def time_to_close(gap: float, speed: float, trend: float) -> float:
    """The instant at which gap + speed s + trend s² / 2 falls to 0; inf if it does not."""
    square = speed * speed - 2.0 * trend * gap
    if square >= 0.0 and speed < 0.0:
        return float(2.0 * gap / (math.sqrt(square) - speed))
    if square >= 0.0 and trend < 0.0:
        return float((speed + math.sqrt(square)) / -trend)
    return math.inf


@entry_point("bounded")
def leave(table: int, h: float, n: int) -> None:
    """In their third step, give limits that are driven back the speed gained since the hit."""
    rows, before, limits = at.rows(table), at.before(table), at.limits(table)
    for k in range(n):
        row = rows[k]
        if row["source"] == LIMITED and limits[row["index"]]["since"] >= h:
            gain = (row["free"] - row["bias"] - bounded.rate(row, before)) / h
            row["free"] -= max(gain, 0.0) * (limits[row["index"]]["since"] + h / 2)


@entry_point("bounded")
def land(table: int, h: float, n: int) -> None:
    """Note how long ago, at the end of the step, limits were hit."""
    rows, limits = at.rows(table), at.limits(table)
    for k in range(n):
        if rows[k]["source"] == LIMITED:
            state = limits[rows[k]["index"]]
            state["next"] = _since(table, h, rows[k], state["impulse"], state["since"])
    for i in range(len(limits)):
        limits[i]["since"], limits[i]["next"] = limits[i]["next"], 0.0


@kernel
def _since(table: int, h: float, row: Any, last: float, since: float) -> float:
    """The time since a limit was hit [s]; 0 if that was not in this step or the one before."""
    if row["p"] <= 0.0:
        return 0.0
    if last > 0.0:
        return since + h if 0.0 < since < h else 0.0
    start, free = bounded.rate(row, at.before(table)), row["free"] - row["bias"]
    if row["bias"] <= 0.0 or start >= 0.0:
        return 0.0
    t = time_to_close(h * row["bias"], (start + free) / 2, (free - start) / h)
    return max(h - t, 0.0)
