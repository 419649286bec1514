"""The bilateral rows of joints.

At the pose x of the step, with W the inverse masses and v_f the velocities by all known forces,
impulses p of the rows B give v = v_f + W B^T p. The row of a joint is

    B v = - gap / h

minus h/2 times the acceleration of its gap at the velocities before. Then :func:`joint_gaps` finds
the gaps that are open after the step, and the rows close these, too (SHAKE, solved to the end).
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import coordinates as q
from sandbox.engine import memory as at
from sandbox.engine.bonds import holds, remaining_gap
from sandbox.engine.curves import CONFORMING, nearest_start
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.plan import clear
from sandbox.engine.records import GROOVE, POINT, RANGE, ROLL
from sandbox.numeric import Array, Records

MIN_LEAD = 1e-100  # minimum lead of a row [N s/m]
CLOSED = 1e-6  # gaps left by a step, over h^2 [m/s^2]: closing them takes this times the mass
NOTHING = 1e-13  # gap [m, rad] within rounding, which is left: redundant rows cannot close it


@entry_point("paths")
def path_row(table: int, h: float, k: int) -> None:
    """The row of a slot with a path, normal to it at its point; the place and direction there.

    For velocities u of the point against ``a``, the gap g to the left of the path bends by
    n . a - κ (t . u)^2 / (1 - κ g), with a the acceleration of the point against ``a``.
    """
    joint = at.joints(table)[k]
    body, before, turn, spans = at.body(table), at.before(table), at.turn(table), at.spans(table)
    a, b, e, r = joint["a"], joint["b"], joint["entry"], joint["row"]
    ax, ay, bx, by, px, py = q.ends(joint, body, turn)
    qx, qy, c, s = ax + px, ay + py, turn[a, 0], turn[a, 1]
    x, y = c * qx + s * qy, c * qy - s * qx
    if not holds(table, joint["bond"]):
        joint["on"] = nearest_start(spans, joint["span"], joint["span_end"], x, y)
    joint["on"], place, tx, ty, across, curve = q.on_path(spans, joint["on"], x, y)
    if joint["around"] > 0.0:
        place += joint["around"] * math.floor((joint["place"] - place) / joint["around"] + 0.5)
    joint["place"] = place
    dx, dy = c * tx - s * ty, s * tx + c * ty
    joint["way"], joint["dx"], joint["dy"] = place, dx, dy
    joint["ta"], joint["tb"] = qy * dx - qx * dy, bx * dy - by * dx
    if r < 0:
        return
    J = at.entries(table)[0]
    q.set_row(J, e, -dy, dx, -(qx * dx + qy * dy), bx * dx + by * dy)
    wa, wb, along = before[a, 2], before[b, 2], q.rate(joint, before)
    bend = (wa * wa * (dx * qy - dy * qx) - wb * wb * (dx * by - dy * bx) - 2.0 * wa * along
            - curve * along * along / max(1.0 - curve * across, CONFORMING))
    at.unknowns(table)[0][r] = -beyond(across) / h - h / 2 * bend


@kernel
def beyond(gap: float) -> float:
    """The part of a gap beyond :data:`NOTHING`."""
    return gap - min(max(gap, -NOTHING), NOTHING)


@kernel
def closed(h: float) -> float:
    """Tolerance of the gap of a joint after a step [m]."""
    return max(CLOSED * h * h, 2 * NOTHING)


@entry_point()
def joint_rows(table: int, h: float) -> None:
    """Coefficients and right sides of all joints; ``results`` get their free coordinates."""
    joints, body, turn, before = at.joints(table), at.body(table), at.turn(table), at.before(table)
    J, rhs = at.entries(table)[0], at.unknowns(table)[0]
    for k in range(len(joints)):
        joint = joints[k]
        a, b, e = joint["a"], joint["b"], joint["entry"]
        ax, ay, bx, by, px, py = q.ends(joint, body, turn)
        wa, wb = before[a, 2], before[b, 2]
        # how the points' distance bends away from its tangent as both bodies turn
        kx, ky = wa * wa * ax - wb * wb * bx, wa * wa * ay - wb * wb * by
        if joint["keeps"] != POINT:
            vx = before[b, 0] - wb * by - before[a, 0] + wa * ay
            vy = before[b, 1] + wb * bx - before[a, 1] - wa * ax
        if q.toothed(joint):
            teeth_row(table, h, k)
            continue
        if joint["keeps"] == POINT:
            if joint["row"] >= 0:
                q.set_row(J, e, 1.0, 0.0, ay, -by)
                q.set_row(J, e + 2, 0.0, 1.0, -ax, bx)
                rhs[joint["row"]] = -beyond(px) / h - h / 2 * kx
                rhs[joint["row_y"]] = -beyond(py) / h - h / 2 * ky
            q.measure_angle(joint, body)
            e += 4
        elif joint["keeps"] == GROOVE and joint["span"] >= 0:
            path_row(table, h, k)
            e += 2
        elif joint["keeps"] == GROOVE:
            c, s = turn[a, 0], turn[a, 1]
            dx, dy = c * joint["gx"] - s * joint["gy"], s * joint["gx"] + c * joint["gy"]
            qx, qy = ax + px, ay + py
            joint["way"], joint["dx"], joint["dy"] = dx * px + dy * py, dx, dy
            joint["ta"], joint["tb"] = qy * dx - qx * dy, bx * dy - by * dx
            if joint["row"] >= 0:
                q.set_row(J, e, -dy, dx, -(qx * dx + qy * dy), bx * dx + by * dy)
                across = dx * py - dy * px
                bend = dx * ky - dy * kx - wa * wa * across - 2.0 * wa * (dx * vx + dy * vy)
                rhs[joint["row"]] = -beyond(across) / h - h / 2 * bend
            e += 2
        else:
            way = math.hypot(px, py)
            ux, uy = (px / way, py / way) if way > 0.0 else (1.0, 0.0)
            joint["way"], joint["dx"], joint["dy"] = way, ux, uy
            joint["ta"], joint["tb"] = ay * ux - ax * uy, bx * uy - by * ux
            if joint["row"] >= 0:  # a rope has none
                q.put_row(J, e, joint)
                bend = ux * kx + uy * ky + (ux * vy - uy * vx) ** 2 / way
                rhs[joint["row"]] = beyond(joint["reach"] - way) / h - h / 2 * bend
                e += 2
            if joint["keeps"] == ROLL:
                rolling_row(table, h, k, ax * ux + ay * uy, bx * ux + by * uy)
        if joint["row_turn"] >= 0:
            q.set_row(J, e, 0.0, 0.0, -1.0, 1.0)
            rhs[joint["row_turn"]] = -beyond(body[b, 2] - body[a, 2] - joint["turn"]) / h


@kernel
def _ahead(gap: float, then: float, J: Array, joint: Any, before: Array, h: float) -> float:
    """Right side of a joint's row that closes its gap now and ``then``, in a step."""
    seen = 0.0
    for n in range(3):
        seen += J[0, n] * before[joint["a"], n] + J[1, n] * before[joint["b"], n]
    return float(-beyond(gap) / h - (then - gap - h * seen) / h)


