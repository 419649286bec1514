"""Tendons over guides, with friction at guides (capstan friction).

A guide is a circle of radius 0 or more. Along the direction u with the left normal n, a circle with
its centre right of the path has the sign s = +1, left of it -1; the tendon touches it at p = c + s
r n, and n . (c2 - c1) = s1 r1 - s2 r2 for a piece between two circles. Every piece pulls its two
bodies at these points. The tendon is off a wheel whose angle of contact would be negative.

Rows of cables, with D v the rate at which a cable shortens and p / h its tension:

    damped       D v + 2 p / (h c)       = 2 k (L - L0) / c - D v_before    (mid-step)
    stiff        D v + p / (h (c + h k)) = k (L - L0) / (c + h k)           (the step's end)
    soft span    D v + p / (h e)         = (k (L - L0) - (c - e) D v_before) / e

Between guides with friction a tendon is cut into spans, each with a tension of its own and a length
M of the tendon. Soft spans are solved evenly about the pose, e = c / 2 + h k / 4. As a wheel turns,
tendon goes with it: the length of a span and M count what was wound up. Tendon that slips over
guide j at the rate s adds to the rows of the spans on both sides; without mass, their tensions
differ by the friction f alone:

    span i       D v + s_i - s_(i+1) + c p_i = r                  M_i += h (s_i - s_(i+1))
    guide j      p_j - p_(j-1) = h f_j,   |f_j| <= tanh(mu phi / 2) (T_j + T_(j-1)),   f s >= 0

The bound is that of Euler and Eytelwein, T_(j-1) e^(-mu phi) <= T_j <= T_(j-1) e^(mu phi), over the
angle phi that the tendon bends by. It is affine in the unknowns, and friction one more row with
bounds (:mod:`sandbox.engine.bounded`). A negligible drag keeps the speed of a free loop finite. No
span can be slack alone: a slack tendon spreads evenly over its spans.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.elements.element import GRAZE
from sandbox.engine import memory as at
from sandbox.engine.bonds import acts, holds
from sandbox.engine.bounded import HOLD_TANGENT, UNBOUNDED, begin_row
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.plan import add_to
from sandbox.engine.records import EVEN, GRIPPED, PULL, STIFF
from sandbox.engine.rows import MIN_LEAD
from sandbox.engine.state import CABLE_FRICTION, CABLE_LOAD
from sandbox.numeric import Array, Records


@kernel
def _near(angle: float, last: float) -> float:
    return angle + 2 * math.pi * math.floor((last - angle) / (2 * math.pi) + 0.5)


@kernel
def measure(cable: Any, guides: Records, pose: Array, turn: Array, start: bool) -> float:
    """Length of a tendon [m] at ``pose`` [nb, 3]; fills its J. ``start``: count turns anew."""
    length: float = _along(cable, guides, pose, turn, start)
    if cable["lifts"] and not start:
        for _ in range(2 * (cable["last"] - cable["first"])):
            if not _lay(cable, guides, pose, turn):
                break
            length = _along(cable, guides, pose, turn, start)
    return length


@kernel
def _along(cable: Any, guides: Records, pose: Array, turn: Array, start: bool) -> float:
    """The length over the guides that the tendon lies on, as :func:`measure` has it."""
    length = 0.0
    first, last = cable["first"], cable["last"]
    for i in range(first, last):
        guides[i]["jx"] = guides[i]["jy"] = guides[i]["jt"] = 0.0
    angle_in = angle_out = 0.0
    i = first
    while i < last - 1:
        j = i + 1
        while guides[j]["lifted"]:  # the last one never is
            j += 1
        a, b = guides[i], guides[j]
        ra, rb = a["radius"], b["radius"]
        straight, ux, uy, ax, ay, bx, by = _stretch(a, b, pose, turn)
        nx, ny = -uy, ux
        length += straight
        a["jx"] -= ux
        a["jy"] -= uy
        a["jt"] -= (ax + ra * nx) * uy - (ay + ra * ny) * ux
        b["jx"] += ux
        b["jy"] += uy
        b["jt"] += (bx + rb * nx) * uy - (by + rb * ny) * ux
        angle = 0.0
        if ra != 0.0 or rb != 0.0 or cable["closed"]:  # else the direction is not needed
            angle = math.atan2(ny, nx)
        if i == first:
            angle_out = angle
            if ra != 0.0 and not cable["closed"]:
                length -= ra * _unwound(angle - pose[a["body"], 2], a, start)
        elif ra != 0.0:
            length += abs(ra) * _wrapped(a, angle_in - angle, start)
        if rb != 0.0 and j == last - 1:
            length += (abs(rb) * _wrapped(b, angle - angle_out, start)
                       if cable["closed"]
                       else rb * _unwound(angle - pose[b["body"], 2], b, start))
        angle_in = angle
        i = j
    return length


@kernel
def _stretch(a: Any, b: Any, pose: Array, turn: Array) -> Any:
    """Length of the tendon between two guides [m], its direction; the guides from their centres."""
    i, j = a["body"], b["body"]
    ca, sa, cb, sb = turn[i, 0], turn[i, 1], turn[j, 0], turn[j, 1]
    ax, ay = ca * a["x"] - sa * a["y"], sa * a["x"] + ca * a["y"]
    bx, by = cb * b["x"] - sb * b["y"], sb * b["x"] + cb * b["y"]
    dx, dy = pose[j, 0] + bx - pose[i, 0] - ax, pose[j, 1] + by - pose[i, 1] - ay
    offset = a["radius"] - b["radius"]
    distance = math.hypot(dx, dy)
    straight = math.sqrt(max(distance * distance - offset * offset, 1e-24))
    square = straight * straight + offset * offset
    ux, uy = (straight * dx + offset * dy) / square, (straight * dy - offset * dx) / square
    return straight, ux, uy, ax, ay, bx, by


@kernel
def _lay(cable: Any, guides: Records, pose: Array, turn: Array) -> bool:
    """Change the wheel whose angle of contact contradicts its state most; whether any."""
    worst, which, before = 0.0, -1, cable["first"]
    for i in range(cable["first"] + 1, cable["last"] - 1):
        if not guides[i]["lifts"]:
            before = i
            continue
        if not guides[i]["lifted"]:
            before = i
            excess = -guides[i]["wrap"] - GRAZE
        else:
            after = i + 1
            while guides[after]["lifted"]:
                after += 1
            on = _stretch(guides[before], guides[i], pose, turn)
            off = _stretch(guides[i], guides[after], pose, turn)
            bend = math.atan2(on[1], -on[2]) - math.atan2(off[1], -off[2])
            excess = _wrapped(guides[i], bend, False)
        if excess > worst:
            worst, which = excess, i
    if which >= 0:
        guides[which]["lifted"] = 1 - guides[which]["lifted"]
    return which >= 0


@kernel
def _wrapped(guide: Any, turn: float, start: bool) -> float:
    """The angle of contact of a tendon on a wheel [rad] whose direction turns by ``turn``."""
    wrap = turn if guide["radius"] > 0 else -turn
    # a tendon that just touches its wheel must not go once round it by rounding
    wrap = ((wrap + GRAZE) % (2 * math.pi) - GRAZE + 2 * math.pi * guide["turns"] if start
            else _near(wrap, guide["wrap"]))
    guide["wrap"] = wrap
    return wrap


@kernel
def _unwound(angle: float, guide: Any, start: bool) -> float:
    """How far the point where a wound tendon leaves its wheel has gone since t = 0 [rad]."""
    psi = angle if start else _near(angle, guide["wrap"])
    guide["wrap"] = psi
    if start:
        guide["wrap0"] = psi
    return float(psi - guide["wrap0"])


EXCESS = 1e-10  # accepted excess of friction, as a share of both tensions: stiff cables hardly slip


@entry_point("slips")
def slip_rows(table: int, h: float, i: int, n: int) -> int:
    """Add the rows of guide ``i``: the sum of the tensions, and friction; how many there are."""
    slip, rows, guides = at.slips(table)[i], at.rows(table), at.guides(table)
    first = guides[slip["guide"]]
    last = guides[slip["twin"]] if slip["twin"] >= 0 else first
    if first["radius"] != 0.0:  # 0 where it does not touch its wheel
        bend = max(0.0, float(last["wrap"]))
    else:
        x, y = first["jx"], first["jy"]
        if slip["twin"] >= 0:
            x += last["jx"]
            y += last["jy"]
        bend = 2.0 * math.asin(min(1.0, 0.5 * math.hypot(x, y)))
    bound = math.tanh(0.5 * slip["friction"] * bend)
    if bound <= 0.0:
        return n
    pulled = at.cables(table)[slip["after"]]["kind"] == PULL
    out = rows[n]
    begin_row(out, CABLE_LOAD, i, slip["sum"], slip["sum"], slip["pressed"], 0)
    out["measure"], out["low"], out["high"] = 1, -UNBOUNDED, UNBOUNDED
    out["ax"], out["ay"] = -1.0, 0.0 if pulled else -1.0
    out["bias"] = -h * at.cables(table)[slip["after"]]["tension"] if pulled else 0.0
    out = rows[n + 1]
    begin_row(out, CABLE_FRICTION, i, slip["slide"], slip["slide"], slip["impulse"], slip["mode"])
    out["ax"], out["normal"], out["friction"] = -1.0, n, bound
    out["hold"], out["tight"] = HOLD_TANGENT, EXCESS
    return n + 2


@entry_point("cables")
def report_cables(table: int, h: float) -> None:
    """Tensions of all tendons that have a row; without stiffness, rounding counts as none."""
    cables, unknown = at.cables(table), at.unknowns(table)[3]
    for i in range(len(cables)):
        if cables[i]["row"] >= 0 and acts(table, cables[i]["bond"]):
            tension = max(unknown[cables[i]["row"]] / h, 0.0)
            cables[i]["tension"] = tension if cables[i]["active"] and tension > MIN_LEAD else 0.0


@entry_point("slips")
def slipped(table: int, h: float) -> None:
    """Move tendon between spans by its slip, and store the tension after the last guide."""
    cables, slips, unknown = at.cables(table), at.slips(table), at.unknowns(table)[3]
    for i in range(len(slips)):
        slip = slips[i]
        before, after = slip["before"], slip["after"]
        cable = cables[before]
        # rates of soft spans are scaled in the rows
        scale = (cable["c"] + h * cable["k"]) / (cable["inside"] * cable_lead(table, h, before))
        rate = unknown[slip["row"]] / scale
        slip["rate"] = rate
        slip["force"] = cables[after]["tension"] - cable["tension"]
        slip["way"] += h * rate
        cable["rest"] -= h * rate
        if cables[after]["kind"] != PULL:
            cables[after]["rest"] += h * rate
    for i in range(len(cables)):
        if cables[i]["spans"] < cables[i]["spans_end"]:
            cables[i]["tension"] = cables[cables[i]["spans_end"] - 1]["tension"]
            if cables[i]["active"]:
                continue
            length = inside = 0.0  # the material of a slack tendon spreads in proportion to length
            for k in range(cables[i]["spans"], cables[i]["spans_end"]):
                length += cables[k]["length"] - cables[k]["wound"]
                inside += cables[k]["rest"] - cables[k]["wound"]
            for k in range(cables[i]["spans"], cables[i]["spans_end"]):
                free = cables[k]["length"] - cables[k]["wound"]
                cables[k]["rest"] = cables[k]["wound"] + inside * free / length


@kernel
def _whole_stretch(table: int, i: int) -> float:
    """Length of a whole tendon minus the rest lengths in its spans [m]."""
    cables = at.cables(table)
    stretch = 0.0
    for k in range(cables[i]["spans"], cables[i]["spans_end"]):
        if cables[k]["kind"] != PULL:
            stretch += cables[k]["length"] - cables[k]["rest"]
    return stretch


@kernel
def _set(table: int, i: int, active: int) -> None:
    cables = at.cables(table)
    cables[i]["active"] = active
    for k in range(cables[i]["spans"], cables[i]["spans_end"]):
        cables[k]["active"] = active


@kernel
def _drawn(table: int, i: int) -> bool:
    cables = at.cables(table)
    last = cables[cables[i]["spans_end"] - 1]
    return bool(last["kind"] == PULL and last["tension"] > 0.0)


@entry_point("slips")
def change_whole(table: int, h: float, i: int) -> bool:
    """Release a whole tendon that would push, engage one that would pull; whether it changed."""
    if _drawn(table, i):
        return False
    cables, unknown = at.cables(table), at.unknowns(table)[3]
    first, last = cables[i]["spans"], cables[i]["spans_end"]
    if cables[i]["active"]:
        if cables[last - 1]["kind"] == PULL:  # whose end is free slides until it does not pull
            return False
        for k in range(first, last):
            if cables[k]["row"] >= 0 and unknown[cables[k]["row"]] >= 0.0:
                return False
        _set(table, i, 0)
        return True
    gone = off = 0.0
    for k in range(first, last):
        if cables[k]["row"] >= 0:
            rate = shortening(table, k, at.velocity(table))
            gone += rate
            off += cable_rate(table, h, k) - rate
    ahead = h * gone if cables[first]["kind"] == STIFF else 0.0
    if _whole_stretch(table, i) <= ahead or off <= 0.0:
        return False
    _set(table, i, 1)
    return True


@entry_point("cables")
def cable_rows(table: int, h: float) -> None:
    """Those of stiff and damped tendons, and of spans; that of a slack one has no coefficients."""
    cables, guides = at.cables(table), at.guides(table)
    J, rhs, compliance = at.entries(table)[0], at.unknowns(table)[0], at.unknowns(table)[1]
    for i in range(len(cables)):
        cable = cables[i]
        r, first = cable["row"], cable["entry"]
        if r < 0:
            continue
        for e in range(first, first + cable["entries"]):
            J[e, 0] = J[e, 1] = J[e, 2] = 0.0
        if cable["into"] >= 0:
            J[cable["into"], 0] = 1.0
        if cable["out_of"] >= 0:
            J[cable["out_of"], 0] = -1.0
        if not cable["active"]:
            rhs[r], compliance[r] = 0.0, 1.0
            continue
        for n in range(cable["first"], cable["last"]):
            add_to(J, guides[n]["entry"], -guides[n]["jx"], -guides[n]["jy"], -guides[n]["jt"])
        rhs[r] = cable_rate(table, h, i)
        compliance[r] = 1.0 / (h * cable_lead(table, h, i))
    slips = at.slips(table)
    for i in range(len(slips)):  # the pull of a drive acts at the last guide that holds
        end = slips[i]["after"]
        if cables[end]["kind"] == PULL:
            rhs[slips[i]["row"]] = -h * cables[end]["tension"]


@kernel
def cable_lead(table: int, h: float, i: int) -> float:
    """The drop of a tendon's tension per rate of shortening after the step [N s/m]."""
    cable = at.cables(table)[i]
    share = 1.0 / cable["inside"] if cable["whole"] >= 0 else 1.0
    k, c = share * cable["k"], share * cable["c"]
    if cable["kind"] == STIFF:
        return max(float(c + h * k), MIN_LEAD)
    return float(c / 2 + h * k / 4 if cable["kind"] == EVEN else c / 2)


