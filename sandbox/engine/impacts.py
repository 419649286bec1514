"""Impacts: contacts with restitution, in the order of their instants within the step.

Contacts that are hit at one instant are reflected together, and the change of velocities may hit
others. Five balls in a row hand on an impact, whether they touch or not, and a box that falls flat
on two corners leaves its floor flat. Friction slows sliding by at most μ times the normal impulse.

The pose x of a step is that of its middle. A contact with an open gap closes s later, with its
normal and arms of that instant; both surfaces are replaced by their circles of curvature. The
velocities at s are

    v(s) = v_before + (1/2 + s / h) (v_free - v_before)

with v_free those at the end of a step without impacts. Joints respond to an impact with their
directions at s. An impact that changes the velocities by Δv leads the pose x back along the new
path: the next pose is x - s Δv + h v. At x - s Δv joints are open by some s²; the step leaves that,
so that its velocities are right, and the pose is then displaced further to close the joints.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import bounded
from sandbox.engine import memory as at
from sandbox.engine import rows as bilateral
from sandbox.engine.bonds import release_rows
from sandbox.engine.bounded_rows import normal_row, tangent_row, time_to_close
from sandbox.engine.coordinates import ends
from sandbox.engine.curves import rotated
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.plan import add, clear, put
from sandbox.engine.records import GEAR, GROOVE, ROLL
from sandbox.engine.state import NORMAL, TANGENT
from sandbox.numeric import Array, Records

FLAT = 1e3  # a radius of curvature [m] from which a surface counts as flat
ITERATIONS = 3
TIME_TOLERANCE = 1e-6  # instants nearer to the pose are that of the pose, as a share of the step


@kernel
def meet(table: int, h: float, i: int, row: Any) -> float:
    """Bring contact ``i`` to the instant at which it closes; 0 if not in this step."""
    t = at.found(table)[i]
    place_as_found(table, i)
    normal_row(h, at.touches(table), i, row)
    start, trend = _motion(table, h, row, 0.0)
    if t["listed"] and not _approaches(table, h, i, row):
        start = max(start, 0.0)  # its force keeps it closed
    row["bias"], row["trend"] = start, trend
    row["gap"], row["closing"], row["bend"] = max(t["gap"], 0.0), start, trend
    s = time_to_close(t["gap"], start, trend + t["acceleration"])
    if t["listed"] or (t["gap"] < 0.0 and not -h <= s < 0.0):
        return 0.0
    for _ in range(ITERATIONS):
        s = _within(h, s)
        _carry(table, h, i, s)
        normal_row(h, at.touches(table), i, row)
        row["bias"], row["trend"] = _motion(table, h, row, 0.0)
        row["gap"] = t["gap"]
        if abs(s) < TIME_TOLERANCE * h:
            return s
        row["bend"] = (row["bias"] + row["trend"] * s - start) / s
        s = time_to_close(t["gap"], start, row["bend"])
    return _within(h, s)


@kernel
def _approaches(table: int, h: float, i: int, row: Any) -> bool:
    """Whether contact ``i`` closes without the forces of this step, by curvature or before it."""
    t = at.found(table)[i]
    bend = -h / 2 * t["acceleration"] if t["listed"] == 1 else min(h * t["acceleration"], 0.0)
    return bool(bounded.rate(row, at.before(table)) + bend < -REBOUND)


@kernel
def _within(h: float, s: float) -> float:
    return min(max(s, -h), h) if abs(s) <= h * (1.0 + TIME_TOLERANCE) else 0.0


@kernel
def place_as_found(table: int, i: int) -> None:
    """Put contact ``i`` where it is at the pose."""
    t, now = at.found(table)[i], at.touches(table)[i]
    now["nx"], now["ny"] = t["nx"], t["ny"]
    now["ax"], now["ay"], now["bx"], now["by"] = t["ax"], t["ay"], t["bx"], t["by"]


@kernel
def _motion(table: int, h: float, row: Any, s: float) -> tuple[float, float]:
    """The rate of a row at the instant ``s``, and how it changes with s."""
    before, free = bounded.rate(row, at.before(table)), bounded.rate(row, at.velocity(table))
    return before + (0.5 + s / h) * (free - before), (free - before) / h


@kernel
def mean(table: int, h: float, s: float, b: int, j: int) -> float:
    """Component ``j`` of the velocity of a body from the pose to the instant ``s``."""
    before = at.before(table)[b, j]
    return float(before + (0.5 + 0.5 * s / h) * (at.velocity(table)[b, j] - before))


@kernel
def _carry(table: int, h: float, i: int, s: float) -> None:
    """Take normal and arms of contact ``i`` from the pose to the instant ``s``."""
    t, now = at.found(table)[i], at.touches(table)[i]
    ka, da, kb, db = t["ka"], t["da"], t["kb"], t["db"]
    a, b, nx, ny, gap, s = t["a"], t["b"], t["nx"], t["ny"], t["distance"], s - t["ahead"]
    wa, wb = mean(table, h, s, a, 2), mean(table, h, s, b, 2)
    # arms of the surfaces' points, half a gap from the middle
    ax, ay = t["ax"] - gap / 2 * nx, t["ay"] - gap / 2 * ny
    bx, by = t["bx"] + gap / 2 * nx, t["by"] + gap / 2 * ny
    slide = (nx * (mean(table, h, s, b, 1) + wb * bx - mean(table, h, s, a, 1) - wa * ax)
             - ny * (mean(table, h, s, b, 0) - wb * by - mean(table, h, s, a, 0) + wa * ay))
    below = ka * db + kb * da + ka * kb * gap
    turn, along_a, along_b = wa, 0.0, 0.0
    if below > 0.0:
        turn = (ka * kb * slide + kb * da * wa + ka * db * wb) / below
        along_a = da * (kb * slide + db * (wb - wa) - kb * wa * gap) / below
        along_b = db * (ka * slide + da * (wa - wb) - ka * wb * gap) / below
    mx, my = rotated(nx, ny, turn * s)
    if abs(da) < FLAT * abs(ka) and abs(db) < FLAT * abs(kb):  # along the line of the centres
        ra, rb = da / ka, db / kb
        ox, oy = rotated(ax - ra * nx, ay - ra * ny, wa * s)
        px, py = rotated(bx + rb * nx, by + rb * ny, wb * s)
        ux = mean(table, h, s, b, 0) - mean(table, h, s, a, 0)
        uy = mean(table, h, s, b, 1) - mean(table, h, s, a, 1)
        mx, my = gap * nx + s * ux + px - ox + ax - bx, gap * ny + s * uy + py - oy + ay - by
        size = math.copysign(math.hypot(mx, my), ra + rb + gap)
        mx, my = mx / size, my / size
    now["nx"], now["ny"] = mx, my
    now["ax"], now["ay"] = _arm(ax, ay, nx, ny, mx, my, ka, da, wa * s, along_a * s)
    now["bx"], now["by"] = _arm(bx, by, -nx, -ny, -mx, -my, kb, db, wb * s, along_b * s)


@kernel
def _arm(
    x: float, y: float, nx: float, ny: float, mx: float, my: float, k: float, d: float,
    angle: float, along: float,
) -> tuple[float, float]:
    """An arm when its body has turned and the outer normal has become (mx, my)."""
    if abs(d) < FLAT * abs(k):
        x, y = rotated(x - d / k * nx, y - d / k * ny, angle)
        return x + d / k * mx, y + d / k * my
    x, y = rotated(x, y, angle)
    return x - along * my, y + along * mx


CLOSINGS = 3  # maximum number of closures of joints after an impact


@entry_point("bounces")
def shift_velocity(table: int, h: float, shifted: bool) -> None:
    """Let ``velocity`` lead from the displaced pose if ``shifted``, else from the pose again."""
    shift, velocity = at.shift(table), at.velocity(table)
    if not shifted:
        put(velocity, at.placed(table))
        return
    put(at.placed(table), velocity)
    for b in range(len(shift)):
        for j in range(3):
            velocity[b, j] += shift[b, j] / h


@kernel
def displaced_gaps(table: int, h: float) -> float:
    """:func:`joint_gaps` where the velocities lead from the displaced pose."""
    clear(at.unknowns(table)[4])
    shift_velocity(table, h, True)
    gap = bilateral.joint_gaps(table, h)
    shift_velocity(table, h, False)
    return gap


@kernel
def add_joints(table: int, velocity: Array, times: float, noted: bool) -> None:
    """Add changes of velocities by impulses of joints alone; note these as carried if ``noted``."""
    joints, impulses, entry_row = at.joints(table), at.unknowns(table)[5], at.entry_row(table)
    entry_body, J, WJ = at.entry_body(table), at.entries(table)[0], at.entries(table)[1]
    for k in range(len(joints)):
        joint, first = joints[k], joints[k]["entry"]
        for e in range(first, first + joint["entries"]):
            for j in range(3):
                velocity[entry_body[e], j] += times * WJ[e, j] * impulses[entry_row[e]]
        for e in range(first, first + joint["entries"] if noted else first, 2):
            p = times * impulses[entry_row[e]]
            joint["kick_x"] += p * J[e + 1, 0]
            joint["kick_y"] += p * J[e + 1, 1]
            joint["twist_a"] += p * J[e, 2]
            joint["twist_b"] += p * J[e + 1, 2]


@entry_point("bounces")
def take_impacts(table: int, h: float, struck: bool) -> None:
    """Add impacts to the free velocities; rows of joints respond at the pose of the step again."""
    shift, delayed, velocity, unknowns = (
        at.shift(table), at.delayed(table), at.velocity(table), at.unknowns(table))
    if struck and len(at.joints(table)) > 0:
        add_joints(table, at.kick(table), -1.0, True)
        body, turn = at.body(table), at.turn(table)
        for k in range(len(at.joints(table))):  # twists keep what forces at the points do not do
            joint = at.joints(table)[k]
            ax, ay, bx, by, px, py = ends(joint, body, turn)
            share = 0.0  # of the way to the point of b, to where a slot or wheels act on a
            if joint["keeps"] == GROOVE:
                share = 1.0
            elif joint["keeps"] == GEAR or joint["keeps"] == ROLL:
                share = joint["ra"] / (joint["ra"] + joint["rb"])
                bx, by = bx - (1.0 - share) * px, by - (1.0 - share) * py
            ax, ay = ax + share * px, ay + share * py
            joint["twist_a"] -= ay * joint["kick_x"] - ax * joint["kick_y"]
            joint["twist_b"] -= bx * joint["kick_y"] - by * joint["kick_x"]
        clear(unknowns[4])
        clear(unknowns[5])
        for b in range(len(shift)):
            for j in range(3):
                shift[b, j] = -delayed[b, j]
                velocity[b, j] = shift[b, j] / h
        bilateral.joint_gaps(table, h)
        for r in range(unknowns.shape[1]):
            unknowns[5, r] = -h * unknowns[4, r]
    add(at.free(table), at.kick(table), 1.0)


@entry_point("bounces")
def lead_back(table: int, h: float, n: int) -> None:
    """Displace the pose by what impacts after it change, times their instants; joints answer."""
    rows, unknowns, shift, delayed = (
        at.rows(table), at.unknowns(table), at.shift(table), at.delayed(table))
    Y, reached, A, chosen = at.columns(table), at.reached(table), at.system(table), at.chosen(table)
    for b in range(len(shift)):
        for j in range(3):
            shift[b, j] = -delayed[b, j]
    clear(unknowns[4])
    bilateral.right_side(table, shift, unknowns[4], unknowns[2])
    bilateral.forward(table, unknowns[2])
    m = 0
    for q in range(bounded.choose(rows, n, chosen)):
        row = rows[chosen[q]]  # active before the impacts; not a contact that closes in the step
        contact = row["source"] == NORMAL or row["source"] == TANGENT
        if (at.found(table)[row["index"]]["listed"] == 1) if contact else not row["measure"]:
            chosen[m] = chosen[q]
            m += 1
    bounded.make_system(rows, n, at.delassus(table), A, chosen, m)
    for q in range(m):
        k = chosen[q]
        A[q, m] = 0.0 if rows[k]["out"] else -bounded.free_rate(
            table, rows[k], Y[k], reached[k], shift, 0.0)
    bounded.factor_system(A, m, chosen[n:])
    bounded.solve_system(A, m, chosen[n:])
    for r in range(unknowns.shape[1]):
        unknowns[4, r] = unknowns[2, r]
    for q in range(m):
        k = chosen[q]
        _answer(table, k, A[q, m])
        if k + 1 < n and rows[k + 1]["normal"] == k and rows[k + 1]["mode"] != 0:
            _answer(table, k + 1, rows[k + 1]["mode"] * rows[k + 1]["friction"] * A[q, m])
    bilateral.backward(table, unknowns[4])
    bilateral.apply_impulses(table, unknowns[4], shift)
    clear(unknowns[5])
    for _ in range(CLOSINGS):  # joints are to be closed where the velocities lead from there
        if displaced_gaps(table, h) < bilateral.closed(h):
            break
        bilateral.forward(table, unknowns[4])
        bilateral.backward(table, unknowns[4])
        for r in range(unknowns.shape[1]):
            unknowns[4, r] *= h
        bilateral.apply_impulses(table, unknowns[4], shift)


@kernel
def _answer(table: int, k: int, p: float) -> None:
    """Add what bounded row ``k`` answers to the displacement, and to what bilateral rows do."""
    row, answer, y, reached = (
        at.rows(table)[k], at.unknowns(table)[4], at.columns(table)[k], at.reached(table)[k])
    for q in range(row["branch"]):
        answer[reached[q]] -= y[reached[q]] * p
    bounded.push(at.inverse_mass(table), row, p, at.shift(table))


REBOUND = 0.01  # minimum approach speed [m/s] of a rebound
EXACT = 1e-10  # tolerance of rates, as a share of the fastest approach
FAINT = 1e-6  # minimum approach in a chain of impacts, as a share of the first
CLOSED = 1e-9  # contacts with gaps up to this [m] are hit together
HALVINGS = 40  # maximum number, of the interval of the share of restitution that is kept
ORDERED = 100  # maximum number of instants of impacts in a step; later impacts are simultaneous


@kernel
def _hit(table: int, h: float) -> bool:
    touches, before, free = at.touches(table), at.before(table), at.free(table)
    row = at.rows(table)[len(at.rows(table)) - 1]
    for i in range(at.touching(table)[0]):
        t = touches[i]
        if t["restitution"] > 0.0:
            normal_row(h, touches, i, row)
            fastest = (min(bounded.rate(row, before), bounded.rate(row, free))
                       + min(h / 2 * t["acceleration"], 0.0))
            if _approaches(table, h, i, row) and (t["late"] == 1 or h * fastest + t["gap"] < 0.0):
                return True
    return False


@kernel
def _list(table: int, h: float, rows: Records) -> tuple[int, float]:
    """Rows of all contacts that give back speed, and from which instant on any may be hit."""
    touches, n, first = at.touches(table), 0, 0.0
    for i in range(at.touching(table)[0]):
        t = touches[i]
        t["bounce"] = t["drag"] = t["gap_shift"] = 0.0
        if t["restitution"] > 0.0 and n + 1 < len(rows):
            first = min(first, meet(table, h, i, rows[n]))
            rows[n]["last"] = 0.0
            n += 1
            if t["friction"] > 0.0:
                tangent_row(h, at.body(table), touches, i, n - 1, rows[n])
                rows[n]["bias"], rows[n]["trend"] = _motion(table, h, rows[n], 0.0)
                rows[n]["bias"] += t["belt"]
                rows[n]["last"] = 0.0
                n += 1
    return n, first


@entry_point("bounces")
def late_hits(table: int, h: float, n: int) -> bool:
    """Mark contacts that forces of this very step bring to hit; whether there are any."""
    rows, touches, found = at.rows(table), at.touches(table), False
    for k in range(n):
        row = rows[k]
        if row["source"] == NORMAL and row["p"] > 0.0:
            t = touches[row["index"]]
            if (t["restitution"] > 0.0 and t["bounce"] == 0.0 and t["late"] == 0
                    and _approaches(table, h, row["index"], row)):
                t["late"], found = 1, True
    return found


@kernel
def _reflect(table: int, h: float, rows: Records, n: int, now: float) -> bool:
    """Reflect contacts as they are hit, from the instant ``now`` on; whether any is."""
    touches, G, inverse_mass, delayed, end = (
        at.touches(table), at.delassus(table), at.inverse_mass(table), at.delayed(table), REBOUND)
    for event in range(ORDERED + 100 * n):
        if event == ORDERED:
            at.standing(table)[5] += 1
        now = _next(table, h, rows, n, now, end)
        if now > h:
            return event > 0
        fastest = _struck(rows, n, touches, now, end, CLOSED if event < ORDERED else math.inf)
        end = max(end, FAINT * fastest)
        _bounce(table, rows, n, now, EXACT * fastest)
        for q in range(n):
            p = rows[q]["p"]
            if p != 0.0:
                t = touches[rows[q]["index"]]
                t["instant"] = now
                if rows[q]["normal"] < 0:
                    t["bounce"] += p
                else:
                    t["drag"] += p
                bounded.push(inverse_mass, rows[q], p * now, delayed)
                for k in range(n):
                    change = G[k, q] * p
                    rows[k]["bias"] += change
                    if rows[k]["normal"] < 0:
                        rows[k]["closing"] += change
                        rows[k]["gap"] -= change * now
                        touches[rows[k]["index"]]["gap_shift"] -= change * now
    return True


@kernel
def _bounce(table: int, rows: Records, n: int, now: float, slack: float) -> None:
    """Find the impulses of contacts that are hit ``now``.

    Friction may add kinetic energy by Newton's law. Restitution is then reduced to the share at
    which the impact adds none; without restitution every impact takes energy.
    """
    G, touches, low, share, high = at.delassus(table), at.touches(table), 0.0, 1.0, 1.0
    for _ in range(HALVINGS):
        for k in range(n):
            if rows[k]["normal"] < 0 and rows[k]["high"] > 0.0:
                u = rows[k]["bias"] + rows[k]["trend"] * now
                rows[k]["free"] = (1.0 + share * touches[rows[k]["index"]]["restitution"]) * u
        if bounded.solve_modes(rows, n, G, at.system(table), at.chosen(table), slack, False) < 0:
            bounded.relax(rows, n, G)
        added = 0.0
        for k in range(n):
            u, p = rows[k]["bias"] + rows[k]["trend"] * now, rows[k]["p"]
            change = bounded.y_of(rows, n, G, k) - rows[k]["free"] if p != 0.0 else 0.0
            added += p * (u + change / 2) - EXACT * abs(p * u)
        low, high = (share, high) if added <= 0.0 else (low, share)
        if low == high:
            return
        share = (low + high) / 2


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
def _struck(rows: Records, n: int, touches: Records, now: float, end: float, near: float) -> float:
    """Prepare the contacts that are hit now, with gaps up to ``near``; the fastest approach."""
    fastest = 0.0
    for k in range(n):
        row = rows[k]
        u = row["bias"] + row["trend"] * now
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
    return fastest


@entry_point("bounces")
def foresee_impacts(table: int, h: float, kept: int) -> bool:
    """Reset impacts; whether a contact is hit in this step, with the velocity without impacts."""
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
    velocity, old = at.velocity(table), at.rows(table)  # bounded rows as in the last step
    put(velocity, free)
    for k in range(kept):
        bounded.push(at.inverse_mass(table), old[k], old[k]["last"], velocity)
    bilateral.answer(table, velocity, unknowns[0], unknowns[4])
    bilateral.apply_impulses(table, unknowns[4], velocity)
    if len(at.joints(table)) > 0:
        rows = at.rows(table)[len(at.rows(table)) // 2:]
        n, now = _list(table, h, rows)
        now = _next(table, h, rows, n, now, REBOUND)
        if now <= h:  # coefficients of the joints where the step leads then
            body, turn, pose = at.body(table), at.turn(table), at.placed(table)
            for b in range(len(body)):
                for j in range(3):
                    pose[b, j] = body[b, j]
                    body[b, j] += now * mean(table, h, now, b, j)
            bilateral.note_turns(body, turn)
            bilateral.joint_rows(table, h)
            release_rows(table, h)
            put(body, pose)
            bilateral.note_turns(body, turn)
    return True


@entry_point("bounces")
def impacts(table: int, h: float, kept: int) -> bool:
    """Reflect approaches; the contacts' impulses are put into ``kick``. Whether there are any."""
    kick, delayed, touches, body = (
        at.kick(table), at.delayed(table), at.touches(table), at.body(table))
    begin = len(at.rows(table)) // 2
    rows = at.rows(table)[begin:]
    n, now = _list(table, h, rows)
    bounded.columns(table, begin, 0, n)
    bounded.couple(table, begin, 0, n)
    struck = _reflect(table, h, rows, n, now)
    for k in range(n):
        i = rows[k]["index"]
        t = touches[i]
        bounded.push(at.inverse_mass(table), rows[k],
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
    bounded.wipe(table, begin, n)
    if struck and len(at.joints(table)) > 0:
        clear(at.unknowns(table)[4])
        bilateral.answer(table, delayed, at.unknowns(table)[4], at.unknowns(table)[5])
        add_joints(table, delayed, 1.0, False)
        bilateral.answer(table, kick, at.unknowns(table)[4], at.unknowns(table)[5])
        add_joints(table, kick, 1.0, True)
    return struck