@entry_point("teeth")
def teeth_row(table: int, h: float, k: int) -> None:
    """The row of teeth without play; those with play are limits."""
    joint, before = at.joints(table)[k], at.before(table)
    J, e, r = at.entries(table)[0], joint["entry"], joint["row"]
    if r < 0:
        return
    side = joint["flank"]
    gap, ux, uy, on_a, on_b = q.flank(joint, side, 0.0, at.body(table), before)
    joint["dx"], joint["dy"] = ux, uy
    q.set_row(J, e, ux, uy, on_a, on_b)
    then = q.flank(joint, side, h, at.body(table), before)[0]
    at.unknowns(table)[0][r] = _ahead(gap, then, J[e:e + 2], joint, before, h)
    at.unknowns(table)[1][r] = 1.0 / (h * h * joint["k"])


@entry_point("teeth")
def rolling_row(table: int, h: float, k: int, on_a: float, on_b: float) -> None:
    """The row that keeps circles from slipping; ``on_a``, ``on_b`` from bodies to centres [m]."""
    joint = at.joints(table)[k]
    body, before = at.body(table), at.before(table)
    J, e, r = at.entries(table)[0], joint["entry"] + 2, joint["row_y"]
    if r < 0:
        return
    ra, rb, ux, uy = joint["ra"], joint["rb"], joint["dx"], joint["dy"]
    lever = (ra + rb) / joint["way"]
    q.set_row(J, e, lever * uy, -lever * ux, ra + lever * on_a, rb - lever * on_b)
    at.unknowns(table)[0][r] = _ahead(
        q.rolled(joint, 0.0, body, before), q.rolled(joint, h, body, before), J[e:e + 2], joint,
        before, h)


