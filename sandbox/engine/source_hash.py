"""Cache keys: a hash of all sources of a compiled function.

Numba finds a cached function again as long as the file of that one function is unchanged. It does
not look at the functions, constants and record types that the function takes from elsewhere. The
hash covers these, so old machine code is never loaded after a change.
"""

from __future__ import annotations

import builtins
import dis
import hashlib
import platform
import types
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
from llvmlite import binding

from sandbox.engine.kernel import Kernel

Source = Callable[..., Any]
_MACHINERY = ("kernel.py", "source_hash.py", "entry_points.py", "memory.py", "native.py")
_OPTIONS = "CPU_NAME", "CPU_FEATURES", "OPT", "BOUNDSCHECK"


def source_hash(function: Source) -> str:
    """Sixteen digits that change with the code, constants and types that a function reaches."""
    reached: dict[str, Source] = {}
    texts: list[str] = []
    waiting = [function]
    while waiting:
        one = waiting.pop()
        name = f"{one.__module__}.{one.__qualname__}"
        if name in reached:
            if reached[name] is not one:
                raise TypeError(f"{function.__qualname__} uses two functions named {name}")
            continue
        reached[name] = one
        text, calls = _describe(one)
        texts.append(text)
        waiting += calls
    first, *others = texts
    return hashlib.sha256(repr((_base(), first, sorted(others))).encode()).hexdigest()[:16]


def cacheable(function: Callable[..., Any]) -> Any:
    """A copy whose name ends with the hash of its sources, in a file that does not change."""
    copy = types.FunctionType(
        function.__code__.replace(co_filename=__file__, co_firstlineno=1), function.__globals__,
        function.__name__, function.__defaults__, function.__closure__)
    copy.__qualname__ = f"{function.__name__}_{source_hash(function)}"
    copy.__module__, copy.__annotations__ = function.__module__, function.__annotations__
    return copy


@cache
def _base() -> tuple[object, ...]:
    files = b"".join(Path(__file__).with_name(name).read_bytes() for name in _MACHINERY)
    return (platform.python_version(), numba.__version__, llvmlite.__version__, np.__version__,
            binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten(),
            *(getattr(numba.config, name) for name in _OPTIONS), hashlib.sha256(files).hexdigest())


@cache
def _describe(function: Source) -> tuple[str, list[Source]]:
    """The code of one function with the values that it takes from outside, and what it calls."""
    calls: list[Source] = []
    parts = [function.__module__, function.__qualname__, repr(function.__defaults__),
             repr(function.__kwdefaults__)]
    closed = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    parts += [f"{name}={_value(cell.cell_contents, calls)}" for name, cell in closed]
    codes = [function.__code__]
    while codes:
        code = codes.pop()
        parts += [code.co_code.hex(), repr(code.co_names), repr(code.co_varnames),
                  f"{code.co_argcount} {code.co_kwonlyargcount} {code.co_flags}"]
        for i, value in enumerate(code.co_consts):
            if isinstance(value, types.CodeType):
                codes.append(value)
            docstring = i == 0 and isinstance(value, str) and value == function.__doc__
            parts.append("None" if docstring or value is None or value in codes
                         else f"{type(value).__name__} {value!r}")
        steps = list(dis.get_instructions(code))
        for step, following in zip(steps, [*steps[1:], None], strict=True):
            if step.opname in ("LOAD_GLOBAL", "LOAD_NAME"):
                parts.append(f"{step.argval}={_global(function, step.argval, following, calls)}")
    return "\n".join(parts), calls


def _global(
    function: Source, name: str, following: dis.Instruction | None, calls: list[Source],
) -> str:
    scope = function.__globals__
    if name not in scope:
        return f"builtin {getattr(builtins, name).__name__}"
    value = scope[name]
    if isinstance(value, types.ModuleType) and following is not None:
        value = getattr(value, following.argval)
    return _value(value, calls)


def _value(value: Any, calls: list[Source]) -> str:
    if entry_point := getattr(value, "entry_point", None):
        return str(entry_point.source_key)
    if view := getattr(value, "view_of_table", None):
        return str(view)
    if isinstance(value, Kernel):
        calls.append(value.py_func)
        return f"{value.__module__}.{value.__qualname__}"
    if isinstance(value, types.FunctionType):
        if not value.__module__.startswith("numba."):
            calls.append(value)
        return f"{value.__module__}.{value.__qualname__}"
    if isinstance(value, int | float | str | np.generic | tuple | type(None)):
        return f"{type(value).__name__} {value!r}"
    if isinstance(value, np.dtype):
        return repr(value)
    if isinstance(value, types.BuiltinFunctionType | np.ufunc) or (
            isinstance(value, type) and value.__module__ in ("builtins", "numpy")):
        return f"{getattr(value, '__module__', '')}.{value.__name__}"
    if type(value).__name__ == "_Intrinsic":  # of native.py, which is part of the base
        return f"{value._defn.__module__}.{value._name}"
    raise TypeError(f"compiled functions cannot use {value!r} of type {type(value).__name__}; "
                    "use numbers, strings, tuples, dtypes and kernels")
