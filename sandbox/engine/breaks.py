"""What breaks: where in a step its load came to the limit, and what it still gave until then.

Forces of step n stand for the time from (n - 1) h to n h, but what they follow from is the pose in
its middle. With T' and T > T_b the loads in the last step and in this one, the load came to T_b at

    t = (n - 3/2 + s) h,    s = (T_b - T') / (T - T')

and up to (n - 1) h all is done. So the step is solved again without the element, which gives
(s - 1/2) h T_b of impulse in place of h T: negative where the last step gave too much. What goes
with a joint (dry friction, dampers, springs, motors and servos about it) gives the same share of
what it gave. Velocities after it are right to second order, wherever in a step it breaks; but for
the torques and pushes that drives are set to, which go with it for the whole step.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.bonds import empty_rows, holds
from sandbox.engine.bounded import push
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.records import GRIPPED, JOINED, PULLING, SPRINGY
from sandbox.engine.report import add_limit, joint_force
from sandbox.engine.state import DRIVEN, JOINT_FRICTION, LIMITED

TOGETHER = 1e-6
"""Share of a step within which two loads are come to at once."""
NEVER = 2.0
"""As the share of the step at which a load was come to: it was not."""


@entry_point("bonds")
def breaks(table: int, h: float, n: int) -> bool:
    """Release what reached its limit first in this step of n bounded rows; whether any did."""
    bonds = at.bonds(table)
    first, made, broken = NEVER, at.made(table), at.broken(table)
    for i in range(len(bonds)):
        if bonds[i]["held"] == 1 and bonds[i]["breaks_at"] < math.inf:
            bonds[i]["load"] = _load(table, h, n, i)
            first = min(first, _when(bonds[i]["load"], bonds[i]["breaks_at"],
                                     bonds[i]["last_load"]))
    for i in range(len(bonds)):
        if bonds[i]["held"] == 0:
            continue
        load, most, last = bonds[i]["load"], bonds[i]["breaks_at"], bonds[i]["last_load"]
        when = _when(load, most, last)
        if when > first + TOGETHER or when > 1.0:
            continue
        # no more is taken back than the last step gave
        share = 0.0
        if last == last:
            share = max((when - 0.5) * most, -0.5 * last) / load
        bonds[i]["held"], bonds[i]["broke"] = 0, 1
        if made[2] < len(broken):  # there is room to write it down
            one = broken[made[2]]
            one["bond"], one["row"], one["when"] = i, made[1], when
            made[2] += 1
        what, k = bonds[i]["what"], bonds[i]["index"]
        if what == JOINED:
            _cut_joint(table, h, n, k, share)
        elif what == PULLING:
            _cut_cable(table, h, k, share)
            for span in range(at.cables(table)[k]["spans"], at.cables(table)[k]["spans_end"]):
                _cut_cable(table, h, span, share)
        elif holds(table, at.springs(table)[k]["hinge_bond"]):  # else it was cut with its hinge
            _cut_spring(table, h, k, share)
    return first <= 1.0


@kernel
def _when(load: float, most: float, last: float) -> float:
    """Share of the step at which a load came to ``most``, or NEVER; ``last`` may be nan."""
    if not load > most:
        return NEVER
    if last != last:
        return 0.5
    return (most - last) / (load - last) if last < most else 0.0


@kernel
def _load(table: int, h: float, n: int, bond: int) -> float:
    what, i = at.bonds(table)[bond]["what"], at.bonds(table)[bond]["index"]
    rows, unknown = at.rows(table), at.unknowns(table)[3]
    if what == JOINED:
        joint = at.joints(table)[i]
        joint_force(h, joint, unknown)
        for k in range(n):
            if rows[k]["source"] == LIMITED and (
                    at.limits(table)[rows[k]["index"]]["joint"] == i):
                add_limit(table, h, k)
        return math.hypot(joint["fx"], joint["fy"])
    if what == SPRINGY:
        row = at.springs(table)[i]["row"]
        return float(abs(
            unknown[row] / h if row >= 0 else at.springs(table)[i]["effort"]))
    cable = at.cables(table)[i]
    if cable["kind"] != GRIPPED:
        return _tension(table, h, i)
    most = 0.0
    for k in range(cable["spans"], cable["spans_end"]):
        most = max(most, _tension(table, h, k))
    return most


@kernel
def _tension(table: int, h: float, i: int) -> float:
    row = at.cables(table)[i]["row"]
    if row < 0:
        return float(at.cables(table)[i]["tension"])
    return max(at.unknowns(table)[3][row] / h, 0.0) if at.cables(table)[i]["active"] else 0.0


@kernel
def _give(table: int, entry: int, count: int, p: float) -> None:
    free, WJ, entry_body = at.free(table), at.entries(table)[1], at.entry_body(table)
    for e in range(entry, entry + count):
        b = entry_body[e]
        if b < len(free):
            free[b, 0] += WJ[e, 0] * p
            free[b, 1] += WJ[e, 1] * p
            free[b, 2] += WJ[e, 2] * p


@kernel
def _cut_rows(table: int, entry: int, count: int, share: float) -> None:
    """Let rows give ``share`` of their impulses, and nothing more."""
    impulses, entry_row = at.unknowns(table)[3], at.entry_row(table)
    for e in range(entry, entry + count):
        _give(table, e, 1, share * impulses[entry_row[e]])
    empty_rows(table, entry, count)


@kernel
def _kick(table: int, b: int, x: float, y: float, t: float) -> None:
    free, w = at.free(table), at.inverse_mass(table)
    free[b, 0] += w[b, 0] * x
    free[b, 1] += w[b, 0] * y
    free[b, 2] += w[b, 1] * t


@kernel
def _cut_joint(table: int, h: float, n: int, j: int, share: float) -> None:
    joint = at.joints(table)[j]
    joint["fx"] *= share
    joint["fy"] *= share
    joint["couple"] *= share
    _cut_rows(table, joint["entry"], joint["entries"], share)
    _cut_bounded(table, n, j, share)
    springs, actions = at.springs(table), at.actions(table)
    for k in range(len(springs)):
        if springs[k]["hinge_bond"] == joint["bond"] and holds(table, springs[k]["bond"]):
            _cut_spring(table, h, k, share)
    for k in range(len(actions)):  # the torque or push that a drive gives is taken back
        if actions[k]["bond"] == joint["bond"] and actions[k]["motor"] < 0:
            _kick_along(table, at.joints(table)[actions[k]["joint"]], -h * actions[k]["torque"])
            actions[k]["torque"] = 0.0


@kernel
def _cut_bounded(table: int, n: int, j: int, share: float) -> None:
    """The same of its limits and dry friction, and of motors and servos about it."""
    rows, limits = at.rows(table), at.limits(table)
    motors, bond = at.motors(table), at.joints(table)[j]["bond"]
    for k in range(len(limits)):
        if limits[k]["joint"] == j:
            limits[k]["impulse"] = 0.0
    for k in range(n):
        source, i, p = rows[k]["source"], rows[k]["index"], share * rows[k]["p"]
        if source == LIMITED and limits[i]["joint"] == j:
            limits[i]["impulse"] = p
        elif source == JOINT_FRICTION and at.dry_friction(table)[i]["joint"] == j:
            at.dry_friction(table)[i]["impulse"] = p
        elif source == DRIVEN and at.motors(table)[i]["bond"] == bond:
            motors[i]["impulse"] = p
        else:
            continue
        push(at.inverse_mass(table), rows[k], p, at.free(table))


@kernel
def _kick_along(table: int, element: Any, p: float) -> None:
    _kick(table, element["b"], p * element["dx"], p * element["dy"], p * element["tb"])
    _kick(table, element["a"], -p * element["dx"], -p * element["dy"], p * element["ta"])


@kernel
def _cut_spring(table: int, h: float, k: int, share: float) -> None:
    s = at.springs(table)[k]
    if s["row"] >= 0:
        s["effort"] = share * at.unknowns(table)[3][s["row"]] / h
        _cut_rows(table, s["entry"], 2, share)
    else:
        _kick_along(table, s, (share - 1.0) * h * s["effort"])
        s["effort"] *= share


@kernel
def _cut_cable(table: int, h: float, i: int, share: float) -> None:
    cable = at.cables(table)[i]
    if cable["kind"] == GRIPPED:
        cable["active"] = 0
        return
    tension = _tension(table, h, i)
    if cable["row"] >= 0:
        if cable["active"]:
            _give(table, cable["entry"], cable["entries"], share * h * tension)
        cable["active"] = 0
    else:
        guides, p = at.guides(table), (share - 1.0) * h * tension
        for g in range(cable["first"], cable["last"]):
            _kick(table, guides[g]["body"], -p * guides[g]["jx"], -p * guides[g]["jy"],
                  -p * guides[g]["jt"])
    cable["tension"] = share * tension
