"""The one solve of a step: all that joints, dampers, cords, limits, motors and contacts carry.

pymunk has moved the bodies to the poses x of the step and found what is near. With W the inverse
masses, f the forces that the poses tell, B the bilateral rows and C those with bounds,

    v = v_before + h W f + W B^T p_b + W C^T p_c

gives the velocities v at the step's end. B is factored once (:mod:`sandbox.engine.factor`), the
rows C are solved on what it leaves (:mod:`sandbox.engine.bounded`); only those come in that carry
something or would be broken without. Whether cords are taut is tried last.

Contacts that give back speed do so before all forces, one after the other, the fastest approach
first, as long as any approaches: five balls in a row that touch then hand on what hits them.
"""

from __future__ import annotations

from typing import Any

from numba import njit

from sandbox.engine.bounded import columns, couple, relax, solve_modes, wipe
from sandbox.engine.factor import assemble, backward, factor, forward
from sandbox.engine.fingerprint import KERNELS
from sandbox.engine.rows import (
    asked_by_cord,
    cord_rows,
    damper_rows,
    joint_gaps,
    joint_rows,
    right_side,
    shortening,
    spread,
    spring_rows,
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
    STOP,
    TANGENT,
    Constants,
    Result,
    State,
)
from sandbox.numeric import Array, Records

HARD = 1e-12
"""Compliance of rigid rows, as a share of what the masses give: redundant ones share by it."""
ROUNDS = 12
"""Most times that rows are added, or cords let go and taken up, in one step."""
CLOSED, CLOSINGS = 1e-10, 3
"""A gap [m] that a joint may be left with by a step; most times that it is solved again for less."""
RETURN, RETURN_TURNING = 0.1, 1.0
"""The fastest that an overlap is undone [m/s], an overrun stop [rad/s]: nothing is thrown."""
REBOUND = 0.01
"""A slower approach [m/s] gives nothing back."""
FAINT = 1e-6
"""Approaches that small against the first end a chain of impacts."""
EXACT = 1e-10
"""Rates that count as none, as a share of the largest that the rows see."""


def _compiled(sources: int) -> Any:
    @njit(cache=True, error_model="numpy")
    def solve(constants: Constants, state: State, result: Result, drive: Array) -> bool:
        """Find ``result.velocity`` from ``result.free``; False if there was no room for all rows.

        ``drive`` [nd] holds the values of the drives at the step's instant.
        """
        assert sources != 0  # see sandbox.engine.fingerprint
        c, s, r = constants, state, result
        h, J, WJ = c.h, r.entries[0], r.entries[1]
        asked, compliance, solved = r.unknowns[0], r.unknowns[1], r.unknowns[2]
        unknown, diagonal = r.unknowns[3], c.starts[len(c.starts) - 1]
        touching = s.touching[0]
        joint_rows(h, c.joints, r.joints, s.body, r.turn, r.before, J, asked)
        damper_rows(h, c.dampers, r.before, J, asked, compliance)
        spring_rows(h, c.springs, r.springs, drive, r.before, J, asked, compliance)
        n = _kept(c, s, r, drive, 0)
        enough = True
        for attempt in range(ROUNDS):
            cord_rows(h, c.cords, s.cords, r.cords, c.guides, r.guides, r.before, J, asked,
                      compliance)
            weigh(c.entry_body, c.inverse_mass, J, WJ)
            assemble(c.pairs, c.direct, J, WJ, r.values)
            for i in range(len(asked)):
                x = r.values[diagonal + i] * (1.0 + HARD) + compliance[i]
                r.values[diagonal + i] = x if x != 0.0 else 1.0
            factor(c.starts, c.below, c.updates, r.values, r.unknowns[4])
            if attempt == 0 and touching > 0:
                _impacts(c, s, r, touching)
            right_side(c.entry_row, c.entry_body, c.hubs, c.inverse_mass, r.free, J, asked, solved)
            forward(c.starts, c.below, r.values, solved)
            done = closed = 0
            for _ in range(ROUNDS):
                columns(r.rows, done, n, c.hubs, c.body_starts, c.body_entries, c.entry_row, WJ,
                        c.branch_starts, c.branches, c.starts, c.below, r.values, r.columns,
                        r.branches)
                couple(r.rows, done, n, c.inverse_mass, c.hubs, r.free, r.values, diagonal,
                       solved, r.columns, r.branches, r.delassus)
                done = n
                slack = _bound(r, n)
                _velocities(c, r, n, solved, unknown)
                n = _broken(c, s, r, n, slack)
                if n < 0:
                    enough, n = False, done
                if n == done and not (closed < CLOSINGS and _close(c, s, r, n, solved)):
                    break
                closed += n == done
            wipe(r.rows, n, r.columns, r.branches)
            if not _change_cords(h, c, s, r, unknown, attempt):
                break
        _report(h, c, s, r, n, unknown)
        return enough

    return solve


