"""Impacts: contacts that give back speed, reflected before all forces.

Those that approach are reflected together, again and again, as long as any approaches. Five balls
in a row that touch then hand on what hits them, and a box that falls flat on two corners leaves
its floor flat.
"""

from __future__ import annotations

from sandbox.engine import memory as at
from sandbox.engine.bounded import HOLD, columns, couple, eliminate, push, rate, wipe
from sandbox.engine.candidates import touch_row
from sandbox.engine.kernel import NONE, kernel
from sandbox.engine.state import NORMAL
from sandbox.numeric import Array, Integers, Records

REBOUND = 0.01
"""A slower approach [m/s] gives nothing back."""
FAINT = 1e-6
"""Approaches that small against the first end a chain of impacts."""


@kernel
def _approaching(table: Integers, h: float, rows: Records) -> int:
    """Rows of the contacts that give back speed and are near enough; 0 if none is hit."""
    touches, before = at.touches(table), at.before(table)
    n, hit = 0, False
    for i in range(at.touching(table)[0]):
        t = touches[i]
        if t["restitution"] > 0.0 and n < len(rows):
            touch_row(h, touches, i, rows[n])
            rows[n]["want"], rows[n]["p"] = 0.0, 0.0
            u = rate(rows[n], before)
            reaches = h * u + t["gap"] < 0.0 or t["late"] == 1
            if u < -REBOUND and reaches:
                hit = True
            if reaches or t["gap"] <= h * REBOUND:
                n += 1
    return n if hit else 0


@kernel
def late_hits(table: Integers, n: int) -> bool:
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
def _reflect(table: Integers, rows: Records, n: int) -> None:
    """Reflect all contacts that approach, together, as long as any does."""
    touches, G = at.touches(table), at.delassus(table)
    A, chosen, end = at.system(table), at.chosen(table), -REBOUND
    for _ in range(100 * n):
        m, fastest = NONE, 0.0
        for k in range(n):
            if rows[k]["free"] < end:
                chosen[m] = k
                m += 1
                fastest = min(fastest, rows[k]["free"])
        if m == 0:
            return
        end = max(end, FAINT * fastest)
        m = reflection(rows, touches, G, A, chosen, m)
        for q in range(m):
            j, p = chosen[q], A[q, m]
            rows[j]["p"] += p
            for k in range(n):
                rows[k]["free"] += G[k, j] * p


@kernel
def reflection(
    rows: Records, touches: Records, G: Array, A: Array, chosen: Integers, m: int,
) -> int:
    """Impulses that reverse the approach of m chosen rows; how many of them are left.

    None of them pulls: what would is let go of. They stand in column m of ``A``.
    """
    while True:
        for r in range(m):
            i = chosen[r]
            for c in range(m):
                A[r, c] = G[i, chosen[c]]
            A[r, r] += HOLD * rows[i]["base"]  # three corners of one face share
            A[r, m] = -(1.0 + touches[rows[i]["index"]]["restitution"]) * rows[i]["free"]
        eliminate(A, m)
        left = NONE
        for r in range(m):
            if A[r, m] >= 0.0:
                chosen[left] = chosen[r]
                left += 1
        if left == m:
            return m
        m = left


@kernel
def impacts(table: Integers, h: float) -> None:
    """Reflect approaches; the contacts' impulses go to the free velocities.

    What joints, cords and dampers make of them is found with all else that they carry.
    """
    begin = len(at.rows(table)) // 2
    rows, Y, reached = (
        at.rows(table)[begin:], at.columns(table)[begin:], at.reached(table)[begin:])
    n = _approaching(table, h, rows)
    if n == 0:
        return
    columns(table, rows, NONE, n, Y, reached)
    couple(table, rows, NONE, n, Y, reached)
    touches, before = at.touches(table), at.before(table)
    for k in range(n):
        rows[k]["free"] = rate(rows[k], before)
    _reflect(table, rows, n)
    free, kick = at.free(table), at.kick(table)
    for b in range(len(free)):  # in place of the one that was tried without late hits
        for j in range(3):
            free[b, j] -= kick[b, j]
            kick[b, j] = 0.0
    for k in range(n):
        touches[rows[k]["index"]]["bounce"] = rows[k]["p"]
        push(at.inverse_mass(table), rows[k], rows[k]["p"], kick)
    for b in range(len(free)):
        for j in range(3):
            free[b, j] += kick[b, j]
    wipe(rows, n, Y, reached)
