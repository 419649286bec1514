"""Work done by every element that carries force, added up step by step.

Over one step a force does h F . (v_before + v_after) / 2, and that makes the
balance exact: summed over all forces and impulses on a body it is its increase
of kinetic energy, to rounding. Sampling afterwards could not: an impact lasts one
step.
"""

from __future__ import annotations

from numba import njit

from sandbox.engine.state import Constants, Result, State


@njit(cache=True, error_model="numpy")
def add_work(constants: Constants, state: State, result: Result) -> None:
    """Add the work [J] of the step just made to ``work``, and give it alone as ``step_work``.

    ``result.free`` is overwritten by the mean velocities of the step.
    """
    h, body, before, v = constants.h, state.body, result.before, result.free
    for i in range(len(body)):
        for j in range(3):
            v[i, j] = (body[i, 3 + j] + before[i, j]) / 2
    for i in range(len(constants.actions)):
        action, action_result = constants.actions[i], result.actions[i]
        a = action["a"]
        if action["motor"] >= 0:
            action_result["torque"] = state.motors[action["motor"]]["impulse"] / h
        if action["b"] >= 0:
            power = action_result["torque"] * (v[action["b"], 2] - v[a, 2])
        else:
            power = (
                action_result["fx"] * v[a, 0] + action_result["fy"] * v[a, 1]
                + action_result["torque"] * v[a, 2]
            )
        action_result["step_work"] = h * power
        state.actions[i]["work"] += action_result["step_work"]
    for i in range(len(constants.springs)):
        spring_result = result.springs[i]
        a, b = constants.springs[i]["a"], constants.springs[i]["b"]
        rate = (
            spring_result["ux"] * (v[b, 0] - v[a, 0]) + spring_result["uy"] * (v[b, 1] - v[a, 1])
            + spring_result["tb"] * v[b, 2] - spring_result["ta"] * v[a, 2]
        )
        spring_result["step_work"] = -h * spring_result["force"] * rate
        state.springs[i]["work"] += spring_result["step_work"]
    for i in range(len(constants.dampers)):
        d, memory = constants.dampers[i], state.dampers[i]
        work = h * memory["torque"] * (v[d["b"], 2] - v[d["a"], 2])
        result.dampers[i]["step_work"] = work
        memory["work"] += work
    for e in range(len(constants.cords)):
        cord, cord_result = constants.cords[e], result.cords[e]
        rate = 0.0
        for n in range(cord["first"], cord["last"]):
            guide = result.guides[n]
            b = constants.guides[n]["body"]
            rate += guide["jx"] * v[b, 0] + guide["jy"] * v[b, 1] + guide["jt"] * v[b, 2]
        cord_result["step_work"] = -h * cord_result["tension"] * rate
        state.cords[e]["work"] += cord_result["step_work"]
