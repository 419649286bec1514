"""The inner loop: move, measure, apply forces, solve, report, sample.

Samples are copies of arrays, contacts, and means of forces over sample intervals. An interval lies
around its sample, so the mean belongs to the instant of the sample, to second order. With an even
number of steps per interval, the step between two samples counts half for either. Intervals meet,
so that the sum of means is the sum of impulses.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.elements.arrays import FORCES
from sandbox.engine import fluids, loads, springs, tendons
from sandbox.engine import memory as at
from sandbox.engine.bonds import release_and_engage
from sandbox.engine.contacts import gap_rate, list_contacts_of_step, short
from sandbox.engine.coordinates import note_rate
from sandbox.engine.entry_points import CalledFromPython, entry_point
from sandbox.engine.impacts import REBOUND
from sandbox.engine.islands import skin_compliance
from sandbox.engine.kernel import kernel
from sandbox.engine.motors import drive_forces
from sandbox.engine.native import call_each, call_step, copy_words
from sandbox.engine.records import SAMPLED, STOP
from sandbox.engine.report import add_work
from sandbox.engine.rows import turned
from sandbox.engine.search import PASSING, find_ahead, overlapped, search
from sandbox.engine.solve import SETTLED, solve
from sandbox.engine.state import AWAY, CLOSING, RESTING, Snapshot, allocate
from sandbox.engine.tables import Tables
from sandbox.numeric import Array, Matrix, Records, Stack


def make_snapshot(samples: int, tables: Tables, contacts: int) -> Snapshot:
    """Memory for so many samples of a run, and so many contacts in all of them together."""
    elements, copied, copies = tables.elements, {}, []
    for name, begin in SAMPLED.items():
        records = getattr(elements, name)
        fields = records.dtype.descr
        offset = records.dtype.fields[begin][1]
        tail = np.dtype([field for field in fields if records.dtype.fields[field[0]][1] >= offset])
        copied[name] = np.zeros((samples, len(records)), tail)
        copies.append((records.ctypes.data + offset, copied[name].ctypes.data, len(records),
                       records.itemsize // 8, tail.itemsize // 8))
    drives = len(tables.state.last_drive)
    tendons = int(np.count_nonzero(elements.cables["whole"] < 0))
    sizes = {
        "samples": samples, "bodies": len(tables.constants.bodies), "drives": drives,
        "contacts": contacts, "mean_contacts": 2 * contacts,
        "forces": FORCES * len(elements.joints) + tendons + len(elements.slips) + drives}
    made: Snapshot = allocate(Snapshot, sizes, copied=copied, copies=np.array(copies))
    return made


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
    body, before, turn, bodies = at.body(table), at.before(table), at.turn(table), at.bodies(table)
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
    copies = at.kept_copies(table)
    for i in range(len(copies)):
        count, words = copies[i, 2], copies[i, 4]
        for k in range(count):
            copy_words(copies[i, 0] + 8 * k * copies[i, 3],
                       copies[i, 1] + 8 * (n * count + k) * words, words)
    accuracy = at.accuracy(table)
    at.kept_residual(table)[n] = max(accuracy[5], accuracy[0])  # at rest the last step repeats
    accuracy[5] = 0.0
    kept_drive = at.kept_drive(table)
    for i in range(len(drive)):
        kept_drive[n, i] = drive[i]
    fill = at.kept_fill(table)
    first = fill[n - 1] if n > 0 else 0
    fill[n] = list_contacts(
        at.touches(table), at.touching(table)[0], body, at.kept_contacts(table), first)
    at.kept_steady(table)[n] = 1
    taken[0] += 1


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
            c["normal"], c["tangent"] = normal, t["tangent"] + t["drag"]
            c["twist"] = 0.0
            if t["bounce"] != 0.0 or t["ahead"] > 0.0:  # it is where both surfaces will be then
                x = body[t["b"], 0] + t["bx"] - body[t["a"], 0] - t["ax"]
                y = body[t["b"], 1] + t["by"] - body[t["a"], 1] - t["ay"]
                tangent = t["tangent"] + t["drag"]
                c["twist"] = (x * (normal * t["ny"] + tangent * t["nx"])
                              - y * (normal * t["nx"] - tangent * t["ny"]))
            m += 1
    return m


@kernel
def room_for_contacts(table: int) -> bool:
    """Whether there is room for the impacts and mean contacts of one more step; noted if not."""
    near, unfinished = len(at.touches(table)), at.kept_unfinished(table)
    rows = unfinished[0] + unfinished[1] + 2 * near
    impacts = at.made(table)[3] + near
    if rows > len(at.kept_mean_contacts(table)) or impacts > len(at.impacts(table)):
        at.kept_taken(table)[2] = 2
        return False
    return True


@kernel
def count_step(table: int, h: float, every: int, due: int) -> None:
    """Count the step to the means of samples ``every`` steps apart, the next in ``due`` steps."""
    waiting = at.kept_waiting(table)
    if every - due != every // 2:
        waiting[0] += 1.0
        return
    share = 1.0 if every % 2 else 0.5
    waiting[0] += share
    keep_means(table, h, every)
    waiting[0] = 1.0 - share


@entry_point()
def keep_means(table: int, h: float, every: int) -> None:
    """Keep the means of an interval, if it is that of a sample, and begin the next one."""
    sums, taken = at.kept_sums(table), at.kept_taken(table)
    unfinished, waiting = at.kept_unfinished(table), at.kept_waiting(table)
    if taken[3] < taken[0]:
        n = taken[0] - taken[1] - 1
        if waiting[1] > 0.0:
            add_forces(table, h)
            at.kept_steady(table)[n] = 0
            for k in range(len(sums)):
                at.kept_means(table)[n, k] = sums[k] / every
            unfinished[0] += unfinished[1]
        at.kept_mean_fill(table)[n] = unfinished[0]
        taken[3] = taken[0]
    if waiting[1] > 0.0:
        for k in range(len(sums)):
            sums[k] = 0.0
        unfinished[1] = 0
        touches = at.touches(table)
        for i in range(at.touching(table)[0]):
            touches[i]["sums"] = -1
        waiting[1] = 0.0


@entry_point()
def add_forces(table: int, h: float) -> None:
    """Add the forces of the last step to the unfinished interval, as often as they are waiting."""
    waiting = at.kept_waiting(table)
    share = waiting[0]
    waiting[0], waiting[1] = 0.0, 1.0
    sums, joints = at.kept_sums(table), at.joints(table)
    for i in range(len(joints)):
        k = FORCES * i
        sums[k] += share * joints[i]["fx"]
        sums[k + 1] += share * joints[i]["fy"]
        sums[k + 2] += share * joints[i]["couple"]
        sums[k + 3] += share * joints[i]["stop"]
    frictions = at.dry_friction(table)
    for i in range(len(frictions)):
        sums[FORCES * frictions[i]["joint"] + 4] += share * frictions[i]["force"]
    k = FORCES * len(joints)
    cables, slips = at.cables(table), at.slips(table)
    tendons = len(sums) - k - len(slips) - len(at.last_drive(table))
    for i in range(tendons):  # spans of tendons come after these
        sums[k + i] += share * cables[i]["tension"]
    k += tendons
    for i in range(len(slips)):
        sums[k + i] += share * slips[i]["force"]
    k += len(slips)
    actions = at.actions(table)
    for i in range(len(actions)):
        if actions[i]["motor"] >= 0:
            sums[k + actions[i]["drive"]] += share * actions[i]["torque"]
    _add_contacts(table, share)


@kernel
def _add_contacts(table: int, share: float) -> None:
    touches, body, unfinished = at.touches(table), at.body(table), at.kept_unfinished(table)
    for i in range(at.touching(table)[0]):
        t = touches[i]
        normal = share * (t["normal"] + t["bounce"])
        if normal > 0.0:
            new = t["sums"] < 0
            if new:
                t["sums"] = unfinished[1]
                unfinished[1] += 1
            c = at.kept_mean_contacts(table)[unfinished[0] + t["sums"]]
            if new:
                c["a"], c["b"] = t["a"], t["b"]
                c["x"] = c["y"] = c["nx"] = c["ny"] = c["px"] = c["py"] = c["normal"] = 0.0
            px, py = _impulse(t)
            c["x"] += normal * (body[t["a"], 0] + t["ax"])
            c["y"] += normal * (body[t["a"], 1] + t["ay"])
            c["nx"] -= normal * t["nx"]
            c["ny"] -= normal * t["ny"]
            c["px"] += share * px
            c["py"] += share * py
            c["normal"] += normal


@kernel
def _impulse(touch: Any) -> tuple[float, float]:
    """Of a contact on its first body in the step just made [N s]."""
    normal, tangent = touch["normal"] + touch["bounce"], touch["tangent"] + touch["drag"]
    return (tangent * touch["ny"] - normal * touch["nx"],
            -tangent * touch["nx"] - normal * touch["ny"])


@entry_point("shapes")
def note_impacts(table: int) -> None:
    """Note contacts hit in this step: free before, and faster than REBOUND or still closing."""
    touches, body, made = at.touches(table), at.body(table), at.made(table)
    for i in range(at.touching(table)[0]):
        t = touches[i]
        last = t["phase"]
        t["phase"] = RESTING if t["normal"] + t["bounce"] > 0.0 else AWAY
        if t["phase"] == AWAY:
            continue
        fast = last == AWAY and gap_rate(at.before(table), t) < -REBOUND
        if fast and gap_rate(at.velocity(table), t) < -REBOUND:
            t["phase"] = CLOSING
        if fast or last == CLOSING or t["bounce"] > 0.0:
            one = at.impacts(table)[made[3]]
            made[3] += 1
            one["step"], one["a"], one["b"] = made[1], t["a"], t["b"]
            one["x"], one["y"] = body[t["a"], 0] + t["ax"], body[t["a"], 1] + t["ay"]
            one["px"], one["py"] = _impulse(t)
            one["after"] = t["instant"] if t["bounce"] > 0.0 else 0.0


FAR = 1e6  # limit of valid positions and speeds [m, rad, m/s, rad/s]

UNKEPT = 0  # as the step to be sampled: none


@kernel
def sound(h: float, body: Array) -> bool:
    """Whether all of ``body`` [nb, 6] is finite and within :data:`FAR`, this step and the next."""
    for i in range(len(body)):
        for j in range(3):  # written so that NaN is not sound
            near = abs(body[i, j] + h * body[i, 3 + j]) < FAR and abs(body[i, 3 + j]) < FAR
            if not near:
                return False
    return True


@kernel
def _again(table: int, drive: Array, speeds: Array) -> bool:
    """Whether all is at rest and this step repeats the last one."""
    standing, last, changed = at.standing(table), at.last_drive(table), False
    for j in range(len(last)):
        changed |= last[j] != drive[j]
        last[j] = drive[j]
    for j in range(len(speeds)):
        changed |= speeds[j, 0] != 0.0 or speeds[j, 1] != 0.0 or speeds[j, 2] != 0.0
    if changed:
        standing[1] = 0
    return bool(standing[1] > SETTLED + 1)


@kernel
def _move(table: int, h: float) -> bool:
    """Move the bodies, unless a step is unfinished; whether there is room for all contacts."""
    touching, body, placed = at.touching(table), at.body(table), at.placed(table)
    velocity, turn = at.velocity(table), at.turn(table)
    if not touching[1]:
        for i in range(len(body)):
            for j in range(3):
                body[i, 3 + j] = velocity[i, j] + 0.0  # as pymunk: without negative zeros
                body[i, j] = placed[i, j] + h * body[i, 3 + j]
            turn[i, 0], turn[i, 1] = turned(at.ahead(table), i, body[i, 2])
    if len(at.neighbors(table)) > 0 and (not touching[1] or touching[2] == 2):
        _find_contacts(table, h)
    touching[1] = short(table)
    return not touching[1]


@entry_point("shapes")
def _find_contacts(table: int, h: float) -> None:
    """Move pymunk's bodies likewise, if any may touch; it finds the points that are near."""
    touching = at.touching(table)
    at.near(table)[0] = 0
    near, parts = search(table, h)
    if not near:
        touching[2] = 1
        return
    _lead(table)
    if parts > PASSING:
        at.standing(table)[6] += overlapped(table, h, parts) and not touching[1]
        touching[2] = 1
        _lead(table)
        at.near(table)[0] = 0
    call_step(at.step(table), at.space(table), h)
    if parts > 1:
        find_ahead(table, h, parts)


