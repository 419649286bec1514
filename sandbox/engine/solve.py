"""The one solve of a step: all that joints, dampers, cords, limits, motors and contacts carry.

pymunk has moved the bodies to the poses x of the step and found what is near. With W the inverse
masses, f the forces that the poses tell, B the bilateral rows and C those with bounds,

    v = v_before + h W f + W B^T p_b + W C^T p_c

gives the velocities v at the step's end. B is factored once (:mod:`sandbox.engine.factor`), the
rows C are solved on what it leaves (:mod:`sandbox.engine.bounded`); only those come in that carry
something or would be broken without. Whether cords are taut is tried last.

Contacts that give back speed do so before all forces: those that approach are reflected together,
again and again, as long as any approaches. Five balls in a row that touch then hand on what hits
them, and a box that falls flat on two corners leaves its floor flat.
"""

from __future__ import annotations

from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.bounded import (
    HOLD,
    columns,
    couple,
    eliminate,
    rate,
    relax,
    solve_modes,
    wipe,
)
from sandbox.engine.factor import assemble, backward, factor, forward
from sandbox.engine.kernel import kernel
from sandbox.engine.rows import (
    CLOSED,
    asked_by_cord,
    beyond,
    cord_rows,
    damper_rows,
    joint_gaps,
    joint_rows,
    right_side,
    shortening,
    spread,
    spring_rows,
    turning_rows,
    weigh,
)
from sandbox.engine.state import (
    DISTANCE,
    DRIVEN,
    GROOVE,
    LIMITED,
    LINE,
    NORMAL,
    POINT,
    STIFF,
    STOP,
    TANGENT,
)
from sandbox.numeric import Array, Integers, Records

HARD = 1e-12
"""Compliance of rigid rows, as a share of what the masses give: redundant ones share by it."""
ROUNDS = 12
"""Most times that rows are added, or cords let go and taken up, in one step."""
CLOSINGS = 3
"""Most times in a step that joints are solved again to be closed."""
RETURN, RETURN_TURNING = 0.1, 1.0
"""The fastest that an overlap is undone [m/s], an overrun stop [rad/s]: nothing is thrown."""
REBOUND = 0.01
"""A slower approach [m/s] gives nothing back."""
STILL, STILL_TURNING = 1e-11, 1e-10
"""Where nothing moves faster [m/s, rad/s] all is at rest, and contacts carry what they carried."""
SETTLED = 20
"""Steps at rest before that, in which the shares in loads come to what they tend to."""
FAINT = 1e-6
"""Approaches that small against the first end a chain of impacts."""
EXACT = 1e-10
"""Rates that count as none, as a share of the largest that the rows see."""


@kernel
def solve(table: Integers, h: float, drive: Array) -> bool:
    """Find the velocities after a step, from the free ones; False if there was no room.

    ``drive`` [nd] holds the values of the drives at the step's instant, ``table`` is that of
    :class:`sandbox.engine.memory.Memory`.
    """
    rows, solved, values = at.rows(table), at.unknowns(table)[2], at.values(table)
    starts, below = at.starts(table), at.below(table)
    Y, reached = at.columns(table), at.reached(table)
    joint_rows(table, h)
    damper_rows(table, h)
    spring_rows(table, h, drive)
    turning_rows(table, h, drive)
    _slacken(table)
    n = _kept(table, h, drive)
    enough = True
    hit = True
    for attempt in range(ROUNDS):
        _factored(table, h)
        if hit:
            _impacts(table, h)
        right_side(table)
        forward(starts, below, values, solved)
        done = closed = 0
        for _ in range(ROUNDS):
            columns(table, rows, done, n, Y, reached)
            couple(table, rows, done, n, Y, reached)
            done = n
            slack = _bound(table, n)
            _velocities(table, n)
            n = _broken(table, h, n, slack)
            if n < 0:
                enough, n = False, done
            if n == done and not (closed < CLOSINGS and _close(table, h, n)):
                break
            closed += n == done
        wipe(rows, n, Y, reached)
        hit = _late_hits(table, n)
        if not (hit or _change_cords(table, h, attempt)):
            break
    _report(table, h, n)
    _rest(table)
    return enough


