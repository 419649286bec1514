"""What a sample keeps of a step, copied by compiled code into one row of the sampler."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from sandbox.engine.state import Constants, Result, State
from sandbox.numeric import Array, Integers, Records

CONTACT = np.dtype([
    ("a", np.int64), ("b", np.int64),   # bodies
    ("x", float), ("y", float),         # place in the world [m]
    ("nx", float), ("ny", float),       # normal from a to b
    ("gap", float),                     # [m]
    ("normal", float), ("tangent", float),  # impulses on b, along (nx, ny) and (-ny, nx) [N s]
])


class Snapshot(NamedTuple):
    """Memory for the raw numbers of samples, an axis of samples before all others.

    ``work`` counts up to the end of the step, ``step_work`` is that step's part of it [J].
    """

    body: Array
    """Poses, and velocities after the step, [n, nb, 6]."""
    before: Array
    """Velocities before the step, [n, nb, 3]."""
    springs: Array
    """Length [m], force [N], work, step_work, [n, ns, 4]."""
    cords: Array
    """Length [m], tension [N], work, step_work, [n, nt, 4]."""
    dampers: Array
    """Torque [N m], work, step_work, [n, nh, 3]."""
    actions: Array
    """Torque [N m], work, step_work, [n, na, 3]."""
    joints: Array
    """Force on b in the world [N], couple on b [N m], [n, nj, 3]."""
    limits: Array
    """Torque of stops [N m], force along the line of others [N], [n, nl]."""
    drive: Array
    """What the drives gave in that step, [n, nd]."""
    contacts: Records
    """CONTACT of all samples, one after the other."""
    fill: Integers
    """How many contacts there are up to the end of each sample, [n]."""


def make_snapshot(samples: int, constants: Constants, drives: int, contacts: int) -> Snapshot:
    """Memory for so many samples of a run, and so many contacts in all of them together."""
    bodies = len(constants.inverse_mass)
    shapes = ((bodies, 6), (bodies, 3), (len(constants.springs), 4), (len(constants.cords), 4),
              (len(constants.dampers), 3), (len(constants.actions), 3),
              (len(constants.joints), 3), (len(constants.limits),), (drives,))
    return Snapshot(*(np.empty((samples, *shape)) for shape in shapes),
                    np.zeros(contacts, CONTACT), np.zeros(samples, dtype=np.int64))


@njit(cache=True, inline="always")
def take(
    kept: Snapshot, n: int, h: float, constants: Constants, state: State, result: Result,
    drive: Array,
) -> None:
    """Copy the step just made into row ``n`` of ``kept``."""
    for i in range(len(state.body)):  # an assignment of arrays would compile its error messages
        for j in range(6):
            kept.body[n, i, j] = state.body[i, j]
        for j in range(3):
            kept.before[n, i, j] = result.before[i, j]
    for i in range(len(result.springs)):
        s = result.springs[i]
        kept.springs[n, i, 0], kept.springs[n, i, 1] = s["length"], s["force"]
        kept.springs[n, i, 2], kept.springs[n, i, 3] = state.springs[i]["work"], s["step_work"]
    for i in range(len(result.cords)):
        t = result.cords[i]
        kept.cords[n, i, 0], kept.cords[n, i, 1] = t["length"], t["tension"]
        kept.cords[n, i, 2], kept.cords[n, i, 3] = state.cords[i]["work"], t["step_work"]
    for i in range(len(result.dampers)):
        d = state.dampers[i]
        kept.dampers[n, i, 0], kept.dampers[n, i, 1] = d["torque"], d["work"]
        kept.dampers[n, i, 2] = result.dampers[i]["step_work"]
    for i in range(len(result.actions)):
        a = result.actions[i]
        kept.actions[n, i, 0], kept.actions[n, i, 1] = a["torque"], state.actions[i]["work"]
        kept.actions[n, i, 2] = a["step_work"]
    for i in range(len(result.joints)):
        j = result.joints[i]
        kept.joints[n, i, 0], kept.joints[n, i, 1] = j["fx"], j["fy"]
        kept.joints[n, i, 2] = j["couple"]
    for i in range(len(state.limits)):
        kept.limits[n, i] = state.limits[i]["impulse"] / h
    for i in range(len(drive)):
        kept.drive[n, i] = drive[i]
    first = kept.fill[n - 1] if n > 0 else 0
    kept.fill[n] = list_contacts(
        state.touches, state.touching[0], state.body, kept.contacts, first)


@njit(cache=True, error_model="numpy")
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
