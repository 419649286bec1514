"""Dry friction in joints: of a pin against rotation, of a slot against sliding along its groove.

The free rate y of a joint is a row with bounds (:mod:`sandbox.engine.bounded`). The bound of its
impulse p is a number, h f, or depends on the load of the joint in the same step,

    |p| <= s |q|        q: the impulses of the joint's rows, two of a pin, one of a slot

s the coefficient, of a pin times its radius. Of two rows |q| is taken as u . q, a row of its own
without effect on bodies. u is the direction of q in the last solve: the step is solved again if it
changes, and the error of |q| is that of u squared.

Break-away: a row that held in the last step has the bound of static friction. If it slips, its load
T reached the bound at t = (n - 3/2 + s) h (:mod:`sandbox.engine.report`), and the impulse is

    h ((s - 1/2) F_s + (3/2 - s) F_k),      s = A / (A + B)

F_s and F_k are static and sliding friction, A = F_s - T the reserve of the last step, B = T - F_s
the excess in this one. This is of second order unless F_s > 3 F_k: friction never drives. The step
is solved with F_s and F_k. Rates are linear in friction, so the slip rates y_s and y_k give
B = (F_s - F_k) y_s / (y_k - y_s). Rows that act on each other slip as one: A and B are sums
weighted with y_s. A row that slides back is tried with static friction, too, with s = 1/2.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine import state as st
from sandbox.engine.bounded import UNBOUNDED, begin_row, put_coordinate, y_of
from sandbox.engine.coordinates import rate as coordinate_rate
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.records import GROOVE
from sandbox.engine.rows import beyond
from sandbox.numeric import Array, Matrix, Records

SAME = 1e-10  # relative tolerance of the load of a joint
NOTHING = 1e-13  # change of rates [m/s, rad/s] by rounding, which is not solved again


@kernel
def _along(table: int, h: float, dry: Any, out: Any) -> None:
    """The free rate of a joint, with its curvature, and a return to where it held."""
    joint, body, before, turn = (
        at.joints(table)[dry["joint"]], at.body(table), at.before(table), at.turn(table))
    put_coordinate(out, joint, 1.0)
    if joint["keeps"] != GROOVE:
        return
    dx, dy, a, b = joint["dx"], joint["dy"], joint["a"], joint["b"]
    bx = turn[b, 0] * joint["bx"] - turn[b, 1] * joint["by"]
    by = turn[b, 1] * joint["bx"] + turn[b, 0] * joint["by"]
    qx, qy = body[b, 0] + bx - body[a, 0], body[b, 1] + by - body[a, 1]
    wa, wb = before[a, 2], before[b, 2]
    vx = before[b, 0] - wb * by - before[a, 0] + wa * qy
    vy = before[b, 1] + wb * bx - before[a, 1] - wa * qx
    # d'' of the point of b in the frame of a, along the groove: centripetal and Coriolis terms
    bend = (wa * wa * (dx * qx + dy * qy) - wb * wb * (dx * bx + dy * by)
            + 2.0 * wa * (dx * vy - dy * vx))
    out["bias"] = 0.5 * h * bend
    if dry["mode"] != 0:
        dry["kept"] = 0
    elif dry["kept"] == 0:
        dry["kept"], dry["place"] = 1, joint["way"]
    else:
        out["bias"] += beyond(joint["way"] - dry["place"]) / h


@entry_point("joint_friction")
def friction_rows(table: int, h: float, i: int, n: int) -> int:
    """Add the rows of a joint's load and of its dry friction; the number of rows then."""
    dry, rows = at.dry_friction(table)[i], at.rows(table)
    joint, holds = at.joints(table)[dry["joint"]], dry["mode"] == 0
    more = dry["static"] if holds else 1.0
    by_load = dry["share"] > 0.0
    if by_load:
        out = rows[n]
        begin_row(out, st.JOINT_LOAD, i, dry["sum"], dry["sum"], dry["pressed"], 0)
        out["measure"], out["low"], out["high"] = 1, -UNBOUNDED, UNBOUNDED
        out["ax"], out["ay"] = -dry["ux"], -dry["uy"]
    m = n + 1 if by_load else n
    out = rows[m]
    begin_row(out, st.JOINT_FRICTION, i, joint["a"], joint["b"], dry["impulse"], dry["mode"])
    out["passive"] = 1
    _along(table, h, dry, out)
    limit = 0.0 if by_load else h * more * dry["maximum"]
    out["low"], out["high"] = -limit, limit
    out["normal"], out["friction"] = n if by_load else -1, more * dry["share"]
    out["static"], out["phase"] = dry["static"], st.HOLDS if holds and more > 1.0 else st.SLIDES
    out["reserve"], out["p_static"], out["slip"] = dry["bound"], dry["impulse"], dry["mode"]
    return m + 1


