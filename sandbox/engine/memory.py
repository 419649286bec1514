"""The arrays of a run handed to compiled code in one piece: a table of where they are.

Handed over one by one, some forty arrays cost more to unwrap than a sample costs to
keep. The table holds for each its address and two lengths; compiled code makes
its views of them (:func:`views`), which costs nothing. Arrays that stand in a table must
neither move nor be replaced while it is used: :class:`Memory` keeps them alive.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.np.numpy_support import carray

from sandbox.engine.native import FOUND, Native, as_pointer
from sandbox.engine.snapshot import CONTACT, Snapshot
from sandbox.engine.state import (
    ACTION,
    ACTION_RESULT,
    ACTION_STATE,
    BOUND,
    CORD,
    CORD_RESULT,
    CORD_STATE,
    DAMPER,
    DAMPER_RESULT,
    DAMPER_STATE,
    GUIDE,
    GUIDE_RESULT,
    GUIDE_STATE,
    JOINT,
    JOINT_RESULT,
    LIMIT,
    LIMIT_STATE,
    MOTOR,
    MOTOR_STATE,
    SHAPE,
    SPRING,
    SPRING_RESULT,
    SPRING_STATE,
    TOUCH,
    Constants,
    Result,
    State,
)
from sandbox.numeric import Array, Integers


class Memory(NamedTuple):
    """What compiled code is handed, and what must live as long as it is used."""

    table: Integers
    """Address, length and second length of every array; a plain number stands first, [k, 3]."""
    h: float
    """The step [s]."""
    kept: tuple[Any, ...]
    """The arrays themselves."""


def make_memory(
    native: Native, constants: Constants, state: State, result: Result, snapshot: Snapshot,
) -> Memory:
    """The table of a run.

    Raises:
        ValueError: an array that is not in one piece.
    """
    values: tuple[Any, ...] = (*native, *constants[1:], *state, *result, *snapshot)
    table = np.zeros((len(values), 3), dtype=np.int64)
    for row, value in zip(table, values, strict=True):
        if isinstance(value, np.ndarray):
            if not value.flags.c_contiguous:
                raise ValueError("an array of a run is not in one piece")
            row[0] = value.ctypes.data
            row[1:1 + min(value.ndim, 2)] = value.shape[:2]
        else:
            row[0] = value
    return Memory(table, constants.h, values)


_CONSTANTS = len(Native._fields)
_STATE = _CONSTANTS + len(Constants._fields) - 1
_RESULT = _STATE + len(State._fields)
_KEPT = _RESULT + len(Result._fields)


@njit(cache=True)
def _row(table: Integers, i: int) -> Array:
    return carray(as_pointer(table[i, 0]), (table[i, 1],), np.float64)


@njit(cache=True)
def _floats(table: Integers, i: int) -> Array:
    return carray(as_pointer(table[i, 0]), (table[i, 1], table[i, 2]), np.float64)


@njit(cache=True)
def _numbers(table: Integers, i: int) -> Integers:
    return carray(as_pointer(table[i, 0]), (table[i, 1],), np.int64)


@njit(cache=True)
def _block(table: Integers, i: int, width: int) -> Array:
    return carray(as_pointer(table[i, 0]), (table[i, 1], table[i, 2], width), np.float64)


@njit(cache=True)
def _grid(table: Integers, i: int) -> Integers:
    return carray(as_pointer(table[i, 0]), (table[i, 1], table[i, 2]), np.int64)


@njit(cache=True, inline="always")
def native_of(table: Integers) -> Native:
    """What to call, from a run's table."""
    return Native(
        table[0, 0], table[1, 0], table[2, 0], table[3, 0], table[4, 0], table[5, 0], table[6, 0],
        carray(as_pointer(table[7, 0]), (1,), np.int32),
        carray(as_pointer(table[8, 0]), (1,), np.int32), _numbers(table, 9),
        carray(as_pointer(table[10, 0]), (table[10, 1],), FOUND))


