"""Tendons: cables over guides, with friction at guides (capstan friction).

Rows of cables, with D v the rate at which a cable shortens and p / h its tension:

    damped       D v + 2 p / (h c)       = 2 k (L - L0) / c - D v_before    (mid-step)
    stiff        D v + p / (h (c + h k)) = k (L - L0) / (c + h k)           (the step's end)
    soft span    D v + p / (h e)         = (k (L - L0) - (c - e) D v_before) / e

A span of a cable that guides hold by friction is solved evenly about the pose where it is soft, e =
c / 2 + h k / 4. Between such guides a cord is cut into spans, of which each has a tension of its
own and holds so much of the cord, M. A span ends wound on its guides: as a wheel turns, cord goes
with it, and both its length and M count what was wound up. What slips over guide j besides, out of
the span before and into the one after, at the rate s, adds to the rows of both and has no mass, so
that friction f is all that the tensions differ by:

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
from sandbox.engine.bounded import HOLD_TANGENT, UNBOUNDED, begin_row
from sandbox.engine.cables import measure, wound_up
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.records import EVEN, GRIPPED, PULL, STIFF
from sandbox.engine.rows import LEAST
from sandbox.engine.state import CABLE_FRICTION, CABLE_LOAD
from sandbox.engine.ties import acts, holds
from sandbox.numeric import Array

EXCESS = 1e-10
"""Share of the tensions on both sides of a guide by which its friction may exceed its bound. A
stiff cable hardly slips under a force far beyond its bound: rates say little of it."""


@kernel
def _bend(table: int, slip: Any) -> float:
    """The angle that a cord bends by at a guide [rad]; 0 where it does not touch its wheel."""
    g, guides = slip["guide"], at.guides(table)
    if guides[g]["radius"] != 0.0:
        twin = slip["twin"] if slip["twin"] >= 0 else g
        return max(0.0, float(guides[twin]["wrap"]))
    x, y = guides[g]["jx"], guides[g]["jy"]
    if slip["twin"] >= 0:
        x += guides[slip["twin"]]["jx"]
        y += guides[slip["twin"]]["jy"]
    return 2.0 * math.asin(min(1.0, 0.5 * math.hypot(x, y)))


@entry_point("slips")
def slip_rows(table: int, h: float, i: int, n: int) -> int:
    """Add the rows of guide ``i``: the sum of the tensions, and friction; how many there are."""
    slip, rows = at.slips(table)[i], at.rows(table)
    bound = math.tanh(0.5 * slip["friction"] * _bend(table, slip))
    if bound <= 0.0:
        return n
    pulled = at.cords(table)[slip["after"]]["kind"] == PULL
    out = rows[n]
    begin_row(out, CABLE_LOAD, i, slip["sum"], slip["sum"], slip["pressed"], 0)
    out["measure"], out["low"], out["high"] = 1, -UNBOUNDED, UNBOUNDED
    out["ax"], out["ay"] = -1.0, 0.0 if pulled else -1.0
    out["want"] = -h * at.cords(table)[slip["after"]]["tension"] if pulled else 0.0
    out = rows[n + 1]
    begin_row(out, CABLE_FRICTION, i, slip["slide"], slip["slide"], slip["impulse"], slip["mode"])
    out["ax"], out["normal"], out["friction"] = -1.0, n, bound
    out["hold"], out["tight"] = HOLD_TANGENT, EXCESS
    return n + 2


@entry_point("cords")
def report_cords(table: int, h: float) -> None:
    """Tensions of all cords that have a row; rounding in a row without stiffness counts as none."""
    cords, unknown = at.cords(table), at.unknowns(table)[3]
    for i in range(len(cords)):
        if cords[i]["row"] >= 0 and acts(table, cords[i]["tie"]):
            tension = max(unknown[cords[i]["row"]] / h, 0.0)
            cords[i]["tension"] = tension if cords[i]["active"] and tension > LEAST else 0.0


@entry_point("slips")
def slipped(table: int, h: float) -> None:
    """Move cord from span to span as it slipped, and note the tension behind the last guide."""
    cords, slips, unknown = at.cords(table), at.slips(table), at.unknowns(table)[3]
    for i in range(len(slips)):
        slip = slips[i]
        before, after = slip["before"], slip["after"]
        cord = cords[before]
        # rates of soft spans stand in the rows by what they make of one another
        scale = (cord["c"] + h * cord["k"]) / (cord["inside"] * cord_lead(table, h, before))
        rate = unknown[slip["row"]] / scale
        slip["rate"] = rate
        slip["force"] = cords[after]["tension"] - cord["tension"]
        slip["way"] += h * rate
        cord["rest"] -= h * rate
        if cords[after]["kind"] != PULL:
            cords[after]["rest"] += h * rate
    for i in range(len(cords)):
        if cords[i]["spans"] < cords[i]["spans_end"]:
            cords[i]["tension"] = cords[cords[i]["spans_end"] - 1]["tension"]
            if cords[i]["active"]:
                continue
            length = inside = 0.0  # what is in a slack cord spreads over its spans as they are long
            for k in range(cords[i]["spans"], cords[i]["spans_end"]):
                length += cords[k]["length"] - cords[k]["wound"]
                inside += cords[k]["rest"] - cords[k]["wound"]
            for k in range(cords[i]["spans"], cords[i]["spans_end"]):
                free = cords[k]["length"] - cords[k]["wound"]
                cords[k]["rest"] = cords[k]["wound"] + inside * free / length


@kernel
def _stretch(table: int, i: int) -> float:
    """By how much a whole cord is longer than what is in its spans [m]."""
    cords = at.cords(table)
    stretch = 0.0
    for k in range(cords[i]["spans"], cords[i]["spans_end"]):
        if cords[k]["kind"] != PULL:
            stretch += cords[k]["length"] - cords[k]["rest"]
    return stretch


@kernel
def _set(table: int, i: int, active: int) -> None:
    cords = at.cords(table)
    cords[i]["active"] = active
    for k in range(cords[i]["spans"], cords[i]["spans_end"]):
        cords[k]["active"] = active


@kernel
def _drawn(table: int, i: int) -> bool:
    cords = at.cords(table)
    last = cords[cords[i]["spans_end"] - 1]
    return bool(last["kind"] == PULL and last["tension"] > 0.0)


@entry_point("slips")
def change_whole(table: int, h: float, i: int) -> bool:
    """Let go of a whole cord all of which would push, take up one that would pull; whether so."""
    if _drawn(table, i):
        return False
    cords, unknown = at.cords(table), at.unknowns(table)[3]
    first, last = cords[i]["spans"], cords[i]["spans_end"]
    if cords[i]["active"]:
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
            rate = shortening(table, k, at.velocity(table))
            gone += rate
            off += cord_rate(table, h, k) - rate
    ahead = h * gone if cords[first]["kind"] == STIFF else 0.0
    if _stretch(table, i) <= ahead or off <= 0.0:
        return False
    _set(table, i, 1)
    return True


@entry_point("cords")
def cord_rows(table: int, h: float) -> None:
    """Those of stiff and damped cords, and of spans; that of a slack one has no coefficients."""
    cords, guides = at.cords(table), at.guides(table)
    J, rhs, compliance = at.entries(table)[0], at.unknowns(table)[0], at.unknowns(table)[1]
    for i in range(len(cords)):
        cord = cords[i]
        r, first = cord["row"], cord["entry"]
        if r < 0:
            continue
        for e in range(first, first + cord["entries"]):
            J[e, 0] = J[e, 1] = J[e, 2] = 0.0
        if cord["into"] >= 0:
            J[cord["into"], 0] = 1.0
        if cord["out_of"] >= 0:
            J[cord["out_of"], 0] = -1.0
        if not cord["active"]:
            rhs[r], compliance[r] = 0.0, 1.0
            continue
        for n in range(cord["first"], cord["last"]):
            e = guides[n]["entry"]
            J[e, 0] -= guides[n]["jx"]
            J[e, 1] -= guides[n]["jy"]
            J[e, 2] -= guides[n]["jt"]
        rhs[r] = cord_rate(table, h, i)
        compliance[r] = 1.0 / (h * cord_lead(table, h, i))
    slips = at.slips(table)
    for i in range(len(slips)):  # what a drive pulls with goes to the last guide that holds
        end = slips[i]["after"]
        if cords[end]["kind"] == PULL:
            rhs[slips[i]["row"]] = -h * cords[end]["tension"]


@kernel
def cord_lead(table: int, h: float, i: int) -> float:
    """By how much a cord's tension falls for a rate at which it shortens after the step [N s/m]."""
    cord = at.cords(table)[i]
    share = 1.0 / cord["inside"] if cord["whole"] >= 0 else 1.0
    k, c = share * cord["k"], share * cord["c"]
    if cord["kind"] == STIFF:
        return max(float(c + h * k), LEAST)
    return float(c / 2 + h * k / 4 if cord["kind"] == EVEN else c / 2)