@entry_point("joint_friction")
def change_friction(table: int, n: int) -> bool:
    """Measure along what joints carry now; whether any friction was measured along another way."""
    rows, frictions = at.rows(table), at.dry_friction(table)
    unknown, changed = at.unknowns(table)[3], False
    for k in range(n - 1):
        if rows[k]["source"] != st.JOINT_LOAD:
            continue
        row, friction = rows[k], rows[k + 1]
        i = row["index"]
        joint = at.joints(table)[frictions[i]["joint"]]
        x = unknown[joint["row"]]
        y = unknown[joint["row_y"]] if joint["row_y"] >= 0 else 0.0
        size = math.hypot(x, y)
        off = size + row["ax"] * x + row["ay"] * y
        change = off * friction["friction"] * friction["base"]
        if off > SAME * size and change > NOTHING:
            frictions[i]["ux"], frictions[i]["uy"] = x / size, y / size
            row["ax"], row["ay"] = -x / size, -y / size
            changed = True
    return changed


@entry_point("joint_friction")
def report_friction(table: int, h: float, i: int, p: float, mode: int, bound: float) -> None:
    """Note what friction was in the step: its impulse on ``b``, the row's mode and static bound."""
    dry = at.dry_friction(table)[i]
    joint = at.joints(table)[dry["joint"]]
    dry["impulse"], dry["mode"], dry["bound"] = p, mode, bound
    dry["force"] = p / h * (1.0 if joint["keeps"] == GROOVE else joint["sense"])
    # a rigid drive may hold what friction has left at its bound: nothing moves all the same
    rate = abs(coordinate_rate(joint, at.velocity(table)))
    still = st.STILL if joint["keeps"] == GROOVE else st.STILL_TURNING
    dry["sticks"] = 1.0 if mode == 0 or rate < still else 0.0


@entry_point("joint_friction")
def release_friction(table: int, h: float, i: int, p: float) -> None:
    """Let friction of a released joint be none but ``p``; where it held it is not drawn back to."""
    dry = at.dry_friction(table)[i]
    dry["pressed"] = dry["place"] = 0.0
    rate = coordinate_rate(at.joints(table)[dry["joint"]], at.velocity(table))
    report_friction(table, h, i, p, -1 if rate > 0.0 else 1 if rate < 0.0 else 0, math.nan)
    dry["kept"] = 0
    dry["sticks"] = 0.0


@entry_point("joint_friction")
def add_friction_work(table: int, v: Matrix) -> None:
    """Work of the step just made, with ``v`` [nb, 3] the means of before and after it."""
    frictions = at.dry_friction(table)
    for i in range(len(frictions)):
        rate = coordinate_rate(at.joints(table)[frictions[i]["joint"]], v)
        frictions[i]["step_work"] = frictions[i]["impulse"] * rate
        frictions[i]["work"] += frictions[i]["step_work"]


@entry_point("static")
def break_away(table: int, n: int) -> bool:
    """Change the friction of rows that begin to slip; whether the step must be solved again."""
    rows, G, changed, tried = at.rows(table), at.delassus(table), False, False
    for k in range(n):
        row, mode = rows[k], rows[k]["mode"]
        if row["static"] <= 1.0:
            continue
        y = y_of(rows, n, G, k)
        if row["phase"] == st.SLIDES and mode * row["slip"] < 0.0:
            row["phase"], row["mode"], row["reserve"] = st.HOLDS, 0, math.nan
            _multiply(row, row["static"])
            changed = True
        elif row["phase"] == st.HOLDS and mode != 0 and abs(y) > st.STILL:
            row["phase"], row["slip"] = st.TRIED, abs(y)
            row["reserve"] -= mode * row["p_static"]
            row["p_static"] = row["p"]
            _multiply(row, 1.0 / row["static"])
            changed = True
        tried |= row["phase"] == st.TRIED
    if tried and not changed:
        for k in range(n):
            rows[k]["violation"] = _share(rows, n, G, k)
        for k in range(n):
            if rows[k]["static"] > 1.0 and rows[k]["phase"] == st.TRIED:
                s = rows[k]["violation"]
                _multiply(rows[k], max((s - 0.5) * rows[k]["static"] + 1.5 - s, 0.0))
                rows[k]["phase"], rows[k]["slip"] = st.SLIDES, 0.0
    return changed or tried


@kernel
def _multiply(row: Any, by: float) -> None:
    row["friction"] *= by
    row["low"] *= by
    row["high"] *= by


@kernel
def _share(rows: Records, n: int, G: Array, k: int) -> float:
    """The share s of row ``k``, whose step was solved with static and with sliding friction."""
    before = beyond = slip = more = 0.0
    for i in range(n):
        row = rows[i]
        if row["static"] > 1.0 and row["phase"] == st.TRIED and G[k, i] != 0.0:
            before += row["slip"] * row["reserve"]
            beyond += row["slip"] * abs(row["p_static"] - row["p"])
            slip += row["slip"] * row["slip"]
            more += row["slip"] * (abs(y_of(rows, n, G, i)) - row["slip"])
    beyond *= slip / more
    share = before / (before + beyond)
    return min(max(share, 0.0), 1.0) if share == share else 0.5