@kernel
def _factored(table: Integers, h: float) -> None:
    """Put together the matrix of the bilateral rows, and factor it."""
    unknowns, values = at.unknowns(table), at.values(table)
    J, WJ = at.entries(table)[0], at.entries(table)[1]
    cord_rows(table, h)
    weigh(table)
    assemble(at.pairs(table), at.direct(table), J, WJ, values)
    count = unknowns.shape[1]
    diagonal = len(values) - count
    for i in range(count):
        values[diagonal + i] = values[diagonal + i] * (1.0 + HARD) + unknowns[1, i]
    entry_row, direct = at.entry_row(table), at.direct(table)
    for k in range(len(direct)):  # what hubs give
        e, axis = direct[k, 1], direct[k, 2]
        values[diagonal + entry_row[e]] += HARD * J[e, axis] * WJ[e, axis]
    factor(at.starts(table), at.below(table), at.updates(table), values, unknowns[4])


@kernel
def _close(table: Integers, h: float, n: int) -> bool:
    """Ask for what leaves joints open where the velocities lead; whether that is worth a solve."""
    unknowns, values, rows = at.unknowns(table), at.values(table), at.rows(table)
    Y, reached = at.columns(table), at.reached(table)
    count = unknowns.shape[1]
    diagonal = len(values) - count
    for i in range(count):
        unknowns[4, i] = 0.0
    if joint_gaps(table, h) < CLOSED:
        return False
    forward(at.starts(table), at.below(table), values, unknowns[4])
    for i in range(count):
        unknowns[2, i] += unknowns[4, i]
    for k in range(n):
        for q in range(rows[k]["branch"]):
            i = reached[k, q]
            rows[k]["free"] += Y[k, i] * values[diagonal + i] * unknowns[4, i]
    return True


@kernel
def _bound(table: Integers, n: int) -> float:
    """Impulses of the bounded rows; a rate that counts as none."""
    rows = at.rows(table)
    most = 0.0
    for k in range(n):
        most = max(most, abs(rows[k]["free"]))
    slack = 1e-13 + EXACT * most
    G = at.delassus(table)
    if n == 0 or (at.standing(table)[1] >= SETTLED and _as_before(rows, n, G)):
        return slack
    A, chosen = at.system(table), at.chosen(table)
    if solve_modes(rows, n, G, A, chosen, slack) < 0:
        relax(rows, n, G)
        if solve_modes(rows, n, G, A, chosen, slack) < 0:
            relax(rows, n, G)
            at.standing(table)[0] += 1
    return slack


@kernel
def _as_before(rows: Records, n: int, G: Array) -> bool:
    """Try the impulses of the last step: whether they leave all rows at rest, and may be."""
    for k in range(n):
        row = rows[k]
        if row["normal"] < 0 and not row["low"] <= row["last"] <= row["high"]:
            return False
        y = row["free"]
        for q in range(n):
            y += G[k, q] * rows[q]["last"]
        if abs(y) > STILL:
            return False
    for k in range(n):
        rows[k]["p"] = rows[k]["last"]
    return True


@kernel
def _rest(table: Integers) -> None:
    """Let bodies stand that move by no more than rounding, all of them or none.

    A step that begins and ends so is the same as the next, if nothing is changed from outside.
    """
    velocity, count = at.velocity(table), at.standing(table)
    before, count[1] = count[1], 0
    for b in range(len(velocity)):
        if not (abs(velocity[b, 0]) < STILL and abs(velocity[b, 1]) < STILL
                and abs(velocity[b, 2]) < STILL_TURNING):
            return
    for b in range(len(velocity)):
        velocity[b, 0] = velocity[b, 1] = velocity[b, 2] = 0.0
    count[1] = min(before + 1, SETTLED + 2)


@kernel
def _velocities(table: Integers, n: int) -> None:
    """The unknowns and the velocities that the impulses of the rows lead to."""
    unknowns, rows, Y, reached = (
        at.unknowns(table), at.rows(table), at.columns(table), at.reached(table))
    free, velocity, inverse_mass = at.free(table), at.velocity(table), at.inverse_mass(table)
    for i in range(unknowns.shape[1]):
        unknowns[3, i] = unknowns[2, i]
    for k in range(n):
        p = rows[k]["p"]
        if p != 0.0:
            for q in range(rows[k]["branch"]):
                i = reached[k, q]
                unknowns[3, i] -= Y[k, i] * p
    backward(at.starts(table), at.below(table), at.values(table), unknowns[3])
    for b in range(len(free)):
        for j in range(3):
            velocity[b, j] = free[b, j]
    spread(table, unknowns[3], velocity)
    for k in range(n):
        _push(inverse_mass, rows[k], rows[k]["p"], velocity)


