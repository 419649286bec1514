"""The inner loop, compiled: move, read, solve, write, work; and what a sample keeps of it."""

from __future__ import annotations

from sandbox.engine import memory as at
from sandbox.engine.entry_points import CalledFromPython
from sandbox.engine.fluid_report import contained
from sandbox.engine.fluids import swell
from sandbox.engine.forces import act, begin, let_go, pull
from sandbox.engine.kernel import kernel
from sandbox.engine.loads import press
from sandbox.engine.means import add_waiting, count_step, note_impacts, room_for_contacts
from sandbox.engine.native import call_each, call_step
from sandbox.engine.snapshot import room_to_keep, take
from sandbox.engine.solve import SETTLED, solve
from sandbox.engine.springs import stretch
from sandbox.engine.ties import let_go_or_take_up, run_surfaces
from sandbox.engine.touching import list_touches, short
from sandbox.engine.work import add_work
from sandbox.numeric import Array, Matrix, Stack

FAR = 1e6
"""Motion is sound while nothing is further out or faster than this [m, rad, m/s, rad/s]."""

UNKEPT = 0
"""As the step that is due to be kept: none ever is."""


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
def _changed(last: Array, now: Array) -> bool:
    changed = False
    for j in range(len(now)):
        changed |= last[j] != now[j]
    return changed


@kernel
def _moving(speeds: Array) -> bool:
    for j in range(len(speeds)):
        if speeds[j, 0] != 0.0 or speeds[j, 1] != 0.0 or speeds[j, 2] != 0.0:
            return True
    return False


@kernel
def _again(table: int, drive: Array, speeds: Array) -> bool:
    """Whether all is at rest, and this step, with these inputs, the last one over again."""
    standing, last = at.standing(table), at.last_drive(table)
    if standing[1] and (_changed(last, drive) or _moving(speeds)):
        standing[1] = 0
    for j in range(len(last)):
        last[j] = drive[j]
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
    let_go_or_take_up(table, drive)
    begin(table)
    act(table, drive)
    stretch(table, drive)
    pull(table, drive)
    swell(table, drive)
    press(table, h)
    let_go(table, h, speeds)
    run_surfaces(table, drive)
    list_touches(table)
    struck = solve(table, h, drive)
    for b in range(len(body)):
        for j in range(3):
            body[b, 3 + j] = velocity[b, j]
    at.write_count(table)[0] = 0
    call_each(at.each_body(table), at.space(table), at.put(table), at.write(table))
    if struck:
        _displace(table)
    add_work(table, h)
    note_impacts(table)
    return bool(sound(h, body)) and bool(contained(table)) and at.standing(table)[3] == 0


@kernel
def _displace(table: int) -> None:
    """Hand on the poses that impacts after them displace."""
    body, shift, placed = at.body(table), at.shift(table), at.placed(table)
    for b in range(len(body)):
        for j in range(3):
            placed[b, j] = body[b, j] + shift[b, j]
    at.place_count(table)[0] = 0
    call_each(at.each_body(table), at.space(table), at.put(table), at.place(table))


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
            add_waiting(table, h)
            if not (_move(table, h) and _push(table, h, drive[i], speeds[i])):
                return i
        if every > 1:
            count_step(table, h, every, due)
        if due == 0:
            take(table, drive[i])
            due = every
    return len(drive)
