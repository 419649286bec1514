"""Impacts: contacts that give back speed, in the order in which they are hit within the step.

Each contact that approaches is hit when its gap closes (:mod:`sandbox.engine.instants`). Those that
are hit at one instant are reflected together, and what that changes may hit others. Five balls in a
row then hand on what hits them, whether they touch or not, and a box that falls flat on two corners
leaves its floor flat. Friction takes its part: what slides is slowed by at most μ times the blow.

What comes to a limit at the instant t of a step is stopped in two steps: the first one leads to the
limit, the second one leaves no speed. Their mean instant is t, so places are right to second order.
But what an acceleration a > 0 drives back leaves the limit at t already. A third step, which begins
at rest and shows what a is, gives the speed that the motion has gained since then.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.bounded import (
    columns,
    couple,
    push,
    rate,
    relax,
    solve_modes,
    wipe,
)
from sandbox.engine.candidates import normal_row, tangent_row
from sandbox.engine.entry_points import entry_point
from sandbox.engine.impact_poses import add_joints, answer_of_joints, note_joints, place_joints
from sandbox.engine.instants import meet, place_as_found, tangent_motion, time_to_close
from sandbox.engine.kernel import kernel
from sandbox.engine.plan import add, clear, put
from sandbox.engine.rows import answer, apply_impulses
from sandbox.engine.state import LIMITED, NORMAL, TANGENT
from sandbox.numeric import Records

REBOUND = 0.01  # minimum approach speed [m/s] of a rebound
EXACT = 1e-10  # tolerance of rates, as a share of the fastest approach
FAINT = 1e-6  # minimum approach in a chain of impacts, as a share of the first
CLOSED = 1e-9  # contacts with gaps up to this [m] are hit together
ORDERED = 100  # maximum number of instants of impacts in a step; later impacts are simultaneous


@kernel
def _hit(table: int, h: float) -> bool:
    touches, before, free = at.touches(table), at.before(table), at.free(table)
    row = at.rows(table)[len(at.rows(table)) - 1]
    for i in range(at.touching(table)[0]):
        t = touches[i]
        if t["restitution"] > 0.0:
            normal_row(h, touches, i, row)
            u = rate(row, before)
            if u < -REBOUND and (
                    t["late"] == 1 or h * min(u, rate(row, free)) + t["gap"] < 0.0):
                return True
    return False


@kernel
def _list(table: int, h: float, rows: Records) -> tuple[int, float]:
    """Rows of all contacts that give back speed, and from which instant on any may be hit."""
    touches, n, first = at.touches(table), 0, 0.0
    for i in range(at.touching(table)[0]):
        t = touches[i]
        t["bounce"] = t["drag"] = t["led"] = 0.0
        if t["restitution"] > 0.0 and n + 1 < len(rows):
            first = min(first, meet(table, h, i, rows[n]))
            rows[n]["last"] = 0.0
            n += 1
            if t["friction"] > 0.0:
                tangent_row(h, at.body(table), touches, i, n - 1, rows[n])
                tangent_motion(table, h, rows[n], t["belt"])
                rows[n]["last"] = 0.0
                n += 1
    return n, first


@entry_point("bounces")
def late_hits(table: int, n: int) -> bool:
    """Mark contacts that forces of this very step bring to hit; whether there are any."""
    rows, touches, before, found = at.rows(table), at.touches(table), at.before(table), False
    for k in range(n):
        row = rows[k]
        if row["source"] == NORMAL and row["p"] > 0.0:
            t = touches[row["index"]]
            if (t["restitution"] > 0.0 and t["bounce"] == 0.0 and t["late"] == 0
                    and rate(row, before) < -REBOUND):
                t["late"], found = 1, True
    return found


@kernel
def _reflect(table: int, h: float, rows: Records, n: int, now: float) -> bool:
    """Reflect contacts as they are hit, from the instant ``now`` on; whether any is."""
    touches, G, inverse_mass = at.touches(table), at.delassus(table), at.inverse_mass(table)
    A, chosen, delayed = at.system(table), at.chosen(table), at.delayed(table)
    end = REBOUND
    for event in range(ORDERED + 100 * n):
        if event == ORDERED:
            at.standing(table)[5] += 1
        now = _next(table, h, rows, n, now, end)
        if now > h:
            return event > 0
        fastest = _struck(rows, n, touches, now, end, CLOSED if event < ORDERED else math.inf)
        end = max(end, FAINT * fastest)
        if solve_modes(rows, n, G, A, chosen, EXACT * fastest) < 0:
            relax(rows, n, G)
        for q in range(n):
            p = rows[q]["p"]
            if p != 0.0:
                t = touches[rows[q]["index"]]
                t["instant"] = now
                if rows[q]["normal"] < 0:
                    t["bounce"] += p
                else:
                    t["drag"] += p
                push(inverse_mass, rows[q], p * now, delayed)
                for k in range(n):
                    change = G[k, q] * p
                    rows[k]["want"] += change
                    if rows[k]["normal"] < 0:
                        rows[k]["closing"] += change
                        rows[k]["gap"] -= change * now
                        touches[rows[k]["index"]]["led"] -= change * now
    return True


@kernel
def _next(table: int, h: float, rows: Records, n: int, now: float, end: float) -> float:
    """The instant of the next hit faster than ``end``; inf if there is none in the step."""
    first = math.inf
    for k in range(n):
        row = rows[k]
        if row["normal"] < 0:
            bend = row["bend"]
            u = row["closing"] + bend * now
            gap = max(row["gap"] + now * (row["closing"] + u) / 2, 0.0)
            if u * u - 2.0 * bend * gap > end * end:
                s = now + time_to_close(gap, u, bend)
                late = at.touches(table)[row["index"]]["late"] == 1
                if late and row["closing"] + bend * h < -end:
                    s = min(s, h)
                if s <= h:
                    first = min(first, s)
    return first


@kernel
def _struck(
    rows: Records, n: int, touches: Records, now: float, end: float, near: float,
) -> float:
    """Make ready those that are hit now, with gaps up to ``near``; the fastest approach.

    Reflected, a contact has y = v + e v_before >= 0; all others have no force to give.
    """
    fastest = 0.0
    for k in range(n):
        row = rows[k]
        u = row["want"] + row["trend"] * now
        row["mode"], row["free"] = 0, u
        if row["normal"] < 0:
            row["mode"], row["high"] = -1, 0.0
            seen = row["closing"] + row["bend"] * now
            gap = row["gap"] + now * (row["closing"] + seen) / 2
            if seen < -end and (gap <= near or touches[row["index"]]["late"] == 1):
                row["closing"] = u - row["bend"] * now
                row["gap"] = -now * (row["closing"] + u) / 2
                if u < -end:
                    fastest = max(fastest, -u)
                    row["mode"], row["high"] = 0, 1e300
                    row["free"] = (1.0 + touches[row["index"]]["restitution"]) * u
    return fastest


@entry_point("bounces")
def foresee_impacts(table: int, h: float, kept: int) -> bool:
    """Forget impacts of a trial without late hits; whether a contact is hit in this step.

    If so, ``velocity`` is that after the step without impacts: ``kept`` rows carry about what they
    did in the last step. If there are joints they are put to the pose of the first impact.
    """
    free, kick, delayed, shift, unknowns = (
        at.free(table), at.kick(table), at.delayed(table), at.shift(table), at.unknowns(table))
    add(free, kick, -1.0)
    for b in range(len(kick)):
        clear(kick[b])
        clear(delayed[b])
        clear(shift[b])
    clear(unknowns[5])
    for k in range(len(at.joints(table))):
        out = at.joints(table)[k]
        out["kick_x"] = out["kick_y"] = out["twist_a"] = out["twist_b"] = 0.0
    if not _hit(table, h):
        return False
    velocity, bounded = at.velocity(table), at.rows(table)  # bounded rows as in the last step
    put(velocity, free)
    for k in range(kept):
        push(at.inverse_mass(table), bounded[k], bounded[k]["last"], velocity)
    answer(table, velocity, unknowns[0], unknowns[4])
    apply_impulses(table, unknowns[4], velocity)
    if len(at.joints(table)) > 0:
        rows = at.rows(table)[len(at.rows(table)) // 2:]
        n, now = _list(table, h, rows)
        now = _next(table, h, rows, n, now, REBOUND)
        if now <= h:
            place_joints(table, h, now)
    return True


@entry_point("bounces")
def impacts(table: int, h: float, kept: int) -> bool:
    """Reflect approaches; the contacts' impulses are put into ``kick``. Whether there are any.

    What tendons and dampers make of them is found with all else that they carry. The impulses of
    the joints in the pose of the impact are in the last row of ``unknowns``.
    """
    kick, delayed, touches, body = (
        at.kick(table), at.delayed(table), at.touches(table), at.body(table))
    begin = len(at.rows(table)) // 2
    rows, Y, reached = (
        at.rows(table)[begin:], at.columns(table)[begin:], at.reached(table)[begin:])
    n, now = _list(table, h, rows)
    columns(table, begin, 0, n)
    couple(table, begin, 0, n)
    struck = _reflect(table, h, rows, n, now)
    for k in range(n):
        i = rows[k]["index"]
        t = touches[i]
        push(at.inverse_mass(table), rows[k],
             t["bounce"] if rows[k]["normal"] < 0 else t["drag"], kick)
        if t["bounce"] == 0.0:
            place_as_found(table, i)
        elif rows[k]["normal"] < 0:
            a, b = t["a"], t["b"]
            if at.inverse_mass(table)[b, 0] == 0.0:  # its place is that on body a
                t["bx"] = t["ax"] + body[a, 0] - body[b, 0]
                t["by"] = t["ay"] + body[a, 1] - body[b, 1]
    for k in range(kept):  # places and gaps may have changed
        row = at.rows(table)[k]
        last, mode = row["last"], row["mode"]
        if row["source"] == NORMAL:
            normal_row(h, touches, row["index"], row)
        elif row["source"] == TANGENT:
            tangent_row(h, body, touches, row["index"], row["normal"], row)
        row["last"], row["mode"] = last, mode
    wipe(rows, n, Y, reached)
    if struck and len(at.joints(table)) > 0:
        answer_of_joints(table, delayed)
        add_joints(table, delayed, 1.0)
        answer_of_joints(table, kick)
        add_joints(table, kick, 1.0)
        note_joints(table, 1.0)
    return struck


@entry_point("bounded")
def leave(table: int, h: float, n: int) -> None:
    """In their third step, give limits that are driven back the speed gained since the hit."""
    rows, before, limits = at.rows(table), at.before(table), at.limits(table)
    for k in range(n):
        row = rows[k]
        if row["source"] == LIMITED and limits[row["index"]]["since"] >= h:
            gain = (row["free"] - row["want"] - rate(row, before)) / h
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
    start, free = rate(row, at.before(table)), row["free"] - row["want"]
    if row["want"] <= 0.0 or start >= 0.0:
        return 0.0
    t = time_to_close(h * row["want"], (start + free) / 2, (free - start) / h)
    return max(h - t, 0.0)