@kernel
def _push(inverse_mass: Array, row: Any, p: float, velocity: Array) -> None:
    """Add what an impulse of a bounded row does to the velocities of its bodies."""
    a, b = row["a"], row["b"]
    wa, wb = inverse_mass[a, 0] * p, inverse_mass[b, 0] * p
    velocity[a, 0] += wa * row["ax"]
    velocity[a, 1] += wa * row["ay"]
    velocity[a, 2] += inverse_mass[a, 1] * p * row["at"]
    velocity[b, 0] += wb * row["bx"]
    velocity[b, 1] += wb * row["by"]
    velocity[b, 2] += inverse_mass[b, 1] * p * row["bt"]


# -- which rows there are ----------------------------------------------------------------


@kernel
def returning(h: float, gap: float, fastest: float) -> float:
    """What a row adds to its rate for its gap: all of it may go in this step, an overlap too."""
    return max(beyond(gap) / h, -fastest)


@kernel
def _touch_row(h: float, touches: Records, i: int, out: Any) -> None:
    t = touches[i]
    nx, ny = t["nx"], t["ny"]
    out["source"], out["index"], out["normal"] = NORMAL, i, -1
    out["a"], out["b"] = t["a"], t["b"]
    out["ax"], out["ay"], out["bx"], out["by"] = -nx, -ny, nx, ny
    out["at"], out["bt"] = t["ay"] * nx - t["ax"] * ny, t["bx"] * ny - t["by"] * nx
    out["want"] = returning(h, t["gap"], RETURN)
    out["low"], out["high"], out["friction"] = 0.0, 1e300, 0.0
    out["last"], out["mode"], out["branch"] = t["normal"], 0, 0


@kernel
def _rub_row(touches: Records, i: int, normal: int, out: Any) -> None:
    t = touches[i]
    x, y = -t["ny"], t["nx"]
    out["source"], out["index"], out["normal"] = TANGENT, i, normal
    out["a"], out["b"] = t["a"], t["b"]
    out["ax"], out["ay"], out["bx"], out["by"] = -x, -y, x, y
    out["at"], out["bt"] = t["ay"] * x - t["ax"] * y, t["bx"] * y - t["by"] * x
    out["want"], out["low"], out["high"], out["friction"] = 0.0, 0.0, 0.0, t["friction"]
    out["last"], out["mode"], out["branch"] = t["tangent"], t["mode"], 0


@kernel
def _limit_row(table: Integers, h: float, i: int, out: Any) -> None:
    limit = at.limits(table)[i]
    joint, way = at.joints(table)[limit["joint"]], at.joint_results(table)[limit["joint"]]
    side, a, b = limit["side"], joint["a"], joint["b"]
    out["source"], out["index"], out["normal"], out["friction"] = LIMITED, i, -1, 0.0
    out["a"], out["b"], out["low"], out["high"], out["branch"] = a, b, 0.0, 1e300, 0
    out["last"], out["mode"] = at.limit_states(table)[i]["impulse"], 0
    if limit["what"] == STOP:
        out["ax"] = out["ay"] = out["bx"] = out["by"] = 0.0
        out["at"], out["bt"] = -side, side
        body = at.body(table)
        gap = side * (body[b, 2] - body[a, 2] - limit["bound"])
        out["want"] = returning(h, gap, RETURN_TURNING)
        return
    out["ax"], out["ay"], out["at"] = -side * way["dx"], -side * way["dy"], side * way["ta"]
    out["bx"], out["by"], out["bt"] = side * way["dx"], side * way["dy"], side * way["tb"]
    out["want"] = returning(h, side * (way["way"] - limit["bound"]), RETURN)


@kernel
def _motor_row(h: float, motors: Records, states: Records, drive: Array, i: int, out: Any) -> None:
    motor = motors[i]
    value = drive[motor["drive"]]
    brake = motor["most"] != motor["most"]
    most = h * (value if brake else motor["most"])
    out["source"], out["index"], out["normal"], out["friction"] = DRIVEN, i, -1, 0.0
    out["a"], out["b"], out["branch"] = motor["a"], motor["b"], 0
    out["low"], out["high"] = -most, most
    out["ax"] = out["ay"] = out["bx"] = out["by"] = 0.0
    out["at"], out["bt"] = -1.0, 1.0
    out["want"] = 0.0 if brake else -motor["sense"] * value
    out["last"], out["mode"] = states[i]["impulse"], states[i]["mode"]


