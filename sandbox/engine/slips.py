"""Cords that guides hold by friction: what slips over each guide, and what friction it meets.

Between such guides a cord is cut into spans, of which each has a tension of its own and holds so
much of the cord, M. A span ends wound on its guides: as a wheel turns, cord goes with it, and both
its length and M count what was wound up. What slips over guide j besides, out of the span before
and into the one after, at the rate s, adds to the rows of both and has no mass, so that friction f
is all that the tensions differ by:

    span i       D v + s_i - s_(i+1) + c p_i = asked              M_i += h (s_i - s_(i+1))
    guide j      p_j - p_(j-1) = h f_j,   |f_j| <= tanh(mu phi / 2) (T_j + T_(j-1)),   f s >= 0

The bound is that of Euler and Eytelwein, T_(j-1) e^(-mu phi) <= T_j <= T_(j-1) e^(mu phi), over the
angle phi that the cord bends by. It is affine in the unknowns, and friction one more row with
bounds (:mod:`sandbox.engine.bounded`). A loop could go round freely where no guide holds it: a drag
of next to nothing keeps its speed a number. By friction no span can be slack alone: a cord pulls as
a whole or not at all, and where it does not its material spreads evenly.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.records import PULL, STIFF
from sandbox.engine.rows import asked_by_cord, cord_lead, shortening
from sandbox.engine.state import PULLED, SLIPPING


@kernel
def _bend(table: int, slip: Any) -> float:
    """The angle that a cord bends by at a guide [rad]; 0 where it does not touch its wheel."""
    g = slip["guide"]
    if at.guides(table)[g]["radius"] != 0.0:
        twin = slip["twin"] if slip["twin"] >= 0 else g
        return max(0.0, float(at.guide_states(table)[twin]["wrap"]))
    pulls = at.guide_results(table)
    x, y = pulls[g]["jx"], pulls[g]["jy"]
    if slip["twin"] >= 0:
        x += pulls[slip["twin"]]["jx"]
        y += pulls[slip["twin"]]["jy"]
    return 2.0 * math.asin(min(1.0, 0.5 * math.hypot(x, y)))


@entry_point("slips")
def ask_slips(table: int, h: float) -> None:
    """What a drive pulls with goes to the last guide that holds its cord."""
    slips, asked = at.slips(table), at.unknowns(table)[0]
    for i in range(len(slips)):
        end = slips[i]["after"]
        if at.cords(table)[end]["kind"] == PULL:
            asked[slips[i]["row"]] = -h * at.cord_results(table)[end]["tension"]


@entry_point("slips")
def slip_rows(table: int, h: float, i: int, n: int) -> int:
    """Add the rows of guide ``i``: the sum of the tensions, and friction; how many there are."""
    slip, state, rows = at.slips(table)[i], at.slip_states(table)[i], at.rows(table)
    bound = math.tanh(0.5 * slip["friction"] * _bend(table, slip))
    if bound <= 0.0:
        return n
    pulled = at.cords(table)[slip["after"]]["kind"] == PULL
    out = rows[n]
    out["source"], out["a"], out["b"] = PULLED, slip["sum"], slip["sum"]
    out["ax"], out["ay"] = -1.0, 0.0 if pulled else -1.0
    out["want"] = -h * at.cord_results(table)[slip["after"]]["tension"] if pulled else 0.0
    out["low"], out["high"], out["normal"] = -1e300, 1e300, -1
    out["last"], out["mode"], out["friction"] = state["sum"], 0, 0.0
    out = rows[n + 1]
    out["source"], out["a"], out["b"] = SLIPPING, slip["slide"], slip["slide"]
    out["ax"], out["ay"], out["want"] = -1.0, 0.0, 0.0
    out["low"], out["high"], out["normal"] = 0.0, 0.0, n
    out["last"], out["mode"], out["friction"] = state["impulse"], state["mode"], bound
    for k in range(n, n + 2):
        rows[k]["index"], rows[k]["branch"] = i, 0
        rows[k]["at"] = rows[k]["bx"] = rows[k]["by"] = rows[k]["bt"] = 0.0
    return n + 2


@entry_point("slips")
def slipped(table: int, h: float) -> None:
    """Move cord from span to span as it slipped, and note the tension behind the last guide."""
    cords, states, results = at.cords(table), at.cord_states(table), at.cord_results(table)
    slips, slip_states, rates = at.slips(table), at.slip_states(table), at.slip_results(table)
    unknown = at.unknowns(table)[3]
    for i in range(len(slips)):
        slip = slips[i]
        before, after = slip["before"], slip["after"]
        cord, state = cords[before], states[before]
        # rates of soft spans stand in the rows by what they make of one another
        scale = (cord["c"] + h * state["k"]) / (state["inside"] * cord_lead(h, cord, state))
        rate = unknown[slip["row"]] / scale
        rates[i]["rate"] = rate
        rates[i]["force"] = results[after]["tension"] - results[before]["tension"]
        slip_states[i]["way"] += h * rate
        state["rest"] -= h * rate
        if cords[after]["kind"] != PULL:
            states[after]["rest"] += h * rate
    for i in range(len(cords)):
        if cords[i]["spans"] < cords[i]["spans_end"]:
            results[i]["tension"] = results[cords[i]["spans_end"] - 1]["tension"]
            if not states[i]["active"]:
                _even_out(table, i)


@kernel
def _even_out(table: int, i: int) -> None:
    """Spread what is in a slack cord over its spans as they are long."""
    cords, states, results = at.cords(table), at.cord_states(table), at.cord_results(table)
    length = inside = 0.0
    for k in range(cords[i]["spans"], cords[i]["spans_end"]):
        length += results[k]["length"] - results[k]["wound"]
        inside += states[k]["rest"] - results[k]["wound"]
    for k in range(cords[i]["spans"], cords[i]["spans_end"]):
        free = results[k]["length"] - results[k]["wound"]
        states[k]["rest"] = results[k]["wound"] + inside * free / length


@kernel
def _stretch(table: int, i: int) -> float:
    """By how much a whole cord is longer than what is in its spans [m]."""
    cords, states, results = at.cords(table), at.cord_states(table), at.cord_results(table)
    stretch = 0.0
    for k in range(cords[i]["spans"], cords[i]["spans_end"]):
        if cords[k]["kind"] != PULL:
            stretch += results[k]["length"] - states[k]["rest"]
    return stretch


@kernel
def _set(table: int, i: int, active: int) -> None:
    states = at.cord_states(table)
    states[i]["active"] = active
    for k in range(at.cords(table)[i]["spans"], at.cords(table)[i]["spans_end"]):
        states[k]["active"] = active


@kernel
def _drawn(table: int, i: int) -> bool:
    """Whether a drive pulls a whole cord at this moment."""
    last = at.cords(table)[i]["spans_end"] - 1
    return bool(at.cords(table)[last]["kind"] == PULL
                and at.cord_results(table)[last]["tension"] > 0.0)


@entry_point("slips")
def slacken_whole(table: int, i: int) -> None:
    """Let go of a whole cord that is not stretched; take up one that a drive pulls."""
    if _drawn(table, i):
        _set(table, i, 1)
    elif _stretch(table, i) <= 0.0:
        _set(table, i, 0)


@entry_point("slips")
def change_whole(table: int, h: float, i: int) -> bool:
    """Let go of a whole cord all of which would push, take up one that would pull; whether so."""
    if _drawn(table, i):
        return False
    cords, states, results = at.cords(table), at.cord_states(table), at.cord_results(table)
    guides, pulls, unknown = at.guides(table), at.guide_results(table), at.unknowns(table)[3]
    first, last = cords[i]["spans"], cords[i]["spans_end"]
    if states[i]["active"]:
        if cords[last - 1]["kind"] == PULL:  # whose end is free slides until it does not pull
            return False
        for k in range(first, last):
            if cords[k]["row"] >= 0 and unknown[cords[k]["row"]] >= 0.0:
                return False
        _set(table, i, 0)
        return True
    gone = off = 0.0
    for k in range(first, last):
        if cords[k]["row"] >= 0:
            rate = shortening(cords[k], guides, pulls, at.velocity(table))
            gone += rate
            off += asked_by_cord(h, cords[k], states[k], results[k]["length"], guides, pulls,
                                 at.before(table)) - rate
    ahead = h * gone if cords[first]["kind"] == STIFF else 0.0
    if _stretch(table, i) <= ahead or off <= 0.0:
        return False
    _set(table, i, 1)
    return True