@kernel
def cable_rate(table: int, h: float, i: int) -> float:
    """The rate at which a taut tendon would shorten without tension [m/s]."""
    cable = at.cables(table)[i]
    share = 1.0 / cable["inside"] if cable["whole"] >= 0 else 1.0
    lead = cable_lead(table, h, i)
    pull = share * cable["k"] * (cable["length"] - cable["rest"])
    if cable["kind"] == STIFF:
        return float(pull / lead)
    speed = shortening(table, i, at.before(table))
    if cable["kind"] == EVEN:
        return float((pull - (share * cable["c"] - lead) * speed) / lead)
    return float(pull / lead - speed)


@kernel
def shortening(table: int, i: int, velocity: Array) -> float:
    """The rate at which a tendon shortens as bodies move with ``velocity`` [nb, 3] [m/s]."""
    cable, guides, speed = at.cables(table)[i], at.guides(table), 0.0
    for n in range(cable["first"], cable["last"]):
        b = guides[n]["body"]
        speed -= (guides[n]["jx"] * velocity[b, 0] + guides[n]["jy"] * velocity[b, 1]
                 + guides[n]["jt"] * velocity[b, 2])
    return speed


@entry_point("cables")
def slacken(table: int) -> None:
    """Release all tendons that are not stretched: dampers do not pull slack tendons."""
    cables = at.cables(table)
    for i in range(len(cables)):
        if not holds(table, cables[i]["bond"]):
            _set(table, i, 0)
        elif cables[i]["kind"] == GRIPPED:
            if _drawn(table, i):
                _set(table, i, 1)
            elif _whole_stretch(table, i) <= 0.0:
                _set(table, i, 0)
        elif cables[i]["whole"] < 0 and cables[i]["length"] <= cables[i]["rest"]:
            cables[i]["active"] = 0