@kernel
def _kept(table: Integers, h: float, drive: Array) -> int:
    """Begin with the motors and with what carried something in the last step; how many rows."""
    rows, touches, limits = at.rows(table), at.touches(table), at.limit_states(table)
    motors, motor_states = at.motors(table), at.motor_states(table)
    n, room = 0, len(rows) - 2
    for i in range(len(motors)):
        if n < room:
            _motor_row(h, motors, motor_states, drive, i, rows[n])
            n += 1
    for i in range(len(limits)):
        if limits[i]["impulse"] > 0.0 and n < room:
            _limit_row(table, h, i, rows[n])
            n += 1
    for i in range(at.touching(table)[0]):
        if touches[i]["listed"] and n < room:
            n = _with_touch(h, touches, rows, i, n)
    return n


@kernel
def _with_touch(h: float, touches: Records, rows: Records, i: int, n: int) -> int:
    """Add the rows of a contact."""
    _touch_row(h, touches, i, rows[n])
    touches[i]["listed"] = 1
    if touches[i]["friction"] > 0.0:
        _rub_row(touches, i, n, rows[n + 1])
        return n + 2
    return n + 1


@kernel
def _broken(table: Integers, h: float, n: int, slack: float) -> int:
    """Add the limits and contacts that the velocities break; how many rows, -1 for no room."""
    rows, touches, velocity = at.rows(table), at.touches(table), at.velocity(table)
    first, room = n, len(rows) - 2
    for i in range(len(at.limits(table))):
        if n >= room:
            return -1
        _limit_row(table, h, i, rows[n])
        if (rate(rows[n], velocity) + rows[n]["want"]) < -slack and not _in(rows, first, LIMITED, i):
            n += 1
    for i in range(at.touching(table)[0]):
        if not touches[i]["listed"]:
            if n >= room:
                return -1
            _touch_row(h, touches, i, rows[n])
            if (rate(rows[n], velocity) + rows[n]["want"]) < -slack:
                n = _with_touch(h, touches, rows, i, n)
    return n


@kernel
def _in(rows: Records, n: int, source: int, index: int) -> bool:
    found = False
    for k in range(n):
        found |= rows[k]["source"] == source and rows[k]["index"] == index
    return found


# -- cords, impacts, results -------------------------------------------------------------


@kernel
def _slacken(table: Integers) -> None:
    """Let go of all cords that are not stretched: their dampers do not pull before they do."""
    cords, states, results = at.cords(table), at.cord_states(table), at.cord_results(table)
    for i in range(len(cords)):
        if results[i]["length"] <= cords[i]["rest"]:
            states[i]["active"] = 0


@kernel
def _change_cords(table: Integers, h: float, attempt: int) -> bool:
    """Let go of cords that would push, take up those that would pull; whether there were any.

    A slack one is taken up only where it is stretched: a stiff one in this step, a soft one now.
    All at once at first, later the one that is furthest off.
    """
    cords, states, results = at.cords(table), at.cord_states(table), at.cord_results(table)
    guides, pulls, unknown = at.guides(table), at.guide_results(table), at.unknowns(table)[3]
    changed, worst, which = False, 0.0, -1
    for i in range(len(cords)):
        cord = cords[i]
        if cord["row"] < 0:
            continue
        if states[i]["active"]:
            off = -unknown[cord["row"]]
        else:
            gone = shortening(cord, guides, pulls, at.velocity(table))
            stretch = results[i]["length"] - cord["rest"]
            if stretch <= (h * gone if cord["kind"] == STIFF else 0.0):
                continue
            asked = asked_by_cord(h, cord, results[i]["length"], guides, pulls, at.before(table))
            off = asked - gone
            off /= 1.0 / (h * (cord["c"] + h * cord["k"])) + cord["response"]
        if off > 0.0:
            changed = True
            if attempt < 3:
                states[i]["active"] = 1 - states[i]["active"]
            elif off > worst:
                worst, which = off, i
    if which >= 0:
        states[which]["active"] = 1 - states[which]["active"]
    return changed


@kernel
def _approaching(table: Integers, h: float, rows: Records) -> int:
    """Rows of the contacts that give back speed and are near enough; 0 if none is hit."""
    touches, before = at.touches(table), at.before(table)
    n, hit = 0, False
    for i in range(at.touching(table)[0]):
        t = touches[i]
        if t["restitution"] > 0.0 and n < len(rows):
            _touch_row(h, touches, i, rows[n])
            rows[n]["want"], rows[n]["p"] = 0.0, 0.0
            u = rate(rows[n], before)
            reaches = h * u + t["gap"] < 0.0 or t["late"] == 1
            if u < -REBOUND and reaches:
                hit = True
            if reaches or t["gap"] <= h * REBOUND:
                n += 1
    return n if hit else 0