@entry_point("teeth")
def wheel_gap(table: int, h: float, k: int) -> float:
    """Gap of the teeth, or slip of the circles, of joint ``k`` one step on [m]."""
    joint = at.joints(table)[k]
    if joint["keeps"] == ROLL:
        return float(q.rolled(joint, h, at.body(table), at.velocity(table)))
    return float(q.flank(joint, joint["flank"], h, at.body(table), at.velocity(table))[0])


@kernel
def _bends(joints: Records, h: float, velocity: Array) -> bool:
    """Whether any joint's points leave their tangents by more than nothing in a step."""
    for k in range(len(joints)):
        joint = joints[k]
        a, b = joint["a"], joint["b"]
        bend = ((abs(joint["ax"]) + abs(joint["ay"])) * velocity[a, 2] ** 2
                + (abs(joint["bx"]) + abs(joint["by"])) * velocity[b, 2] ** 2)
        if joint["keeps"] >= GROOVE and joint["keeps"] != RANGE:
            bend += ((velocity[b, 0] - velocity[a, 0]) ** 2
                     + (velocity[b, 1] - velocity[a, 1]) ** 2) / joint["reach"]
        if h * h * bend > closed(h):
            return True
    return False


@entry_point()
def joint_gaps(table: int, h: float) -> float:
    """Set rates that close the gaps of joints after the step, in the scratch; the largest gap."""
    joints, body, velocity = at.joints(table), at.body(table), at.velocity(table)
    targets, kept = at.unknowns(table)[4], at.unknowns(table)[5]
    turn = at.ahead(table)
    # the rows foresaw the bend of the velocities before
    if not (_bends(joints, h, velocity) or _bends(joints, h, at.before(table))):
        return 0.0
    for b in range(len(body)):
        turned(turn, b, body[b, 2] + h * velocity[b, 2])
    worst = 0.0
    for k in range(len(joints)):
        joint = joints[k]
        if joint["row"] < 0 or not holds(table, joint["bond"]):
            continue
        a, b = joint["a"], joint["b"]
        left_x, left_y, _ = remaining_gap(table, joint["bond"], h)
        if q.toothed(joint):
            gap = wheel_gap(table, h, k)
            gap += at.unknowns(table)[3][joint["row"]] / (h * joint["k"]) - kept[joint["row"]]
            targets[joint["row"]] = -gap / h
            worst = max(worst, abs(gap))
            continue
        ca, sa = turn[a, 0], turn[a, 1]
        px, py = q.vector_ahead(joint, h, body, velocity, ca, sa, turn[b, 0], turn[b, 1])
        x, y = q.gaps(joint, px, py, ca, sa)
        if joint["span"] >= 0:
            x = q.path_gap(table, h, k)
        x -= left_x + kept[joint["row"]]
        targets[joint["row"]] = -x / h
        worst = max(worst, abs(x))
        if joint["keeps"] == POINT:
            y -= left_y + kept[joint["row_y"]]
            targets[joint["row_y"]] = -y / h
            worst = max(worst, abs(y))
        if joint["keeps"] == ROLL:
            gap = wheel_gap(table, h, k) - kept[joint["row_y"]]
            targets[joint["row_y"]] = -gap / h
            worst = max(worst, abs(gap))
    return worst


