"""What a sample keeps of a step, copied by compiled code into one row of the sampler."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.engine import memory as at
from sandbox.engine.kernel import kernel
from sandbox.engine.state import CONTACT, Constants, Snapshot
from sandbox.numeric import Array, Integers, Records


def make_snapshot(samples: int, constants: Constants, drives: int, contacts: int) -> Snapshot:
    """Memory for so many samples of a run, and so many contacts in all of them together."""
    bodies = len(constants.inverse_mass)
    shapes = ((bodies, 6), (bodies, 3), (len(constants.springs), 4), (len(constants.cords), 4),
              (len(constants.dampers), 3), (len(constants.actions), 3),
              (len(constants.joints), 3), (len(constants.limits),), (drives,))
    kept: list[Any] = [*(np.empty((samples, *shape)) for shape in shapes),
                       np.zeros(contacts, CONTACT), np.zeros(samples, dtype=np.int64)]
    return Snapshot(*kept)


@kernel
def take(table: Integers, h: float, n: int, drive: Array) -> None:
    """Copy the step just made, with its drives [nd], into row ``n`` of what samples are kept in."""
    body, before, kept = at.body(table), at.before(table), at.kept_body(table)
    kept_before = at.kept_before(table)
    for i in range(len(body)):  # an assignment of arrays would compile its error messages
        for j in range(6):
            kept[n, i, j] = body[i, j]
        for j in range(3):
            kept_before[n, i, j] = before[i, j]
    springs, spring_results = at.spring_states(table), at.spring_results(table)
    kept = at.kept_springs(table)
    for i in range(len(springs)):
        s = spring_results[i]
        kept[n, i, 0], kept[n, i, 1] = s["length"], s["force"]
        kept[n, i, 2], kept[n, i, 3] = springs[i]["work"], s["step_work"]
    cords, cord_results = at.cord_states(table), at.cord_results(table)
    kept = at.kept_cords(table)
    for i in range(len(cords)):
        t = cord_results[i]
        kept[n, i, 0], kept[n, i, 1] = t["length"], t["tension"]
        kept[n, i, 2], kept[n, i, 3] = cords[i]["work"], t["step_work"]
    dampers, damper_results = at.damper_states(table), at.damper_results(table)
    kept = at.kept_dampers(table)
    for i in range(len(dampers)):
        kept[n, i, 0], kept[n, i, 1] = dampers[i]["torque"], dampers[i]["work"]
        kept[n, i, 2] = damper_results[i]["step_work"]
    actions, action_results = at.action_states(table), at.action_results(table)
    kept = at.kept_actions(table)
    for i in range(len(actions)):
        kept[n, i, 0], kept[n, i, 1] = action_results[i]["torque"], actions[i]["work"]
        kept[n, i, 2] = action_results[i]["step_work"]
    joints, kept = at.joint_results(table), at.kept_joints(table)
    for i in range(len(joints)):
        kept[n, i, 0], kept[n, i, 1] = joints[i]["fx"], joints[i]["fy"]
        kept[n, i, 2] = joints[i]["couple"]
    limits, kept_limits = at.limit_states(table), at.kept_limits(table)
    for i in range(len(limits)):
        kept_limits[n, i] = limits[i]["impulse"] / h
    kept_drive = at.kept_drive(table)
    for i in range(len(drive)):
        kept_drive[n, i] = drive[i]
    fill = at.kept_fill(table)
    first = fill[n - 1] if n > 0 else 0
    fill[n] = list_contacts(
        at.touches(table), at.touching(table)[0], body, at.kept_contacts(table), first)


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
            m += 1
    return m
