"""Break-away: friction that holds with more than it slides with gives way.

A row that held in the last step has the bound of static friction. If it slips against that, its
load T came to the bound at t = (n - 3/2 + s) h, as in :mod:`sandbox.engine.breaks`, and the
friction of the step has the impulse

    h ((s - 1/2) F_s + (3/2 - s) F_k),      s = A / (A + B)

F_s and F_k are static and sliding friction, A = F_s - T is what was left of the bound in the last
step, B = T - F_s the load beyond it in this one. Velocities and places are then right to second
order, unless F_s > 3 F_k: friction never drives. T is not known. The step is solved with F_s, which
gives the rate of slip y_s, and with F_k, which gives y_k. Rates are linear in friction, so
B = (F_s - F_k) y_s / (y_k - y_s). Rows that act on each other, as those of a box on two corners,
slip as one: A and B are sums, weighted with y_s.

A row that slides back passes through rest, and is tried with static friction, too. What was left of
its bound is not known: s = 1/2.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.bounded import y_of
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.state import HOLDS, RUBBING, SLIDES, STILL, TANGENT, TRIED
from sandbox.numeric import Array, Records


@entry_point("static")
def break_away(table: int, n: int) -> bool:
    """Change the friction of rows that begin to slip; whether the step must be solved again."""
    rows, G, changed, tried = at.rows(table), at.delassus(table), False, False
    for k in range(n):
        row, mode = rows[k], rows[k]["mode"]
        if not _may_hold(row):
            continue
        y = y_of(rows, n, G, k)
        if row["phase"] == SLIDES and mode * row["slip"] < 0.0:
            row["phase"], row["mode"], row["spare"] = HOLDS, 0, math.nan
            _multiply(row, row["static"])
            changed = True
        elif row["phase"] == HOLDS and mode != 0 and abs(y) > STILL:
            row["phase"], row["slip"] = TRIED, abs(y)
            row["spare"] -= mode * row["gave"]
            row["gave"] = row["p"]
            _multiply(row, 1.0 / row["static"])
            changed = True
        tried |= row["phase"] == TRIED
    if tried and not changed:
        for k in range(n):
            rows[k]["wrong"] = _share(rows, n, G, k)
        for k in range(n):
            if _may_hold(rows[k]) and rows[k]["phase"] == TRIED:
                s = rows[k]["wrong"]
                _multiply(rows[k], max((s - 0.5) * rows[k]["static"] + 1.5 - s, 0.0))
                rows[k]["phase"], rows[k]["slip"] = SLIDES, 0.0
    return changed or tried


@kernel
def _may_hold(row: Any) -> bool:
    """Whether a row has static above sliding friction."""
    return bool((row["source"] == RUBBING or row["source"] == TANGENT) and row["static"] > 1.0)


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
        if _may_hold(row) and row["phase"] == TRIED and G[k, i] != 0.0:
            before += row["slip"] * row["spare"]
            beyond += row["slip"] * abs(row["gave"] - row["p"])
            slip += row["slip"] * row["slip"]
            more += row["slip"] * (abs(y_of(rows, n, G, i)) - row["slip"])
    beyond *= slip / more
    share = before / (before + beyond)
    return min(max(share, 0.0), 1.0) if share == share else 0.5