@kernel
def turned(last: Array, b: int, angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle of body ``b``; ``last`` [nb, 3] has them and the last angle."""
    if last[b, 2] != angle:
        last[b, 0], last[b, 1], last[b, 2] = math.cos(angle), math.sin(angle), angle
    return last[b, 0], last[b, 1]


@kernel
def note_turns(body: Array, turn: Array) -> None:
    """Note cosine and sine of the angles of all bodies."""
    for b in range(len(body)):
        turn[b, 0], turn[b, 1] = math.cos(body[b, 2]), math.sin(body[b, 2])


@kernel
def right_side(table: int, free: Array, targets: Array, rhs: Array) -> None:
    """Right sides of rows less their rates at the free velocities [nb, 3]."""
    entry_row, entry_body, hubs = at.entry_row(table), at.entry_body(table), at.hubs(table)
    inverse_mass, J = at.inverse_mass(table), at.entries(table)[0]
    for r in range(len(rhs)):
        rhs[r] = targets[r]
    row, x = 0, 0.0
    for e in range(len(entry_row)):  # those of a row one after the other
        b = entry_body[e]
        if e == 0 or entry_row[e] != row:
            row = entry_row[e]
            x = rhs[row]
        if hubs[b, 0] < 0:
            x -= J[e, 0] * free[b, 0] + J[e, 1] * free[b, 1] + J[e, 2] * free[b, 2]
        rhs[row] = x
    for b in range(len(free)):
        if hubs[b, 0] >= 0:
            rhs[hubs[b, 0]] = -free[b, 0] / inverse_mass[b, 0]
            rhs[hubs[b, 1]] = -free[b, 1] / inverse_mass[b, 0]
            rhs[hubs[b, 2]] = -free[b, 2] / inverse_mass[b, 1]


@kernel
def answer(table: int, free: Array, targets: Array, impulses: Array) -> None:
    """Impulses [m] of bilateral rows with right sides ``targets`` at free velocities [nb, 3]."""
    solved = at.unknowns(table)[2]
    right_side(table, free, targets, solved)
    forward(table, solved)
    for r in range(len(solved)):
        impulses[r] = solved[r]
    backward(table, impulses)


@kernel
def apply_impulses(table: int, impulses: Array, velocity: Array) -> None:
    """Add W B^T p to the velocities of free bodies."""
    entry_row, entry_body, WJ = at.entry_row(table), at.entry_body(table), at.entries(table)[1]
    starts, entries, direct = at.body_starts(table), at.body_entries(table), at.direct(table)
    for b in range(len(velocity)):
        x, y, t = velocity[b, 0], velocity[b, 1], velocity[b, 2]
        for k in range(starts[b], starts[b + 1]):
            e = entries[k]
            p = impulses[entry_row[e]]
            x, y, t = x + WJ[e, 0] * p, y + WJ[e, 1] * p, t + WJ[e, 2] * p
        velocity[b, 0], velocity[b, 1], velocity[b, 2] = x, y, t
    for k in range(len(direct)):  # hubs
        e, axis = direct[k, 1], direct[k, 2]
        if entry_body[e] < len(velocity):
            velocity[entry_body[e], axis] += WJ[e, axis] * impulses[entry_row[e]]


@kernel
def assemble(table: int) -> None:
    """Add up the matrix, compliances and masses of hubs left out."""
    J, WJ, values = at.entries(table)[0], at.entries(table)[1], at.values(table)
    pairs, direct = at.pairs(table), at.direct(table)
    clear(values)
    slot, x = 0, 0.0
    for k in range(len(pairs)):  # those of a slot one after the other
        a, b = pairs[k, 1], pairs[k, 2]
        if pairs[k, 0] != slot:
            values[slot] = x
            slot, x = pairs[k, 0], 0.0
        x += J[a, 0] * WJ[b, 0] + J[a, 1] * WJ[b, 1] + J[a, 2] * WJ[b, 2]
    if len(pairs) > 0:
        values[slot] = x
    for k in range(len(direct)):
        values[direct[k, 0]] += J[direct[k, 1], direct[k, 2]]


@kernel
def factor(table: int) -> None:
    """Turn the matrix into its factor."""
    starts, below, updates = at.starts(table), at.below(table), at.updates(table)
    values, column = at.values(table), at.unknowns(table)[4]
    t, n = 0, len(starts) - 1
    diagonal = starts[n]
    for j in range(n):
        first, last = starts[j], starts[j + 1]
        inverse = 1.0 / values[diagonal + j]
        values[diagonal + j] = inverse
        for p in range(first, last):
            x = values[p]
            scaled = x * inverse
            column[p - first] = x
            values[p] = scaled
            values[diagonal + below[p]] -= scaled * x
            for m in range(p - first):
                values[updates[t + m]] -= scaled * column[m]
            t += p - first


@kernel
def forward(table: int, y: Array) -> None:
    """L^-1 y in place."""
    starts, below, values = at.starts(table), at.below(table), at.values(table)
    for j in range(len(starts) - 1):
        x = y[j]
        if x != 0.0:
            for p in range(starts[j], starts[j + 1]):
                y[below[p]] -= values[p] * x


@kernel
def backward(table: int, y: Array) -> None:
    """L^-T D^-1 y in place."""
    starts, below, values = at.starts(table), at.below(table), at.values(table)
    n = len(starts) - 1
    diagonal = starts[n]
    for j in range(n - 1, -1, -1):
        x = y[j] * values[diagonal + j]
        for p in range(starts[j], starts[j + 1]):
            x -= values[p] * y[below[p]]
        y[j] = x
