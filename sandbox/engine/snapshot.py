"""What a sample keeps of a step, copied by compiled code into the next row of the sampler."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.fluid_report import take_lines
from sandbox.engine.kernel import kernel
from sandbox.engine.loads import take_loads
from sandbox.engine.records import STOP
from sandbox.engine.state import (
    ANGLE,
    CONTACT,
    CONTACT_SUMS,
    DAMPED_WORK,
    DAMPING,
    RATE,
    RUBBED,
    RUBBED_WORK,
    STICKS,
    STOPPING,
    Constants,
    Snapshot,
)
from sandbox.kinds.arrays import FORCES
from sandbox.numeric import Array, Records


def make_snapshot(samples: int, constants: Constants, drives: int, contacts: int) -> Snapshot:
    """Memory for so many samples of a run, and so many contacts in all of them together."""
    bodies = len(constants.inverse_mass)
    shapes = ((bodies, 3), (bodies, 3), (bodies, 3), (len(constants.springs), 3),
              (len(constants.cords), 3), (len(constants.slips), 2), (len(constants.wheels),),
              (len(constants.actions), 2),
              (len(constants.joints), STICKS + 1), (len(constants.fluids), 7),
              (len(constants.valves), 2), (len(constants.pumps), 2), (len(constants.loads), 4))
    tendons = np.count_nonzero(constants.cords["whole"] < 0)
    forces = FORCES * len(constants.joints) + tendons + len(constants.slips) + drives
    kept: list[Any] = [*(np.full((samples, *shape), np.nan) for shape in shapes),
                       np.zeros((samples, len(constants.ties)), dtype=np.int64),
                       np.full((samples, drives), np.nan),
                       np.zeros(contacts, CONTACT), np.zeros(samples, dtype=np.int64),
                       np.zeros(4, dtype=np.int64), np.zeros(forces), np.zeros((samples, forces)),
                       np.zeros(samples, dtype=np.int64), np.zeros(2),
                       np.zeros(2 * contacts, CONTACT_SUMS), np.zeros(samples, dtype=np.int64),
                       np.zeros(2, dtype=np.int64)]
    return Snapshot(*kept)


@kernel
def room_to_keep(table: int) -> bool:
    """Whether one more sample can be kept, however many contacts it has; noted if not."""
    fill, taken = at.kept_fill(table), at.kept_taken(table)
    n = taken[0] - taken[1]
    used = fill[n - 1] if n > 0 else 0
    if (n == len(fill) or used + len(at.touches(table)) > len(at.kept_contacts(table))
            or 2 * at.kept_unfinished(table)[0] > len(at.kept_mean_contacts(table))):
        taken[2] = 1
    return bool(taken[2] == 0)


@entry_point()
def take(table: int, h: float, drive: Array) -> None:
    """Copy the step just made, with its drives [nd], into the next row that samples are kept in."""
    taken = at.kept_taken(table)
    n = taken[0] - taken[1]
    _take_bodies(table, h, n)
    springs, spring_results = at.spring_states(table), at.spring_results(table)
    kept = at.kept_springs(table)
    for i in range(len(springs)):
        s = spring_results[i]
        kept[n, i, 0], kept[n, i, 1] = s["length"], s["force"]
        kept[n, i, 2] = springs[i]["work"] - s["step_work"] / 2
    cords, cord_results = at.cord_states(table), at.cord_results(table)
    kept = at.kept_cords(table)
    for i in range(len(cords)):
        t = cord_results[i]
        kept[n, i, 0], kept[n, i, 1] = t["length"], t["tension"]
        kept[n, i, 2] = cords[i]["work"] - t["step_work"] / 2
    slips, slip_results = at.slip_states(table), at.slip_results(table)
    kept = at.kept_slips(table)
    for i in range(len(slips)):
        kept[n, i, 0] = slip_results[i]["force"]
        kept[n, i, 1] = slips[i]["way"]
    wheels, guides, off = at.wheels(table), at.guide_states(table), at.kept_lifted(table)
    for i in range(len(wheels)):
        off[n, i] = guides[wheels[i]]["lifted"]
    actions, action_results = at.action_states(table), at.action_results(table)
    kept = at.kept_actions(table)
    for i in range(len(actions)):
        kept[n, i, 0] = action_results[i]["torque"]
        kept[n, i, 1] = actions[i]["work"] - action_results[i]["step_work"] / 2
    take_joints(table, h, n)
    take_lines(table, n)
    take_loads(table, n)
    ties, kept_ties = at.tie_states(table), at.kept_ties(table)
    for i in range(len(ties)):
        kept_ties[n, i] = ties[i]["held"]
    kept_drive = at.kept_drive(table)
    for i in range(len(drive)):
        kept_drive[n, i] = drive[i]
    fill = at.kept_fill(table)
    first = fill[n - 1] if n > 0 else 0
    fill[n] = list_contacts(
        at.touches(table), at.touching(table)[0], at.body(table), at.kept_contacts(table), first)
    at.kept_steady(table)[n] = 1
    taken[0] += 1


@kernel
def _take_bodies(table: int, h: float, n: int) -> None:
    body, before, turn, bodies = (
        at.body(table), at.before(table), at.turn(table), at.bodies(table))
    pose, velocity, acceleration = (
        at.kept_pose(table), at.kept_velocity(table), at.kept_acceleration(table))
    for i in range(len(body)):
        b, c, s = bodies[i], turn[i, 0], turn[i, 1]
        m = b["number"]
        pose[n, m, 0] = body[i, 0] - (c * b["x"] - s * b["y"])
        pose[n, m, 1] = body[i, 1] - (s * b["x"] + c * b["y"])
        pose[n, m, 2] = body[i, 2]
        for j in range(3):  # an assignment of arrays would compile its error messages
            velocity[n, m, j] = (before[i, j] + body[i, 3 + j]) / 2
            acceleration[n, m, j] = (body[i, 3 + j] - before[i, j]) / h


@kernel
def list_contacts(touches: Records, count: int, body: Array, out: Records, m: int) -> int:
    """Note the points that carry something from row ``m`` of ``out`` on; where it ends."""
    for i in range(count):
        t, c = touches[i], out[m]
        normal = t["normal"] + t["bounce"]
        if normal > 0.0:
            c["a"], c["b"], c["gap"] = t["a"], t["b"], t["gap"]
            c["x"], c["y"] = body[t["a"], 0] + t["ax"], body[t["a"], 1] + t["ay"]
            c["nx"], c["ny"] = t["nx"], t["ny"]
            c["normal"], c["tangent"] = normal, t["tangent"] + t["rub"]
            c["twist"] = twist_of(body, t)
            m += 1
    return m


@kernel
def twist_of(body: Array, t: Any) -> float:
    """Moment that a contact's impulse has on body b besides that at the place on body a [N m s].

    An impact is where both surfaces will be when it happens, which is not one place at the pose.
    """
    if t["bounce"] == 0.0:
        return 0.0
    x = body[t["b"], 0] + t["bx"] - body[t["a"], 0] - t["ax"]
    y = body[t["b"], 1] + t["by"] - body[t["a"], 1] - t["ay"]
    normal, tangent = t["normal"] + t["bounce"], t["tangent"] + t["rub"]
    return float(x * (normal * t["ny"] + tangent * t["nx"])
                 - y * (normal * t["nx"] - tangent * t["ny"]))


@entry_point()
def take_joints(table: int, h: float, n: int) -> None:
    """Copy the values of joints into row ``n`` of the samples."""
    kept = at.kept_joints(table)[n]
    joints, results, body, before = (
        at.joints(table), at.joint_results(table), at.body(table), at.before(table))
    for i in range(len(joints)):
        joint, result = joints[i], results[i]
        kept[i, 0], kept[i, 1], kept[i, 2] = result["fx"], result["fy"], result["couple"]
        if joint["hinge"]:
            a, b, sense = joint["a"], joint["b"], joint["sense"]
            kept[i, ANGLE] = sense * (body[b, 2] - body[a, 2]) - joint["zero"]
            kept[i, RATE] = sense * (body[b, 5] + before[b, 2] - body[a, 5] - before[a, 2]) / 2
            kept[i, DAMPING] = kept[i, DAMPED_WORK] = 0.0
        if joint["line"]:
            a, b = joint["a"], joint["b"]
            kept[i, ANGLE] = result["way"]
            kept[i, RATE] = (
                result["dx"] * (body[b, 3] + before[b, 0] - body[a, 3] - before[a, 0])
                + result["dy"] * (body[b, 4] + before[b, 1] - body[a, 4] - before[a, 1])
                + result["ta"] * (body[a, 5] + before[a, 2])
                + result["tb"] * (body[b, 5] + before[b, 2])) / 2
        if joint["stopped"]:
            kept[i, STOPPING] = 0.0
    dampers, states, work = at.dampers(table), at.damper_states(table), at.damper_results(table)
    for i in range(len(dampers)):
        j = dampers[i]["joint"]
        kept[j, DAMPING] = joints[j]["sense"] * states[i]["torque"]
        kept[j, DAMPED_WORK] = states[i]["work"] - work[i]["step_work"] / 2
    rubs, rubbed, done = at.rubs(table), at.rub_results(table), at.rub_states(table)
    for i in range(len(rubs)):
        j = rubs[i]["joint"]
        kept[j, RUBBED], kept[j, STICKS] = rubbed[i]["force"], rubbed[i]["sticks"]
        kept[j, RUBBED_WORK] = done[i]["work"] - rubbed[i]["step_work"] / 2
    limits, stops = at.limits(table), at.limit_states(table)
    for i in range(len(limits)):
        if limits[i]["what"] == STOP:
            j = limits[i]["joint"]
            kept[j, STOPPING] += joints[j]["sense"] * limits[i]["side"] * stops[i]["impulse"] / h