@njit(cache=True, inline="always")
def views(table: Integers, h: float) -> tuple[Constants, State, Result]:
    """Constants, state and result in the memory that a run's table points to."""
    i = _CONSTANTS
    constants = Constants(
        h,
        _row(table, i),
        _floats(table, i + 1),
        _numbers(table, i + 2),
        carray(as_pointer(table[i + 3, 0]), (table[i + 3, 1],), ACTION),
        carray(as_pointer(table[i + 4, 0]), (table[i + 4, 1],), SPRING),
        carray(as_pointer(table[i + 5, 0]), (table[i + 5, 1],), DAMPER),
        carray(as_pointer(table[i + 6, 0]), (table[i + 6, 1],), CORD),
        carray(as_pointer(table[i + 7, 0]), (table[i + 7, 1],), GUIDE),
        carray(as_pointer(table[i + 8, 0]), (table[i + 8, 1],), JOINT),
        carray(as_pointer(table[i + 9, 0]), (table[i + 9, 1],), LIMIT),
        carray(as_pointer(table[i + 10, 0]), (table[i + 10, 1],), MOTOR),
        carray(as_pointer(table[i + 11, 0]), (table[i + 11, 1],), SHAPE),
        _floats(table, i + 12),
        _floats(table, i + 13),
        _numbers(table, i + 14),
        _numbers(table, i + 15),
        _numbers(table, i + 16),
        _numbers(table, i + 17),
        _numbers(table, i + 18),
        _grid(table, i + 19),
        _grid(table, i + 20),
        _numbers(table, i + 21),
        _numbers(table, i + 22),
        _numbers(table, i + 23),
        _numbers(table, i + 24),
        _grid(table, i + 25),
    )
    i = _STATE
    state = State(
        _floats(table, i),
        carray(as_pointer(table[i + 1, 0]), (table[i + 1, 1],), ACTION_STATE),
        carray(as_pointer(table[i + 2, 0]), (table[i + 2, 1],), SPRING_STATE),
        carray(as_pointer(table[i + 3, 0]), (table[i + 3, 1],), DAMPER_STATE),
        carray(as_pointer(table[i + 4, 0]), (table[i + 4, 1],), CORD_STATE),
        carray(as_pointer(table[i + 5, 0]), (table[i + 5, 1],), GUIDE_STATE),
        carray(as_pointer(table[i + 6, 0]), (table[i + 6, 1],), LIMIT_STATE),
        carray(as_pointer(table[i + 7, 0]), (table[i + 7, 1],), MOTOR_STATE),
        carray(as_pointer(table[i + 8, 0]), (table[i + 8, 1],), TOUCH),
        _numbers(table, i + 9),
    )
    i = _RESULT
    result = Result(
        _floats(table, i),
        _floats(table, i + 1),
        _floats(table, i + 2),
        _floats(table, i + 3),
        _floats(table, i + 4),
        carray(as_pointer(table[i + 5, 0]), (table[i + 5, 1],), ACTION_RESULT),
        carray(as_pointer(table[i + 6, 0]), (table[i + 6, 1],), SPRING_RESULT),
        carray(as_pointer(table[i + 7, 0]), (table[i + 7, 1],), DAMPER_RESULT),
        carray(as_pointer(table[i + 8, 0]), (table[i + 8, 1],), CORD_RESULT),
        carray(as_pointer(table[i + 9, 0]), (table[i + 9, 1],), GUIDE_RESULT),
        carray(as_pointer(table[i + 10, 0]), (table[i + 10, 1],), JOINT_RESULT),
        _block(table, i + 11, 3),
        _row(table, i + 12),
        _floats(table, i + 13),
        carray(as_pointer(table[i + 14, 0]), (table[i + 14, 1],), TOUCH),
        _numbers(table, i + 15),
        carray(as_pointer(table[i + 16, 0]), (table[i + 16, 1],), BOUND),
        _numbers(table, i + 17),
        _floats(table, i + 18),
        _grid(table, i + 19),
        _floats(table, i + 20),
        _floats(table, i + 21),
        _numbers(table, i + 22),
    )
    return constants, state, result


@njit(cache=True, inline="always")
def snapshot_of(table: Integers) -> Snapshot:
    """Where samples are kept, from a run's table."""
    i = _KEPT
    return Snapshot(
        _block(table, i, 6), _block(table, i + 1, 3), _block(table, i + 2, 4),
        _block(table, i + 3, 4), _block(table, i + 4, 3), _block(table, i + 5, 3),
        _block(table, i + 6, 3), _floats(table, i + 7), _floats(table, i + 8),
        carray(as_pointer(table[i + 9, 0]), (table[i + 9, 1],), CONTACT), _numbers(table, i + 10))
