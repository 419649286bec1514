"""The inner loop, compiled: move, read, solve, write, work; and what a sample keeps of it."""

from __future__ import annotations

from typing import Any

from numba import njit

from sandbox.engine import memory as at
from sandbox.engine.fingerprint import KERNELS
from sandbox.engine.forces import act, begin, let_go, pull, stretch
from sandbox.engine.kernel import kernel
from sandbox.engine.native import call_each, call_step
from sandbox.engine.snapshot import list_contacts, take
from sandbox.engine.solve import SETTLED, solve
from sandbox.engine.touching import list_touches, short
from sandbox.engine.work import add_work
from sandbox.numeric import Array, Integers, Records

FAR = 1e6
"""Motion is sound while nothing is further out or faster than this [m, rad, m/s, rad/s]."""


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


def _compiled(sources: int) -> Any:
    @njit(cache=True, error_model="numpy")
    def advance(table: Integers, h: float, drive: Array, speeds: Array) -> int:
        """Make one step for each row of ``drive`` [n, nd]; how many left the motion sound.

        Without room for what touches a step is left half made: bodies moved, ``touching[1]`` set.

        ``speeds`` [n, ns, 3] are the velocities of scheduled bodies after each step, ``table``
        is that of :class:`sandbox.engine.memory.Memory`.
        """
        assert sources != 0  # see sandbox.engine.fingerprint
        near, body, velocity = at.near(table), at.body(table), at.velocity(table)
        read_count, write_count = at.read_count(table), at.write_count(table)
        space, each, count = at.space(table), at.each_body(table), at.standing(table)
        last, touching = at.last_drive(table), at.touching(table)
        for i in range(len(drive)):
            if count[1] and (_changed(last, drive[i]) or _moving(speeds[i])):
                count[1] = 0
            for j in range(len(last)):
                last[j] = drive[i, j]
            if count[1] > SETTLED + 1:  # this step is the last one over again
                continue
            if not touching[1]:
                near[0] = 0
                call_step(at.step(table), space, h)
                read_count[0] = 0
                call_each(each, space, at.get(table), at.read(table))
            touching[1] = short(table)
            if touching[1]:
                return i
            begin(table)
            act(table, drive[i])
            stretch(table, drive[i])
            pull(table, drive[i])
            let_go(table, h, speeds[i])
            list_touches(table)
            enough = solve(table, h, drive[i])
            for b in range(len(body)):
                for j in range(3):
                    body[b, 3 + j] = velocity[b, j]
            write_count[0] = 0
            call_each(each, space, at.put(table), at.write(table))
            add_work(table, h)
            if not enough or not sound(h, body):
                return i
        return len(drive)

    @njit(cache=True, error_model="numpy")
    def keep(table: Integers, h: float, row: int, drive: Array) -> None:
        """Copy the step just made, with its drives [nd], into a row of what samples are kept in."""
        assert sources != 0
        take(table, h, row, drive)

    @njit(cache=True, error_model="numpy")
    def list_now(touches: Records, count: int, body: Array, out: Records) -> int:
        """Note those of the last step's contacts that carry something; how many."""
        assert sources != 0
        return int(list_contacts(touches, count, body, out, 0))

    return advance, keep, list_now


advance, keep, list_now = _compiled(KERNELS)