@kernel
def cord_rate(table: int, h: float, i: int) -> float:
    """The rate at which a taut cord wants to shorten, were there no tension [m/s]."""
    cord = at.cords(table)[i]
    share = 1.0 / cord["inside"] if cord["whole"] >= 0 else 1.0
    lead = cord_lead(table, h, i)
    pull = share * cord["k"] * (cord["length"] - cord["rest"])
    if cord["kind"] == STIFF:
        return float(pull / lead)
    speed = shortening(table, i, at.before(table))
    if cord["kind"] == EVEN:
        return float((pull - (share * cord["c"] - lead) * speed) / lead)
    return float(pull / lead - speed)


@kernel
def shortening(table: int, i: int, velocity: Array) -> float:
    """The rate at which a cord shortens as bodies move with ``velocity`` [nb, 3] [m/s]."""
    cord, guides, speed = at.cords(table)[i], at.guides(table), 0.0
    for n in range(cord["first"], cord["last"]):
        b = guides[n]["body"]
        speed -= (guides[n]["jx"] * velocity[b, 0] + guides[n]["jy"] * velocity[b, 1]
                 + guides[n]["jt"] * velocity[b, 2])
    return speed


@entry_point("cords")
def slacken(table: int) -> None:
    """Let go of all cords that are not stretched: their dampers do not pull before they do."""
    cords = at.cords(table)
    for i in range(len(cords)):
        if not holds(table, cords[i]["tie"]):
            _set(table, i, 0)
        elif cords[i]["kind"] == GRIPPED:
            if _drawn(table, i):
                _set(table, i, 1)
            elif _stretch(table, i) <= 0.0:
                _set(table, i, 0)
        elif cords[i]["whole"] < 0 and cords[i]["length"] <= cords[i]["rest"]:
            cords[i]["active"] = 0


