"""The inner loop, compiled: forces, write, step, read, work."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sandbox.engine.fingerprint import KERNELS
from sandbox.engine.forces import apply_forces
from sandbox.engine.native import call_each, call_step
from sandbox.engine.work import add_work

Array = NDArray[np.float64]
Records = NDArray[Any]
Integers = NDArray[np.int64]

FAR = 1e6
"""Motion is sound while nothing is further out or faster than this [m, rad, m/s, rad/s]."""


@njit(cache=True)
def sound(h: float, state: Array) -> bool:
    """Whether all of ``state`` [nb, 6] is finite and within :data:`FAR`, this step and the next."""
    for i in range(len(state)):
        for j in range(3):  # written so that NaN is not sound
            near = abs(state[i, j] + h * state[i, 3 + j]) < FAR and abs(state[i, 3 + j]) < FAR
            if not near:
                return False
    return True


def _compiled(sources: str) -> Any:
    @njit(cache=True)
    def advance(
        h: float, call: tuple[int, ...],
        read_count: NDArray[np.intc], write_count: NDArray[np.intc],
        state: Array, before: Array,
        pose: Array, force: Array, drive: Array,
        inverse_mass: Array, held: Array, actions: Records, springs: Records, dampers: Records,
        blocks: Array, spans: Records, nodes: Records, rows: Integers, pairs: Integers,
        starts: Integers, columns: Integers, work: Array,
    ) -> int:
        """Make one step for each row of ``drive`` [n, nd]; how many left the motion sound.

        ``call`` are :class:`sandbox.engine.native.Addresses`; the rest as in
        :func:`sandbox.engine.forces.apply_forces`.
        """
        assert sources  # see sandbox.engine.fingerprint
        step, each_body, space, get, read, put, write = call
        for i in range(len(drive)):
            apply_forces(
                h, state, before, pose, force, drive[i], inverse_mass, held, actions, springs,
                dampers, blocks, spans, nodes, rows, pairs, starts, columns, work)
            write_count[0] = 0
            call_each(each_body, space, put, write)
            call_step(step, space, h)
            read_count[0] = 0
            call_each(each_body, space, get, read)
            add_work(h, state, before, actions, springs, dampers, spans, nodes)
            if not sound(h, state):
                return i
        return len(drive)

    return advance


advance = _compiled(KERNELS)