@njit(cache=True, error_model="numpy")
def _close(c: Constants, s: State, r: Result, n: int, solved: Array) -> bool:
    """Ask for what leaves joints open where the velocities lead; whether that is worth a solve."""
    more = r.unknowns[4]
    for i in range(len(more)):
        more[i] = 0.0
    if joint_gaps(c.h, c.joints, s.body, r.velocity, more) < CLOSED:
        return False
    forward(c.starts, c.below, r.values, more)
    diagonal = c.starts[len(c.starts) - 1]
    for i in range(len(more)):
        solved[i] += more[i]
    for k in range(n):
        for q in range(r.rows[k]["branch"]):
            i = r.branches[k, q]
            r.rows[k]["free"] += r.columns[k, i] * r.values[diagonal + i] * more[i]
    return True


@njit(cache=True, error_model="numpy")
def _bound(r: Result, n: int) -> float:
    """Impulses of the bounded rows; a rate that counts as none."""
    most = 0.0
    for k in range(n):
        most = max(most, abs(r.rows[k]["free"]))
    slack = 1e-13 + EXACT * most
    if n > 0 and solve_modes(r.rows, n, r.delassus, r.system, r.chosen, slack) < 0:
        relax(r.rows, n, r.delassus)
        r.count[1] += 1
    return slack


@njit(cache=True, error_model="numpy")
def _velocities(c: Constants, r: Result, n: int, solved: Array, unknown: Array) -> None:
    """The unknowns and the velocities that the impulses of the rows lead to."""
    for i in range(len(unknown)):
        unknown[i] = solved[i]
    for k in range(n):
        p = r.rows[k]["p"]
        if p != 0.0:
            for q in range(r.rows[k]["branch"]):
                i = r.branches[k, q]
                unknown[i] -= r.columns[k, i] * p
    backward(c.starts, c.below, r.values, unknown)
    for b in range(len(r.free)):
        for j in range(3):
            r.velocity[b, j] = r.free[b, j]
    spread(c.entry_row, c.entry_body, r.entries[1], unknown, r.velocity)
    for k in range(n):
        _push(c.inverse_mass, r.rows[k], r.rows[k]["p"], r.velocity)


@njit(cache=True, error_model="numpy")
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


@njit(cache=True, error_model="numpy")
def _seen(row: Any, velocity: Array) -> float:
    """The rate y of a row."""
    a, b = row["a"], row["b"]
    return float(
        row["want"] + row["ax"] * velocity[a, 0] + row["ay"] * velocity[a, 1]
        + row["at"] * velocity[a, 2] + row["bx"] * velocity[b, 0] + row["by"] * velocity[b, 1]
        + row["bt"] * velocity[b, 2])


# -- which rows there are ----------------------------------------------------------------


@njit(cache=True, error_model="numpy")
def returning(h: float, gap: float, fastest: float) -> float:
    """What a row adds to its rate for its gap: all of it may go in this step, an overlap too."""
    return max(gap / h, -fastest)


