"""Results of a step: impulses as forces of the elements, and the work of all of them.

Over one step a force does the work h F . (v_before + v_after) / 2. With this rule the work of all
forces and impulses on a body is its increase of kinetic energy, to rounding. Work is summed in each
step, because an impact lasts one step and samples would miss it.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.coordinates import toothed
from sandbox.engine.entry_points import entry_point
from sandbox.engine.fluid_report import add_fluid_work, report_lines
from sandbox.engine.friction import add_friction_work, release_friction, report_friction
from sandbox.engine.islands import PILED
from sandbox.engine.kernel import kernel
from sandbox.engine.loads import add_load_work
from sandbox.engine.records import FLANK, GROOVE, LINE, POINT, ROLL
from sandbox.engine.rows import joint_rate
from sandbox.engine.springs import add_spring_work, report_springs
from sandbox.engine.state import (
    CABLE_FRICTION,
    CABLE_LOAD,
    HOLDS,
    JOINT_FRICTION,
    JOINT_LOAD,
    LIMITED,
    NORMAL,
    TANGENT,
)
from sandbox.engine.tendons import add_cord_work, report_cords, slipped
from sandbox.engine.ties import acts, holds, tied
from sandbox.numeric import Array


@entry_point()
def report(table: int, h: float, drive: Array, n: int) -> None:
    """Write the impulses into the tables of their elements."""
    unknown = at.unknowns(table)[3]
    report_springs(table, h)
    report_cords(table, h)
    slipped(table, h)
    joints, joint_results, joint_states = (
        at.joints(table), at.joint_results(table), at.joint_states(table))
    for i in range(len(joints)):
        if acts(table, joints[i]["tie"]):
            joint_force(h, joints[i], joint_results[i], unknown)
        _change_flank(joints[i], joint_states[i], unknown)
    _report_bounded(table, h, n)
    tied(table, h)
    report_lines(table, h, drive)


@kernel
def _report_bounded(table: int, h: float, n: int) -> None:
    rows, touches, motors = at.rows(table), at.touches(table), at.motor_states(table)
    states, rubs = at.limit_states(table), at.dry_friction_states(table)
    slips, motor_table, joints = at.slip_states(table), at.motors(table), at.joints(table)
    for i in range(len(slips)):
        slips[i]["impulse"] = slips[i]["sum"] = slips[i]["mode"] = 0
    for i in range(len(states)):
        if acts(table, joints[at.limits(table)[i]["joint"]]["tie"]):
            states[i]["impulse"] = 0.0
    for i in range(len(motors)):
        tie = motor_table[i]["tie"]
        if not holds(table, tie):
            motors[i]["target"] = math.nan
            if acts(table, tie):
                motors[i]["impulse"] = 0.0
    for i in range(len(rubs)):
        tie = joints[at.dry_friction(table)[i]["joint"]]["tie"]
        if not holds(table, tie):
            release_friction(table, h, i, 0.0 if acts(table, tie) else rubs[i]["impulse"])
    for i in range(at.touching(table)[0]):
        t = touches[i]
        if t["listed"] == PILED:
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
            states[i]["impulse"] = max(p, 0.0)
            add_limit(table, h, k)
        elif row["source"] == CABLE_LOAD:
            slips[i]["sum"] = p
        elif row["source"] == CABLE_FRICTION:
            slips[i]["impulse"], slips[i]["mode"] = p, row["mode"]
        elif row["source"] == JOINT_LOAD:
            rubs[i]["pressed"] = p
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
    out = at.joint_results(table)[limit["joint"]]
    if limit["what"] == LINE:
        out["fx"] += limit["side"] * out["dx"] * p / h
        out["fy"] += limit["side"] * out["dy"] * p / h
    if limit["what"] == FLANK:
        out["fx"] += row["bx"] * p / h
        out["fy"] += row["by"] * p / h


@kernel
def _change_flank(joint: Any, state: Any, unknown: Array) -> None:
    """Teeth push: where they would have to pull, the other side of them pushes in the next step."""
    if toothed(joint) and joint["row"] >= 0 and unknown[joint["row"]] < 0.0:
        state["flank"] = -state["flank"]


@kernel
def joint_force(h: float, joint: Any, out: Any, unknown: Array) -> None:
    """What the rows of a joint carry, without its limits."""
    out["fx"], out["fy"], out["couple"] = out["kick_x"] / h, out["kick_y"] / h, 0.0
    if joint["row"] >= 0:
        p = unknown[joint["row"]] / h
        if joint["keeps"] == POINT:
            out["fx"] += p
            out["fy"] += unknown[joint["row_y"]] / h
        elif joint["keeps"] == GROOVE:
            out["fx"] -= out["dy"] * p
            out["fy"] += out["dx"] * p
        else:
            out["fx"] += out["dx"] * p
            out["fy"] += out["dy"] * p
        if joint["keeps"] == ROLL:
            p = unknown[joint["row_y"]] / h
            if joint["ra"] + joint["rb"] < 0.0:
                p = -p
            out["fx"] += out["dy"] * p
            out["fy"] -= out["dx"] * p
    if joint["row_turn"] >= 0:
        out["couple"] = unknown[joint["row_turn"]] / h


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
    actions, states, results = at.actions(table), at.action_states(table), at.action_results(table)
    motors = at.motor_states(table)
    for i in range(len(actions)):
        action, result = actions[i], results[i]
        a = action["a"]
        if action["runs"]:
            result["torque"] = _tangential_impulse(table, a) * at.belts(table)[a] / h
            result["step_work"] = h * result["torque"]
            states[i]["work"] += result["step_work"]
            continue
        if action["motor"] >= 0:
            result["torque"] = motors[action["motor"]]["impulse"] / h
        if action["joint"] >= 0:
            power = result["torque"] * joint_rate(table, action["joint"], v)
        else:
            power = (result["fx"] * v[a, 0] + result["fy"] * v[a, 1]
                     + result["torque"] * v[a, 2])
        result["step_work"] = h * power
        states[i]["work"] += h * power
    add_spring_work(table, h, v)
    add_cord_work(table, h, v)
    add_friction_work(table, h, v)
    add_fluid_work(table, h, v)
    add_load_work(table, h, v)


@kernel
def _tangential_impulse(table: int, body: int) -> float:
    """Impulse on what touches a body along the body's surface, counter-clockwise [N s]."""
    touches, p = at.touches(table), 0.0
    for i in range(at.touching(table)[0]):
        if touches[i]["a"] == body or touches[i]["b"] == body:
            p += touches[i]["tangent"] + touches[i]["rub"]
    return p
