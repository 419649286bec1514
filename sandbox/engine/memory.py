"""The table of a run: addresses and lengths of all its arrays, for compiled code.

Compiled functions take the address of the table and make views of the fields of
:mod:`sandbox.engine.state`: ``memory.body(table)``. Eighty arguments would take tens of seconds to
compile. Arrays must not be replaced while a table is used: :class:`Memory` keeps them alive.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import from_dtype, types
from numba.extending import intrinsic
from numba.np import arrayobj

from sandbox.engine.native import Native
from sandbox.engine.plan import Pattern
from sandbox.engine.state import Constants, Elements, Result, Snapshot, State, declared
from sandbox.numeric import Integers

_arrays: Any = arrayobj
_WORD = ir.IntType(64)
WIDTH = 4  # numbers of the table for each array: its address and three lengths
_PARTS: tuple[Any, ...] = (Native, Constants, Elements, State, Result, Pattern, Snapshot)
TABLE_WORDS = WIDTH * sum(len(part._fields) for part in _PARTS)  # before the entry points


class Memory(NamedTuple):
    """What compiled code gets, and what must live as long as it is used."""

    address: int  # Of the table: address and lengths of every array, then addresses of entry points
    h: float  # the step [s]
    kept: tuple[Any, ...]  # the table and the arrays themselves


def make_memory(parts: Iterable[Any], h: float, entry_points: Integers) -> Memory:
    """The table of a run; ``parts`` as in :data:`_PARTS`."""
    values = tuple(itertools.chain.from_iterable(parts))
    table = np.zeros((len(values), WIDTH), dtype=np.int64)
    for row, value in zip(table, values, strict=True):
        if isinstance(value, np.ndarray):
            if not value.flags.c_contiguous:
                raise ValueError("an array of a run is not in one piece")
            row[0] = value.ctypes.data
            row[1:1 + value.ndim] = value.shape
        elif isinstance(value, int):
            row[0] = value
    whole = np.concatenate([table.ravel(), entry_points])
    return Memory(whole.ctypes.data, h, (whole, *values))


def _view(name: str, place: int, dtype: Any, shape: list[str]) -> Any:
    """An intrinsic for the array at ``place`` in the table, or the number without ``dtype``."""
    item = None if dtype is None else from_dtype(np.dtype(dtype))
    made = types.int64 if item is None else types.Array(item, len(shape), "C")

    def view(context: Any, table: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            source = builder.inttoptr(args[0], _WORD.as_pointer())

            def at(offset: int) -> Any:
                return builder.load(builder.gep(source, [ir.Constant(_WORD, place + offset)]))

            if item is None:
                return at(0)
            array = _arrays.make_array(made)(context, builder)
            size = ir.Constant(_WORD, context.get_abi_sizeof(context.get_data_type(item)))
            lengths = [ir.Constant(_WORD, int(length)) if length.isdigit() else at(1 + axis)
                       for axis, length in enumerate(shape)]
            strides = [size]
            for length in lengths[:0:-1]:
                strides.insert(0, builder.mul(strides[0], length))
            _arrays.populate_array(
                array, data=builder.inttoptr(at(0), array.data.type), shape=lengths,
                strides=strides, itemsize=size, meminfo=None)
            return array._getvalue()

        return made(table), generate

    result: Any = intrinsic(view)
    result.view_of_table = f"{name} {place} {made} {shape} {dtype and np.dtype(dtype)!r}"
    return result


for _place, (_part, _field) in enumerate(
        (part, field) for part in _PARTS for field in part._fields):
    if _field in declared(_part):
        _name = f"kept_{_field}" if _part is Snapshot else _field
        globals()[_name] = _view(_name, WIDTH * _place, *declared(_part)[_field])


def __getattr__(name: str) -> Any:
    """Tell type checkers that there are views."""
    raise AttributeError(f"there is no array '{name}' in the memory of a run")
