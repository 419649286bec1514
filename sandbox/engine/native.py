"""pymunk's own C functions, called from compiled code.

Calls through Python would cost more than a step of a small hand. Only this module uses the
internals of pymunk.
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

from sandbox.engine.source_hash import cacheable, cached
from sandbox.numeric import Array, Integers, Records

_cgutils: Any = cgutils
_WORD, _BYTE = ir.IntType(64), ir.IntType(8)


def _caller(result: Any, *arguments: Any) -> Any:
    """Signature and code of a call of the C function whose address is the first argument."""
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        kind = ir.FunctionType(context.get_value_type(result) if result != types.void
                               else ir.VoidType(), [one.type for one in args[1:]])
        value = builder.call(builder.inttoptr(args[0], kind.as_pointer()), args[1:])
        return context.get_dummy_value() if result == types.void else value

    return result(types.intp, *arguments), generate


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
as_pointer: Any = intrinsic(_pointer_to)
copy_words: Any = intrinsic(_copy)  # copy so many words of 8 bytes


FOUND = np.dtype([
    ("shape_a", np.int64), ("shape_b", np.int64),   # numbers of shapes
    ("feature", np.int64),  # which point of the two it is
    ("nx", float), ("ny", float),   # normal from a to b
    ("ax", float), ("ay", float),   # places on both surfaces, from the bodies' centres of
    ("bx", float), ("by", float),   # mass [m]
    ("ka", float), ("da", float), ("kb", float), ("db", float),     # curvatures k / d
    ("ahead", float),       # when the bodies are there, after the pose [s]
])  # a point in which two shapes meet, as pymunk has it, and curvatures for the engine's use


class Native(NamedTuple):
    """What the compiled loop calls, and with what: addresses in memory, and two counters."""

    step: int
    each_body: int
    space: int
    put: int
    write: int
    place: int
    write_count: NDArray[np.intc]  # fill of the buffer that is written from, 0 before each call
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
    """Lists the pairs of shapes that pymunk finds near one another, instead of solving them."""

    def __init__(self, space: pymunk.Space, room: int) -> None:
        grow = ctypes.pythonapi.PyMem_RawRealloc
        grow.restype, grow.argtypes = ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_size_t)
        self.table: Integers = np.array([
            0, room, grow(None, room * FOUND.itemsize),
            address(ffi.addressof(lib, "cpShapeGetCollisionType")),
            ctypes.cast(grow, ctypes.c_void_p).value], dtype=np.int64)
        """Points found, room, where they are; functions: number of a shape, and to make room."""
        finalize(self, _free, self.table)
        handler = lib.cpSpaceAddGlobalCollisionHandler(space._space)
        handler.userData = ffi.cast("void *", self.table.ctypes.data)
        handler.preSolveFunc = ffi.cast("void (*)(cpArbiter *, cpSpace *, void *)", _note().address)

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


def _struct(name: str, **fields: tuple[str, int, Any]) -> np.dtype[Any]:
    """Fields of a struct of pymunk: of each its member, bytes after the member's start, type."""
    return np.dtype({
        "names": list(fields), "formats": [kind for _, _, kind in fields.values()],
        "offsets": [ffi.offsetof(name, member) + more for member, more, _ in fields.values()],
        "itemsize": ffi.sizeof(name)})


@cache
def _note() -> Any:
    arbiter_type = _struct(
        "struct cpArbiter", a=("a", 0, np.int64), b=("b", 0, np.int64), nx=("n", 0, float),
        ny=("n", 8, float), count=("count", 0, np.intc), points=("contacts", 0, np.int64),
        process=("processCollision", 0, np.int8))
    point_type = _struct(
        "struct cpContact", ax=("r1", 0, float), ay=("r1", 8, float), bx=("r2", 0, float),
        by=("r2", 8, float), feature=("hash", 0, np.int64))
    itemsize = FOUND.itemsize

    def note(address: int, space: int, table: Any) -> None:
        arbiter = carray(as_pointer(address), (1,), arbiter_type)[0]
        arbiter["process"] = 0
        count = arbiter["count"]
        points = carray(as_pointer(arbiter["points"]), (count,), point_type)
        a = call_for_word(table[3], arbiter["a"]) - 1
        b = call_for_word(table[3], arbiter["b"]) - 1
        if table[0] + count > table[1]:
            room = 2 * (table[0] + count)
            table[2] = call_for_words(table[4], table[2], room * itemsize)
            table[1] = room
        raw = carray(as_pointer(table[2]), (table[1],), FOUND)
        for i in range(count):
            found, point = raw[table[0]], points[i]
            table[0] += 1
            found["shape_a"], found["shape_b"] = a, b
            found["feature"] = point["feature"]
            found["nx"], found["ny"] = arbiter["nx"], arbiter["ny"]
            found["ax"], found["ay"] = point["ax"], point["ay"]
            found["bx"], found["by"] = point["bx"], point["by"]
            found["ahead"] = 0.0

    return cached(note, cacheable(note), lambda function, cache: cfunc(
        "void(intp, intp, CPointer(int64))", cache=cache)(function))
