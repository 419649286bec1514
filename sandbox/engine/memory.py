"""The arrays of a run handed to compiled code in one piece: a table of where they are.

Handed over one by one, some forty arrays cost more to unwrap than a sample costs to
keep. The table holds for each its address and two lengths; compiled code makes
its views of them (:func:`views`), which costs nothing. Arrays that stand in a table must
neither move nor be replaced while it is used: :class:`Memory` keeps them alive.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic
from numba.np.numpy_support import carray

from sandbox.engine.native import Native
from sandbox.engine.snapshot import Snapshot
from sandbox.engine.state import (
    ACTION,
    ACTION_RESULT,
    ACTION_STATE,
    CORD,
    CORD_RESULT,
    CORD_STATE,
    DAMPER,
    DAMPER_RESULT,
    DAMPER_STATE,
    GUIDE,
    GUIDE_RESULT,
    GUIDE_STATE,
    SPRING,
    SPRING_RESULT,
    SPRING_STATE,
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


def _pointer_to(context: Any, address: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], ir.IntType(8).as_pointer())

    return types.voidptr(types.intp), generate


_pointer: Any = intrinsic(_pointer_to)
_CONSTANTS = len(Native._fields)
_STATE = _CONSTANTS + len(Constants._fields) - 1
_RESULT = _STATE + len(State._fields)
_KEPT = _RESULT + len(Result._fields)


@njit(cache=True)
def _row(table: Integers, i: int) -> Array:
    return carray(_pointer(table[i, 0]), (table[i, 1],), np.float64)


@njit(cache=True)
def _floats(table: Integers, i: int) -> Array:
    return carray(_pointer(table[i, 0]), (table[i, 1], table[i, 2]), np.float64)


@njit(cache=True)
def _numbers(table: Integers, i: int) -> Integers:
    return carray(_pointer(table[i, 0]), (table[i, 1],), np.int64)


@njit(cache=True, inline="always")
def native_of(table: Integers) -> Native:
    """What to call, from a run's table."""
    return Native(
        table[0, 0], table[1, 0], table[2, 0], table[3, 0], table[4, 0], table[5, 0], table[6, 0],
        carray(_pointer(table[7, 0]), (1,), np.int32),
        carray(_pointer(table[8, 0]), (1,), np.int32), table[9, 0], _numbers(table, 10))


@njit(cache=True, inline="always")
def views(table: Integers, h: float) -> tuple[Constants, State, Result]:
    """Constants, state and result in the memory that a run's table points to."""
    i = _CONSTANTS
    constants = Constants(
        h, _floats(table, i),
        carray(_pointer(table[i + 1, 0]), (table[i + 1, 1],), ACTION),
        carray(_pointer(table[i + 2, 0]), (table[i + 2, 1],), SPRING),
        carray(_pointer(table[i + 3, 0]), (table[i + 3, 1],), DAMPER),
        _row(table, i + 4),
        carray(_pointer(table[i + 5, 0]), (table[i + 5, 1],), CORD),
        carray(_pointer(table[i + 6, 0]), (table[i + 6, 1],), GUIDE),
        _numbers(table, i + 7),
        carray(_pointer(table[i + 8, 0]), (table[i + 8, 1], table[i + 8, 2]), np.int64),
        _numbers(table, i + 9), _numbers(table, i + 10))
    i = _STATE
    state = State(
        _floats(table, i), _floats(table, i + 1), _floats(table, i + 2), _floats(table, i + 3),
        carray(_pointer(table[i + 4, 0]), (table[i + 4, 1],), ACTION_STATE),
        carray(_pointer(table[i + 5, 0]), (table[i + 5, 1],), SPRING_STATE),
        carray(_pointer(table[i + 6, 0]), (table[i + 6, 1],), DAMPER_STATE),
        carray(_pointer(table[i + 7, 0]), (table[i + 7, 1],), CORD_STATE),
        carray(_pointer(table[i + 8, 0]), (table[i + 8, 1],), GUIDE_STATE))
    i = _RESULT
    result = Result(
        _floats(table, i),
        carray(_pointer(table[i + 1, 0]), (table[i + 1, 1],), ACTION_RESULT),
        carray(_pointer(table[i + 2, 0]), (table[i + 2, 1],), SPRING_RESULT),
        carray(_pointer(table[i + 3, 0]), (table[i + 3, 1],), DAMPER_RESULT),
        carray(_pointer(table[i + 4, 0]), (table[i + 4, 1],), CORD_RESULT),
        carray(_pointer(table[i + 5, 0]), (table[i + 5, 1],), GUIDE_RESULT),
        _floats(table, i + 6))
    return constants, state, result


@njit(cache=True)
def _block(table: Integers, i: int, width: int) -> Array:
    return carray(_pointer(table[i, 0]), (table[i, 1], table[i, 2], width), np.float64)


@njit(cache=True, inline="always")
def snapshot_of(table: Integers) -> Snapshot:
    """Where samples are kept, from a run's table."""
    i = _KEPT
    return Snapshot(
        _block(table, i, 6), _block(table, i + 1, 3), _block(table, i + 2, 3),
        _block(table, i + 3, 4), _block(table, i + 4, 4), _block(table, i + 5, 3),
        _block(table, i + 6, 3), _floats(table, i + 7))
