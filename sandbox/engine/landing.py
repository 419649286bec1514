"""Limits from which a motion rebounds by an acceleration.

What comes to a limit at the instant t of a step is stopped in two steps: the first one leads to the
limit, the second one leaves no speed. Their mean instant is t, so places are right to second order.
But what an acceleration a > 0 drives back leaves the limit at t already. A third step, which begins
at rest and shows what a is, gives the speed that the motion has gained since then.
"""

from __future__ import annotations

from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.bounded import rate
from sandbox.engine.entry_points import entry_point
from sandbox.engine.instants import time_to_close
from sandbox.engine.kernel import kernel
from sandbox.engine.state import LIMITED


@entry_point("bounded")
def leave(table: int, h: float, n: int) -> None:
    """In their third step, give limits that are driven back the speed gained since the hit."""
    rows, before, limits = at.rows(table), at.before(table), at.limit_states(table)
    for k in range(n):
        row = rows[k]
        if row["source"] == LIMITED and limits[row["index"]]["since"] >= h:
            gain = (row["free"] - row["want"] - rate(row, before)) / h
            row["free"] -= max(gain, 0.0) * (limits[row["index"]]["since"] + h / 2)


@entry_point("bounded")
def land(table: int, h: float, n: int) -> None:
    """Note how long ago, at the end of the step, limits were hit."""
    rows, limits = at.rows(table), at.limit_states(table)
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