@njit(cache=True, error_model="numpy")
def _touch_row(h: float, touches: Records, i: int, out: Any) -> None:
    t = touches[i]
    nx, ny = t["nx"], t["ny"]
    out["source"], out["index"], out["normal"] = NORMAL, i, -1
    out["a"], out["b"], out["ax"], out["ay"], out["bx"], out["by"] = t["a"], t["b"], -nx, -ny, nx, ny
    out["at"], out["bt"] = t["ay"] * nx - t["ax"] * ny, t["bx"] * ny - t["by"] * nx
    out["want"] = returning(h, t["gap"], RETURN)
    out["low"], out["high"], out["friction"] = 0.0, 1e300, 0.0
    out["last"], out["mode"], out["branch"] = t["normal"], 0, 0


@njit(cache=True, error_model="numpy")
def _rub_row(touches: Records, i: int, normal: int, out: Any) -> None:
    t = touches[i]
    x, y = -t["ny"], t["nx"]
    out["source"], out["index"], out["normal"] = TANGENT, i, normal
    out["a"], out["b"], out["ax"], out["ay"], out["bx"], out["by"] = t["a"], t["b"], -x, -y, x, y
    out["at"], out["bt"] = t["ay"] * x - t["ax"] * y, t["bx"] * y - t["by"] * x
    out["want"], out["low"], out["high"], out["friction"] = 0.0, 0.0, 0.0, t["friction"]
    out["last"], out["mode"], out["branch"] = t["tangent"], t["mode"], 0


@njit(cache=True, error_model="numpy")
def _limit_row(
    h: float, limits: Records, states: Records, joints: Records, results: Records, body: Array,
    i: int, out: Any,
) -> None:
    limit, joint = limits[i], joints[limits[i]["joint"]]
    way = results[limit["joint"]]
    side, a, b = limit["side"], joint["a"], joint["b"]
    out["source"], out["index"], out["normal"], out["friction"] = LIMITED, i, -1, 0.0
    out["a"], out["b"], out["low"], out["high"], out["branch"] = a, b, 0.0, 1e300, 0
    out["last"], out["mode"] = states[i]["impulse"], 0
    if limit["what"] == STOP:
        out["ax"] = out["ay"] = out["bx"] = out["by"] = 0.0
        out["at"], out["bt"] = -side, side
        gap = side * (body[b, 2] - body[a, 2] - limit["bound"])
        out["want"] = returning(h, gap, RETURN_TURNING)
        return
    out["ax"], out["ay"], out["at"] = -side * way["dx"], -side * way["dy"], side * way["ta"]
    out["bx"], out["by"], out["bt"] = side * way["dx"], side * way["dy"], side * way["tb"]
    out["want"] = returning(h, side * (way["way"] - limit["bound"]), RETURN)


@njit(cache=True, error_model="numpy")
def _motor_row(h: float, motors: Records, states: Records, drive: Array, i: int, out: Any) -> None:
    motor = motors[i]
    value = drive[motor["drive"]]
    brake = motor["most"] != motor["most"]
    most = h * (value if brake else motor["most"])
    out["source"], out["index"], out["normal"], out["friction"] = DRIVEN, i, -1, 0.0
    out["a"], out["b"], out["low"], out["high"], out["branch"] = motor["a"], motor["b"], -most, most, 0
    out["ax"] = out["ay"] = out["bx"] = out["by"] = 0.0
    out["at"], out["bt"] = -1.0, 1.0
    out["want"] = 0.0 if brake else -motor["sense"] * value
    out["last"], out["mode"] = states[i]["impulse"], states[i]["mode"]


