"""Impacts: contacts that give back speed, reflected before all forces.

Those that approach are reflected together, again and again, as long as any approaches. Five balls
in a row that touch then hand on what hits them, and a box that falls flat on two corners leaves
its floor flat. Friction takes its part: what slides is slowed by at most μ times the blow.
"""

from __future__ import annotations

from sandbox.engine import memory as at
from sandbox.engine.bounded import columns, couple, push, rate, relax, solve_modes, wipe
from sandbox.engine.candidates import rub_row, touch_row
from sandbox.engine.entry_points import entry_point
from sandbox.engine.factor import forward
from sandbox.engine.kernel import kernel
from sandbox.engine.rows import right_side
from sandbox.engine.state import NORMAL
from sandbox.numeric import Array, Records

REBOUND = 0.01
"""A slower approach [m/s] gives nothing back."""
EXACT = 1e-10
"""Rates that count as none, as a share of the fastest approach."""
FAINT = 1e-6
"""Approaches that small against the first end a chain of impacts."""


@kernel
def _approaching(table: int, h: float, rows: Records) -> int:
    """Rows of the contacts that give back speed and are near enough; 0 if none is hit."""
    touches, before = at.touches(table), at.before(table)
    n, hit = 0, False
    for i in range(at.touching(table)[0]):
        t = touches[i]
        if t["restitution"] > 0.0 and n + 1 < len(rows):
            touch_row(h, touches, i, rows[n])
            rows[n]["want"], rows[n]["last"] = 0.0, 0.0
            u = rate(rows[n], before)
            reaches = h * u + t["gap"] < 0.0 or t["late"] == 1
            if u < -REBOUND and reaches:
                hit = True
            if reaches or t["gap"] <= h * REBOUND:
                n += 1
                if t["friction"] > 0.0:
                    rub_row(h, at.body(table), touches, i, n - 1, rows[n])
                    rows[n]["want"], rows[n]["last"] = t["belt"], 0.0
                    n += 1
    return n if hit else 0


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
def _reflect(table: int, rows: Records, n: int) -> None:
    """Reflect all contacts that approach, together, as long as any does.

    Rates stand in ``want``, what contacts take in their ``bounce`` and ``rub``.
    """
    touches, G = at.touches(table), at.delassus(table)
    A, chosen, end = at.system(table), at.chosen(table), -REBOUND
    for _ in range(100 * n):
        fastest = _struck(rows, n, touches, end)
        if fastest == 0.0:
            return
        end = max(end, FAINT * fastest)
        if solve_modes(rows, n, G, A, chosen, -EXACT * fastest) < 0:
            relax(rows, n, G)
        for q in range(n):
            p = rows[q]["p"]
            if p != 0.0:
                t = touches[rows[q]["index"]]
                if rows[q]["normal"] < 0:
                    t["bounce"] += p
                else:
                    t["rub"] += p
                for k in range(n):
                    rows[k]["want"] += G[k, q] * p


@kernel
def _struck(rows: Records, n: int, touches: Records, end: float) -> float:
    """Make ready those that approach faster than ``end``; the fastest approach, 0 for none.

    Reflected, a contact has y = v + e v_before >= 0; all others have no force to give.
    """
    fastest = 0.0
    for k in range(n):
        row = rows[k]
        u = row["want"]
        row["mode"], row["free"] = 0, u
        if row["normal"] < 0:
            row["mode"], row["high"] = -1, 0.0
            if u < end:
                fastest = min(fastest, u)
                row["mode"], row["high"] = 0, 1e300
                row["free"] = (1.0 + touches[row["index"]]["restitution"]) * u
    return fastest


@entry_point("bounces")
def impacts(table: int, h: float) -> None:
    """Reflect approaches; the contacts' impulses go to the free velocities.

    What joints, cords and dampers make of them is found with all else that they carry.
    """
    begin = len(at.rows(table)) // 2
    rows, Y, reached = (
        at.rows(table)[begin:], at.columns(table)[begin:], at.reached(table)[begin:])
    n = _approaching(table, h, rows)
    if n == 0:
        return
    free, kick, touches = at.free(table), at.kick(table), at.touches(table)
    _add(free, kick, -1.0)  # of a try without late hits
    right_side(table)
    forward(at.starts(table), at.below(table), at.values(table), at.unknowns(table)[2])
    columns(table, begin, 0, n)
    couple(table, begin, 0, n)
    _halfway(table, rows, n)
    _reflect(table, rows, n)
    for b in range(len(kick)):
        for j in range(3):
            kick[b, j] = 0.0
    for k in range(n):
        t = touches[rows[k]["index"]]
        push(at.inverse_mass(table), rows[k],
             t["bounce"] if rows[k]["normal"] < 0 else t["rub"], kick)
    _add(free, kick, 1.0)
    wipe(rows, n, Y, reached)


@kernel
def _add(velocity: Array, change: Array, times: float) -> None:
    for b in range(len(velocity)):
        for j in range(3):
            velocity[b, j] += times * change[b, j]


@kernel
def _halfway(table: int, rows: Records, n: int) -> None:
    """The rates that are reflected, into ``want``; what the contacts take begins with 0.

    Of contacts that approach these are halfway through what the forces of this step do. So a ball
    that gives back all of its speed keeps its energy.
    """
    touches, before = at.touches(table), at.before(table)
    near = False
    for k in range(n):
        row = rows[k]
        t, u = touches[row["index"]], rate(row, before) + row["want"]
        t["bounce"] = t["rub"] = 0.0
        if row["normal"] < 0:
            near = u < -REBOUND
        row["want"] = (u + row["free"]) / 2 if near else u
