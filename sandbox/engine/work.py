"""Work done by every element that carries force, added up step by step.

Over one step a force does h F . (v_before + v_after) / 2, and that makes the
balance exact: summed over all forces and impulses on a body it is its increase
of kinetic energy, to rounding. Sampling afterwards could not: an impact lasts one
step.
"""

from __future__ import annotations

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.fluid_report import add_fluid_work
from sandbox.engine.kernel import kernel
from sandbox.engine.loads import add_load_work
from sandbox.engine.records import GRIPPED, PULL
from sandbox.engine.rows import shortening, way_rate
from sandbox.engine.rubs import add_rubbed_work
from sandbox.engine.springs import add_spring_work
from sandbox.numeric import Array


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
            result["torque"] = _rubbed(table, a) * at.belts(table)[a] / h
            result["step_work"] = h * result["torque"]
            states[i]["work"] += result["step_work"]
            continue
        if action["motor"] >= 0:
            result["torque"] = motors[action["motor"]]["impulse"] / h
        if action["line"] >= 0:
            power = result["torque"] * way_rate(table, action["line"], v)
        elif action["b"] >= 0:
            power = result["torque"] * (v[action["b"], 2] - v[a, 2])
        else:
            power = (result["fx"] * v[a, 0] + result["fy"] * v[a, 1]
                     + result["torque"] * v[a, 2])
        result["step_work"] = h * power
        states[i]["work"] += h * power
    add_spring_work(table, h, v)
    _cords(table, h, v)
    add_rubbed_work(table, h, v)
    add_fluid_work(table, h, v)
    add_load_work(table, h, v)


@kernel
def _rubbed(table: int, body: int) -> float:
    """Impulse on what touches a body along the body's surface, counter-clockwise [N s]."""
    touches, p = at.touches(table), 0.0
    for i in range(at.touching(table)[0]):
        if touches[i]["a"] == body or touches[i]["b"] == body:
            p += touches[i]["tangent"] + touches[i]["rub"]
    return p


@kernel
def _cords(table: int, h: float, v: Array) -> None:
    cords, states, results = at.cords(table), at.cord_states(table), at.cord_results(table)
    guides, pulls = at.guides(table), at.guide_results(table)
    for i in range(len(cords)):
        if cords[i]["kind"] != GRIPPED:
            rate = shortening(cords[i], guides, pulls, v)
            results[i]["step_work"] = h * results[i]["tension"] * rate
            states[i]["work"] += results[i]["step_work"]
    for i in range(len(cords)):
        if cords[i]["kind"] == GRIPPED:
            results[i]["step_work"] = 0.0
            for k in range(cords[i]["spans"], cords[i]["spans_end"]):
                results[i]["step_work"] += results[k]["step_work"]
            states[i]["work"] += results[i]["step_work"]
    slips, slip_results = at.slips(table), at.slip_results(table)
    for i in range(len(slips)):  # what a drive pulls over the last guide is work of it, too
        end = slips[i]["after"]
        if cords[end]["kind"] == PULL:
            drawn = h * results[end]["tension"] * slip_results[i]["rate"]
            results[end]["step_work"] += drawn
            states[end]["work"] += drawn
