"""pymunk's own C functions, called from compiled code.

Going through Python to write velocities and step costs more than a step of a small hand itself. The
functions behind ``Space.step`` and ``pymunk.batch`` are therefore called by
address. This is the only module that knows of pymunk's insides.
"""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Annotated, Any, NamedTuple
from weakref import finalize

import numpy as np
import pymunk
from llvmlite import ir
from numba import cfunc, types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.numpy_support import carray
from numpy.typing import NDArray
from pymunk import batch
from pymunk._chipmunk_cffi import ffi, lib

from sandbox.numeric import Array, Integers, Records

_cgutils: Any = cgutils
_WORD, _REAL, _INT, _BYTE = ir.IntType(64), ir.DoubleType(), ir.IntType(32), ir.IntType(8)


def _caller(result: Any, *arguments: Any) -> Any:
    """Signature and code of a call of the C function whose address is the first argument."""
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        kind = ir.FunctionType(context.get_value_type(result) if result != types.void
                               else ir.VoidType(), [one.type for one in args[1:]])
        value = builder.call(builder.inttoptr(args[0], kind.as_pointer()), args[1:])
        return context.get_dummy_value() if result == types.void else value

    return result(types.intp, *arguments), generate


def _loaded(kind: ir.Type, result: Any = types.intp) -> Any:
    """An intrinsic that reads a number at an address."""
    def at(context: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            value = builder.load(builder.inttoptr(args[0], kind.as_pointer()))
            return builder.sext(value, _WORD) if kind == _INT else value

        return result(types.intp), generate

    return intrinsic(at)


def _byte_to(context: Any, address: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(builder.trunc(args[1], _BYTE), builder.inttoptr(args[0], _BYTE.as_pointer()))
        return context.get_dummy_value()

    return types.void(types.intp, types.intp), generate


def _pointer_to(context: Any, address: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], _BYTE.as_pointer())

    return types.voidptr(types.intp), generate


def _copy(context: Any, source: Any, target: Any, words: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        source, target = (builder.inttoptr(one, _WORD.as_pointer()) for one in args[:2])
        _cgutils.raw_memcpy(builder, target, source, args[2], 8)
        return context.get_dummy_value()

    return types.void(types.intp, types.intp, types.intp), generate


call_step: Any = intrinsic(lambda context, address, space, h: _caller(
    types.void, types.intp, types.float64))
call_each: Any = intrinsic(lambda context, address, space, function, data: _caller(
    types.void, types.intp, types.intp, types.intp))
call_for_word: Any = intrinsic(lambda context, address, subject: _caller(types.intp, types.intp))
call_for_words: Any = intrinsic(lambda context, address, one, two: _caller(
    types.intp, types.intp, types.intp))
real_at, word_at, int_at = _loaded(_REAL, types.float64), _loaded(_WORD), _loaded(_INT)
byte_to: Any = intrinsic(_byte_to)
as_pointer: Any = intrinsic(_pointer_to)
copy_words: Any = intrinsic(_copy)  # copy so many words of 8 bytes


FOUND = np.dtype([
    ("shape_a", np.int64), ("shape_b", np.int64),   # numbers of shapes
    ("feature", np.int64),  # which point of the two it is
    ("nx", float), ("ny", float),   # normal from a to b
    ("ax", float), ("ay", float),   # places on both surfaces, from the bodies' centres of
    ("bx", float), ("by", float),   # mass [m]
    ("ka", float), ("da", float), ("kb", float), ("db", float),     # curvatures k / d
])  # a point in which two shapes meet, as pymunk has it, and curvatures for the engine's use


class Native(NamedTuple):
    """What the compiled loop calls, and with what: addresses in memory, and two counters."""

    step: int
    each_body: int
    space: int
    put: int
    write: int
    place: int
    write_count: NDArray[np.intc]
    """Fill of the buffer that is written from, [1]; 0 before each call."""
    place_count: NDArray[np.intc]  # the same of the buffer of poses
    near: Integers  # the table of `Finder`, whose first number is set to 0 before each call, [5]
    raw: Annotated[Records, FOUND]  # [room]


def address(pointer: Any) -> int:
    """The address that a C pointer holds."""
    return int(ffi.cast("intptr_t", pointer))


class Channel:
    """One batch of body fields; ``count`` [1] is the fill of its buffer, 0 before each call."""

    def __init__(self, fields: batch.BodyFields, memory: Array) -> None:
        self.buffer = batch.Buffer()
        self.buffer.set_float_buf(memory)
        self.request = ffi.new("pmBatchedData *")
        self.request.fields = fields.value
        self.request.floatArray = self.buffer._float_arr
        self.request.intArray = self.buffer._int_arr
        # the struct begins with its fill, an int
        size = ffi.sizeof("int")
        self.count = np.frombuffer(ffi.buffer(self.buffer._float_arr, size), dtype=np.intc)


def make_native(space: pymunk.Space, write: Channel, place: Channel, finder: Finder) -> Native:
    """What the compiled loop needs for ``space``."""
    return Native(
        step=address(ffi.addressof(lib, "cpSpaceStep")),
        each_body=address(ffi.addressof(lib, "cpSpaceEachBody")),
        space=address(space._space),
        put=address(ffi.addressof(lib, "pmSpaceBodySetIteratorFuncBatched")),
        write=address(write.request), place=address(place.request),
        write_count=write.count, place_count=place.count, near=finder.table, raw=finder.raw,
    )


class Finder:
    """Lists the pairs of shapes that pymunk finds near one another, instead of solving them.

    The callback is compiled: in Python it would be slow, and cffi drops its exceptions and Ctrl-C.
    """

    def __init__(self, space: pymunk.Space, room: int) -> None:
        grow = ctypes.pythonapi.PyMem_RawRealloc
        grow.restype, grow.argtypes = ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_size_t)
        self.table: Integers = np.array([
            0, room, grow(None, room * FOUND.itemsize),
            address(ffi.addressof(lib, "cpShapeGetCollisionType")),
            ctypes.cast(grow, ctypes.c_void_p).value], dtype=np.int64)
        """Points found, points that there is room for, where they are; functions: of the number of
        a shape, and to make room, which finding does by itself."""
        finalize(self, _free, self.table)
        handler = lib.cpSpaceAddGlobalCollisionHandler(space._space)
        handler.userData = ffi.cast("void *", self.table.ctypes.data)
        handler.preSolveFunc = ffi.cast(
            "void (*)(cpArbiter *, cpSpace *, void *)", _note().address)

    @property
    def raw(self) -> Records:
        """What was found in the last step, FOUND, [room]; valid until more is found."""
        room, place = self.table[1:3].tolist()
        memory = (ctypes.c_byte * (room * FOUND.itemsize)).from_address(place)
        return np.frombuffer(memory, dtype=FOUND)


def _free(table: Integers) -> None:
    free = ctypes.pythonapi.PyMem_RawFree
    free.restype, free.argtypes = None, (ctypes.c_void_p,)
    free(int(table[2]))


@cache
def _note() -> Any:
    # offsets in pymunk's structs; their values are part of the cache key
    a_at, b_at, count_at, points_at, normal_at, processed_at = (
        ffi.offsetof("struct cpArbiter", name)
        for name in ("a", "b", "count", "contacts", "n", "processCollision"))
    r1_at, r2_at, hash_at = (
        ffi.offsetof("struct cpContact", name) for name in ("r1", "r2", "hash"))
    size, itemsize = ffi.sizeof("struct cpContact"), FOUND.itemsize

    def note(arbiter: int, space: int, table: Any) -> None:
        byte_to(arbiter + processed_at, 0)
        count = int_at(arbiter + count_at)
        point = word_at(arbiter + points_at)
        a = call_for_word(table[3], word_at(arbiter + a_at)) - 1
        b = call_for_word(table[3], word_at(arbiter + b_at)) - 1
        if table[0] + count > table[1]:
            room = 2 * (table[0] + count)
            table[2] = call_for_words(table[4], table[2], room * itemsize)
            table[1] = room
        raw = carray(as_pointer(table[2]), (table[1],), FOUND)
        for _ in range(count):
            n = table[0]
            table[0] = n + 1
            found = raw[n]
            found["shape_a"], found["shape_b"] = a, b
            found["feature"] = word_at(point + hash_at)
            found["nx"] = real_at(arbiter + normal_at)
            found["ny"] = real_at(arbiter + normal_at + 8)
            found["ax"], found["ay"] = real_at(point + r1_at), real_at(point + r1_at + 8)
            found["bx"], found["by"] = real_at(point + r2_at), real_at(point + r2_at + 8)
            point += size

    from sandbox.engine.source_hash import cacheable

    signature, note = "void(intp, intp, CPointer(int64))", cacheable(note)
    try:
        return cfunc(signature, cache=True)(note)
    except (RuntimeError, OSError):  # no place for a cache; no room left
        return cfunc(signature)(note)