@kernel
def _late_hits(table: Integers, n: int) -> bool:
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
        m, fastest = 0, 0.0
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
        left = 0
        for r in range(m):
            if A[r, m] >= 0.0:
                chosen[left] = chosen[r]
                left += 1
        if left == m:
            return m
        m = left


@kernel
def _impacts(table: Integers, h: float) -> None:
    """Reflect approaches; the contacts' impulses go to the free velocities.

    What joints, cords and dampers make of them is found with all else that they carry.
    """
    begin = len(at.rows(table)) // 2
    rows, Y, reached = (
        at.rows(table)[begin:], at.columns(table)[begin:], at.reached(table)[begin:])
    n = _approaching(table, h, rows)
    if n == 0:
        return
    columns(table, rows, 0, n, Y, reached)
    couple(table, rows, 0, n, Y, reached)
    touches, before, G = at.touches(table), at.before(table), at.delassus(table)
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
        _push(at.inverse_mass(table), rows[k], rows[k]["p"], kick)
    for b in range(len(free)):
        for j in range(3):
            free[b, j] += kick[b, j]
    wipe(rows, n, Y, reached)


@kernel
def _report(table: Integers, h: float, n: int) -> None:
    """Impulses into the tables of their elements."""
    unknown = at.unknowns(table)[3]
    dampers, damper_states = at.dampers(table), at.damper_states(table)
    for i in range(len(dampers)):
        damper_states[i]["torque"] = unknown[dampers[i]["row"]] / h
    actions, action_results = at.actions(table), at.action_results(table)
    for i in range(len(actions)):
        if actions[i]["row"] >= 0:
            action_results[i]["torque"] = unknown[actions[i]["row"]] / h
    springs, spring_results = at.springs(table), at.spring_results(table)
    for i in range(len(springs)):
        if springs[i]["row"] >= 0:
            spring_results[i]["force"] = unknown[springs[i]["row"]] / h
    cords, cord_states, cord_results = (
        at.cords(table), at.cord_states(table), at.cord_results(table))
    for i in range(len(cords)):
        if cords[i]["row"] >= 0:
            pulls = unknown[cords[i]["row"]] / h
            cord_results[i]["tension"] = max(pulls, 0.0) if cord_states[i]["active"] else 0.0
    joints, joint_results = at.joints(table), at.joint_results(table)
    for i in range(len(joints)):
        _joint_force(h, joints[i], joint_results[i], unknown)
    _report_bounded(table, h, n)


@kernel
def _report_bounded(table: Integers, h: float, n: int) -> None:
    rows, touches, motors = at.rows(table), at.touches(table), at.motor_states(table)
    limits, states, results = at.limits(table), at.limit_states(table), at.joint_results(table)
    for i in range(len(states)):
        states[i]["impulse"] = 0.0
    for i in range(at.touching(table)[0]):
        t = touches[i]
        t["normal"] = t["tangent"] = 0.0
        t["mode"] = t["listed"] = 0
    for k in range(n):
        row = rows[k]
        i, p = row["index"], row["p"]
        if row["source"] == NORMAL:
            touches[i]["normal"] = max(p, 0.0)
            touches[i]["listed"] = 1 if p > 0.0 else 0
        elif row["source"] == TANGENT:
            touches[i]["tangent"], touches[i]["mode"] = p, row["mode"]
        elif row["source"] == LIMITED:
            states[i]["impulse"] = max(p, 0.0)
            if limits[i]["what"] == LINE:
                out = results[limits[i]["joint"]]
                out["fx"] += limits[i]["side"] * out["dx"] * max(p, 0.0) / h
                out["fy"] += limits[i]["side"] * out["dy"] * max(p, 0.0) / h
        else:
            motors[i]["impulse"], motors[i]["mode"] = p, row["mode"]


@kernel
def _joint_force(h: float, joint: Any, out: Any, unknown: Array) -> None:
    out["fx"] = out["fy"] = out["couple"] = 0.0
    if joint["row"] >= 0:
        p = unknown[joint["row"]] / h
        if joint["keeps"] == POINT:
            out["fx"], out["fy"] = p, unknown[joint["row_y"]] / h
        elif joint["keeps"] == GROOVE:
            out["fx"], out["fy"] = -out["dy"] * p, out["dx"] * p
        elif joint["keeps"] == DISTANCE:
            out["fx"], out["fy"] = out["dx"] * p, out["dy"] * p
    if joint["row_turn"] >= 0:
        out["couple"] = unknown[joint["row_turn"]] / h