@kernel
def _lead(table: int) -> None:
    """Give pymunk's bodies their velocities, and the last poses unless they have them."""
    if at.touching(table)[2]:
        at.place_count(table)[0] = 0
        call_each(at.each_body(table), at.space(table), at.put(table), at.place(table))
        at.touching(table)[2] = 0
    at.write_count(table)[0] = 0
    call_each(at.each_body(table), at.space(table), at.put(table), at.write(table))


@kernel
def _push(table: int, h: float, drive: Array, speeds: Array) -> bool:
    """Find the velocities after the step; whether they are valid."""
    body, velocity, placed, shift = (
        at.body(table), at.velocity(table), at.placed(table), at.shift(table))
    before, force, kick = at.before(table), at.force(table), at.kick(table)
    release_and_engage(table, drive)
    at.made(table)[0] += 1
    for b in range(len(body)):
        for j in range(3):
            before[b, j] = body[b, 3 + j]
            force[b, j] = kick[b, j] = shift[b, j] = 0.0
    drive_forces(table, drive)
    springs.stretch(table, drive)
    tendons.pull(table, drive)
    fluids.measure_volumes(table, drive)
    loads.press(table, h)
    free_velocities(table, h, speeds)
    actions, belts = at.actions(table), at.belts(table)
    for i in range(len(actions)):
        if actions[i]["runs"]:
            belts[actions[i]["a"]] = actions[i]["sense"] * drive[actions[i]["drive"]]
    list_contacts_of_step(table)
    skin_compliance(table, h)
    struck = solve(table, h, drive)
    for b in range(len(body)):
        for j in range(3):
            body[b, 3 + j] = velocity[b, j]
            # impacts after the poses displace them
            placed[b, j] = body[b, j] + shift[b, j] if struck else body[b, j]
    joints, limits = at.joints(table), at.limits(table)
    for i in range(len(joints)):
        note_rate(joints[i], body, before)
        joints[i]["stop"] = 0.0
    for i in range(len(limits)):
        if limits[i]["what"] == STOP:
            joint = joints[limits[i]["joint"]]
            joint["stop"] += joint["sense"] * limits[i]["side"] * limits[i]["impulse"] / h
    at.touching(table)[2] |= struck
    add_work(table, h)
    note_impacts(table)
    return bool(sound(h, body)) and bool(fluids.contained(table)) and at.standing(table)[3] == 0


