"""The inner loop, compiled: move, read, solve, write, work; and what a sample keeps of it."""

from __future__ import annotations

from typing import Any

from numba import njit

from sandbox.engine.fingerprint import KERNELS
from sandbox.engine.forces import predict
from sandbox.engine.memory import native_of, snapshot_of, views
from sandbox.engine.native import Native, call_each, call_step
from sandbox.engine.snapshot import take
from sandbox.engine.solve import solve
from sandbox.engine.state import Constants, Result, State
from sandbox.engine.touching import list_touches
from sandbox.engine.work import add_work
from sandbox.numeric import Array, Integers

FAR = 1e6
"""Motion is sound while nothing is further out or faster than this [m, rad, m/s, rad/s]."""


@njit(cache=True)
def sound(h: float, body: Array) -> bool:
    """Whether all of ``body`` [nb, 6] is finite and within :data:`FAR`, this step and the next."""
    for i in range(len(body)):
        for j in range(3):  # written so that NaN is not sound
            near = abs(body[i, j] + h * body[i, 3 + j]) < FAR and abs(body[i, 3 + j]) < FAR
            if not near:
                return False
    return True


def _compiled(sources: int) -> Any:
    @njit(cache=True, error_model="numpy")
    def advance(table: Integers, h: float, drive: Array, speeds: Array) -> int:
        """Make one step for each row of ``drive`` [n, nd]; how many left the motion sound.

        ``speeds`` [n, ns, 3] are the velocities of scheduled bodies after each step, ``table``
        is that of :class:`sandbox.engine.memory.Memory`.
        """
        assert sources != 0  # see sandbox.engine.fingerprint
        native = native_of(table)
        constants, state, result = views(table, h)
        for i in range(len(drive)):
            if not _step(native, constants, state, result, drive[i], speeds[i]):
                return i
            if not sound(h, state.body):
                return i
        return len(drive)

    @njit(cache=True, error_model="numpy")
    def keep(table: Integers, h: float, row: int, drive: Array) -> None:
        """Copy the step just made, with its drives [nd], into a row of what samples are kept in."""
        assert sources != 0
        constants, state, result = views(table, h)
        take(snapshot_of(table), row, h, constants, state, result, drive)

    return advance, keep


@njit(cache=True, inline="always")
def _step(
    native: Native, constants: Constants, state: State, result: Result, drive: Array,
    speeds: Array,
) -> bool:
    """Move, find contacts, solve; False if there was no room for all contacts."""
    native.found[0] = 0
    call_step(native.step, native.space, constants.h)
    native.read_count[0] = 0
    call_each(native.each_body, native.space, native.get, native.read)
    predict(constants, state, result, drive, speeds)
    count = native.found[0]
    enough = count <= len(native.raw)
    state.touching[0] = 0 if not enough else list_touches(
        native.raw, count, constants.shapes, state.body, constants.friction,
        constants.restitution, state.touches, state.touching[0], result.order, result.found)
    for i in range(state.touching[0]):
        state.touches[i] = result.found[i]
    enough = solve(constants, state, result, drive) and enough
    for i in range(len(state.body)):
        for j in range(3):
            state.body[i, 3 + j] = result.velocity[i, j]
    native.write_count[0] = 0
    call_each(native.each_body, native.space, native.put, native.write)
    add_work(constants, state, result)
    return enough


advance, keep = _compiled(KERNELS)