@njit(cache=True, error_model="numpy")
def _kept(c: Constants, s: State, r: Result, drive: Array, n: int) -> int:
    """Begin with the motors and with what carried something in the last step; how many rows."""
    room = len(r.rows) - 2
    for i in range(len(c.motors)):
        if n < room:
            _motor_row(c.h, c.motors, s.motors, drive, i, r.rows[n])
            n += 1
    for i in range(len(c.limits)):
        if s.limits[i]["impulse"] > 0.0 and n < room:
            _limit_row(c.h, c.limits, s.limits, c.joints, r.joints, s.body, i, r.rows[n])
            n += 1
    for i in range(s.touching[0]):
        if s.touches[i]["listed"] and n < room:
            n = _with_touch(c.h, s.touches, r.rows, i, n)
    return n


@njit(cache=True, error_model="numpy")
def _with_touch(h: float, touches: Records, rows: Records, i: int, n: int) -> int:
    """Add the rows of a contact."""
    _touch_row(h, touches, i, rows[n])
    touches[i]["listed"] = 1
    if touches[i]["friction"] > 0.0:
        _rub_row(touches, i, n, rows[n + 1])
        return n + 2
    return n + 1


@njit(cache=True, error_model="numpy")
def _broken(c: Constants, s: State, r: Result, n: int, slack: float) -> int:
    """Add the limits and contacts that the velocities break; how many rows, -1 for no room."""
    first, room = n, len(r.rows) - 2
    for i in range(len(c.limits)):
        if n >= room:
            return -1
        _limit_row(c.h, c.limits, s.limits, c.joints, r.joints, s.body, i, r.rows[n])
        if _seen(r.rows[n], r.velocity) < -slack and not _in(r.rows, first, LIMITED, i):
            n += 1
    for i in range(s.touching[0]):
        if not s.touches[i]["listed"]:
            if n >= room:
                return -1
            _touch_row(c.h, s.touches, i, r.rows[n])
            if _seen(r.rows[n], r.velocity) < -slack:
                n = _with_touch(c.h, s.touches, r.rows, i, n)
    return n


@njit(cache=True, error_model="numpy")
def _in(rows: Records, n: int, source: int, index: int) -> bool:
    for k in range(n):
        if rows[k]["source"] == source and rows[k]["index"] == index:
            return True
    return False


# -- cords, impacts, results -------------------------------------------------------------


@njit(cache=True, error_model="numpy")
def _change_cords(
    h: float, c: Constants, s: State, r: Result, unknown: Array, attempt: int,
) -> bool:
    """Let go of cords that would push, take up those that would pull; whether there were any.

    All at once at first, later the one that is furthest off.
    """
    changed, worst, which = False, 0.0, -1
    for i in range(len(c.cords)):
        cord = c.cords[i]
        if cord["row"] < 0:
            continue
        if s.cords[i]["active"]:
            off = -unknown[cord["row"]]
        else:
            asked = asked_by_cord(h, cord, r.cords[i]["length"], c.guides, r.guides, r.before)
            off = asked - shortening(cord, c.guides, r.guides, r.velocity)
            off /= 1.0 / (h * (cord["c"] + h * cord["k"])) + cord["response"]
        if off > 0.0:
            changed = True
            if attempt < 3:
                s.cords[i]["active"] = not s.cords[i]["active"]
            elif off > worst:
                worst, which = off, i
    if which >= 0:
        s.cords[which]["active"] = not s.cords[which]["active"]
    return changed


