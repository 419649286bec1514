"""pymunk's own C functions, called from compiled code.

A step of a small hand takes some 12 microseconds in Chipmunk, and going
through Python to read bodies, write forces and step costs more than that
again. The functions behind ``Space.step`` and ``pymunk.batch`` are therefore
called by address from the compiled loop. This is the only module that knows
of pymunk's insides; ``World.read``, ``write`` and ``step`` do the same through
the public interface, and a test holds the two against each other.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pymunk
from llvmlite import ir
from numba import cfunc, types
from numba.extending import intrinsic
from numpy.typing import NDArray
from pymunk import batch
from pymunk._chipmunk_cffi import ffi, lib

from sandbox.errors import SandboxError
from sandbox.numeric import Array, Integers

_WORD, _REAL, _BYTE = ir.IntType(64), ir.DoubleType(), ir.IntType(8)


def _step(context: Any, address: Any, space: Any, h: Any) -> Any:
    """Call ``void f(space, double)`` at ``address``."""
    return types.void(types.intp, types.intp, types.float64), _caller([_WORD, _REAL])


def _each(context: Any, address: Any, space: Any, function: Any, data: Any) -> Any:
    """Call ``void f(space, function, data)`` at ``address``."""
    signature = types.void(types.intp, types.intp, types.intp, types.intp)
    return signature, _caller([_WORD, _WORD, _WORD])


def _with_real(context: Any, address: Any, subject: Any, value: Any) -> Any:
    """Call ``void f(subject, double)`` at ``address``."""
    return types.void(types.intp, types.intp, types.float64), _caller([_WORD, _REAL])


def _with_byte(context: Any, address: Any, subject: Any, value: Any) -> Any:
    """Call ``void f(subject, unsigned char)`` at ``address``."""
    return types.void(types.intp, types.intp, types.uint8), _caller([_WORD, _BYTE])


def _for_real(context: Any, address: Any, subject: Any) -> Any:
    """Call ``double f(subject)`` at ``address``."""
    return types.float64(types.intp, types.intp), _caller([_WORD], _REAL)


def _at(context: Any, address: Any) -> Any:
    """The double at ``address``."""
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(builder.inttoptr(args[0], _REAL.as_pointer()))

    return types.float64(types.intp), generate


def _caller(arguments: list[ir.Type], result: ir.Type | None = None) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        function = ir.FunctionType(result or ir.VoidType(), arguments).as_pointer()
        value = builder.call(builder.inttoptr(args[0], function), args[1:])
        return value if result else context.get_dummy_value()

    return generate


call_step: Any = intrinsic(_step)
call_each: Any = intrinsic(_each)
call_for_real: Any = intrinsic(_for_real)
real_at: Any = intrinsic(_at)
_call_with_real: Any = intrinsic(_with_real)
_call_with_byte: Any = intrinsic(_with_byte)


class Native(NamedTuple):
    """What the compiled loop calls, and with what: addresses in memory, and two counters."""

    step: int
    each_body: int
    space: int
    get: int
    read: int
    put: int
    write: int
    read_count: NDArray[np.intc]
    """Fill of the buffer that is read into, [1]; 0 before each call."""
    write_count: NDArray[np.intc]
    """Fill of the buffer that is written from, [1]; 0 before each call."""
    impulse: int
    """What gives the last impulse of a constraint."""
    handles: Integers
    """The constraints to ask for theirs."""


def address(pointer: Any) -> int:
    """The address that a C pointer holds."""
    return int(ffi.cast("intptr_t", pointer))


class Channel:
    """One batch of body fields: a request for pymunk and the buffer it fills or sends.

    ``count`` [1] is the buffer's fill; set it to 0 before every call.
    """

    def __init__(self, fields: batch.BodyFields, memory: Array) -> None:
        self.memory = memory
        self.buffer = batch.Buffer()
        self.buffer.set_float_buf(memory)
        self.request = ffi.new("pmBatchedData *")
        self.request.fields = fields.value
        self.request.floatArray = self.buffer._float_arr
        self.request.intArray = self.buffer._int_arr
        # the struct begins with its fill, an int
        size = ffi.sizeof("int")
        self.count = np.frombuffer(ffi.buffer(self.buffer._float_arr, size), dtype=np.intc)


def make_native(
    space: pymunk.Space, read: Channel, write: Channel, constraints: list[pymunk.Constraint],
) -> Native:
    """What the compiled loop needs for ``space``; ``constraints`` are asked for their impulses.

    Their property ``impulse`` would cost as much as a third of a step of the whole hand.
    """
    return Native(
        step=address(ffi.addressof(lib, "cpSpaceStep")),
        each_body=address(ffi.addressof(lib, "cpSpaceEachBody")),
        space=address(space._space),
        get=address(ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")),
        read=address(read.request),
        put=address(ffi.addressof(lib, "pmSpaceBodySetIteratorFuncBatched")),
        write=address(write.request),
        read_count=read.count, write_count=write.count,
        impulse=address(ffi.addressof(lib, "cpConstraintGetImpulse")),
        handles=np.array([address(c._constraint) for c in constraints], dtype=np.int64),
    )


# Answers to collisions are compiled, too: Python would be slow there, and cffi prints and drops
# what a callback raises, a Ctrl-C that happens to arrive in it included. Their data are what to
# call, as a number (addresses have less than the 53 bits of a double), and the value to set.
_ANSWER = "void(intp, intp, CPointer(float64))"


@cache
def _set_friction() -> Any:
    @cfunc(_ANSWER, cache=True)
    def set_friction(arbiter: int, space: int, data: Any) -> None:
        _call_with_real(int(data[0]), arbiter, data[1])

    return set_friction


@cache
def _let_pass() -> Any:
    @cfunc(_ANSWER, cache=True)
    def let_pass(arbiter: int, space: int, data: Any) -> None:
        _call_with_byte(int(data[0]), arbiter, np.uint8(data[1]))

    return let_pass


def rub(space: pymunk.Space, a: int, b: int, friction: float) -> Array:
    """Give shapes of collision types ``a`` and ``b`` a coefficient of their own.

    The returned memory must live as long as ``space``.
    """
    data = np.array([address(ffi.addressof(lib, "cpArbiterSetFriction")), friction], dtype=float)
    _handler(space, a, b, data).preSolveFunc = _function(_set_friction())
    return data


def refuse(space: pymunk.Space, a: int, b: int) -> Array:
    """Keep shapes of collision types ``a`` and ``b`` from touching.

    The returned memory must live as long as ``space``.
    """
    data = np.array([address(ffi.addressof(lib, "cpArbiterSetProcessCollision")), 0], dtype=float)
    _handler(space, a, b, data).beginFunc = _function(_let_pass())
    return data


def _handler(space: pymunk.Space, a: int, b: int, data: Array) -> Any:
    handler = lib.cpSpaceAddCollisionHandler(space._space, a, b)
    handler.userData = ffi.cast("void *", data.ctypes.data)
    return handler


def _function(compiled: Any) -> Any:
    return ffi.cast("void (*)(cpArbiter *, cpSpace *, void *)", compiled.address)


def motor_impulse(motor: pymunk.SimpleMotor) -> int:
    """Where pymunk keeps the last impulse of a motor, with its sign [N m s]: that on body ``b``.

    Asked for it, pymunk gives the size only.

    Raises:
        SandboxError: this version of pymunk keeps it elsewhere.
    """
    return address(motor._constraint) + _impulse_offset()


_SEARCHED = range(0, 256, ffi.sizeof("double"))
"""Where in a motor its rate is looked for [bytes]; it stands at 104 in pymunk 7.3."""


@cache
def _impulse_offset() -> int:
    """Bytes from a motor's beginning to its impulse, found and tried on a motor of its own.

    In Chipmunk's struct the rate, the inverse of 1 / I_a + 1 / I_b and the impulse follow one
    another.
    """
    space = pymunk.Space()
    a, b = pymunk.Body(1, 2), pymunk.Body(1, 3)
    motor = pymunk.SimpleMotor(a, b, 0.123456789)
    space.add(a, b, motor)
    start = address(motor._constraint)

    def real(offset: int) -> float:
        return float(ffi.cast("double *", start + offset)[0])

    place = next((offset for offset in _SEARCHED if real(offset) == motor.rate), -1)
    for rate in (-0.987654321, 0.5):
        motor.rate = rate
        space.step(0.01)
        before, found = real(place), real(place + 2 * ffi.sizeof("double"))
        momentum = 3 * b.angular_velocity + 2 * a.angular_velocity  # of both together: none
        if place < 0 or before != rate or abs(found) != motor.impulse or found * rate >= 0 or (
            abs(momentum) > 1e-12
        ):
            raise SandboxError(
                f"pymunk {pymunk.version} keeps the impulse of a motor elsewhere than the versions "
                "that sandbox knows: motors and brakes cannot be simulated with it")
    return int(place + 2 * ffi.sizeof("double"))