@CalledFromPython
def advance(table: int, h: float, drive: Matrix, speeds: Stack, due: int, every: int) -> int:
    """Make one step for each row of ``drive`` [n, nd]; returns the number of valid steps.

    Step ``due`` of these, counted from 1, is sampled, and then each ``every``-th. Fewer steps are
    made where the motion becomes invalid or where there is no room for a sample or for contacts.
    ``speeds`` [n, ns, 3] are the velocities of scheduled bodies after each step.
    """
    at.made(table)[3] = 0
    for i in range(len(drive)):
        due -= 1
        if due == 0 and not room_to_keep(table):
            return i
        at.made(table)[1] = i
        if not _again(table, drive[i], speeds[i]):
            if not room_for_contacts(table):
                return i
            if at.kept_waiting(table)[0] > 0.0:  # before the step finds other forces
                add_forces(table, h)
            if not (_move(table, h) and _push(table, h, drive[i], speeds[i])):
                return i
        if every > 1:
            count_step(table, h, every, due)
        if due == 0:
            take(table, h, drive[i])
            due = every
    return len(drive)


@kernel
def free_velocities(table: int, h: float, speeds: Array) -> None:
    """Velocities after the step without constraints; ``speeds`` [ns, 3] are of scheduled bodies."""
    before, free, force = at.before(table), at.free(table), at.force(table)
    inverse_mass, gravity = at.inverse_mass(table), at.gravity(table)
    for i in range(len(free)):
        w, wt = inverse_mass[i, 0], inverse_mass[i, 1]
        if w == 0.0:
            free[i, 0] = free[i, 1] = free[i, 2] = 0.0
            continue
        free[i, 0] = before[i, 0] + h * (gravity[0] + w * force[i, 0])
        free[i, 1] = before[i, 1] + h * (gravity[1] + w * force[i, 1])
        free[i, 2] = before[i, 2] + h * wt * force[i, 2]
    scheduled = at.scheduled(table)
    for i in range(len(scheduled)):
        for j in range(3):
            free[scheduled[i], j] = speeds[i, j]
