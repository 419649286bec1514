"""The solve of a step: impulses of all joints, dampers, tendons, limits, motors and contacts.

With W the inverse masses, f the forces at the poses x of the step, B the bilateral rows and C those
with bounds,

    v = v_before + h W f + W B^T p_b + W C^T p_c

gives the velocities v at the step's end. B is factored once (:mod:`sandbox.engine.plan`). Rows C
that carry something or would be violated are solved on what it leaves
(:mod:`sandbox.engine.bounded`). Then groups of elements may change their active sets and
linearisations (:func:`_change`), and the step is solved again. Restitution acts before
all forces (:mod:`sandbox.engine.impacts`).
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import bounded, fluids, impacts, loads, springs, tendons
from sandbox.engine import memory as at
from sandbox.engine import rows as bilateral
from sandbox.engine.bonds import release_rows
from sandbox.engine.bounded_rows import RETURN, broken_rows, kept_rows, land, leave
from sandbox.engine.entry_points import entry_point
from sandbox.engine.islands import SLOW, SLOW_TURNING, list_piles, stretch_skin
from sandbox.engine.joint_friction import break_away, change_friction
from sandbox.engine.kernel import kernel
from sandbox.engine.motors import brake_in_time
from sandbox.engine.piles import LAST, solve_piles
from sandbox.engine.plan import put
from sandbox.engine.report import breaks, report
from sandbox.engine.state import COARSE, STILL, STILL_TURNING
from sandbox.numeric import Array, Records

HARD = 1e-12  # compliance of rigid rows, relative to that of the masses: redundant ones share
LAW_ROUNDS = 12  # maximum number of changes of tendons and linearisations of laws in a step
PRESSED = 60  # the same of loads: quadratic drag on a fast body halves its speed each time
CLOSINGS = 3  # maximum number of times in a step that joints are solved again to be closed
GROWN = 100.0  # maximum kinetic energy of a closing over that of the one before: 10^4 if singular
SETTLED = 20  # steps at rest before it, in which the shares of loads converge
ATTEMPTS = 2  # maximum number of searches for modes in a step; after them relaxation has to do
HOPELESS = 1e4  # speed [m/s, rad/s] by an impulse alone from which it undoes no overlap
EXACT = 1e-10  # rates that count as zero, as a share of the largest of the rows
SOFTER, SOFT_SHARE = 1e3, 0.1
"""Factor by which impulses are held to the last more strongly, and the share of an impulse left
above which something else limits it."""
AGROUND, ALMOST = 1e-6, 1e-3
"""Minimum approach [m/s, rad/s], and its share of the speeds of both bodies, by which joints drive
overlapping bodies into each other; at a common hinge it is less."""


@kernel
def solve(table: int, h: float, drive: Array) -> bool:
    """Find the velocities after a step; whether there was an impact. ``drive`` [nd]: its values."""
    solved = at.unknowns(table)[2]
    at.standing(table)[2] = 0
    bilateral.joint_rows(table, h)
    springs.spring_rows(table, h, drive)
    springs.law_rows(table, h, drive)
    loads.load_rows(table, h)
    release_rows(table, h)
    tendons.slacken(table)
    list_piles(table)
    n = kept_rows(table, h, drive)
    hit = struck = True
    piles, solves = 0.0, 0
    for attempt in range(PRESSED):
        factor_matrix(table, h, drive)
        if hit:
            struck = strike(table, h, drive, n)
        bilateral.right_side(table, at.free(table), at.unknowns(table)[0], solved)
        bilateral.forward(table, solved)
        done, closings, taken, again = 0, 0, math.inf, False
        while True:  # rows only grow in number, and joints are closed so often at most
            bounded.columns(table, 0, done, n)
            bounded.couple(table, 0, done, n)
            if done == 0:
                brake_in_time(table, h, n)
                leave(table, h, n)
            done = n
            slack = solve_bounded(table, n, again)
            find_velocities(table, n)
            piles = solve_piles(table, h, solves, again)
            solves += 1
            n = broken_rows(table, h, n, slack)
            again = n == done
            if again:
                taken = close_joints(table, h, n, GROWN * taken) if closings < CLOSINGS else 0.0
                if taken == 0.0:
                    break
                closings += 1
        if struck:
            impacts.lead_back(table, h, n)
        bounded.wipe(table, 0, n)
        hit = impacts.late_hits(table, h, n)
        changed, converging, answered = _change(table, h, drive, attempt, n, hit)
        hit |= struck and answered
        if not (converging or (changed and attempt < LAW_ROUNDS - 1)):
            if attempt + 1 == PRESSED:
                break
            if break_away(table, n):
                continue
            if not breaks(table, h, n):
                break
            n = kept_rows(table, h, drive)
    at.standing(table)[3], at.standing(table)[4] = jammed(table, n, slack), n
    land(table, h, n)
    report(table, h, drive, n)
    stretch_skin(table, h, n)
    _note_accuracy(table, n, slack, max(piles, solve_piles(table, h, LAST, False)))
    _rest(table)
    return struck


@kernel
def _change(table: int, h: float, drive: Array, attempt: int, n: int, again: bool) -> Any:
    """Change active sets and linearisations: any; whether it converges; any that impacts meet."""
    changed, converging = springs.change_laws(table, h, drive), loads.change_loads(table, h)
    changed |= change_friction(table, n)
    answered = not again and (tendons.change_cables(table, h, attempt)
                              or fluids.change_lines(table, h, drive, attempt))
    return changed | again | answered, converging, answered


@entry_point("bounces")
def strike(table: int, h: float, drive: Array, n: int) -> bool:
    """Find the impacts of the step, joints in the pose of the first one; whether there are any."""
    struck = impacts.foresee_impacts(table, h, n)
    if struck:
        if len(at.joints(table)) > 0:
            factor_matrix(table, h, drive)
        struck = impacts.impacts(table, h, n)
        if len(at.joints(table)) > 0:
            bilateral.joint_rows(table, h)
            release_rows(table, h)
            factor_matrix(table, h, drive)
        impacts.take_impacts(table, h, struck)
    return struck


@entry_point()
def factor_matrix(table: int, h: float, drive: Array) -> None:
    """Put together the matrix of the bilateral rows, and factor it."""
    unknowns, values = at.unknowns(table), at.values(table)
    J, WJ = at.entries(table)[0], at.entries(table)[1]
    entry_body, inverse_mass = at.entry_body(table), at.inverse_mass(table)
    tendons.cable_rows(table, h)
    fluids.fluid_rows(table, h, drive)
    for e in range(len(entry_body)):
        b = entry_body[e]
        if b < len(inverse_mass):  # else a slip, which has no mass
            w, wt = inverse_mass[b, 0], inverse_mass[b, 1]
            WJ[e, 0], WJ[e, 1], WJ[e, 2] = w * J[e, 0], w * J[e, 1], wt * J[e, 2]
    bilateral.assemble(table)
    fluids.join_lines(table, h)
    count = unknowns.shape[1]
    diagonal = len(values) - count
    for i in range(count):
        values[diagonal + i] = values[diagonal + i] * (1.0 + HARD) + unknowns[1, i]
    entry_row, direct = at.entry_row(table), at.direct(table)
    for k in range(len(direct)):  # what hubs give
        e, axis = direct[k, 1], direct[k, 2]
        values[diagonal + entry_row[e]] += HARD * J[e, axis] * WJ[e, axis]
    bilateral.factor(table)


@entry_point()
def close_joints(table: int, h: float, n: int, most: float) -> float:
    """Close the gaps of joints; twice the energy [J] of that. 0: small, or it is above ``most``."""
    unknowns, values, rows = at.unknowns(table), at.values(table), at.rows(table)
    Y, reached = at.columns(table), at.reached(table)
    count = unknowns.shape[1]
    diagonal = len(values) - count
    if impacts.displaced_gaps(table, h) < bilateral.closed(h):
        return 0.0
    bilateral.forward(table, unknowns[4])
    taken = 0.0
    for i in range(count):
        taken += unknowns[4, i] * unknowns[4, i] * values[diagonal + i]
    if taken > most:
        return 0.0
    for i in range(count):
        unknowns[2, i] += unknowns[4, i]
    for k in range(n):
        for q in range(rows[k]["branch"]):
            i = reached[k, q]
            rows[k]["free"] += Y[k, i] * values[diagonal + i] * unknowns[4, i]
    return taken


@entry_point()
def solve_bounded(table: int, n: int, again: bool) -> float:
    """Impulses of the bounded rows; a rate that counts as none. ``again``: :func:`solve_modes`."""
    rows = at.rows(table)
    most = 0.0
    for k in range(n):
        most = max(most, abs(rows[k]["free"]))
    slack = 1e-13 + EXACT * most
    G = at.delassus(table)
    if n == 0 or (at.standing(table)[1] >= SETTLED and _as_before(rows, n, G)):
        return slack
    hopeless = True
    while hopeless:  # wedged overlaps are no longer undone
        _impulses(table, n, slack, again)
        hopeless = False
        for k in range(n):
            row = rows[k]
            if row["back"] < 0.0 and row["p"] * row["base"] > HOPELESS:
                row["free"] -= row["back"]
                row["back"], hopeless = 0.0, True
    return slack


@kernel
def _impulses(table: int, n: int, slack: float, again: bool) -> None:
    rows, G, A, chosen = at.rows(table), at.delassus(table), at.system(table), at.chosen(table)
    given_up = at.standing(table)
    if given_up[2] >= ATTEMPTS:
        bounded.relax(rows, n, G)
    elif bounded.solve_modes(rows, n, G, A, chosen, slack, again) < 0:
        bounded.relax(rows, n, G)
        if bounded.solve_modes(rows, n, G, A, chosen, slack, True) < 0 and not (
                n <= bounded.SEARCHED and bounded.search_modes(rows, n, G, A, chosen, slack)):
            bounded.relax(rows, n, G)
            given_up[0] += 1 if given_up[2] == 0 else 0
            given_up[2] += 1


@entry_point("bounded")
def jammed(table: int, n: int, slack: float) -> int:
    """The number, from 1, of a bounded row that has no solution; 0 if all have one.

    A schedule may drive bodies against something fixed. Then nothing but its hold to the last one
    limits the row's impulse; or joints leave the row no freedom, and its bodies move into each
    other. Other overlaps, as of links about a common hinge, are no jam.
    """
    rows, which, most = at.rows(table), -1, HOPELESS
    scheduled, velocity, moving = at.scheduled(table), at.velocity(table), False
    for i in range(len(scheduled)):
        for j in range(3):
            moving |= velocity[scheduled[i], j] != 0.0
    for k in range(n if moving else 0):
        row = rows[k]
        overlaps = row["gentle"] == 1 and row["bias"] <= -RETURN
        if row["out"] and overlaps:
            a, b, v = row["a"], row["b"], velocity
            speeds = (
                abs(row["ax"] * v[a, 0]) + abs(row["ay"] * v[a, 1]) + abs(row["at"] * v[a, 2])
                + abs(row["bx"] * v[b, 0]) + abs(row["by"] * v[b, 1]) + abs(row["bt"] * v[b, 2]))
            if bounded.rate(row, v) < -max(AGROUND, ALMOST * speeds):
                return k + 1
        elif row["a"] < len(velocity) and not (row["out"] or overlaps) and (
                abs(row["p"] - row["last"]) * row["base"] > most):
            which, most = k, abs(row["p"] - row["last"]) * row["base"]
    if which < 0:
        return 0
    for k in range(n):
        rows[k]["base"] *= SOFTER
    _impulses(table, n, slack, False)
    left = abs(rows[which]["p"] - rows[which]["last"]) * rows[which]["base"] / SOFTER
    for k in range(n):
        rows[k]["base"] /= SOFTER
    if left < SOFT_SHARE * most:
        return which + 1
    _impulses(table, n, slack, False)
    return 0


@kernel
def _note_accuracy(table: int, n: int, slack: float, piles: float) -> None:
    """Note the residual of a step: at most ``slack`` if modes were found, ``piles`` of piles."""
    rows, G, accuracy, worst = at.rows(table), at.delassus(table), at.accuracy(table), piles
    if at.standing(table)[2] == 0 and slack <= COARSE:
        worst = max(worst, slack if n > 0 else 0.0)
    else:
        for k in range(n):
            worst = max(worst, bounded.residual(rows, n, G, k))
    accuracy[0], accuracy[5] = worst, max(accuracy[5], worst)
    if worst > accuracy[1]:
        accuracy[1], accuracy[2] = worst, at.made(table)[0]
    if worst > COARSE:
        accuracy[4] += 1.0


@kernel
def _as_before(rows: Records, n: int, G: Array) -> bool:
    """Try the impulses of the last step: whether they leave all rows at rest, and may be."""
    for k in range(n):
        rows[k]["p"] = rows[k]["last"]
    for k in range(n):
        row = rows[k]
        if row["normal"] < 0 and not row["low"] <= row["p"] <= row["high"]:
            return False
        if abs(bounded.y_of(rows, n, G, k)) > STILL:
            return False
    return True


@kernel
def _rest(table: int) -> None:
    """Let bodies stand that move by no more than rounding, all of them or none."""
    velocity, count = at.velocity(table), at.standing(table)
    before, count[1] = count[1], 0
    linked = at.pile_counts(table)[0] == 1
    slow, turning = (SLOW, SLOW_TURNING) if linked else (STILL, STILL_TURNING)
    for b in range(len(velocity)):
        if not (abs(velocity[b, 0]) < slow and abs(velocity[b, 1]) < slow
                and abs(velocity[b, 2]) < turning):
            return
    belts, changing = at.belts(table), fluids.flowing(table) or loads.timed(table)
    for b in range(len(velocity)):
        velocity[b, 0] = velocity[b, 1] = velocity[b, 2] = 0.0
        changing |= belts[b] != 0.0  # friction on a surface that runs does work
    if not changing:
        count[1] = min(before + 1, SETTLED + 2)


@entry_point()
def find_velocities(table: int, n: int) -> None:
    """The unknowns and the velocities that the impulses of the rows lead to."""
    unknowns, rows, velocity = at.unknowns(table), at.rows(table), at.velocity(table)
    Y, reached = at.columns(table), at.reached(table)
    for i in range(unknowns.shape[1]):
        unknowns[3, i] = unknowns[2, i]
    for k in range(n):
        p = rows[k]["p"]
        if p != 0.0 and not rows[k]["measure"]:
            for q in range(rows[k]["branch"]):
                i = reached[k, q]
                unknowns[3, i] -= Y[k, i] * p
    bilateral.backward(table, unknowns[3])
    put(velocity, at.free(table))
    bilateral.apply_impulses(table, unknowns[3], velocity)
    for k in range(n):
        bounded.push(at.inverse_mass(table), rows[k], rows[k]["p"], velocity)
