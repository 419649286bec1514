"""The inner loop: move, measure, apply forces, solve, report, sample."""

from __future__ import annotations

import math

from sandbox.engine import memory as at
from sandbox.engine.bonds import release_and_engage
from sandbox.engine.entry_points import CalledFromPython
from sandbox.engine.groups import apply_forces, is_valid
from sandbox.engine.islands import soften
from sandbox.engine.kernel import kernel
from sandbox.engine.native import call_each, call_step
from sandbox.engine.report import add_work
from sandbox.engine.snapshot import (
    add_forces,
    count_step,
    note_impacts,
    room_for_contacts,
    room_to_keep,
    take,
)
from sandbox.engine.solve import SETTLED, solve
from sandbox.engine.touching import list_contacts_of_step, short
from sandbox.numeric import Array, Matrix, Stack

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
    """Whether all is at rest, and this step, with these inputs, the last one over again."""
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
    """Move the bodies, unless a step is half made; whether there is room for what is near then."""
    touching = at.touching(table)
    if not touching[1]:
        at.near(table)[0] = at.read_count(table)[0] = 0
        call_step(at.step(table), at.space(table), h)
        call_each(at.each_body(table), at.space(table), at.get(table), at.read(table))
    touching[1] = short(table)
    return not touching[1]


@kernel
def _push(table: int, h: float, drive: Array, speeds: Array) -> bool:
    """Find the velocities after the step and hand them on; whether it is sound, and not jammed."""
    body, velocity = at.body(table), at.velocity(table)
    release_and_engage(table, drive)
    begin(table)
    apply_forces(table, h, drive)
    let_go(table, h, speeds)
    actions, belts = at.actions(table), at.belts(table)
    for i in range(len(actions)):
        if actions[i]["runs"]:
            belts[actions[i]["a"]] = actions[i]["sense"] * drive[actions[i]["drive"]]
    list_contacts_of_step(table)
    soften(table, h)
    struck = solve(table, h, drive)
    for b in range(len(body)):
        for j in range(3):
            body[b, 3 + j] = velocity[b, j]
    at.write_count(table)[0] = 0
    call_each(at.each_body(table), at.space(table), at.put(table), at.write(table))
    if struck:  # impacts after the poses displace them
        shift, placed = at.shift(table), at.placed(table)
        for b in range(len(body)):
            for j in range(3):
                placed[b, j] = body[b, j] + shift[b, j]
        at.place_count(table)[0] = 0
        call_each(at.each_body(table), at.space(table), at.put(table), at.place(table))
    add_work(table, h)
    note_impacts(table)
    return bool(sound(h, body)) and bool(is_valid(table)) and at.standing(table)[3] == 0


@CalledFromPython
def advance(
    table: int, h: float, drive: Matrix, speeds: Stack, due: int, every: int,
) -> int:
    """Make one step for each row of ``drive`` [n, nd]; how many were made and left it sound.

    Step ``due`` of these, counted from 1, is kept as a sample, and then each ``every``-th.
    Fewer are made where the motion is no longer sound; where there is no room to keep the
    next sample, or the contacts and impacts of the next step; and where there is none for what
    touches. That step is then left half made: bodies moved, ``touching[1]`` set.

    ``speeds`` [n, ns, 3] are the velocities of scheduled bodies after each step, ``table``
    is that of :class:`sandbox.engine.memory.Memory`.
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
def begin(table: int) -> None:
    """Note how the bodies stand and move where pymunk has moved them."""
    body, before, turn, force, kick, shift = (
        at.body(table), at.before(table), at.turn(table), at.force(table), at.kick(table),
        at.shift(table))
    at.made(table)[0] += 1
    for i in range(len(body)):
        turn[i, 0], turn[i, 1] = math.cos(body[i, 2]), math.sin(body[i, 2])
        for j in range(3):
            before[i, j] = body[i, 3 + j]
            force[i, j] = kick[i, j] = shift[i, j] = 0.0


@kernel
def let_go(table: int, h: float, speeds: Array) -> None:
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
