"""The table of a run: addresses and lengths of all its arrays, for compiled code.

Compiled functions take the address of the table and make the views that they need:
``memory.body(table)``. A view costs no time and compiles in some milliseconds, while some eighty
arguments would cost more than a sample and take tens of seconds to compile. Arrays in a table must
neither move nor be replaced while it is used: :class:`Memory` keeps them alive.

The views are made from the fields of :mod:`sandbox.engine.state`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np
from llvmlite import ir
from numba import from_dtype, types
from numba.extending import intrinsic
from numba.np import arrayobj
from numpy.typing import NDArray

from sandbox.engine.native import Native
from sandbox.engine.state import Constants, Result, Snapshot, State
from sandbox.numeric import Array, Integers, Records

_arrays: Any = arrayobj
_WORD = ir.IntType(64)
_ITEMS = {str(Array): float, str(Integers): np.int64, str(NDArray[np.intc]): np.intc}
"""Types of the items of plain arrays."""
WIDTH = 4
"""Numbers of the table for each array: its address and three lengths."""
_PARTS: tuple[Any, ...] = (Native, Constants, State, Result, Snapshot)
TABLE_WORDS = WIDTH * sum(len(part._fields) for part in _PARTS)
"""Length of the table without the addresses of entry points, which follow."""


class Memory(NamedTuple):
    """What compiled code gets, and what must live as long as it is used."""

    address: int
    """Of the table: address and lengths of every array, then addresses of entry points."""
    h: float
    """The step [s]."""
    kept: tuple[Any, ...]
    """The table and the arrays themselves."""


def make_memory(
    native: Native, constants: Constants, state: State, result: Result, snapshot: Snapshot,
    entry_points: Integers,
) -> Memory:
    """The table of a run.

    Raises:
        ValueError: an array that is not in one piece.
    """
    values: tuple[Any, ...] = (*native, *constants, *state, *result, *snapshot)
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
    return Memory(whole.ctypes.data, constants.h, (whole, *values))


def _view(name: str, place: int, dtype: Any, axes: int) -> Any:
    """An intrinsic that makes a view of the array at ``place`` in the table."""
    item = from_dtype(np.dtype(dtype))
    made = types.Array(item, axes, "C")

    def view(context: Any, table: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            source = builder.inttoptr(args[0], _WORD.as_pointer())

            def at(offset: int) -> Any:
                return builder.load(builder.gep(source, [ir.Constant(_WORD, place + offset)]))

            array = _arrays.make_array(made)(context, builder)
            size = ir.Constant(_WORD, context.get_abi_sizeof(context.get_data_type(item)))
            lengths = [at(1 + axis) for axis in range(axes)]
            strides = [size]
            for length in lengths[:0:-1]:
                strides.insert(0, builder.mul(strides[0], length))
            _arrays.populate_array(
                array, data=builder.inttoptr(at(0), array.data.type), shape=lengths,
                strides=strides, itemsize=size, meminfo=None)
            return array._getvalue()

        return made(table), generate

    result: Any = intrinsic(view)
    result.view_of_table = f"{name} {place} {made} {np.dtype(dtype)!r}"
    return result


def _number(name: str, place: int) -> Any:
    """An intrinsic that reads the number at ``place`` in the table."""
    def number(context: Any, table: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            source = builder.inttoptr(args[0], _WORD.as_pointer())
            return builder.load(builder.gep(source, [ir.Constant(_WORD, place)]))

        return types.int64(table), generate

    result: Any = intrinsic(number)
    result.view_of_table = f"{name} {place}"
    return result


def view_name(part: Any, field: str) -> str:
    """The name of the view of a field of one of the parts.

    It is the field's name. Where :class:`Constants` has a field of that name, too, ``actions``
    becomes ``action_states`` or ``action_results``. Fields of a :class:`Snapshot` get the prefix
    ``kept_``.
    """
    if part is Snapshot:
        return f"kept_{field}"
    if part in (State, Result) and field in Constants._fields:
        return field.removesuffix("s") + ("_states" if part is State else "_results")
    return field


def _views() -> Iterator[tuple[str, Any]]:
    """Names of all views with the intrinsics that make them."""
    place = 0
    for part in _PARTS:
        for field, note in get_type_hints(part, include_extras=True).items():
            view = view_name(part, field)
            array, more = get_args(note) if get_origin(note) is Annotated else (note, 1)
            if note is int:
                yield view, _number(view, place)
            elif str(array) in _ITEMS or array is Records:
                axes, dtype = (more, _ITEMS[str(array)]) if isinstance(more, int) else (1, more)
                yield view, _view(view, place, dtype, axes)
            place += WIDTH


globals().update(_views())


def __getattr__(name: str) -> Any:
    """Tell type checkers that there are views."""
    raise AttributeError(f"there is no array '{name}' in the memory of a run")
