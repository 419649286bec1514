"""Results of a step: impulses as forces of the elements, and the work of all of them.

A force does the work h F . (v_before + v_after) / 2 in a step: the work on a body is its increase
of kinetic energy, to rounding. Work is summed in each step; samples would miss impacts.

Breaks: forces of step n hold for the time from (n - 1) h to n h, but follow from the pose in its
middle. With T' and T > T_b the loads in the last step and in this one, the load reached T_b at

    t = (n - 3/2 + s) h,    s = (T_b - T') / (T - T')

The step is solved again without the element, with its impulse (s - 1/2) h T_b instead of h T. Dry
friction, dampers, springs, motors and servos at a joint give the same share of theirs. Velocities
are then of second order, but for torques and pushes of drives, which end for the whole step.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine import records
from sandbox.engine import state as sources
from sandbox.engine.bonds import acts, empty_rows, holds, report_bonds
from sandbox.engine.bounded import push
from sandbox.engine.coordinates import rate, toothed
from sandbox.engine.entry_points import entry_point
from sandbox.engine.fluids import add_fluid_work, report_lines
from sandbox.engine.joint_friction import add_friction_work, release_friction, report_friction
from sandbox.engine.kernel import kernel
from sandbox.engine.loads import add_load_work
from sandbox.engine.plan import add_to
from sandbox.engine.springs import add_spring_work, report_springs
from sandbox.engine.tendons import add_cable_work, report_cables, slipped
from sandbox.numeric import Array


@entry_point()
def report(table: int, h: float, drive: Array, n: int) -> None:
    """Write the impulses into the tables of their elements."""
    unknown = at.unknowns(table)[3]
    report_springs(table, h)
    report_cables(table, h)
    slipped(table, h)
    joints = at.joints(table)
    for i in range(len(joints)):
        if acts(table, joints[i]["bond"]):
            joint_force(h, joints[i], unknown)
        # teeth push: where they would have to pull, their other flank pushes in the next step
        if toothed(joints[i]) and joints[i]["row"] >= 0 and unknown[joints[i]["row"]] < 0.0:
            joints[i]["flank"] = -joints[i]["flank"]
    _report_bounded(table, h, n)
    report_bonds(table, h)
    report_lines(table, h, drive)


@kernel
def _report_bounded(table: int, h: float, n: int) -> None:
    rows, touches, motors = at.rows(table), at.touches(table), at.motors(table)
    limits, frictions = at.limits(table), at.dry_friction(table)
    slips, joints = at.slips(table), at.joints(table)
    for i in range(len(slips)):
        slips[i]["impulse"] = slips[i]["pressed"] = slips[i]["mode"] = 0
    for i in range(len(limits)):
        if acts(table, joints[limits[i]["joint"]]["bond"]):
            limits[i]["impulse"] = 0.0
    for i in range(len(motors)):
        bond = motors[i]["bond"]
        if not holds(table, bond):
            motors[i]["target"] = math.nan
            if acts(table, bond):
                motors[i]["impulse"] = 0.0
    for i in range(len(frictions)):
        bond = joints[at.dry_friction(table)[i]["joint"]]["bond"]
        if not holds(table, bond):
            release_friction(table, h, i, 0.0 if acts(table, bond) else frictions[i]["impulse"])
    for i in range(at.touching(table)[0]):
        t = touches[i]
        if t["listed"] == sources.IN_PILE:
            continue
        t["normal"] = t["tangent"] = 0.0
        t["mode"] = t["listed"] = 0
    for k in range(n):
        row = rows[k]
        i, p = row["index"], row["p"]
        if row["source"] == sources.NORMAL:
            touches[i]["normal"] = max(p, 0.0)
            touches[i]["listed"] = 1 if p > 0.0 else 0
        elif row["source"] == sources.TANGENT:
            mode = 0 if row["phase"] == sources.HOLDS else row["mode"]
            touches[i]["tangent"], touches[i]["mode"] = p, mode
        elif row["source"] == sources.LIMITED:
            limits[i]["impulse"] = max(p, 0.0)
            add_limit(table, h, k)
        elif row["source"] == sources.CABLE_LOAD:
            slips[i]["pressed"] = p
        elif row["source"] == sources.CABLE_FRICTION:
            slips[i]["impulse"], slips[i]["mode"] = p, row["mode"]
        elif row["source"] == sources.JOINT_LOAD:
            frictions[i]["pressed"] = p
        elif row["source"] == sources.JOINT_FRICTION:
            mode, bound = row["mode"], math.nan
            if row["phase"] == sources.HOLDS:
                mode, bound = 0, row["high"]
                if row["normal"] >= 0:
                    bound = row["friction"] * rows[row["normal"]]["p"]
            report_friction(table, h, i, p, mode, bound)
        else:
            motors[i]["impulse"], motors[i]["mode"] = p, row["mode"]
            motors[i]["target"] = motors[i]["aim"]


@kernel
def add_limit(table: int, h: float, k: int) -> None:
    """Add what bounded row ``k``, a limit's, carries to its joint's force."""
    row = at.rows(table)[k]
    limit, p = at.limits(table)[row["index"]], max(row["p"], 0.0)
    out = at.joints(table)[limit["joint"]]
    if limit["what"] == records.LINE:
        out["fx"] += limit["side"] * out["dx"] * p / h
        out["fy"] += limit["side"] * out["dy"] * p / h
    if limit["what"] == records.FLANK:
        out["fx"] += row["bx"] * p / h
        out["fy"] += row["by"] * p / h


@kernel
def joint_force(h: float, joint: Any, unknown: Array) -> None:
    """What the rows of a joint carry, without its limits."""
    joint["fx"], joint["fy"], joint["couple"] = joint["kick_x"] / h, joint["kick_y"] / h, 0.0
    if joint["row"] >= 0:
        p = unknown[joint["row"]] / h
        if joint["keeps"] == records.POINT:
            joint["fx"] += p
            joint["fy"] += unknown[joint["row_y"]] / h
        elif joint["keeps"] == records.GROOVE:
            joint["fx"] -= joint["dy"] * p
            joint["fy"] += joint["dx"] * p
        else:
            joint["fx"] += joint["dx"] * p
            joint["fy"] += joint["dy"] * p
        if joint["keeps"] == records.ROLL:
            p = unknown[joint["row_y"]] / h
            if joint["ra"] + joint["rb"] < 0.0:
                p = -p
            joint["fx"] += joint["dy"] * p
            joint["fy"] -= joint["dx"] * p
    if joint["row_turn"] >= 0:
        joint["couple"] = unknown[joint["row_turn"]] / h


@entry_point()
def add_work(table: int, h: float) -> None:
    """Add the work [J] of the step; the free velocities become the means over the step."""
    body, before, v, shift = at.body(table), at.before(table), at.free(table), at.shift(table)
    for i in range(len(body)):
        for j in range(3):
            v[i, j] = (body[i, 3 + j] + before[i, j]) / 2 + shift[i, j] / h
    actions, motors, touches = at.actions(table), at.motors(table), at.touches(table)
    for i in range(len(actions)):
        action = actions[i]
        a = action["a"]
        if action["runs"]:
            along = 0.0  # impulse on what touches the body along its surface, counter-clockwise
            for k in range(at.touching(table)[0]):
                if touches[k]["a"] == a or touches[k]["b"] == a:
                    along += touches[k]["tangent"] + touches[k]["drag"]
            action["torque"] = along * at.belts(table)[a] / h
            action["step_work"] = h * action["torque"]
            action["work"] += action["step_work"]
            continue
        if action["motor"] >= 0:
            action["torque"] = action["sense"] * motors[action["motor"]]["impulse"] / h
        if action["joint"] >= 0:
            power = (action["sense"] * action["torque"]
                     * rate(at.joints(table)[action["joint"]], v))
        else:
            power = (action["fx"] * v[a, 0] + action["fy"] * v[a, 1] + action["torque"] * v[a, 2])
        action["step_work"] = h * power
        action["work"] += h * power
    add_spring_work(table, h, v)
    add_cable_work(table, h, v)
    add_friction_work(table, v)
    add_fluid_work(table, h, v)
    add_load_work(table, h, v)


TOGETHER = 1e-6  # share of a step within which two elements break at once
NEVER = 2.0  # the instant of a load that is not reached, as a share of the step


@entry_point("bonds")
def breaks(table: int, h: float, n: int) -> bool:
    """Release the elements that reach their load limits first in this step; whether any did."""
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
        load, strength, last = bonds[i]["load"], bonds[i]["breaks_at"], bonds[i]["last_load"]
        when = _when(load, strength, last)
        if when > first + TOGETHER or when > 1.0:
            continue
        # not more is taken back than the impulse of the last step
        share = 0.0
        if last == last:
            share = max((when - 0.5) * strength, -0.5 * last) / load
        bonds[i]["held"], bonds[i]["broke"] = 0, 1
        if made[2] < len(broken):
            one = broken[made[2]]
            one["bond"], one["row"], one["when"] = i, made[1], when
            made[2] += 1
        what, k = bonds[i]["what"], bonds[i]["index"]
        if what == records.JOINED:
            _cut_joint(table, h, n, k, share)
        elif what == records.PULLING:
            _cut_cable(table, h, k, share)
            for span in range(at.cables(table)[k]["spans"], at.cables(table)[k]["spans_end"]):
                _cut_cable(table, h, span, share)
        elif holds(table, at.springs(table)[k]["hinge_bond"]):  # else released with its hinge
            _cut_spring(table, h, k, share)
    return first <= 1.0


@kernel
def _when(load: float, strength: float, last: float) -> float:
    """Share of the step at which a load reaches the strength, or NEVER; ``last`` may be nan."""
    if not load > strength:
        return NEVER
    if last != last:
        return 0.5
    return (strength - last) / (load - last) if last < strength else 0.0


@kernel
def _load(table: int, h: float, n: int, bond: int) -> float:
    what, i = at.bonds(table)[bond]["what"], at.bonds(table)[bond]["index"]
    rows, unknown = at.rows(table), at.unknowns(table)[3]
    if what == records.JOINED:
        joint = at.joints(table)[i]
        joint_force(h, joint, unknown)
        for k in range(n):
            if rows[k]["source"] == sources.LIMITED and (
                    at.limits(table)[rows[k]["index"]]["joint"] == i):
                add_limit(table, h, k)
        return math.hypot(joint["fx"], joint["fy"])
    if what == records.SPRINGY:
        row = at.springs(table)[i]["row"]
        return float(abs(unknown[row] / h if row >= 0 else at.springs(table)[i]["effort"]))
    cable = at.cables(table)[i]
    if cable["kind"] != records.GRIPPED:
        return _tension(table, h, i)
    largest = 0.0
    for k in range(cable["spans"], cable["spans_end"]):
        largest = max(largest, _tension(table, h, k))
    return largest


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
            add_to(free, b, WJ[e, 0] * p, WJ[e, 1] * p, WJ[e, 2] * p)


@kernel
def _cut_rows(table: int, entry: int, count: int, share: float) -> None:
    impulses, entry_row = at.unknowns(table)[3], at.entry_row(table)
    for e in range(entry, entry + count):
        _give(table, e, 1, share * impulses[entry_row[e]])
    empty_rows(table, entry, count)


@kernel
def _kick(table: int, b: int, x: float, y: float, t: float) -> None:
    w = at.inverse_mass(table)
    add_to(at.free(table), b, w[b, 0] * x, w[b, 0] * y, w[b, 1] * t)


@kernel
def _cut_joint(table: int, h: float, n: int, j: int, share: float) -> None:
    joint = at.joints(table)[j]
    joint["fx"] *= share
    joint["fy"] *= share
    joint["couple"] *= share
    _cut_rows(table, joint["entry"], joint["entries"], share)
    rows, limits, motors = at.rows(table), at.limits(table), at.motors(table)
    for k in range(len(limits)):
        if limits[k]["joint"] == j:
            limits[k]["impulse"] = 0.0
    for k in range(n):  # bounded rows of its limits, its dry friction, motors and servos about it
        source, i, p = rows[k]["source"], rows[k]["index"], share * rows[k]["p"]
        if source == sources.LIMITED and limits[i]["joint"] == j:
            limits[i]["impulse"] = p
        elif source == sources.JOINT_FRICTION and at.dry_friction(table)[i]["joint"] == j:
            at.dry_friction(table)[i]["impulse"] = p
        elif source == sources.DRIVEN and motors[i]["bond"] == joint["bond"]:
            motors[i]["impulse"] = p
        else:
            continue
        push(at.inverse_mass(table), rows[k], p, at.free(table))
    springs, actions = at.springs(table), at.actions(table)
    for k in range(len(springs)):
        if springs[k]["hinge_bond"] == joint["bond"] and holds(table, springs[k]["bond"]):
            _cut_spring(table, h, k, share)
    for k in range(len(actions)):  # drives give no torque or push
        if actions[k]["bond"] == joint["bond"] and actions[k]["motor"] < 0:
            _kick_along(table, at.joints(table)[actions[k]["joint"]],
                        -h * actions[k]["sense"] * actions[k]["torque"])
            actions[k]["torque"] = 0.0


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
    if cable["kind"] == records.GRIPPED:
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