@entry_point("cables")
def change_cables(table: int, h: float, attempt: int) -> bool:
    """Release tendons that would push, engage stretched ones that would pull; whether any."""
    cables, unknown = at.cables(table), at.unknowns(table)[3]
    changed, worst, which = False, 0.0, -1
    for i in range(len(cables)):
        cable = cables[i]
        if not holds(table, cable["bond"]):
            continue
        if cable["kind"] == GRIPPED:
            changed |= change_whole(table, h, i)
        if cable["row"] < 0 or cable["whole"] >= 0:
            continue
        if cable["active"]:
            off = -unknown[cable["row"]]
        else:
            gone = shortening(table, i, at.velocity(table))
            stretch = cable["length"] - cable["rest"]
            if stretch <= (h * gone if cable["kind"] == STIFF else 0.0):
                continue
            off = cable_rate(table, h, i) - gone
            off /= 1.0 / (h * max(cable["c"] + h * cable["k"], MIN_LEAD)) + cable["response"]
        if off > 0.0:
            changed = True
            if attempt < 3:
                cable["active"] = 1 - cable["active"]
            elif off > worst:
                worst, which = off, i
    if which >= 0:
        cables[which]["active"] = 1 - cables[which]["active"]
    return changed


@entry_point("cables")
def pull(table: int, drive: Array) -> None:
    """Lengths of all tendons, and the tensions of those that have no row."""
    cables, body, guides, out = at.cables(table), at.body(table), at.guides(table), at.force(table)
    for i in range(len(cables)):
        cable = cables[i]
        if cable["stiffener"] >= 0:
            cable["k"] = drive[cable["stiffener"]]
        cable["length"] = measure(cable, guides, body, at.turn(table), False)
        if cable["whole"] >= 0:
            one, two = guides[cable["first"]], guides[cable["last"] - 1]
            cable["wound"] = (two["radius"] * (two["wrap"] - two["wrap0"])
                              - one["radius"] * (one["wrap"] - one["wrap0"]))
            cable["inside"] = max(cable["minimum"], cable["rest"] - cable["wound"])
        if cable["row"] >= 0 or cable["kind"] == GRIPPED:
            continue
        if not holds(table, cable["bond"]):
            cable["tension"] = 0.0
        elif cable["kind"] == PULL:
            cable["tension"] = drive[cable["drive"]]
        else:
            cable["tension"] = max(cable["k"] * (cable["length"] - cable["rest"]), 0.0)
        for n in range(cable["first"], cable["last"]):
            b, t = guides[n]["body"], -cable["tension"]
            add_to(out, b, guides[n]["jx"] * t, guides[n]["jy"] * t, guides[n]["jt"] * t)


@kernel
def add_cable_work(table: int, h: float, v: Array) -> None:
    """Work of the step; ``v`` [nb, 3] are the mean velocities of before and after it."""
    cables = at.cables(table)
    for i in range(len(cables) - 1, -1, -1):  # spans come after their tendons
        work = h * cables[i]["tension"] * shortening(table, i, v)
        if cables[i]["kind"] == GRIPPED:
            work = 0.0
            for k in range(cables[i]["spans"], cables[i]["spans_end"]):
                work += cables[k]["step_work"]
        cables[i]["step_work"] = work
        cables[i]["work"] += work
    slips = at.slips(table)
    for i in range(len(slips)):  # work of a drive on tendon that slips over the last guide
        end = slips[i]["after"]
        if cables[end]["kind"] == PULL:
            drawn = h * cables[end]["tension"] * slips[i]["rate"]
            cables[end]["step_work"] += drawn
            cables[end]["work"] += drawn
