"""Results of a step: impulses as forces of the elements, and the work of all of them.

Over one step a force does the work h F . (v_before + v_after) / 2. With this rule the work of all
forces and impulses on a body is its increase of kinetic energy, to rounding. Work is summed in each
step, because an impact lasts one step and samples would miss it.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.bonds import acts, holds, report_bonds
from sandbox.engine.coordinates import toothed
from sandbox.engine.entry_points import entry_point
from sandbox.engine.fluid_report import add_fluid_work, report_lines
from sandbox.engine.friction import add_friction_work, release_friction, report_friction
from sandbox.engine.kernel import kernel
from sandbox.engine.loads import add_load_work
from sandbox.engine.records import FLANK, GROOVE, LINE, POINT, ROLL
from sandbox.engine.rows import joint_rate
from sandbox.engine.springs import add_spring_work, report_springs
from sandbox.engine.state import (
    CABLE_FRICTION,
    CABLE_LOAD,
    HOLDS,
    IN_PILE,
    JOINT_FRICTION,
    JOINT_LOAD,
    LIMITED,
    NORMAL,
    TANGENT,
)
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
        _change_flank(joints[i], unknown)
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
        if t["listed"] == IN_PILE:
            continue
        t["normal"] = t["tangent"] = 0.0
        t["mode"] = t["listed"] = 0
    for k in range(n):
        row = rows[k]
        i, p = row["index"], row["p"]
        if row["source"] == NORMAL:
            touches[i]["normal"] = max(p, 0.0)
            touches[i]["listed"] = 1 if p > 0.0 else 0
        elif row["source"] == TANGENT:
            mode = 0 if row["phase"] == HOLDS else row["mode"]
            touches[i]["tangent"], touches[i]["mode"] = p, mode
        elif row["source"] == LIMITED:
            limits[i]["impulse"] = max(p, 0.0)
            add_limit(table, h, k)
        elif row["source"] == CABLE_LOAD:
            slips[i]["pressed"] = p
        elif row["source"] == CABLE_FRICTION:
            slips[i]["impulse"], slips[i]["mode"] = p, row["mode"]
        elif row["source"] == JOINT_LOAD:
            frictions[i]["pressed"] = p
        elif row["source"] == JOINT_FRICTION:
            mode, bound = row["mode"], math.nan
            if row["phase"] == HOLDS:
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
    if limit["what"] == LINE:
        out["fx"] += limit["side"] * out["dx"] * p / h
        out["fy"] += limit["side"] * out["dy"] * p / h
    if limit["what"] == FLANK:
        out["fx"] += row["bx"] * p / h
        out["fy"] += row["by"] * p / h


@kernel
def _change_flank(joint: Any, unknown: Array) -> None:
    """Teeth push: where they would have to pull, the other side of them pushes in the next step."""
    if toothed(joint) and joint["row"] >= 0 and unknown[joint["row"]] < 0.0:
        joint["flank"] = -joint["flank"]


@kernel
def joint_force(h: float, joint: Any, unknown: Array) -> None:
    """What the rows of a joint carry, without its limits."""
    joint["fx"], joint["fy"], joint["couple"] = joint["kick_x"] / h, joint["kick_y"] / h, 0.0
    if joint["row"] >= 0:
        p = unknown[joint["row"]] / h
        if joint["keeps"] == POINT:
            joint["fx"] += p
            joint["fy"] += unknown[joint["row_y"]] / h
        elif joint["keeps"] == GROOVE:
            joint["fx"] -= joint["dy"] * p
            joint["fy"] += joint["dx"] * p
        else:
            joint["fx"] += joint["dx"] * p
            joint["fy"] += joint["dy"] * p
        if joint["keeps"] == ROLL:
            p = unknown[joint["row_y"]] / h
            if joint["ra"] + joint["rb"] < 0.0:
                p = -p
            joint["fx"] += joint["dy"] * p
            joint["fy"] -= joint["dx"] * p
    if joint["row_turn"] >= 0:
        joint["couple"] = unknown[joint["row_turn"]] / h


@entry_point()
def add_work(table: int, h: float) -> None:
    """Add the work [J] of the step just made to ``work``, and give it alone as ``step_work``.

    The free velocities are overwritten by the means of before and after the step, and by what
    impacts displace: h times that is the way on which forces do their work.
    """
    body, before, v, shift = at.body(table), at.before(table), at.free(table), at.shift(table)
    for i in range(len(body)):
        for j in range(3):
            v[i, j] = (body[i, 3 + j] + before[i, j]) / 2 + shift[i, j] / h
    actions, motors = at.actions(table), at.motors(table)
    for i in range(len(actions)):
        action = actions[i]
        a = action["a"]
        if action["runs"]:
            action["torque"] = _tangential_impulse(table, a) * at.belts(table)[a] / h
            action["step_work"] = h * action["torque"]
            action["work"] += action["step_work"]
            continue
        if action["motor"] >= 0:
            action["torque"] = motors[action["motor"]]["impulse"] / h
        if action["joint"] >= 0:
            power = action["torque"] * joint_rate(table, action["joint"], v)
        else:
            power = (action["fx"] * v[a, 0] + action["fy"] * v[a, 1]
                     + action["torque"] * v[a, 2])
        action["step_work"] = h * power
        action["work"] += h * power
    add_spring_work(table, h, v)
    add_cable_work(table, h, v)
    add_friction_work(table, h, v)
    add_fluid_work(table, h, v)
    add_load_work(table, h, v)


@kernel
def _tangential_impulse(table: int, body: int) -> float:
    """Impulse on what touches a body along the body's surface, counter-clockwise [N s]."""
    touches, p = at.touches(table), 0.0
    for i in range(at.touching(table)[0]):
        if touches[i]["a"] == body or touches[i]["b"] == body:
            p += touches[i]["tangent"] + touches[i]["drag"]
    return p