@entry_point("cords")
def change_cords(table: int, h: float, attempt: int) -> bool:
    """Release cords that would push, take up stretched ones that would pull; whether any."""
    cords, unknown = at.cords(table), at.unknowns(table)[3]
    changed, worst, which = False, 0.0, -1
    for i in range(len(cords)):
        cord = cords[i]
        if not holds(table, cord["tie"]):
            continue
        if cord["kind"] == GRIPPED:
            changed |= change_whole(table, h, i)
        if cord["row"] < 0 or cord["whole"] >= 0:
            continue
        if cord["active"]:
            off = -unknown[cord["row"]]
        else:
            gone = shortening(table, i, at.velocity(table))
            stretch = cord["length"] - cord["rest"]
            if stretch <= (h * gone if cord["kind"] == STIFF else 0.0):
                continue
            off = cord_rate(table, h, i) - gone
            off /= 1.0 / (h * max(cord["c"] + h * cord["k"], LEAST)) + cord["response"]
        if off > 0.0:
            changed = True
            if attempt < 3:
                cord["active"] = 1 - cord["active"]
            elif off > worst:
                worst, which = off, i
    if which >= 0:
        cords[which]["active"] = 1 - cords[which]["active"]
    return changed


@entry_point("cords")
def pull(table: int, drive: Array) -> None:
    """Lengths of all cords, and the tensions of those that have no row."""
    cords, body, guides, out = at.cords(table), at.body(table), at.guides(table), at.force(table)
    for i in range(len(cords)):
        cord = cords[i]
        if cord["stiffener"] >= 0:
            cord["k"] = drive[cord["stiffener"]]
        cord["length"] = measure(cord, guides, body, False)
        if cord["whole"] >= 0:
            cord["wound"] = wound_up(cord, guides)
            cord["inside"] = max(cord["least"], cord["rest"] - cord["wound"])
        if cord["row"] >= 0 or cord["kind"] == GRIPPED:
            continue
        if not holds(table, cord["tie"]):
            cord["tension"] = 0.0
        elif cord["kind"] == PULL:
            cord["tension"] = drive[cord["drive"]]
        else:
            cord["tension"] = max(cord["k"] * (cord["length"] - cord["rest"]), 0.0)
        for n in range(cord["first"], cord["last"]):
            b = guides[n]["body"]
            out[b, 0] -= guides[n]["jx"] * cord["tension"]
            out[b, 1] -= guides[n]["jy"] * cord["tension"]
            out[b, 2] -= guides[n]["jt"] * cord["tension"]


@kernel
def add_cord_work(table: int, h: float, v: Array) -> None:
    """Work of the step; ``v`` [nb, 3] are the mean velocities of before and after it."""
    cords = at.cords(table)
    for i in range(len(cords)):
        if cords[i]["kind"] != GRIPPED:
            rate = shortening(table, i, v)
            cords[i]["step_work"] = h * cords[i]["tension"] * rate
            cords[i]["work"] += cords[i]["step_work"]
    for i in range(len(cords)):
        if cords[i]["kind"] == GRIPPED:
            cords[i]["step_work"] = 0.0
            for k in range(cords[i]["spans"], cords[i]["spans_end"]):
                cords[i]["step_work"] += cords[k]["step_work"]
            cords[i]["work"] += cords[i]["step_work"]
    slips = at.slips(table)
    for i in range(len(slips)):  # what a drive pulls over the last guide is work of it, too
        end = slips[i]["after"]
        if cords[end]["kind"] == PULL:
            drawn = h * cords[end]["tension"] * slips[i]["rate"]
            cords[end]["step_work"] += drawn
            cords[end]["work"] += drawn
