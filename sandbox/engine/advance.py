"""The inner loop, compiled: forces, write, step, read, work; and what a sample keeps of it."""

from __future__ import annotations

from typing import Any

from numba import njit

from sandbox.engine.fingerprint import KERNELS
from sandbox.engine.forces import apply_forces
from sandbox.engine.memory import native_of, snapshot_of, views
from sandbox.engine.native import Native, call_each, call_step
from sandbox.engine.snapshot import take
from sandbox.engine.state import Constants, Result, State
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


@njit(cache=True, inline="always")
def step(
    native: Native, constants: Constants, state: State, result: Result, drive: Array,
) -> None:
    """One step, with the values of the drives in it [nd]."""
    apply_forces(constants, state, result, drive)
    native.write_count[0] = 0
    call_each(native.each_body, native.space, native.put, native.write)
    call_step(native.step, native.space, constants.h)
    native.read_count[0] = 0
    call_each(native.each_body, native.space, native.get, native.read)
    add_work(constants, state, result)


def _compiled(sources: int) -> Any:
    @njit(cache=True)
    def advance(table: Integers, h: float, drive: Array) -> int:
        """Make one step for each row of ``drive`` [n, nd]; how many left the motion sound.

        ``table`` is that of :class:`sandbox.engine.memory.Memory`.
        """
        assert sources != 0  # see sandbox.engine.fingerprint
        native = native_of(table)
        constants, state, result = views(table, h)
        for i in range(len(drive)):
            step(native, constants, state, result, drive[i])
            if not sound(h, state.body):
                return i
        return len(drive)

    @njit(cache=True)
    def keep(table: Integers, h: float, row: int) -> None:
        """Copy the step just made into a row of what samples are kept in."""
        assert sources != 0
        native = native_of(table)
        _, state, result = views(table, h)
        take(snapshot_of(table), row, state, result, native.impulse, native.handles)

    return advance, keep


advance, keep = _compiled(KERNELS)