@njit(cache=True, error_model="numpy")
def _impacts(c: Constants, s: State, r: Result, touching: int) -> None:
    """Reflect approaches, the fastest first; the change of velocities goes to ``r.free``."""
    n, room = 0, len(r.rows) // 2 - 1
    begin = len(r.rows) - room
    rows = r.rows[begin:]
    hit = False
    for i in range(touching):
        t = s.touches[i]
        if t["restitution"] > 0.0 and n < room:
            _touch_row(c.h, s.touches, i, rows[n])
            rows[n]["want"] = 0.0
            u = _seen(rows[n], r.before)
            rows[n]["free"], rows[n]["p"] = u, 0.0
            if u < -REBOUND and c.h * u + t["gap"] < 0.0:
                hit = True
            if t["gap"] < -c.h * u or t["gap"] <= c.h * REBOUND:
                n += 1
    if not hit:
        return
    Y, reached, G = r.columns[begin:], r.branches[begin:], r.delassus
    columns(rows, 0, n, c.hubs, c.body_starts, c.body_entries, c.entry_row, r.entries[1],
            c.branch_starts, c.branches, c.starts, c.below, r.values, Y, reached)
    for i in range(len(r.unknowns[4])):
        r.unknowns[4, i] = 0.0
    diagonal = c.starts[len(c.starts) - 1]
    couple(rows, 0, n, c.inverse_mass, c.hubs, r.before, r.values, diagonal, r.unknowns[4], Y,
           reached, G)
    for k in range(n):
        rows[k]["free"] = _seen(rows[k], r.before)
    end = -REBOUND
    for _ in range(100 * n):
        which, fastest = -1, end
        for k in range(n):
            if rows[k]["free"] < fastest:
                which, fastest = k, rows[k]["free"]
        if which < 0:
            break
        end = max(end, FAINT * fastest)
        e = s.touches[rows[which]["index"]]["restitution"]
        p = -(1.0 + e) * fastest / G[which, which]
        rows[which]["p"] += p
        for k in range(n):
            rows[k]["free"] += G[k, which] * p
    impulse = r.unknowns[4]
    for k in range(n):
        s.touches[rows[k]["index"]]["bounce"] = rows[k]["p"]
        for q in range(rows[k]["branch"]):
            i = reached[k, q]
            impulse[i] -= Y[k, i] * rows[k]["p"]
    backward(c.starts, c.below, r.values, impulse)
    spread(c.entry_row, c.entry_body, r.entries[1], impulse, r.free)
    for k in range(n):
        _push(c.inverse_mass, rows[k], rows[k]["p"], r.free)
    wipe(rows, n, Y, reached)


@njit(cache=True, error_model="numpy")
def _report(h: float, c: Constants, s: State, r: Result, n: int, unknown: Array) -> None:
    """Impulses into the tables of their elements."""
    for i in range(len(c.dampers)):
        s.dampers[i]["torque"] = unknown[c.dampers[i]["row"]] / h
    for i in range(len(c.springs)):
        if c.springs[i]["row"] >= 0:
            r.springs[i]["force"] = unknown[c.springs[i]["row"]] / h
    for i in range(len(c.cords)):
        if c.cords[i]["row"] >= 0:
            pulls = unknown[c.cords[i]["row"]] / h
            r.cords[i]["tension"] = max(pulls, 0.0) if s.cords[i]["active"] else 0.0
    for i in range(len(c.joints)):
        _joint_force(h, c.joints[i], r.joints[i], unknown)
    for i in range(len(c.limits)):
        s.limits[i]["impulse"] = 0.0
    for i in range(s.touching[0]):
        t = s.touches[i]
        t["normal"] = t["tangent"] = 0.0
        t["mode"] = t["listed"] = 0
    for k in range(n):
        row = r.rows[k]
        i, p = row["index"], row["p"]
        if row["source"] == NORMAL:
            s.touches[i]["normal"] = max(p, 0.0)
            s.touches[i]["listed"] = p > 0.0
        elif row["source"] == TANGENT:
            s.touches[i]["tangent"], s.touches[i]["mode"] = p, row["mode"]
        elif row["source"] == LIMITED:
            p = max(p, 0.0)
            s.limits[i]["impulse"] = p
            if c.limits[i]["what"] == LINE:
                out = r.joints[c.limits[i]["joint"]]
                out["fx"] += c.limits[i]["side"] * out["dx"] * p / h
                out["fy"] += c.limits[i]["side"] * out["dy"] * p / h
        else:
            s.motors[i]["impulse"], s.motors[i]["mode"] = p, row["mode"]


@njit(cache=True, error_model="numpy")
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


solve = _compiled(KERNELS)
